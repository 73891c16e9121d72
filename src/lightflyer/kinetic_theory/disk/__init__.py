"""The disk problem on one mesh: linear and non-linear."""
