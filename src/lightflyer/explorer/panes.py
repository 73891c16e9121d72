"""Figures of the page as Bokeh draws them, with empty sources that the page fills.

Every figure, source and axis has a name, by which the page finds it. Colours are those of all
figures of the package; the page sets those of text, grid and background, light or dark.
"""

from functools import cache
from typing import Any, Literal

from bokeh.embed import json_item
from bokeh.models import (
    BasicTickFormatter,
    ColumnDataSource,
    FactorRange,
    FixedTicker,
    HoverTool,
    LinearColorMapper,
    LogTicker,
    Range1d,
)
from bokeh.palettes import Cividis256
from bokeh.plotting import figure

from lightflyer.explorer.view import FAINT
from lightflyer.files.palette import (
    AVAILABLE,
    BLUE,
    GREEN,
    GREY,
    LIMIT,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
)

Scale = Literal["log", "linear", "auto"]
Mode = Literal["mouse", "vline"]
LOGARITHMIC: Scale = "log"
LINEAR: Scale = "linear"

_LINE = 2.5
_FONT = "13px"
_PINNED = "pins"
_WAVELENGTHS = (0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)  # labelled [µm]


@cache
def panes(*, logarithmic: bool) -> dict[str, Any]:
    """All figures, for surroundings of a kind."""
    along = LOGARITHMIC if logarithmic else LINEAR
    drawn = {
        "irradiance": _irradiance(along),
        "temperature": _temperature(along),
        "payload": _payload(along),
        "map": _map(along),
        "models": _models(along),
        "film": _film(),
        "sensitivity": _sensitivity(),
        "mission": _mission(),
        "track": _track(),
    }
    return {name: json_item(pane) for name, pane in drawn.items()}


def _empty(name: str, *columns: str) -> ColumnDataSource:
    return ColumnDataSource({column: [] for column in columns}, name=name)


def _range(name: str) -> Range1d:
    return Range1d(start=0.1, end=1.0, name=name)


def _figure(name: str, x: Scale, y: Scale, **more: Any) -> Any:
    ranges = {"x_range": _range("x"), "y_range": _range("y")}
    made = figure(
        name=name,
        sizing_mode="stretch_both",
        x_axis_type=x,
        y_axis_type=y,
        tools="",
        toolbar_location=None,
        min_border_right=16,
        outline_line_color=None,
        **(ranges | more),
    )
    made.xaxis.name, made.yaxis.name = "x-axis", "y-axis"
    for scale, axis in ((x, made.xaxis), (y, made.yaxis)):
        if scale == LOGARITHMIC:
            axis.ticker = LogTicker(mantissas=[1, 2, 5], desired_num_ticks=8)
    for axis in (made.xaxis, made.yaxis):
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = axis.major_label_text_font_size = _FONT
        axis.axis_label_text_font = axis.major_label_text_font = "system-ui, sans-serif"
    return made


def _hover(
    pane: Any,
    renderers: list[Any],
    tooltips: list[tuple[str, str]],
    mode: Mode,
    name: str = "hover",
) -> None:
    """Show values below the pointer; the page puts units into the one named ``hover``."""
    tool = HoverTool(
        renderers=renderers, tooltips=tooltips, mode=mode, point_policy="snap_to_data", name=name
    )
    pane.add_tools(tool)


def _coordinate_figure(name: str, along: Scale, up: Scale, *outputs: str) -> tuple[Any, Any]:
    """A figure over the coordinate: bands of flight, 95 % band, pinned curves, the place shown."""
    pane = _figure(name, along, up)
    pane.vstrip("low", "high", source=_empty("flies", "low", "high"), fill_color=GREEN,
                fill_alpha=0.13, line_color=None)  # fmt: skip
    pane.varea("x", "low", "high", source=_empty("band", "x", "low", "high"), fill_color=BLUE,
               fill_alpha=0.22)  # fmt: skip
    pane.multi_line("xs", "ys", source=_empty(_PINNED, "xs", "ys", "colour"), line_color="colour",
                    line_width=_LINE, line_dash="dashdot")  # fmt: skip
    pane.vspan("x", source=_empty("place", "x"), line_color=GREY, line_width=1.5,
               line_dash="dotted")  # fmt: skip
    return pane, _empty("curve", "x", *outputs)


