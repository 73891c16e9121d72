"""``lightflyer predict``: what the flyer of a file will do."""

import gc
import json
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table

from lightflyer.foundation.errors import ConfigurationError, ParameterError

if TYPE_CHECKING:
    from lightflyer.config.sections import FlyerFile, Setup
    from lightflyer.prediction.prediction import AltitudePrediction, ChamberPrediction
    from lightflyer.uncertainty.propagation import PredictionUncertainty

_KILOMETRE = 1e3
_MILLIGRAMS = 1e6


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
) -> None:
    """Predict where a flyer levitates, what it carries and how hot it gets.

    Parameters
    ----------
    flyer_file
        TOML file that describes flyer, film, environment and force model; "lightflyer init"
        writes one.
    out
        Folder to write figures (PNG, SVG), the dataset (NetCDF) and the summary (JSON) into.
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
    """
    gc.disable()  # a short-lived process: collecting its imports' garbage costs more than it saves
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.prediction.prediction import predict

    if samples < 0 or seed < 0:
        raise ParameterError("--samples and --seed must be zero or positive")
    configuration = read_flyer_file(flyer_file)
    setup = configuration.build()
    loading = _load_in_background() if out is not None else None
    prediction = predict(setup, _asked(at, setup))
    summary = prediction.summary() | _film_origins(configuration)
    uncertainty = _uncertainty(configuration, prediction, samples, seed)
    if uncertainty is not None:
        summary["uncertainty"] = uncertainty.summary()
    written = []
    if out is not None and loading is not None:
        loading.join()
        results = (prediction, summary, uncertainty)
        written = _write(out, configuration, flyer_file, setup, results, csv=csv)
    if json_output:
        print(json.dumps(summary, allow_nan=False))  # noqa: T201
        return
    console = Console(highlight=False)
    _show(console, configuration, setup, prediction, summary)
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)
    if out is None:
        console.print("add --out FOLDER to write figures and data")


def _uncertainty(
    configuration: "FlyerFile",
    prediction: "AltitudePrediction | ChamberPrediction",
    samples: int,
    seed: int,
) -> "PredictionUncertainty | None":
    if not configuration.uncertainties():
        return None  # and nothing is imported or compiled for it
    from lightflyer.uncertainty.propagation import propagate

    return propagate(configuration, prediction, samples, seed)


def _load_in_background() -> threading.Thread:
    """Import what writing needs while XLA, which lets other threads run, compiles the model."""

    def load() -> None:
        import h5netcdf  # noqa: F401
        import xarray  # noqa: F401

    thread = threading.Thread(target=load, daemon=True)
    thread.start()
    return thread


def _asked(at: str | None, setup: "Setup") -> list[float] | None:
    """The coordinates of ``--at`` in SI units."""
    from lightflyer.environment.chamber import Chamber
    from lightflyer.foundation.units import parse

    if at is None:
        return None
    unit = "Pa" if isinstance(setup.environment, Chamber) else "m"
    try:
        points = [parse(part.strip(), unit).value for part in at.split(",") if part.strip()]
    except ConfigurationError as error:
        raise ConfigurationError(f"--at: {error}") from None
    if not points:
        raise ConfigurationError(f'--at "{at}" names no point')
    return points


def _film_origins(configuration: "FlyerFile") -> dict[str, Any]:
    """Where the properties of a film of layers come from."""
    import math

    from lightflyer.film.layered_section import LayeredFilmSection

    if not isinstance(configuration.film, LayeredFilmSection):
        return {}
    incidence = math.radians(configuration.environment.incidence.value)
    return {"film": configuration.film.report(incidence)}


