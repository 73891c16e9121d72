"""How strongly it is pushed: one force model a file."""
