"""Methods by which results draw themselves, with modules of figures that are imported then."""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NEW_AXES = "By default that of a new figure."

_PARAMETERS = """
        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            {}
"""
_DOCUMENTATION = """Draw {}.
{}
        Returns
        -------
        matplotlib.figure.Figure
        """


def figure_method(figure: str, what: str, axes: str = "") -> "Callable[..., Figure]":
    """Method ``plot`` that calls a function by its dotted name; ``axes``: what these may be."""
    module, _, name = figure.rpartition(".")

    def plot(self: Any) -> "Figure":
        drawn: Figure = getattr(import_module(module), name)(self)
        return drawn

    def plot_on(self: Any, ax: "Axes | None" = None) -> "Figure":
        drawn: Figure = getattr(import_module(module), name)(self, ax)
        return drawn

    method = plot_on if axes else plot
    method.__name__ = "plot"
    method.__doc__ = _DOCUMENTATION.format(what, _PARAMETERS.format(axes) if axes else "")
    return method
