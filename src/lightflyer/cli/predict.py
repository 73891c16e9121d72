"""``lightflyer predict``: what the flyer of a file will do."""

import gc
import json
import math
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions
from lightflyer.cli.output import print_json, printer, write_json
from lightflyer.foundation.errors import ConfigurationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.config.flyer_file import FlyerFile
    from lightflyer.environment.base import Coordinate
    from lightflyer.prediction.prediction import Prediction
    from lightflyer.uncertainty.propagation import PredictionUncertainty


def predict_command(
    flyer_file: Path,
    /,
    *,
    out: Path | None = None,
    at: str | None = None,
    json_output: Annotated[bool, Parameter(name="--json", negative=())] = False,
    csv: Annotated[bool, Parameter(negative=())] = False,
    samples: int = 500,
    seed: int = 0,
    figures: FigureOptions = AS_USUAL,
) -> None:
    """Predict where a flyer levitates, what it carries and how hot it gets.

    Parameters
    ----------
    flyer_file
        TOML file that describes flyer, film, environment and force model; "lightflyer init"
        writes one.
    out
        Folder to write figures, the dataset (NetCDF) and the summary (JSON) into.
    at
        Altitudes such as "68 km,72 km", or in a chamber pressures such as "3 Pa,30 mTorr", to
        report one by one.
    json_output
        Print one JSON object instead of tables.
    csv
        With --out, write the table as CSV too.
    samples
        Monte Carlo samples for the bands of a file with ±; 0 for first order alone.
    seed
        Of the samples.
    figures
        How figures are written.
    """
    gc.disable()  # a short-lived process: collecting its imports' garbage costs more than it saves
    figures.check(out)
    if csv and out is None:
        raise ConfigurationError("--csv: the table needs a folder; add --out FOLDER")
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.prediction.prediction import predict_design

    file = read_flyer_file(flyer_file)
    design = file.design()
    uncertain = bool(file.uncertainties() or design.open_parts())
    if uncertain:  # else nothing is imported or compiled for it
        from lightflyer.uncertainty.propagation import propagate, require_samples

        require_samples(samples, seed, "--")
    loading = _load_in_background() if out is not None else None
    where = design.setup.environment.coordinate
    prediction = predict_design(design, _asked(at, where))
    uncertainty = None
    if uncertain:
        uncertainty = propagate(design, prediction=prediction, samples=samples, seed=seed)
    summary = prediction.summary() | _film_origins(file)
    if uncertainty is not None:
        summary["uncertainty"] = uncertainty.summary()
    written = []
    if out is not None and loading is not None:
        loading.join()
        results = prediction, summary, uncertainty
        written = _write(out, file, flyer_file, results, figures, csv=csv)
    if json_output:
        print_json(summary)
        return
    console = printer()
    _show(console, file, prediction, summary)
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)
    if out is None:
        console.print("add --out FOLDER to write figures and data")


def _load_in_background() -> threading.Thread:
    """Import what writing needs while XLA, which lets other threads run, compiles the model."""

    def load() -> None:
        import h5netcdf  # noqa: F401
        import xarray  # noqa: F401

    thread = threading.Thread(target=load, daemon=True)
    thread.start()
    return thread


def _asked(at: str | None, where: "Coordinate") -> list[float] | None:
    """The coordinates of ``--at`` in SI units."""
    from lightflyer.foundation.units import parse

    if at is None:
        return None
    try:
        points = [parse(part.strip(), where.unit).value for part in at.split(",") if part.strip()]
    except ConfigurationError as error:
        raise ConfigurationError(f"--at: {error}") from None
    if not points:
        raise ConfigurationError(f'--at "{at}" names no {where.name}')
    return points


def _film_origins(file: "FlyerFile") -> dict[str, Any]:
    """Origin of the properties of each film of layers, by the film's name in the file."""
    incidence = math.radians(file.environment.incidence.value)
    return {
        name: film.report(incidence, passing=file.flyer.needs_transmittance)
        for name, film in file.films().items()
        if film.layered
    }


def _write(
    out: Path,
    file: "FlyerFile",
    flyer_file: Path,
    results: "tuple[Prediction, Any, PredictionUncertainty | None]",
    options: FigureOptions,
    *,
    csv: bool,
) -> list[Path]:
    from lightflyer.foundation.files import output_directory
    from lightflyer.prediction.figures import prediction_figures
    from lightflyer.prediction.tables import to_dataset, write_csv

    prediction, summary, uncertainty = results
    dataset = to_dataset(prediction, flyer_file.read_text(encoding="utf-8-sig"))
    dataset.attrs["uncertainties"] = json.dumps(file.uncertainties())
    dataset.attrs["summary"] = json.dumps(summary)
    if uncertainty is not None:
        from lightflyer.uncertainty.figures import add_to_dataset, add_to_figures

        add_to_dataset(dataset, uncertainty)

    def draw() -> "dict[str, Figure]":
        figures = prediction_figures(prediction)
        if uncertainty is not None:
            add_to_figures(figures, uncertainty)
        return figures

    names = ["prediction.nc", "prediction.json"]
    with output_directory(out) as stage:
        dataset.to_netcdf(stage("prediction.nc"), engine="h5netcdf")
        write_json(stage("prediction.json"), summary)
        if csv:
            names.append("prediction.csv")
            write_csv(prediction, stage("prediction.csv"))
        names += options.write(stage, draw)
    return [out / name for name in names]


