"""The force model from kinetic theory."""