def _write(
    out: Path,
    configuration: "FlyerFile",
    flyer_file: Path,
    setup: "Setup",
    results: "tuple[AltitudePrediction | ChamberPrediction, Any, PredictionUncertainty | None]",
    *,
    csv: bool,
) -> list[Path]:
    from lightflyer.foundation import drawing as plot
    from lightflyer.foundation import files as output

    prediction, summary, uncertainty = results

    dataset = output.to_dataset(prediction, flyer_file.read_text(encoding="utf-8-sig"))
    dataset.attrs["uncertainties"] = json.dumps(configuration.uncertainties())
    dataset.attrs["summary"] = json.dumps(summary)
    available = float(setup.environment.radiation.irradiance)
    figures = plot.prediction_figures(prediction, available)
    if uncertainty is not None:
        from lightflyer.uncertainty import figures as bands

        bands.add_to_dataset(dataset, prediction, uncertainty)
        bands.add_to_figures(figures, prediction, uncertainty)
    names = ["prediction.nc", "prediction.json"]
    with output.output_directory(out) as stage:
        dataset.to_netcdf(stage("prediction.nc"), engine="h5netcdf")
        text = json.dumps(summary, indent=2, allow_nan=False)
        stage("prediction.json").write_text(text + "\n", encoding="utf-8")
        if csv:
            names.append("prediction.csv")
            output.write_csv(prediction, stage("prediction.csv"))
        for name, figure in figures.items():
            files = [f"{name}.png", f"{name}.svg"]
            plot.save(figure, [stage(file) for file in files])
            names += files
    return [out / name for name in names]


def _show(
    console: Console,
    configuration: "FlyerFile",
    setup: "Setup",
    prediction: "AltitudePrediction | ChamberPrediction",
    summary: dict[str, Any],
) -> None:
    from lightflyer.prediction.prediction import AltitudePrediction

    flyer, light = setup.flyer, float(setup.environment.radiation.irradiance)
    own_mass, payload = float(flyer.own_mass) * _MILLIGRAMS, float(flyer.payload) * _MILLIGRAMS
    diameter = configuration.flyer.diameter.value * 100.0
    console.print(
        f"disk of {diameter:g} cm, {own_mass:.4g} mg, payload {payload:g} mg; "
        f"light {light:g} W/m² at {configuration.environment.incidence.value:g}° incidence"
    )
    if "film" in summary:
        console.print(_origins_line(summary["film"]), soft_wrap=True)
    if isinstance(prediction, AltitudePrediction):
        _show_altitude(console, summary, light)
    else:
        _show_chamber(console, summary)
    console.print(_points_table(summary["at"]))
    if "uncertainty" in summary:
        _show_bands(console, summary["uncertainty"])
    elif configuration.uncertainties():
        uncertain = ", ".join(configuration.uncertainties())
        console.print(f"uncertainties of {uncertain} are kept with the data, not propagated")


def _show_bands(console: Console, uncertainty: dict[str, Any]) -> None:
    """The 95 % bands of all results but those asked for one by one."""
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    table.add_column("95 % band of", no_wrap=True)
    for heading in ("value", "first order", "Monte Carlo", "samples"):
        table.add_column(heading, justify="right", no_wrap=True)
    shown = ""
    for name, result in uncertainty["results"].items():
        group, _, entry = name.rpartition(".")
        if name.startswith("at["):
            continue
        if group != shown:
            table.add_row(group)
            shown = group
        sampled = result.get("monte_carlo")
        share = f"{100.0 * sampled['share_of_samples']:.0f} %" if sampled else "–"
        cells = (f"{result['value']:.4g}", _span(result["first_order"]), _span(sampled), share)
        table.add_row(f"  {entry}" if group else entry, *cells)
    console.print(table)
    correlation = uncertainty["tac_correlation"]
    note = "" if correlation is None else f", TAC errors correlated by {correlation:g}"
    console.print(f"from the ± of {', '.join(uncertainty['inputs'])}{note}")


def _span(band: dict[str, Any] | None) -> str:
    if band is None or band["low"] is None:
        return "–"
    return f"{band['low']:.4g} to {band['high']:.4g}"


