"""Where it flies: chamber, Earth; gas state, gravity and radiation."""
