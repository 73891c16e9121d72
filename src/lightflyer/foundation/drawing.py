"""Style and saving of all figures. Only this module and those named ``figures`` import matplotlib.

Colours are Okabe and Ito's, which people with any colour vision can tell apart, and lines differ
in style too.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.style
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from lightflyer.foundation.errors import ParameterError

BLUE, ORANGE, GREEN, VERMILION, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#777777"
SKY, PURPLE, YELLOW = "#56B4E9", "#CC79A7", "#F0E442"
PALETTE = (BLUE, VERMILION, GREEN, ORANGE, "black")
MARKERS = "osD^vP*X"

FORMATS = ("png", "svg", "pdf")
"""Endings of the files that :func:`save` writes."""

_DOTS_PER_INCH = 150


def require_style(style: str, prefix: str = "") -> None:
    """Raise unless Matplotlib knows a style sheet.

    Parameters
    ----------
    style : str
        Name or path.
    prefix : str
        Of the message.

    Raises
    ------
    ParameterError
    """
    try:
        with styled(style):
            pass
    except (OSError, ValueError):
        raise ParameterError(
            f'{prefix}"{style}": is neither a style of Matplotlib, such as "grayscale", nor a '
            'style sheet, such as "journal.mplstyle"'
        ) from None


@contextmanager
def styled(style: str | None) -> Iterator[None]:
    """Draw in a style within the block.

    Parameters
    ----------
    style : str or None
        Style sheet of Matplotlib, by name or path; None for the one in use. Colours that tell
        curves apart stay those of this package.
    """
    if style is None:
        yield
        return
    with matplotlib.style.context(style):
        yield


def new_figure(columns: int = 1, width: float = 6.0, height: float = 4.2, rows: int = 1) -> Figure:
    """An empty figure with axes in a row, or in several.

    Parameters
    ----------
    columns : int
    width : float
        Of each axes [inch].
    height : float
        Of the figure [inch].
    rows : int

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = Figure(figsize=(columns * width, height), layout="constrained")
    figure.subplots(rows, columns)
    return figure


def save(figure: Figure, paths: list[Path], dpi: int = _DOTS_PER_INCH) -> None:
    """Write a figure, the same bytes every time.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    paths : list of Path
        The suffix chooses the format, one of :data:`FORMATS`.
    dpi : int
        Dots per inch of a PNG.
    """
    figure.set_dpi(dpi)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out: not again for every format
    # the canvases are called directly because savefig draws everything twice
    with mpl.rc_context({"svg.hashsalt": "lightflyer", "svg.fonttype": "none"}):
        for path in paths:
            if path.suffix == ".svg":
                blank = {"Date": None, "Creator": None}
                canvas: Any = FigureCanvasSVG(figure)
                canvas.print_svg(path, metadata=blank)
            elif path.suffix == ".pdf":
                canvas = FigureCanvasPdf(figure)
                canvas.print_pdf(path, metadata={"CreationDate": None, "Creator": None})
            else:
                canvas = FigureCanvasAgg(figure)
                canvas.print_png(path, metadata={"Software": None})


def plain_decades(axis: Axis) -> None:
    """Label decades in plain numbers, which read as well as powers and draw much faster.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        A logarithmic one.
    """
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_locator(LogLocator(subs=range(2, 10)))
    axis.set_minor_formatter(NullFormatter())