def _show(
    console: Console, file: "FlyerFile", prediction: "Prediction", summary: dict[str, Any]
) -> None:
    flyer = prediction.setup.flyer
    own_mass, payload = _mass(float(flyer.own_mass)), _mass(float(flyer.payload), "g")
    console.print(f"{flyer.describe()}, {own_mass}, payload {payload}")
    console.print("; ".join(prediction.assumptions), soft_wrap=True)
    for name in filter(summary.__contains__, file.films()):
        console.print(_origins_line(name, summary[name]), soft_wrap=True)
    console.print(_results(prediction, summary))
    for table in _points_tables(prediction):
        console.print(table)
    for text in prediction.warnings:
        console.print(f"warning: {text}", soft_wrap=True)
    if "uncertainty" in summary:
        _show_bands(console, summary["uncertainty"])
    elif file.uncertainties():
        uncertain = ", ".join(file.uncertainties())
        console.print(f"uncertainties of {uncertain} are kept with the data, not propagated")


def _show_bands(console: Console, uncertainty: dict[str, Any]) -> None:
    """The 95 % bands of all results but those asked for one by one."""
    table = _bands_table(uncertainty["results"], shares=True)
    fits = _measure(table).maximum <= _NARROW
    console.print(table if fits else _bands_table(uncertainty["results"], shares=False))
    correlation = uncertainty["tac_correlation"]
    note = "" if correlation is None else f", TAC errors correlated by {correlation:g}"
    sources = []
    if uncertainty["inputs"]:
        sources.append(f"the ± of {', '.join(uncertainty['inputs'])}{note}")
    if uncertainty["between_bounds"]:
        names = ", ".join(uncertainty["between_bounds"])
        sources.append(f"the bounds of {names}")
    console.print(f"from {', and '.join(sources)}")


def _bands_table(results: dict[str, Any], *, shares: bool) -> Table:
    """Table of bands, perhaps with the shares of the samples that have such a result."""
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    table.add_column("95 % band of", no_wrap=True)
    for heading in ("value", "first order", "Monte Carlo", *(["samples"] if shares else [])):
        table.add_column(heading, justify="right", no_wrap=True)
    shown = ""
    for name, result in results.items():
        group, _, entry = name.rpartition(".")
        if name.startswith("at["):
            continue
        if group != shown:
            table.add_row(group)
            shown = group
        sampled = result.get("monte_carlo")
        share = f"{100.0 * sampled['share_of_samples']:.0f} %" if sampled else "–"
        cells = [f"{result['value']:.4g}", _span(result["first_order"]), _span(sampled)]
        table.add_row(f"  {entry}" if group else entry, *cells, *([share] if shares else []))
    return table


def _measure(table: Table) -> Measurement:
    """Width of a table on an unbounded terminal."""
    return Measurement.get(_UNBOUNDED, _UNBOUNDED.options, table)


def _span(band: dict[str, Any] | None) -> str:
    if band is None:
        return "–"
    if band["low"] is None:
        spread = band.get("standard_uncertainty")
        return "–" if spread is None else f"± {spread:.3g}"
    high = "∞" if band["high"] is None else f"{band['high']:.4g}"
    return f"{band['low']:.4g} to {high}"


def _origins_line(section: str, film: dict[str, Any]) -> str:
    """Which properties of the film are measured and which computed, in words."""
    parts = [
        f"{name} {_film_value(entry['value'])}{_plus_minus(entry)} ({entry['origin']})"
        for name, entry in film.items()
        if name != "extrapolated"
    ]
    return f"{section}: " + ", ".join(parts)


def _plus_minus(entry: dict[str, Any]) -> str:
    return f" ± {entry['uncertainty']:g}" if entry.get("uncertainty") else ""


def _film_value(value: float | dict[str, float]) -> str:
    if not isinstance(value, dict):
        return f"{value:.4g}"
    ends = list(value.items())
    return " to ".join(f"{number:.3g} at {kelvin} K" for kelvin, number in (ends[0], ends[-1]))


def _results(prediction: "Prediction", summary: dict[str, Any]) -> Table:
    """Lines on where it levitates, with how much light, and what it carries."""
    where, light = prediction.coordinate, prediction.available
    key, factor = prediction.coordinate_key
    unit, digits = where.shown_unit, ".3g" if where.logarithmic else ".2f"
    best, easiest = prediction.best, prediction.easiest
    rows = Table.grid(padding=(0, 2))
    if not prediction.bands:
        lift = round(float(best.values["lift_over_weight"]), 2) + 0.0  # and never -0.00
        shortfall = f"lift is at most {lift:.2f} of its weight, at "
        shortfall += f"{best.coordinate * factor:{digits}} {unit}"
        rows.add_row("levitates", f"nowhere at {light:g} W/m²: {shortfall}")
    else:
        edge = ".4g" if where.logarithmic else ".3f"
        bands = summary[f"{where.name}_bands{key.removeprefix(where.name)}"]
        shown = ", ".join(f"{low:{edge}} {unit} to {high:{edge}} {unit}" for low, high in bands)
        rows.add_row("levitates", shown + _pressures(prediction, summary, len(bands)))
    if easiest is None:
        rows.add_row("least irradiance", f"none: no irradiance lifts it at any {where.name}")
    else:
        rows.add_row(
            "least irradiance",
            f"{easiest.values['levitation_irradiance']:.1f} W/m² at "
            f"{easiest.coordinate * factor:{digits}} {unit} "
            f"({easiest.values['levitation_temperature']:.1f} K)",
        )
    place = f"at {best.coordinate * factor:{digits}} {unit} ({best.values['temperature']:.1f} K)"
    rows.add_row("best payload", _payload(best.values, place))
    return rows


