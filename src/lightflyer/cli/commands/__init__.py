"""Commands, one a module; those of the lab bench are in ``cli/lab``."""
