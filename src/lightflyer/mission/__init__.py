"""Missions: trajectories of flyers through days, nights and winds."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
