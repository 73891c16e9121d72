"""The paper's figures, and the numbers behind them, as tables that are written beside them.

Measured points are drawn only where the user gives them.
"""

from collections.abc import Callable, Iterator
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.calibration.points import Points
from lightflyer.core import constants
from lightflyer.design.outputs import OUTPUTS
from lightflyer.files.drawing import (
    MARKERS,
    legend_below,
    new_figure,
    outline_effects,
    plain_decades,
    shared_legend,
)
from lightflyer.files.palette import BLUE, GREY, ORANGE, VERMILION
from lightflyer.paper.conditions import (
    COLUMNS,
    DECIDING,
    Table,
    atmosphere,
    facts,
    film,
    in_chamber,
    over_altitude,
)
from lightflyer.paper.results import bands, best_payload, film_mass, planck_per_wavenumber

Curves = dict[str, np.ndarray]  # Columns by name with unit; all of a figure have one length
TORR = constants.SEA_LEVEL_PRESSURE / 760.0  # Definition of the unit [Pa]

COATINGS = ("ge", "cnt")
PANEL_SIZES_CM = (2, 3, 4)  # Diameters of Fig. 5(b-d) [cm]
SIZES_CM = np.round(np.arange(0.2, 6.01, 0.05), 2)  # Diameters of Fig. S8 [cm]
LARGER_SIZES_CM = (3, 4)  # Diameters of Fig. S7(a, b) and (c, d) [cm]
PLANCK_TEMPERATURES = (400, 500)  # Temperatures of Fig. 3(c) [K]

MAP_PRESSURES_MTORR = np.geomspace(1.0, 300.0, 61)
MAP_IRRADIANCES = np.linspace(0.0, 4000.0, 41)

_OBLIQUE = 45.0  # degrees, Fig. 6(a)
_ALTITUDES_KM = np.linspace(55.0, 90.0, 351)

_STYLES = {"printed": "--", "reported": "-", "reported-mean": ":"}
_COLOURS = {"ge": BLUE, "cnt": VERMILION}
_NAMES = {"ge": "Ge", "cnt": "CNT"}
_MILLI, _KILO, _CENTIMETRE = 1e-3, 1e3, 1e-2
_BETWEEN = 2, 5  # ticks between decades: more take longer to draw than the curves
_WITH_LEGEND = 4.8  # height of a figure [inch]
_ABOVE_LABELS = 3.5  # font sizes that a letter is above axes with ticks and a label on top
_FLIGHT_KM = (60.0, 88.0)  # drawn range of Fig. 6
_MEASURED_FIGURES = ("2", "S2", "S3")


def _curve(words: str, output: str, table: Table) -> Curves:
    """A column of an output, in the unit it is shown in; NaN where there is no value."""
    factor, unit = OUTPUTS[output].shown
    values = factor * table[output]
    return {f"{words} [{unit or 1}]": np.where(np.isfinite(values), values, np.nan)}


def figure_3c() -> Curves:
    """Planck radiance over the wavenumbers of the measured spectra."""
    wavenumber = np.linspace(400.0, 4000.0, 361)
    curves = {"wavenumber [1/cm]": wavenumber}
    for temperature in PLANCK_TEMPERATURES:
        radiance = planck_per_wavenumber(wavenumber, temperature)
        curves[f"radiance at {temperature} K [W/(m^2 sr cm^-1)]"] = radiance
    return curves


def figure_5a() -> Curves:
    """Temperature of the 2-cm disks over pressure and irradiance, reported reading."""
    pressure, light = np.meshgrid(MAP_PRESSURES_MTORR, MAP_IRRADIANCES, indexing="ij")
    curves = {"pressure [mTorr]": pressure.ravel(), "irradiance [W/m^2]": light.ravel()}
    for coating in COATINGS:
        table = in_chamber(
            COLUMNS[1],
            film(coating),
            curves["pressure [mTorr]"] * _MILLI * TORR,
            PANEL_SIZES_CM[0] * _CENTIMETRE,
            curves["irradiance [W/m^2]"],
        )
        curves |= _curve(f"temperature {coating}", "temperature", table)
        curves |= _curve(f"lift over weight {coating}", "lift_over_weight", table)
    return curves


