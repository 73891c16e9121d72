"""``lightflyer film``: optics and areal density of a film from its layers."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions
from lightflyer.cli.output import print_json, printer, show
from lightflyer.core.atomic_files import write_netcdf
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.quantities import quantities
from lightflyer.files.result_text import table_of, warning_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.film import Film
    from lightflyer.film.angles import AngularSummary
    from lightflyer.film.layered_section import SampleSection
    from lightflyer.film.summary import FilmSummary

_LEAST_SHARE = 0.0005  # of a spectrum, printed as 0.1 %
_SHOWN_TEMPERATURE = 300.0  # [K], nearest to which an emittance by angle is printed
_ROUNDING = 1e-9  # so that steps that make 90 degrees end before it
_NANOMETRES, _GRAMS = 1e9, 1e3
_TEMPERATURES = "200 K,250 K,300 K,350 K,400 K,450 K,500 K"


def film_command(
    film_file: Path,
    /,
    *,
    out: Path | None = None,
    temperatures: str = _TEMPERATURES,
    at: str | None = None,
    angles: str | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Compute absorptance, transmittance, emittance and areal density of a film from its layers.

    Transmittances matter where a film shades another, as in a sandwich. Where the file states ± of
    layers' numbers, values have 95 % intervals from them. Shares of a spectrum without
    optical data are printed with bounds, apart from the intervals.

    Parameters
    ----------
    film_file
        TOML file whose section [film] has layers, such as a flyer file.
    out
        Folder for figures and the summary (JSON).
    temperatures
        Temperatures of the film at which to give its emittance.
    at
        Wavelengths, such as "550 nm,10 um", at which to give reflectance, transmittance and
        absorptance.
    angles
        Angles to the normal, such as "0 deg,30 deg,60 deg", or a step, such as "5 deg", at which to
        give shares of the light and the emittance of the top by polarisation.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.config.reader import read_film_file
    from lightflyer.film.angles import AngularSummary, write_csv, write_spectral_csv
    from lightflyer.film.summary import FilmSummary

    section = read_film_file(film_file)
    asked = quantities("--temperatures", temperatures, "K")
    directions = _directions(angles)
    film = section.film()
    written = section.written_layers
    tied = len(section.layers)
    spreads = section.independent_spreads
    spreads += [layer.thickness.uncertainty for layer in written[tied:]]  # a thick substrate
    others = section.neighbours()
    points, beyond = _points(film, at, spreads, others)
    summary = FilmSummary.of(
        film, section.light(), asked,
        thickness_uncertainty=spreads,
        density_uncertainty=[
            None if layer.density is None else layer.density.uncertainty
            for layer in written
        ],
        others=others,
    )  # fmt: skip
    by_angle = None
    if directions is not None:
        by_angle = AngularSummary.of(film, summary.light, directions, summary.temperatures)
    warnings = [*summary.warnings, *beyond]
    described = summary.to_json() | {
        "origin": {
            name: {"origin": "measured", "value": value.value, "uncertainty": value.uncertainty}
            for name, value in section.measured_values().items()
        },
        "warnings": warnings,
    }
    described |= {} if at is None else {"at": points}
    files: dict[str, Any] = {"film.json": described}
    if by_angle is not None:
        described["angles"] = _angles_json(by_angle)
        files |= {
            "film-angles.csv": partial(write_csv, by_angle),
            "film-angles-spectral.csv": partial(write_spectral_csv, by_angle),
            "film-angles.nc": lambda path: write_netcdf(by_angle.to_dataset(), path),
        }

    def draw() -> "dict[str, Figure]":
        from lightflyer.film.figures import angle_figures, film_figures

        return film_figures(summary) | ({} if by_angle is None else angle_figures(by_angle))

    paths = figures.write_folder(out, files, draw)
    if json_output:
        print_json(described)
        return
    console = printer()
    _show(console, section, summary, points)
    if by_angle is not None:
        import numpy as np

        number = int(np.argmin(abs(by_angle.temperatures - _SHOWN_TEMPERATURE)))
        shown = f"{by_angle.temperatures[number]:g} K"
        light = by_angle.lit.with_mean()
        heat = by_angle.thermal.with_mean()["absorptance"][..., number]
        columns = [light["reflectance"], light["transmittance"], light["absorptance"], heat]
        names = ("reflectance", "transmittance", "absorptance", f"emittance, {shown}")
        heads = ("angle\n[deg]", *(f"{name}\ns / p / mean" for name in names))
        table = _table(f"by angle, of {by_angle.light.name}, top", heads)
        for place, angle in enumerate(np.degrees(by_angle.incidence)):
            cells = (" / ".join(f"{one:.3f}" for one in part[:, place]) for part in columns)
            table.add_row(f"{angle:.4g}", *cells)
        console.print(table)
    show(console, warning_lines(warnings))
    if summary.uncertainty is None:
        console.print("state ± of the layers' thicknesses for intervals")
    figures.tell(console, paths, "add --out FOLDER to write figures and data")


def _points(
    film: "Film",
    at: str | None,
    spreads: Sequence[float | None],
    others: "Sequence[tuple[Film, Film]]",
) -> tuple[list[dict[str, Any]], list[str]]:
    """Optics at the wavelengths of ``--at``, for normal incidence on the top, and warnings."""
    if at is None:
        return [], []
    from lightflyer.film.optics.stack import thickness_uncertainty
    from lightflyer.film.summary import possible_interval

    wavelengths = quantities("--at", at, "m")

    def optics(one: "Film") -> dict[str, Any]:
        found = one.optics(wavelengths).polarisation_mean()
        shares = {"reflectance": found.reflectance, "transmittance": found.transmittance,
                  "absorptance": found.absorptance}  # fmt: skip
        return shares | ({"scattered": found.scattered} if one.is_rough else {})

    values = optics(film)
    points: list[dict[str, Any]] = [{"wavelength_um": float(one) * 1e6} for one in wavelengths]
    for number, point in enumerate(points):
        point |= {name: float(value[number]) for name, value in values.items()}
    if any(spreads) or others:
        spread = thickness_uncertainty(optics, film, [one or 0.0 for one in spreads], others)
        for number, point in enumerate(points):
            point["interval_95"] = {
                name: possible_interval(point[name], one[number], 1.0).tolist()
                for name, one in spread.items()
            }
    beyond = [
        f"at {point['wavelength_um']:.5g} µm optical data are extrapolated: {text}"
        for point, one in zip(points, wavelengths, strict=True)
        for text in film.extrapolations(one, one)
    ]
    return points, beyond


def _directions(angles: str | None) -> Any:
    """Angles of ``--angles`` [rad], or None."""
    if angles is None:
        return None
    import numpy as np

    asked = quantities("--angles", angles, "rad")
    right = 0.5 * np.pi
    if asked.size == 1 and 0.0 < asked[0] < right:
        asked = np.arange(0.0, right * (1.0 - _ROUNDING), asked[0])
    if np.any(asked < 0.0) or np.any(asked >= right):
        raise ConfigurationError(f'--angles "{angles}": angles are from 0 to below 90 degrees')
    return asked


def _angles_json(by_angle: "AngularSummary") -> dict[str, Any]:
    """Averages by angle, as lists over the angles."""
    import numpy as np

    from lightflyer.film.angles import POLARISATIONS

    def listed(values: Any) -> dict[str, Any]:
        return {name: values[row].tolist() for row, name in enumerate(POLARISATIONS)}

    emittance = by_angle.thermal.with_mean()["absorptance"]
    return {
        "angle_deg": np.degrees(by_angle.incidence).tolist(),
        "light": {name: listed(values) for name, values in by_angle.lit.with_mean().items()},
        "emittance_top": {
            f"{temperature:g}": listed(emittance[..., number])
            for number, temperature in enumerate(by_angle.temperatures)
        },
    }


def _show(
    console: Console,
    section: "SampleSection",
    summary: "FilmSummary",
    points: list[dict[str, Any]],
) -> None:
    from lightflyer.film.media.medium import MICROMETRE

    for layer, written in zip(summary.film.layers, section.written_layers, strict=True):
        spread = written.thickness.uncertainty
        stated = "" if spread is None else f" ± {spread * _NANOMETRES:g} nm"
        console.print(
            f"{layer.material.name:10} {layer.thickness_text:>8}{stated}  {layer.material.source}",
            soft_wrap=True,
        )
    for name, medium in (("above", summary.film.above), ("below", summary.film.below)):
        if medium is not None:
            console.print(f"{name} it {medium.name}, endless  {medium.source}", soft_wrap=True)
    if summary.film.unknown_density is None:
        mass = float(summary.film.areal_density) * _GRAMS
        interval = _span(summary.interval("areal_density_g_m2"))
        console.print(f"areal density     {mass:.4g} g/m²{interval}")
    lights = {"AM0": ("solar", summary.solar)}
    if summary.lamp is not summary.solar:
        lights[summary.light.name] = ("lamp", summary.lamp)
    for light, (kind, averages) in lights.items():
        for side, mean in averages.items():
            interval = _span(summary.interval(f"{kind}_absorptance_{side}"))
            console.print(f"absorptance       {mean.value:.4f}{interval} of {light}, {side}"
                          f"{_bound_text(mean)}", soft_wrap=True)  # fmt: skip
        passing = summary.passing[kind]
        interval = _span(summary.interval(f"{kind}_transmittance"))
        console.print(f"transmittance     {passing.value:.4f}{interval} of {light}"
                      f"{_bound_text(passing)}", soft_wrap=True)  # fmt: skip
    for table in _tables(summary):
        console.print(table)
    shortest, longest = summary.wavelength[[0, -1]] / MICROMETRE
    console.print(f"spectrum from {shortest:.4g} µm to {longest:.4g} µm")
    for point in points:
        parts = [
            f"{name} {point[name]:.4f}" + _span(point.get("interval_95", {}).get(name))
            for name in ("reflectance", "transmittance", "absorptance", "scattered")
            if name in point
        ]
        console.print(f"at {point['wavelength_um']:.5g} µm: {', '.join(parts)}", soft_wrap=True)
    limit = section.limit()
    if limit is not None:
        console.print(f"highest temperature that the film withstands {limit:g} K")
    measured = section.measured_values() if summary.film.free_standing else {}
    for name, value in measured.items():
        spread = "" if value.uncertainty is None else f" ± {value.uncertainty:g}"
        console.print(f"measured, used in predictions: {name} {value.value:g}{spread}")


def _span(ends: Any) -> str:
    return "" if ends is None else f" ({ends[0]:.4g} to {ends[1]:.4g})"


def _bound_text(mean: Any) -> str:
    """Bounds of an absorptance, and why, where some of the light lies outside the data."""
    outside = 1.0 - float(mean.covered)
    if outside < _LEAST_SHARE:
        return ""
    return f"; {outside:.1%} is outside the data: bounds {mean.lower:.3f} to {mean.upper:.3f}"


def _table(title: str, headings: Sequence[str]) -> Table:
    return table_of(headings, left=(), title=title, title_style="")


def _tables(summary: "FilmSummary") -> Iterator[Table]:
    """Emittances at each temperature, their intervals, and shares of the radiation without data."""
    sides, values = tuple(summary.thermal), summary.values()
    hemispherical = _side_headings("hemispherical", sides)
    ratio, through = "absorptance\n/ emittance", "infrared\ntransmittance"
    heads = "at\n[K]", *hemispherical, *_side_headings("normal", sides), ratio, through
    table = _table("emittance", heads)
    kinds = ("emittance", "emittance_normal")
    names = [f"{kind}_{side}" for kind in kinds for side in sides]
    for row, temperature in enumerate(summary.temperatures):
        table.add_row(
            f"{temperature:g}",
            *(f"{values[name][row]:.4f}" for name in names),
            f"{values['selectivity'][row]:.2f}".replace("nan", "–"),  # of a zero emittance
            f"{values['infrared_transmittance'][row]:.4f}",
        )
    yield table
    if summary.uncertainty is not None:
        title = "95 % intervals from the stated ± of the layers' numbers"
        table = _table(title, ("at\n[K]", *hemispherical, ratio, through))
        names = [*(f"emittance_{side}" for side in sides), "selectivity", "infrared_transmittance"]
        columns = [summary.interval(name) for name in names]
        for row, temperature in enumerate(summary.temperatures):
            pairs = (column[:, row] for column in columns if column is not None)
            ends = (f"{low:.4g} to {high:.4g}".replace("nan to nan", "–") for low, high in pairs)
            table.add_row(f"{temperature:g}", *ends)
        yield table
    top = summary.thermal["top"]
    if (1.0 - top.covered).max() < _LEAST_SHARE:
        return
    title = (
        "radiation without optical data, and bounds if nothing or everything is absorbed, or "
        "passes, there"
    )
    outside = "outside\nthe data", "of which\nextrapolated"
    table = _table(title, ("at\n[K]", *outside, *hemispherical, through))
    for row, temperature in enumerate(summary.temperatures):
        bounded = (*summary.thermal.values(), summary.passing["thermal"])
        table.add_row(
            f"{temperature:g}",
            f"{1.0 - top.covered[row]:.1%}",
            f"{top.extrapolated_share[row]:.1%}",
            *(f"{one.lower[row]:.3f} to {one.upper[row]:.3f}" for one in bounded),
        )
    yield table


def _side_headings(what: str, sides: Sequence[str]) -> list[str]:
    """Headings of a column a side, of which the first says what it is."""
    return [f"{what if not number else ''}\n{side}" for number, side in enumerate(sides)]