def _level(pane: Any, colour: str = AVAILABLE) -> None:
    pane.line("x", "y", source=_empty("level", "x", "y"), line_color=colour, line_width=_LINE,
              line_dash="dashed")  # fmt: skip


def _best(pane: Any) -> None:
    pane.scatter("x", "y", source=_empty("best", "x", "y"), marker="star", size=15,
                 fill_color=ORANGE, line_color=GREY)  # fmt: skip


def _irradiance(along: Scale) -> Any:
    pane, source = _coordinate_figure("irradiance", along, LOGARITHMIC, "needed", "inside")
    _level(pane)
    pane.line("x", "inside", source=source, line_color=BLUE, line_width=_LINE)
    line = pane.line("x", "needed", source=source, line_color=BLUE, line_width=_LINE,
                     line_alpha=FAINT)  # fmt: skip
    points = _empty("points", "x", "y", "low", "high", "sample")
    pane.segment("x", "low", "x", "high", source=points, line_color=PURPLE, line_width=1.5)
    dots = pane.scatter("x", "y", source=points, marker="diamond", size=9, fill_color=PURPLE,
                        line_color=PURPLE)  # fmt: skip
    _best(pane)
    _hover(pane, [line], [("", "@x{0.00}"), ("needed", "@needed{0,0.0} W/m²")], "vline")
    tips = [("measured", "@sample"), ("", "@y{0,0.0} W/m²")]
    _hover(pane, [dots], tips, "mouse", name="points-hover")
    return pane


def _temperature(along: Scale) -> Any:
    pane, source = _coordinate_figure("temperature", along, LINEAR, "flyer", "gas")
    _level(pane, LIMIT)
    pane.multi_line("xs", "ys", source=_empty("nodes", "xs", "ys", "colour"), line_color="colour",
                    line_width=_LINE)  # fmt: skip
    pane.line("x", "gas", source=source, line_color=GREY, line_width=_LINE, line_dash="dotted")
    line = pane.line("x", "flyer", source=source, line_color=BLUE, line_width=_LINE)
    tips = [("", "@x{0.00}"), ("flyer", "@flyer{0.0} K"), ("gas", "@gas{0.0} K")]
    _hover(pane, [line], tips, "vline")
    return pane


def _payload(along: Scale) -> Any:
    pane, source = _coordinate_figure("payload", along, LINEAR, "payload", "inside")
    pane.line("x", "inside", source=source, line_color=BLUE, line_width=_LINE)
    line = pane.line("x", "payload", source=source, line_color=BLUE, line_width=_LINE,
                     line_alpha=FAINT)  # fmt: skip
    pane.hspan(0.0, line_color=GREY, line_width=1.0)
    _best(pane)
    _hover(pane, [line], [("", "@x{0.00}"), ("payload", "@payload{0.0000}")], "vline")
    return pane


def _map(along: Scale) -> Any:
    """Payload as coloured cells; a click is the page's."""
    pane = _figure("map", LOGARITHMIC, along)
    mapper = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0, nan_color="#00000000")
    mapper.name = "colours"
    cells = _empty("cells", "left", "right", "bottom", "top", "value", "x", "y")
    quads = pane.quad(
        "left", "right", "bottom", "top", source=cells,
        fill_color={"field": "value", "transform": mapper},
        line_color={"field": "value", "transform": mapper},  # no seams between cells
    )  # fmt: skip
    here = _empty("here", "x", "y")
    for colour, width in (("white", 6.0), (VERMILION, 2.5)):
        pane.scatter("x", "y", source=here, marker="cross", size=18, line_color=colour,
                     line_width=width)  # fmt: skip
    pane.scatter("x", "y", source=_empty("best", "x", "y"), marker="star", size=20,
                 fill_color=ORANGE, line_color="black")  # fmt: skip
    bar = quads.construct_color_bar(width=12, bar_line_color=None)
    pane.add_layout(bar, "right")
    _hover(pane, [quads], [("size", "@x{0.000}"), ("at", "@y{0.0}"), ("payload", "@value{0.0000}")],
           "mouse")  # fmt: skip
    return pane


