"""``lightflyer film``: absorptance, emittance and areal density of a film from its layers."""

import gc
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table

from lightflyer.foundation.errors import ConfigurationError

if TYPE_CHECKING:
    from lightflyer.film.layered_section import LayeredFilmSection
    from lightflyer.film.summary import FilmSummary

_PERCENT = 100.0
_TEMPERATURES = "200 K,250 K,300 K,350 K,400 K,450 K,500 K"


def film_command(
    film_file: Path,
    /,
    *,
    out: Path | None = None,
    temperatures: str = _TEMPERATURES,
    at: str | None = None,
    json_output: Annotated[bool, Parameter(name="--json", negative=())] = False,
) -> None:
    """Compute absorptance, emittance and areal density of a film from its layers.

    Parameters
    ----------
    film_file
        TOML file whose section [film] has layers, such as a flyer file.
    out
        Folder for figures (PNG, SVG) and the summary (JSON).
    temperatures
        Temperatures of the film at which to give its emittance.
    at
        Wavelengths, such as "550 nm,10 um", at which to give reflectance, transmittance and
        absorptance.
    json_output
        Print one JSON object instead of tables.
    """
    gc.disable()  # a short-lived process: collecting its imports' garbage costs more than it saves
    from lightflyer.config.reader import read_film_file
    from lightflyer.film.summary import FilmSummary

    section = read_film_file(film_file)
    asked = _quantities("--temperatures", temperatures, "K")
    film = section.film()
    points = _points(film, at)
    summary = FilmSummary.of(film, section.light(), asked)
    described = summary.to_json() | {"origin": _origins(section)}
    if at is not None:
        described["at"] = points
    written = [] if out is None else _write(out, summary, described)
    if json_output:
        print(json.dumps(described, allow_nan=False, ensure_ascii=False))  # noqa: T201
        return
    console = Console(highlight=False)
    _show(console, section, summary, points)
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)
    if out is None:
        console.print("add --out FOLDER to write figures and data")


def _quantities(option: str, text: str, unit: str) -> Any:
    import numpy as np

    from lightflyer.foundation.units import parse

    try:
        values = [parse(part.strip(), unit).value for part in text.split(",") if part.strip()]
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if not values:
        raise ConfigurationError(f'{option} "{text}" has no quantity in it')
    return np.array(values)


def _points(film: Any, at: str | None) -> list[dict[str, float]]:
    """Optics at the wavelengths of ``--at``, for normal incidence on the top."""
    if at is None:
        return []
    wavelengths = _quantities("--at", at, "m")
    optics = film.optics(wavelengths).unpolarised()
    rows = zip(wavelengths, optics.reflectance, optics.transmittance, strict=True)
    return [
        {
            "wavelength_um": float(wavelength) * 1e6,
            "reflectance": float(reflected),
            "transmittance": float(transmitted),
            "absorptance": float(1.0 - reflected - transmitted),
        }
        for wavelength, reflected, transmitted in rows
    ]


def _origins(section: "LayeredFilmSection") -> dict[str, Any]:
    """Measured values of the file, which replace the computed ones in predictions."""
    return {
        name: {"origin": "measured", "value": value.value, "uncertainty": value.uncertainty}
        for name, value in section.measured().items()
    }


def _write(out: Path, summary: "FilmSummary", described: dict[str, Any]) -> list[Path]:
    from lightflyer.film.figures import film_figures
    from lightflyer.foundation import drawing as plot
    from lightflyer.foundation import files as output

    names = ["film.json"]
    with output.output_directory(out) as stage:
        text = json.dumps(described, indent=2, allow_nan=False, ensure_ascii=False)
        stage("film.json").write_text(text + "\n", encoding="utf-8")
        for name, figure in film_figures(summary).items():
            files = [f"{name}.png", f"{name}.svg"]
            plot.save(figure, [stage(file) for file in files])
            names += files
    return [out / name for name in names]


def _show(
    console: Console,
    section: "LayeredFilmSection",
    summary: "FilmSummary",
    points: list[dict[str, float]],
) -> None:
    from lightflyer.film.materials import MICROMETRE

    for layer in summary.film.layers:
        nanometres = float(layer.thickness) * 1e9
        console.print(f"{layer.material.name:10} {nanometres:8.4g} nm  {layer.material.source}")
    console.print(f"areal density     {float(summary.film.areal_density) * 1e3:.4g} g/m²")
    for light, averages in {"AM0": summary.solar, summary.light.name: summary.lamp}.items():
        for side, mean in averages.items():
            console.print(
                f"absorptance       {mean.value:.4f} of {light}, {side} ({mean.lower:.3f} to "
                f"{mean.upper:.3f}: {_left_out(mean.covered)} of its power is outside the data)"
            )
    console.print(_emittances(summary))
    shortest, longest = summary.wavelength[[0, -1]] / MICROMETRE
    console.print(
        "emittance: mean over the wavelengths with data; bounds: nothing or everything absorbed at "
        f"the others\nspectrum from {shortest:.4g} µm to {longest:.4g} µm"
    )
    for text in summary.extrapolated:
        console.print(f"extrapolated: {text}")
    for point in points:
        console.print(
            f"at {point['wavelength_um']:.5g} µm: reflectance {point['reflectance']:.4f}, "
            f"transmittance {point['transmittance']:.4f}, absorptance {point['absorptance']:.4f}"
        )
    for name, value in section.measured().items():
        spread = "" if value.uncertainty is None else f" ± {value.uncertainty:g}"
        console.print(f"measured, used in predictions: {name} {value.value:g}{spread}")


def _left_out(covered: Any) -> str:
    return f"{(1.0 - float(covered)) * _PERCENT:.1f} %"


def _emittances(summary: "FilmSummary") -> Table:
    table = Table(box=None, padding=(0, 1))
    for heading in (
        "at\n[K]",
        "emittance\ntop",
        "\nbottom",
        "normal\ntop",
        "\nbottom",
        "absorptance\n/ emittance",
        "outside\nthe data",
        "bounds\n(top)",
    ):
        table.add_column(heading, justify="right")
    top, bottom = summary.thermal["top"], summary.thermal["bottom"]
    normal = summary.thermal_normal
    for row, temperature in enumerate(summary.temperatures):
        table.add_row(
            f"{temperature:g}",
            f"{top.value[row]:.4f}",
            f"{bottom.value[row]:.4f}",
            f"{normal['top'].value[row]:.4f}",
            f"{normal['bottom'].value[row]:.4f}",
            f"{summary.selectivity()[row]:.2f}",
            _left_out(top.covered[row]),
            f"{top.lower[row]:.3f}–{top.upper[row]:.3f}",
        )
    return table
