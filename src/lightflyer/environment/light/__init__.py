"""The sun, the sky and the ground: the light and heat radiation that they send."""