def _origins_line(film: dict[str, Any]) -> str:
    """Which properties of the film are measured and which computed, in words."""
    parts = [
        f"{name} {_film_value(entry['value'])} ({entry['origin']})"
        for name, entry in film.items()
        if name != "extrapolated"
    ]
    parts += [f"extrapolated {text}" for text in film["extrapolated"]]
    return "film: " + ", ".join(parts)


def _film_value(value: float | dict[str, float]) -> str:
    if not isinstance(value, dict):
        return f"{value:.4g}"
    ends = list(value.items())
    return " to ".join(f"{number:.3g} at {kelvin} K" for kelvin, number in (ends[0], ends[-1]))


def _show_altitude(console: Console, summary: dict[str, Any], light: float) -> None:
    rows = Table.grid(padding=(0, 2))
    pressures, bands = summary["pressure_band_pa"], summary["altitude_bands_km"]
    easiest, best = summary["minimum_irradiance"], summary["best"]
    if pressures is None:
        rows.add_row("levitates", f"nowhere at {light:g} W/m²: {_shortfall(best)}")
    else:
        where = ", ".join(f"{low:.3f} km to {high:.3f} km" for low, high in bands)
        label = "widest at " if len(bands) > 1 else ""
        rows.add_row(
            "levitates", f"{where} ({label}{pressures[0]:.3g} Pa to {pressures[1]:.3g} Pa)"
        )
    if easiest is None:
        rows.add_row("least irradiance", "none: no irradiance lifts it at any altitude")
    else:
        rows.add_row(
            "least irradiance",
            f"{easiest['value_w_m2']:.1f} W/m² at {easiest['altitude_km']:.2f} km "
            f"({easiest['temperature_k']:.1f} K)",
        )
    rows.add_row("best payload", _best(best))
    console.print(rows)


def _shortfall(best: dict[str, Any]) -> str:
    return (
        f"lift is at most {best['lift_over_weight']:.2f} of its weight, "
        f"at {best['altitude_km']:.2f} km"
    )


def _best(best: dict[str, Any]) -> str:
    where = f"at {best['altitude_km']:.2f} km ({best['temperature_k']:.1f} K)"
    if best["payload_mg"] < 0.0:
        return f"none: {-best['payload_mg']:.4g} mg short of lifting itself {where}"
    return f"{best['payload_mg']:.4g} mg, {best['relative_payload']:.3g} of its own mass, {where}"


def _show_chamber(console: Console, summary: dict[str, Any]) -> None:
    optimum = summary["optimum"]
    if optimum is None:
        console.print("no irradiance levitates it at any pressure in the range")
        return
    console.print(
        f"least irradiance {optimum['irradiance_w_m2']:.1f} W/m² at "
        f"{optimum['pressure_pa']:.3g} Pa ({optimum['temperature_k']:.1f} K)"
    )


# Heading and format of each column; a column is shown where the summary has it.
_COLUMNS = {
    "altitude_km": ("altitude\n[km]", "g"),
    "pressure_pa": ("pressure\n[Pa]", ".4g"),
    "gas_temperature_k": ("gas\n[K]", ".1f"),
    "levitation_irradiance_w_m2": ("to levitate\n[W/m²]", ".1f"),
    "levitation_temperature_k": ("then\n[K]", ".1f"),
    "temperature_k": ("in the light\n[K]", ".1f"),
    "lift_n": ("lift\n[µN]", ".4g"),
    "lift_over_weight": ("lift /\nweight", ".3f"),
}
_SCALES = {"lift_n": 1e6}


def _points_table(points: list[dict[str, Any]]) -> Table | str:
    if not points:
        return ""
    shown = [name for name in _COLUMNS if name in points[0]]
    table = Table(box=None, padding=(0, 1))
    for name in shown:
        table.add_column(_COLUMNS[name][0], justify="right")
    for point in points:
        table.add_row(*(_cell(name, point[name]) for name in shown))
    return table


def _cell(name: str, value: float | None) -> str:
    return "–" if value is None else format(value * _SCALES.get(name, 1.0), _COLUMNS[name][1])