def figure_5bcd() -> Curves:
    """Irradiance to levitate against pressure, both coatings, three sizes, all readings."""
    pressure = np.geomspace(1.0, 300.0, 201)
    curves = {"pressure [mTorr]": pressure, "pressure [Pa]": pressure * _MILLI * TORR}
    for size in PANEL_SIZES_CM:
        for coating in COATINGS:
            for column in COLUMNS:
                table = in_chamber(
                    column, film(coating), curves["pressure [Pa]"], size * _CENTIMETRE
                )
                words = f"irradiance {size} cm {coating} {column.key}"
                curves |= _curve(words, "levitation_irradiance", table)
    return curves


def _flight_curves(size_cm: float, words: str = "") -> Curves:
    """Irradiance and temperature to levitate against altitude, all readings."""
    curves: Curves = {}
    for column in COLUMNS:
        for name, incidence in (("", 0.0), (" 45 deg", _OBLIQUE)):
            table = over_altitude(
                column,
                _ALTITUDES_KM * _KILO,
                size_cm * _CENTIMETRE,
                constants.SOLAR_CONSTANT_LU2023,
                incidence,
            )
            label = f"irradiance{name}{words} {column.key}"
            curves |= _curve(label, "levitation_irradiance", table)
        curves |= _curve(f"temperature{words} {column.key}", "levitation_temperature", table)
    return curves


def _altitudes() -> Curves:
    """Altitudes of the curves, and the temperature of the air."""
    _, temperature = atmosphere(_ALTITUDES_KM * _KILO)
    return {"altitude [km]": _ALTITUDES_KM, "gas temperature [K]": temperature}


def figure_6() -> Curves:
    """Irradiance and temperature to levitate against altitude, 2 cm, all readings."""
    return _altitudes() | _flight_curves(PANEL_SIZES_CM[0])


def figure_s7() -> Curves:
    """As Fig. 6 for larger disks."""
    curves = _altitudes()
    for size in LARGER_SIZES_CM:
        curves |= _flight_curves(size, f" {size} cm")
    return curves


def figure_s8() -> Curves:
    """Altitudes and largest payload over size, each at its best altitude, all readings."""
    curves = {"diameter [cm]": SIZES_CM}
    for column in COLUMNS:
        lower, best, upper = bands(column, SIZES_CM * _CENTIMETRE)
        for name, altitude in (("lower edge", lower), ("optimal", best), ("upper edge", upper)):
            curves[f"{name} {column.key} [km]"] = altitude / _KILO
        _, relative = best_payload(column, SIZES_CM * _CENTIMETRE)
        curves[f"payload {column.key} [mg]"] = relative * film_mass(SIZES_CM * _CENTIMETRE)
        curves[f"relative payload {column.key} [1]"] = relative
    return curves


FIGURES: dict[str, tuple[str, Callable[[], Curves]]] = {
    "figure-3c": ("Fig. 3(c), right axis", figure_3c),
    "figure-5a": ("Fig. 5(a)", figure_5a),
    "figure-5bcd": ("Fig. 5(b–d)", figure_5bcd),
    "figure-6": ("Fig. 6(a, b)", figure_6),
    "figure-s7": ("Fig. S7(a–d)", figure_s7),
    "figure-s8": ("Fig. S8(a, b)", figure_s8),
}
"""Title of each figure and the function that computes its numbers, by file name."""


def captions() -> dict[str, str]:
    """Caption of each figure, with its conditions, by file name."""
    chamber = facts()["chamber"]["note"]
    versions = (
        "Figs. 6 and S8 of the paper may come from slightly different versions of its model: the "
        "3-cm payload in its text follows if (20) takes the mean temperature, not the disk's."
    )
    return {
        "figure-3c": "Blackbody radiance per wavenumber at 400 K and 500 K; shaded, the window of "
        "900 ± 400 cm⁻¹. The measured spectra of the left axis are not available.",
        "figure-5a": f"Temperature of 2-cm disks over pressure and irradiance, reported reading; "
        f"above the white line they levitate. {chamber}",
        "figure-5bcd": f"Irradiance to levitate against pressure. {chamber}",
        "figure-6": f"2-cm disk in the paper's atmosphere: (a) irradiance to levitate, at normal "
        f"incidence and 45°; (b) its temperature when it just levitates, and that of the air. "
        f"{versions}",
        "figure-s7": "As Fig. 6, for disks of (a, b) 3 cm and (c, d) 4 cm. The paper's caption "
        "refers to Fig. 5, but its text speaks of altitudes.",
        "figure-s8": f"Over the disk's diameter, at 1360 W/m²: (a) altitudes at which it levitates "
        f"(shaded for the reported reading, edges for the others) and altitude of the largest "
        f"payload; (b) largest payload, thick, and relative payload, thin. {versions}",
    }


