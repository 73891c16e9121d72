"""The best design, and what its uncertainty comes from."""
