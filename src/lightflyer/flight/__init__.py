"""From flyer, surroundings and force model to temperature, lift, levitation and bands."""
