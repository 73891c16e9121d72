"""Style and saving of all figures. Only this module and those named ``figures`` import matplotlib.

Markers and lines differ in style, for print without colours.
"""

import io
import math
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import Formatter, LogLocator
from matplotlib.transforms import ScaledTranslation

from lightflyer.core.errors import ParameterError
from lightflyer.files.palette import LIMIT, OUTSIDE, PALETTE

MARKERS = "osD^vP*X<"
LINES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
BAND, INTERVAL = "95 % band", "95 % interval"
"""What shaded bands and error bars are, in legends."""

TOO_HOT = "hotter than its film withstands"  # What hatched ranges are
EXTRAPOLATED = "faint: extrapolated"  # What faint ranges are

FORMATS = ("png", "svg", "pdf")  # Endings of the files that :func:`save` writes
OWN_STYLES = ("column",)  # Style sheets of the package: a journal's column of 8.6 cm
DOTS_PER_INCH = 150  # Of a PNG where nothing else is asked

_POINTS_PER_INCH = 72.0
_PACKED = 3  # of 9, of a PNG: twice as fast as usual, and 6 % larger
_WIDTH, _HEIGHT = 6.0, 4.2  # of axes [inch], unless a style sheet gives a size of figures
_PAGE = 9.0  # width of several axes [inch]: letters are legible where a page makes it its width
_OF_COLUMN = 0.95  # that a legend may take: the axes above it are not in the middle
_LINE = 1.35  # height of a line of text, in font sizes
_TIGHT, _ROOMY = 1.0, 2.7  # decades up to which a logarithmic axis has labels between decades
_MANTISSAS = {_TIGHT: (1, 2, 3, 5, 7), _ROOMY: (1, 2, 5), np.inf: (1,)}
_FEW_TICKS = 0.45  # decades below which ticks are no longer at whole multiples of a decade
_SAME = 1e-5  # difference of mantissas that are one
_PLAIN = (1e-4, 1e5)  # numbers that are not written as powers of ten


def series_style(number: int) -> dict[str, Any]:
    """Colour and marker of one of several series."""
    return {"color": PALETTE[number % len(PALETTE)], "marker": MARKERS[number % len(MARKERS)]}


def require_style(style: str) -> None:
    """Raise unless Matplotlib knows a style sheet; ``style``: name or path."""
    try:
        with use_style(style):
            pass
    except (OSError, ValueError):
        raise ParameterError(
            f'--style "{style}": is neither "column", nor a style of Matplotlib, such as '
            '"grayscale", nor a style sheet, such as "journal.mplstyle"'
        ) from None


@contextmanager
def use_style(style: str | None) -> Iterator[None]:
    """Draw in a style within the block."""
    if style is None:
        yield
        return
    own = f"lightflyer.data.{style}" if style in OWN_STYLES else style
    from matplotlib.style import context  # reads all styles

    with context(own):
        yield


class _Figure(Figure):
    """A figure that a notebook shows by itself."""

    def _repr_png_(self) -> bytes:
        written = io.BytesIO()
        self.savefig(written, format="png", dpi=DOTS_PER_INCH)
        return written.getvalue()


def new_figure(
    columns: int = 1, width: float = _WIDTH, height: float = _HEIGHT, rows: int = 1
) -> Figure:
    """An empty figure with axes in a row, or in several; ``width`` [inch]; ``height`` [inch]."""
    # Where the style in use gives a size of figures (``figure.figsize``), that is the size of one
    # axes, and everything else is scaled with it.
    across, up = 1.0, 1.0
    given, usual = (
        list(chosen["figure.figsize"]) for chosen in (mpl.rcParams, mpl.rcParamsDefault)
    )
    if given != usual:
        across, up = given[0] / _WIDTH, given[1] / _HEIGHT
    else:
        width = min(width, _PAGE / columns)
    figure = _Figure(figsize=(columns * width * across, height * up), layout="constrained")
    figure.subplots(rows, columns)
    if mpl.rcParams["axes.prop_cycle"] == mpl.rcParamsDefault["axes.prop_cycle"]:
        for axes in figure.axes:
            axes.set_prop_cycle(color=PALETTE)
    return figure


def figure_for(ax: Axes | None, **options: Any) -> tuple[Figure, Axes]:
    """Axes to draw on: those given, or those of a new figure; returns ``figure``, ``ax``."""
    if ax is None:
        figure = new_figure(**options)
        return figure, figure.axes[0]
    owner = ax.get_figure(root=True)
    assert owner is not None  # axes that can be drawn on have one
    return owner, ax


def save(figure: Figure, paths: list[Path], dpi: int = DOTS_PER_INCH) -> None:
    """Write a figure, the same bytes every time; ``dpi``: dots per inch of a PNG."""
    figure.set_dpi(dpi)
    FigureCanvasAgg(figure)
    if (engine := figure.get_layout_engine()) is not None:
        for ax in figure.axes:  # at the sides they are no wider than labels, and slow to measure
            ax.spines[["left", "right"]].set_in_layout(False)
        engine.execute(figure)
        figure.set_layout_engine("none")  # laid out: not again for every format
    # the canvases are called directly because savefig draws everything twice
    with mpl.rc_context({"svg.hashsalt": "lightflyer", "svg.fonttype": "none"}):
        for path in paths:
            if path.suffix == ".svg":
                blank = {"Date": None, "Creator": None}
                canvas: Any = FigureCanvasSVG(figure)
                canvas.print_svg(path, metadata=blank)
            elif path.suffix == ".pdf":
                from matplotlib.backends.backend_pdf import FigureCanvasPdf  # takes a while

                canvas = FigureCanvasPdf(figure)
                canvas.print_pdf(path, metadata={"CreationDate": None, "Creator": None})
            else:
                canvas = FigureCanvasAgg(figure)
                canvas.print_png(
                    path, metadata={"Software": None}, pil_kwargs={"compress_level": _PACKED}
                )


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class _PlainNumbers(Formatter):
    """Numbers of a logarithmic axis: decades, and some between where few decades are shown."""

    def __call__(self, x: float, pos: int | None = None) -> str:  # noqa: ARG002
        low, high = sorted(self.axis.get_view_interval()) if self.axis else (x, x)
        decades = math.log10(high / low) if low > 0.0 else math.inf
        exponent = math.floor(math.log10(x) + 1e-9)
        mantissa = x / 10.0**exponent
        if decades >= _FEW_TICKS:
            shown = next(some for most, some in _MANTISSAS.items() if decades <= most)
            if not any(abs(mantissa - one) < _SAME for one in shown):
                return ""
        if _PLAIN[0] <= x < _PLAIN[1]:
            return f"{x:.6g}"
        factor = "" if abs(mantissa - 1.0) < _SAME else f"{mantissa:.3g}·"
        return f"{factor}10{str(exponent).translate(_RAISED)}"  # ten times quicker than mathtext