def _models(along: Scale) -> Any:
    pane = _figure("models", along, LOGARITHMIC)
    source = _empty("curves", "xs", "ys", "colour", "name", "dash", "alpha")
    lines = pane.multi_line(
        "xs", "ys", source=source, line_color="colour", line_width=_LINE, line_dash="dash",
        line_alpha="alpha",
    )  # fmt: skip
    _level(pane)
    _hover(pane, [lines], [("", "@name"), ("at", "$data_x{0.0}"), ("", "$data_y{0,0.0} W/m²")],
           "mouse")  # fmt: skip
    return pane


def _film() -> Any:
    pane = _figure("film", LOGARITHMIC, LINEAR)
    pane.xaxis.ticker = FixedTicker(ticks=list(_WAVELENGTHS))
    pane.xaxis.formatter = BasicTickFormatter()
    light = _empty("light", "x", "zero", "y")
    pane.varea("x", "zero", "y", source=light, fill_color=ORANGE, fill_alpha=0.22)
    heat = _empty("heat", "x", "zero", "y")
    pane.varea("x", "zero", "y", source=heat, fill_color=GREY, fill_alpha=0.22)
    source = _empty("curve", "x", "absorptance", "reflectance", "transmittance")
    looks = {"reflectance": (BLUE, "dashed"), "transmittance": (GREEN, "dashdot"),
             "absorptance": (VERMILION, "solid")}  # fmt: skip
    for name, (colour, dash) in looks.items():
        line = pane.line("x", name, source=source, line_color=colour, line_width=_LINE,
                         line_dash=dash)  # fmt: skip
    tips = [(name, f"@{name}{{0.000}}") for name in looks]
    _hover(pane, [line], [("wavelength", "@x{0.00} µm"), *tips], "vline")
    return pane


def _sensitivity() -> Any:
    pane = _figure("sensitivity", LINEAR, "auto", y_range=FactorRange(name="y"))
    bars = pane.hbar(
        y="name", left=0.0, right="value", height=0.7,
        source=_empty("bars", "name", "value", "colour", "text"), fill_color="colour",
        line_color=None,
    )  # fmt: skip
    pane.vspan(0.0, line_color=GREY)
    _hover(pane, [bars], [("", "@name"), ("", "@text")], "mouse")
    return pane


def _mission() -> Any:
    pane = _figure("mission", LINEAR, LINEAR)
    pane.vstrip("low", "high", source=_empty("nights", "low", "high"), fill_color=GREY,
                fill_alpha=0.22, line_color=None)  # fmt: skip
    line = _flight(pane, "light", "temperature")
    tips = [("after", "@x{0.0} h"), ("altitude", "@y{0.00} km"), ("light", "@light{0,0} W/m²"),
            ("flyer", "@temperature{0.0} K")]  # fmt: skip
    _hover(pane, [line], tips, "vline")
    return pane


def _track() -> Any:
    """The way over the ground."""
    pane = _figure("track", LINEAR, LINEAR)
    pane.line("x", "y", source=_empty("shores", "x", "y"), line_color=GREY, line_width=1.0)
    line = _flight(pane, "utc")
    pane.scatter("x", "y", source=_empty("release", "x", "y"), marker="triangle", size=10,
                 fill_color=BLUE, line_color=None)  # fmt: skip
    tips = [("", "@utc"), ("longitude", "@x{0.00}°"), ("latitude", "@y{0.00}°")]
    _hover(pane, [line], tips, "mouse")
    return pane


def _flight(pane: Any, *columns: str) -> Any:
    """Line of a flight over those of its ensemble, its end, and where it is at the time shown."""
    pane.multi_line("xs", "ys", source=_empty("members", "xs", "ys"), line_color=SKY,
                    line_width=1.0, line_alpha=0.6)  # fmt: skip
    line = pane.line("x", "y", source=_empty("curve", "x", "y", *columns), line_color=BLUE,
                     line_width=_LINE)  # fmt: skip
    pane.scatter("x", "y", source=_empty("end", "x", "y"), size=10, fill_color=VERMILION,
                 line_color=None)  # fmt: skip
    pane.scatter("x", "y", source=_empty("now", "x", "y"), size=12, fill_color=ORANGE,
                 line_color=GREY)  # fmt: skip
    return line
