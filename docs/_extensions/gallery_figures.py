"""How examples draw: the colours of the package, and figures that need no pyplot."""

from pathlib import Path
from typing import Any
from weakref import WeakSet

import matplotlib as mpl
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

from lightflyer.foundation.drawing import PALETTE

STYLE = {
    "axes.prop_cycle": mpl.cycler(color=PALETTE),
    "figure.constrained_layout.use": True,
    "figure.figsize": (6.4, 4.2),
    "savefig.dpi": 100,
}

_saved: WeakSet[Figure] = WeakSet()


def take_style(*_: Any) -> None:
    """Colours that people with any colour vision can tell apart, before each example."""
    mpl.rcParams.update(STYLE)


def result_figures(_block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Save the figure that a block ends with, such as ``found.plot()``.

    Parameters
    ----------
    _block : tuple
        The code.
    variables, settings : dict
        As Sphinx-Gallery gives them.

    Returns
    -------
    str
        The picture in reStructuredText; empty where the block ends with no figure.
    """
    shown = variables["example_globals"].get("___")  # what the last block that had a value gave
    if not isinstance(shown, Figure) or not hasattr(shown, "_repr_png_") or shown in _saved:
        return ""
    _saved.add(shown)
    path = Path(next(variables["image_path_iterator"]))
    path.write_bytes(shown._repr_png_())
    return figure_rst([str(path)], settings["src_dir"])
