"""How examples stand and draw: their order, the package's colours, figures that need no pyplot."""

from pathlib import Path
from typing import Any
from weakref import WeakSet

import matplotlib as mpl
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

from lightflyer.files.palette import PALETTE

STYLE = {
    "axes.prop_cycle": mpl.cycler(color=PALETTE),
    "figure.constrained_layout.use": True,
    "figure.figsize": (6.4, 4.2),
    "savefig.dpi": 100,
}

ORDER = (
    "lu2023_altitudes.py",
    "lu2023_sizes.py",
    "lu2023_lamp.py",
    "force_over_knudsen.py",
    "cortes2020_plate.py",
    "schafer2025_disk.py",
    "celenza2023_kilogram.py",
    "experimentalist.py",
    "designer.py",
    "theorist.py",
)
"""Examples, the simplest first; others follow by name."""

_saved: WeakSet[Figure] = WeakSet()


class Order:
    """Key by which examples are sorted.

    Parameters
    ----------
    _folder : str
        Of the examples.
    """

    def __init__(self, _folder: str) -> None:
        self._places = {name: place for place, name in enumerate(ORDER)}

    def __call__(self, name: str) -> tuple[int, str]:
        """Place of an example, by the name of its file."""
        return self._places.get(name, len(ORDER)), name


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
