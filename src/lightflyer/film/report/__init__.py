"""Optics and mass of a film as summaries, tables and figures."""