def rows(curves: Curves) -> Iterator[str]:
    """Lines of a CSV file with the curves; a cell without a value is empty."""
    yield ",".join(curves)
    for values in zip(*curves.values(), strict=True):
        yield ",".join("" if np.isnan(value) else f"{value:.8g}" for value in values)


def _letter(ax: Axes, letter: str) -> None:
    # at a stated place: Matplotlib measures all ticks again and again to find it by itself
    above = _ABOVE_LABELS * mpl.rcParams["font.size"] if ax.child_axes else None
    ax.set_title(f"({letter})", loc="left", fontweight="bold", y=1.0, pad=above)


def _torr_axis(ax: Axes) -> None:
    """Pressure in mTorr below, in Pa above."""
    ax.set_xscale("log")
    ax.set_xlabel("pressure [mTorr]")
    plain_decades(ax.xaxis, _BETWEEN)
    scale = _MILLI * TORR

    def to_pascal(pressure: Any) -> Any:
        return pressure * scale

    def to_millitorr(pressure: Any) -> Any:
        return pressure / scale

    top = ax.secondary_xaxis("top", functions=(to_pascal, to_millitorr))
    top.set_xlabel("pressure [Pa]")
    plain_decades(top.xaxis, _BETWEEN)


def _draw_3c(curves: Curves) -> Figure:
    figure = new_figure()
    (ax,) = figure.axes
    wavenumber = curves["wavenumber [1/cm]"]
    for colour, style, temperature in zip(
        (BLUE, VERMILION), ("-", "--"), PLANCK_TEMPERATURES, strict=True
    ):
        radiance = curves[f"radiance at {temperature} K [W/(m^2 sr cm^-1)]"]
        ax.plot(wavenumber, radiance, color=colour, ls=style, label=f"blackbody, {temperature} K")
    window = facts()["window"]
    centre, half = window["wavenumber_per_cm"], window["half_width_per_cm"]
    ax.axvspan(centre - half, centre + half, color=GREY, alpha=0.2, lw=0, label="900 ± 400 cm⁻¹")
    ax.set_xlim(wavenumber[-1], wavenumber[0])  # spectra run from high to low wavenumbers
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("wavenumber [cm⁻¹]")
    ax.yaxis.tick_right()
    ax.yaxis.set_label_position("right")
    ax.set_ylabel("blackbody radiance [W/(m² sr cm⁻¹)]")
    legend_below(ax)
    return figure


def _draw_5a(curves: Curves) -> Figure:
    figure = new_figure(columns=2)
    shape = (MAP_PRESSURES_MTORR.size, MAP_IRRADIANCES.size)
    tables = {name: curves[f"temperature {name} [K]"].reshape(shape) for name in ("cnt", "ge")}
    hottest = max(table.max() for table in tables.values())
    coldest = facts()["chamber"]["temperature_k"]
    levels = np.arange(np.floor(coldest / 20.0) * 20.0, hottest + 20.0, 20.0)
    for ax, (coating, table) in zip(figure.axes[:2], tables.items(), strict=True):
        image = ax.contourf(
            MAP_PRESSURES_MTORR, MAP_IRRADIANCES / _KILO, table.T, levels=levels, cmap="cividis"
        )
        _torr_axis(ax)
        ax.set_ylabel("irradiance [kW/m²]")
        ax.label_outer()
        name = f"mylar-{_NAMES[coating]}, 2 cm"
        white = {"facecolor": "white", "edgecolor": "none"}
        ax.text(0.03, 0.93, name, transform=ax.transAxes, bbox=white, va="top")
        lift = curves[f"lift over weight {coating} [1]"].reshape(shape)
        ax.contour(
            MAP_PRESSURES_MTORR, MAP_IRRADIANCES / _KILO, lift.T, [1.0], colors="white"
        ).set_path_effects(outline_effects())
    figure.colorbar(image, ax=figure.axes[:2], label="temperature of the disk [K]")
    _letter(figure.axes[0], "a")
    return figure


