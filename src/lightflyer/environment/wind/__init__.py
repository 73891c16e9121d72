"""Winds: one model a module."""
