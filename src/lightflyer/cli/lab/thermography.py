"""``lightflyer lab thermography``: emissivity from temperatures, absorptivity from light."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console

from lightflyer.cli.lab._shared import (
    Json,
    estimate_table,
    finish,
    print_json,
    quantity,
    read_summary,
    show_read,
    updating,
    write_record,
)
from lightflyer.foundation.errors import ConfigurationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.foundation.units import Measured
    from lightflyer.lab.thermography import RadiativeProperties

_IMAGES = (".jpg", ".jpeg")


def thermography_command(
    file: Path | None = None,
    /,
    *,
    light_meter: Annotated[bool, Parameter(negative=())] = False,
    columns: str | None = None,
    hotplate: str | None = None,
    lower: str | None = None,
    upper: str | None = None,
    ambient: str | None = None,
    regions: str | None = None,
    accuracy: str | None = None,
    draws: int = 100_000,
    seed: int = 0,
    out: Path | None = None,
    update: Path | None = None,
    face: Literal["top", "bottom", "both"] = "both",
    json_output: Json = False,
) -> None:
    """Find reflectance, transmittance and emissivity from apparent temperatures.

    Parameters
    ----------
    file
        Table with the columns hotplate_temperature, lower_temperature, upper_temperature and
        ambient_temperature, one measurement per row; or a radiometric image (.jpg) with
        --regions. Without a file, the four options below give the temperatures.
    light_meter
        The columns are incident, reflected, transmitted and dark, readings of a light meter in
        any one unit, which give the visible absorptivity.
    columns
        Columns in the order of the file, in place of a header.
    hotplate
        Temperature of the hotplate, such as "150 ± 0.5 °C", where the file has no such column.
    lower
        Apparent temperature of the film's lower side.
    upper
        Apparent temperature of the film's upper side.
    ambient
        Temperature of the surroundings.
    regions
        Regions of an image, rows and then columns: "hotplate=10:40,20:60; upper=50:80,20:60".
    accuracy
        Standard uncertainty of all readings that state none, such as "0.5 K".
    draws
        Number of Monte Carlo draws.
    seed
        Seed of the draws.
    out
        Folder to write the record (JSON, NetCDF) and the figure (PNG, SVG) into.
    update
        Flyer file to write the emissivity (the absorptance for a light meter) into.
    face
        Face of that film.
    json_output
        Print one JSON object instead of tables.
    """
    from lightflyer.lab import thermography

    method = thermography.LIGHT if light_meter else thermography.THERMAL
    texts = (hotplate, lower, upper, ambient)
    given = _given(dict(zip(thermography.THERMAL.readings, texts, strict=True)))
    if light_meter and (given or accuracy or file is None):
        raise ConfigurationError("--light-meter needs a file and takes no temperatures")
    tables = []
    if file is None:
        readings = thermography.given_readings(given, method)
    elif file.suffix.lower() in _IMAGES:
        readings = thermography.given_readings(_of_image(file, regions, accuracy) | given, method)
    else:
        readings, table = thermography.read_readings(file, method, columns=columns, given=given)
        tables = [table]
    if accuracy is not None:
        readings = _with_accuracy(readings, _accuracy(accuracy))
    result = thermography.reduce_readings(readings, draws=draws, seed=seed)
    document = result.summary() | {"read": read_summary(tables)}
    files = [] if file is None else [file]
    written, updated = write_record(
        out, "thermography", document, thermography.to_dataset(result, [str(f) for f in files]),
        lambda: _figures(result),
        updating(update, _values(result, face, light_meter=light_meter), "thermography", files),
    )  # fmt: skip
    if json_output:
        print_json(document)
        return
    console = Console(highlight=False)
    show_read(console, tables)
    _show(console, result)
    finish(console, written, updated, update)


def _given(options: dict[str, str | None]) -> "dict[str, Measured]":
    given = {}
    for name, text in options.items():
        if text is not None:
            option = f"--{name.partition('_')[0]}"
            given[name] = quantity(option, text, "K")
            if given[name].value <= 0.0:
                raise ConfigurationError(f'{option}: "{text}" is not above absolute zero')
    return given


def _accuracy(text: str) -> float:
    from lightflyer.cli.lab._shared import difference

    return difference("--accuracy", text, "K")


def _with_accuracy(readings: Any, accuracy: float) -> Any:
    """The readings, with an accuracy for those that state no uncertainty."""
    import dataclasses

    import numpy as np

    known = readings.uncertainties
    return dataclasses.replace(readings, uncertainties=np.where(known > 0.0, known, accuracy))


def _of_image(file: Path, regions: str | None, accuracy: str | None) -> "dict[str, Measured]":
    from lightflyer.foundation.units import Measured
    from lightflyer.lab.thermal_image import parse_regions, read_thermal_image, region_temperatures

    if regions is None:
        raise ConfigurationError(f'{file}: an image needs --regions "hotplate=10:40,20:60; ..."')
    rectangles = parse_regions(regions)
    found = region_temperatures(read_thermal_image(file), rectangles, str(file))
    if accuracy is None:
        return found
    common = _accuracy(accuracy)
    return {
        name: Measured(one.value, ((one.uncertainty or 0.0) ** 2 + common**2) ** 0.5)
        for name, one in found.items()
    }


def _values(
    result: "RadiativeProperties", face: Literal["top", "bottom", "both"], *, light_meter: bool
) -> dict[tuple[str, str], Any]:
    from lightflyer.config.update import emittance_keys

    if not light_meter:
        return dict.fromkeys(emittance_keys(face), result.emissivity)
    keys = {"top": ["absorptance"], "bottom": ["absorptance_bottom"]}
    both = [*keys["top"], *keys["bottom"]]
    return {("film", key): result.emissivity for key in keys.get(face, both)}


def _figures(result: "RadiativeProperties") -> "dict[str, Figure]":
    from lightflyer.lab.figures.thermography import thermography_figures

    return thermography_figures(result)


def _show(console: Console, result: "RadiativeProperties") -> None:
    remainder = result.readings.method.remainder
    rows = []
    for name, estimate in result.first_order.items():
        shown = remainder if name == "emissivity" else name
        rows += [(shown, estimate), ("  by Monte Carlo", result.monte_carlo[name])]
    console.print(estimate_table(rows))
    if not result.readings.uncertainties.any():
        alone = result.readings.values.shape[1] == 1
        said = (
            "the interval of one row has no width"
            if alone
            else "intervals include the scatter of the rows only"
        )
        console.print(f"no reading states an uncertainty: {said}")
