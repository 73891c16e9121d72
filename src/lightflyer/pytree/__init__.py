"""Records that are pytrees of JAX, and JAX itself, which is loaded when something is traced."""
