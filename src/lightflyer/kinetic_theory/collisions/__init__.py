"""Collisions of real molecules in place of a model equation, for the linear disk problem."""