def _pressures(prediction: "Prediction", summary: dict[str, Any], bands: int) -> str:
    """Pressures of the widest band, where the coordinate is another."""
    if prediction.coordinate.name == "pressure":
        return ""
    low, high = summary["pressure_band_pa"]
    return f" ({'widest at ' if bands > 1 else ''}{low:.3g} Pa to {high:.3g} Pa)"


def _mass(kilograms: float, form: str = ".4g") -> str:
    """A mass with a unit that suits it."""
    from lightflyer.flight.outputs import OUTPUTS

    factor, unit = OUTPUTS["own_mass"].shown_for(kilograms)
    return f"{kilograms * factor:{form}} {unit}"


def _payload(best: dict[str, float], place: str) -> str:
    payload = best["payload"]
    if payload < 0.0:
        return f"none: {_mass(-payload)} short of lifting itself {place}"
    return f"{_mass(payload)}, {best['relative_payload']:.3g} of its own mass, {place}"


# Heading and format of the columns that every flyer has.
_COLUMNS = {
    "pressure": ("pressure\n[Pa]", ".4g"),
    "gas_temperature": ("gas\n[K]", ".1f"),
    "levitation_irradiance": ("to levitate\n[W/m²]", ".1f"),
    "levitation_temperature": ("then\n[K]", ".1f"),
    "temperature": ("in the light\n[K]", ".1f"),
    "lift": ("lift\n[{}]", ".4g"),
    "lift_over_weight": ("lift /\nweight", ".3f"),
}
_NODE = ("of the {}\n[K]", ".1f")  # a temperature of one part of the flyer
_ROOMY = 8  # columns that fit a terminal of 80 characters with two spaces between them
_NARROW = 80  # columns of a narrow terminal
_UNBOUNDED = printer(width=1000)  # on which tables are measured
_OWN = 5  # results of the flyer's or the force model's own that fit beside the coordinate


def _points_tables(prediction: "Prediction") -> Iterator[Table]:
    """Tables of the results at each coordinate asked for, those that every flyer has first."""
    from lightflyer.flight.outputs import node_outputs

    if not prediction.asked.size:
        return
    nodes = {
        name: (_NODE[0].format(name.removeprefix("temperature_").replace("_", " ")), _NODE[1])
        for name in node_outputs(prediction.setup.flyer)
    }
    names = prediction.point_names
    first = [name for name in names if name in _COLUMNS or name in nodes]
    table = _points_table(prediction, {name: (_COLUMNS | nodes)[name] for name in first})
    if _measure(table).minimum > _NARROW:
        first = [name for name in names if name in _COLUMNS]
        table = _points_table(prediction, {name: _COLUMNS[name] for name in first})
    yield table
    rest = [name for name in names if name not in first]
    headings = {name: nodes.get(name, (_own_heading(prediction, name), ".4g")) for name in rest}
    for start in range(0, len(rest), _OWN):
        part = rest[start : start + _OWN]
        yield _points_table(prediction, {name: headings[name] for name in part})


def _own_heading(prediction: "Prediction", name: str) -> str:
    from lightflyer.flight.outputs import outputs_of

    words, known = name.replace("_", " "), outputs_of(prediction.setup)[name]
    return f"{words}\n[{{}}]" if known.shown[1] else words


def _points_table(prediction: "Prediction", headings: dict[str, tuple[str, str]]) -> Table:
    """Table of some results, each with its heading and format."""
    from lightflyer.flight.outputs import outputs_of

    where, (_, factor) = prediction.coordinate, prediction.coordinate_key
    known = outputs_of(prediction.setup)
    columns = {
        f"{where.name}\n[{where.shown_unit}]": [f"{x * factor:.6g}" for x in prediction.asked]
    }
    for name, (heading, form) in headings.items():
        values = prediction.at[name]
        scale, unit = known[name].shown_for(values)
        title = heading.format(unit.replace("^2", "²"))
        columns[title] = [_cell(value * scale, form) for value in values]
    table = Table(box=None, padding=(0, 1), collapse_padding=len(columns) > _ROOMY, pad_edge=False)
    for heading, cells in columns.items():
        # headings may wrap between words, numbers never
        words = max(map(len, [*heading.split(), *cells]))
        table.add_column(heading, justify="right", min_width=words)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    return table


def _cell(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "–"