def plain_decades(axis: Axis, between: Sequence[int] = range(2, 10)) -> None:
    """Label a logarithmic axis in plain numbers, between decades too where it shows few of them."""
    axis.set_major_formatter(_PlainNumbers())
    axis.set_minor_locator(LogLocator(subs=between))
    axis.set_minor_formatter(_PlainNumbers())


def label_axes(ax: Axes, x: str, y: str, *, log: str = "") -> None:
    """Label axes and draw a grid; those in ``log`` are logarithmic, labelled in plain numbers."""
    ax.set(xlabel=x, ylabel=y)
    for name, axis in (("x", ax.xaxis), ("y", ax.yaxis)):
        if name in log:
            ax.set(**{f"{name}scale": "log"})
            plain_decades(axis)
    ax.grid(alpha=0.25, which="both" if log == "xy" else "major")


def outline_effects(width: float = 3.0, colour: str = "black") -> list[AbstractPathEffect]:
    """Path effects that make a line or a text stand out from any colour below it."""
    return [withStroke(linewidth=width, foreground=colour)]


def wrap_label(label: str, width: int = 28) -> str:
    """A long label of an axis in several lines; ``width`` [characters]; ``width``: of a line."""
    return "\n".join(textwrap.wrap(label, width))


def hatch(ax: Axes, low: float, high: float) -> None:
    """Hatch a range of the axis where a film is too hot; one entry in the legend."""
    named = TOO_HOT in ax.get_legend_handles_labels()[1]
    ax.axvspan(
        low, high, facecolor="none", edgecolor=LIMIT, hatch="///", alpha=0.35, lw=0.0,
        label=None if named else TOO_HOT,
    )  # fmt: skip


def legend_below(
    ax: Axes, handles: Sequence[Any] | None = None, *, most: int = 3, title: str | None = None
) -> None:
    """Put the legend under the axes, where it hides no data; ``ax``: with its label."""
    handles = ax.get_legend_handles_labels()[0] if handles is None else handles
    if not handles:
        return
    rows = -(-len(handles) // most)
    figure = ax.get_figure(root=True)
    assert figure is not None  # axes that can be drawn on have one
    chosen = mpl.rcParams
    ticks = chosen["xtick.major.size"] + chosen["xtick.major.pad"]
    ticks += _LINE * FontProperties(size=chosen["xtick.labelsize"]).get_size_in_points()
    lines = 1 + ax.get_xlabel().count("\n")
    label = chosen["axes.labelpad"] + lines * _LINE * float(ax.xaxis.label.get_fontsize())
    below = ScaledTranslation(
        0.0,
        -float(ticks + (label if ax.get_xlabel() else 0.0)) / _POINTS_PER_INCH,
        figure.dpi_scale_trans,
    )
    room = ax.get_subplotspec()
    columns = 1 if room is None else room.get_gridspec().ncols
    width = _OF_COLUMN * figure.get_figwidth() * figure.dpi / columns
    renderer: Any = FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]
    for number in range(-(-len(handles) // rows), 0, -1):
        legend = ax.legend(
            handles=handles,
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            bbox_transform=ax.transAxes + below,
            borderaxespad=0.0,
            frameon=False,
            ncols=number,
            columnspacing=1.2,
            handlelength=1.7,
            handletextpad=0.6,
            fontsize="small",
            title=title,
            title_fontsize="small",
        )
        if legend.get_window_extent(renderer).width < width:
            break


def shared_legend(
    figure: Figure, handles: Sequence[Any], *, most: int = 4, title: str | None = None
) -> None:
    """Put one legend for all axes of a figure under them; ``figure``: with a layout engine."""
    rows = -(-len(handles) // most)
    renderer: Any = FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]
    for number in range(-(-len(handles) // rows), 0, -1):
        legend = figure.legend(
            handles=handles,
            loc="outside lower center",
            frameon=False,
            ncols=number,
            columnspacing=1.2,
            handlelength=1.7,
            handletextpad=0.6,
            fontsize="small",
            title=title,
            title_fontsize="small",
        )
        if number == 1 or legend.get_window_extent(renderer).width < figure.bbox.width:
            break
        legend.remove()


def fade(ax: Axes, low: float, high: float) -> None:
    """Fade what is drawn in a range of the axis along which a model is outside its range."""
    named = EXTRAPOLATED in ax.get_legend_handles_labels()[1]
    ax.axvspan(
        low, high, facecolor="white", edgecolor=OUTSIDE, alpha=0.65, lw=0.5, zorder=2.5,
        label=None if named else EXTRAPOLATED,
    )  # fmt: skip