def _draw_5bcd(curves: Curves, points: Points | None) -> Figure:
    figure = new_figure(columns=3, width=4.6)
    for ax, letter, size in zip(figure.axes[:3], "bcd", PANEL_SIZES_CM, strict=True):
        for coating in COATINGS:
            for column in COLUMNS:
                needed = curves[f"irradiance {size} cm {coating} {column.key} [W/m^2]"] / _KILO
                ax.plot(
                    curves["pressure [mTorr]"],
                    needed,
                    color=_COLOURS[coating],
                    ls=_STYLES[column.key],
                    label=f"{_NAMES[coating]}, {column.title}",
                )
        _draw_points(ax, points, _panel_points(points, size))
        ax.set_yscale("log")
        plain_decades(ax.yaxis, _BETWEEN)
        ax.set_ylim(0.4, 20.0)
        ax.set_xlim(1.0, 300.0)
        _torr_axis(ax)
        ax.set_ylabel("irradiance to levitate [kW/m²]")
        ax.label_outer()
        ax.text(0.05, 0.05, f"{size} cm", transform=ax.transAxes)
        _letter(ax, letter)
    lines: dict[str, Any] = {}
    for ax in figure.axes[:3]:
        lines |= {label: line for line, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    shared_legend(figure, list(lines.values()), most=6)
    return figure


def _panel_points(points: Points | None, size_cm: float) -> Any:
    if points is None or "diameter" not in points.numbers:
        return None
    return np.isclose(points.numbers["diameter"], size_cm * _CENTIMETRE)


def _draw_points(ax: Axes, points: Points | None, chosen: Any) -> None:
    if points is None or chosen is None:
        return
    spread = points.numbers.get("irradiance_uncertainty")
    for marker, sample in zip(MARKERS * len(points), dict.fromkeys(points.samples), strict=False):
        here = chosen & points.of(sample)
        if not here.any():
            continue
        ax.errorbar(
            points.pressure[here] / (_MILLI * TORR),
            points.irradiance[here] / _KILO,
            yerr=None if spread is None else spread[here] / _KILO,
            fmt=marker,
            color="black",
            mfc="none",
            ms=5,
            label=f"{sample} (your data)",
        )


def _draw_flight(axes: Any, letters: str, curves: Curves, words: str = "") -> None:
    """Irradiance and temperature to levitate against altitude."""
    left, right = axes
    altitude = curves["altitude [km]"]
    for column in COLUMNS:
        style = _STYLES[column.key]
        for colour, name, label in ((BLUE, "", "normal"), (ORANGE, " 45 deg", "45°")):
            needed = curves[f"irradiance{name}{words} {column.key} [W/m^2]"] / _KILO
            text = f"{label}, {column.title}"
            left.plot(altitude, needed, color=colour, ls=style, label=text)
        temperature = curves[f"temperature{words} {column.key} [K]"]
        right.plot(altitude, temperature, color=BLUE, ls=style, label=column.title)
    right.plot(altitude, curves["gas temperature [K]"], color=GREY, label="air")
    available = constants.SOLAR_CONSTANT_LU2023 / _KILO
    left.axhline(available, color=GREY, lw=1, label=f"available, {available:.2f} kW/m²")
    left.set_ylim(0.0, 4.0)
    left.set_ylabel("irradiance to levitate [kW/m²]")
    right.set_ylim(160.0, 600.0)
    right.set_ylabel("temperature when just levitating [K]")
    for ax, letter in zip(axes, letters, strict=True):
        ax.set_xlabel("altitude [km]")
        ax.set_xlim(*_FLIGHT_KM)
        ax.grid(alpha=0.25)
        _letter(ax, letter)


def _draw_6(curves: Curves) -> Figure:
    figure = new_figure(columns=2, height=_WITH_LEGEND)
    _draw_flight(figure.axes, "ab", curves)
    for ax in figure.axes[:2]:
        legend_below(ax)
    return figure


def _draw_s7(curves: Curves) -> Figure:
    figure = new_figure(columns=2, height=8.6, rows=2)
    for axes, letters, size in zip(
        (figure.axes[:2], figure.axes[2:]), ("ab", "cd"), LARGER_SIZES_CM, strict=True
    ):
        _draw_flight(axes, letters, curves, f" {size} cm")
        for ax in axes:
            ax.text(0.03, 0.03, f"{size} cm", transform=ax.transAxes)
    for ax in figure.axes[2:4]:
        legend_below(ax)
    return figure


def _draw_s8(curves: Curves) -> Figure:
    figure = new_figure(columns=2, height=_WITH_LEGEND)
    altitudes, payloads = figure.axes
    relative_payloads, diameter = payloads.twinx(), curves["diameter [cm]"]
    for column in COLUMNS:
        key, style = column.key, _STYLES[column.key]
        lower, upper = (curves[f"{edge} edge {key} [km]"] for edge in ("lower", "upper"))
        if key == DECIDING:
            altitudes.fill_between(diameter, lower, upper, color=BLUE, alpha=0.2, lw=0)
        altitudes.plot(diameter, lower, color=BLUE, ls=style, label=f"edges, {column.title}")
        altitudes.plot(diameter, upper, color=BLUE, ls=style)
        optimal, label = curves[f"optimal {key} [km]"], f"optimal, {column.title}"
        altitudes.plot(diameter, optimal, color=ORANGE, ls=style, label=label)
        payload = curves[f"payload {key} [mg]"]
        payloads.plot(diameter, payload, color=BLUE, ls=style, label=f"payload, {column.title}")
        relative = curves[f"relative payload {key} [1]"]
        relative_payloads.plot(diameter, relative, color=VERMILION, ls=style, lw=1)
        label = f"relative payload, {column.title}"
        payloads.plot([], [], color=VERMILION, ls=style, lw=1, label=label)
    altitudes.set_ylabel("altitude [km]")
    payloads.axhline(0.0, color=GREY, lw=1)
    payloads.set_ylim(-0.25, 1.0)
    relative_payloads.set_ylim(-0.625, 2.5)  # both axes have their zero at one height
    payloads.set_ylabel("payload [mg]", color=BLUE)
    relative_payloads.set_ylabel("relative payload [own mass]", color=VERMILION)
    for ax, letter in zip(figure.axes[:2], "ab", strict=True):
        ax.set_xlim(0.0, curves["diameter [cm]"][-1])
        ax.set_xlabel("diameter [cm]")
        ax.grid(alpha=0.25)
        _letter(ax, letter)
        legend_below(ax, most=2)
    return figure


def paper_figure(name: str, curves: Curves, points: Points | None = None) -> Figure:
    """One figure of the paper; ``name``: A key of :data:`lightflyer.paper.figures.FIGURES`."""
    if name == "figure-5bcd":
        return _draw_5bcd(curves, points)
    draw = {
        "figure-3c": _draw_3c,
        "figure-5a": _draw_5a,
        "figure-6": _draw_6,
        "figure-s7": _draw_s7,
        "figure-s8": _draw_s8,
    }[name]
    return draw(curves)


def measured_figures(points: Points) -> dict[str, Figure]:
    """Figures 2, S2 and S3 with the user's own points."""
    belongs = points.texts.get("figure", ["2"] * len(points))
    figures = {}
    for name in _MEASURED_FIGURES:
        chosen = np.array([text.upper() == name for text in belongs])
        if not chosen.any():
            continue
        figure = new_figure()
        (ax,) = figure.axes
        _draw_points(ax, points, chosen)
        ax.set_yscale("log")
        plain_decades(ax.yaxis)
        _torr_axis(ax)
        ax.set_ylabel("irradiance at lift-off [kW/m²]")
        legend_below(ax)
        figures[f"figure-{name.lower()}"] = figure
    return figures
