"""``lightflyer lab tac``: accommodation coefficients from a heater's power."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rich.console import Console
from rich.table import Table

from lightflyer.cli.lab._shared import (
    Files,
    Json,
    difference,
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

    from lightflyer.lab.tac import TacFit

_CORRELATED = 0.5  # correlation of neighbouring residuals above which intervals are too narrow
_PERCENT = 100.0


def tac_command(
    files: Files,
    /,
    *,
    columns: str | None = None,
    calibration: Path | None = None,
    ambient: str | None = None,
    heater: Literal["lu2023"] = "lu2023",
    diameter: str | None = None,
    tolerance: str = "1 K",
    emissivity: str | None = None,
    reading: Literal["printed", "reported"] = "printed",
    gas: Literal["air", "lu2023-air"] = "air",
    out: Path | None = None,
    update: Path | None = None,
    face: Literal["top", "bottom", "both"] = "both",
    json_output: Json = False,
) -> None:
    """Fit accommodation coefficient, area ratio and offset to a heater's power against pressure.

    Parameters
    ----------
    files
        Tables, one per run, with the columns pressure, heater_power (or heater_voltage and
        heater_current), heater_temperature and ambient_temperature, units in the header such as
        "pressure [mTorr]". Several runs are averaged.
    columns
        Columns in the order of the files, in place of a header: "pressure [Pa], -,
        heater_power [mW]"; - skips a column.
    calibration
        Table of resistance and temperature; voltage over current then gives the heater's
        temperature.
    ambient
        Temperature of gas and walls where the files have no such column, such as "22 °C".
    heater
        Preset of the heater: lu2023 is the paper's, with a diameter of 24 mm.
    diameter
        Diameter of the heater, such as "24 mm", in place of the preset's.
    tolerance
        Largest distance of the heater temperature from its median; other rows are dropped.
    emissivity
        Emissivity of the heater; its radiation is then counted apart from the offset.
    reading
        Conventions of the heat loss; reported counts the continuum loss twice.
    gas
        Gas in the chamber.
    out
        Folder to write the record (JSON, NetCDF) and the figure (PNG, SVG) into.
    update
        Flyer file to write the coefficient into.
    face
        Face of that film.
    json_output
        Print one JSON object instead of tables.
    """
    from lightflyer.config.update import tac_keys
    from lightflyer.force.lu2023 import READINGS
    from lightflyer.gas import GASES
    from lightflyer.lab import tac, tac_record
    from lightflyer.lab.tac_data import read_resistance_calibration, read_tac

    thermometer = None if calibration is None else read_resistance_calibration(calibration)
    width = tac.HEATERS[heater] if diameter is None else quantity("--diameter", diameter, "m").value
    options: dict[str, Any] = {
        "diameter": width,
        "tolerance": difference("--tolerance", tolerance, "K"),
        "reading": READINGS[reading],
        "gas": GASES[gas],
    }
    if emissivity is not None:
        options["emissivity"] = quantity("--emissivity", emissivity, "").value
    surroundings = None if ambient is None else quantity("--ambient", ambient, "K").value
    runs = [
        read_tac(file, columns=columns, thermometer=thermometer, ambient_temperature=surroundings)
        for file in _distinct(files)
    ]
    fits = [tac.fit_tac(run, **options) for run in runs]
    document = tac_record.summary(fits) | {"read": read_summary([run.table for run in runs])}
    values = dict.fromkeys(tac_keys(face), tac_record.mean_tac(fits))
    written, updated = write_record(
        out, "tac", document, tac_record.to_dataset(fits), lambda: _figures(fits),
        updating(update, values, f"tac, {reading} reading", files),
    )  # fmt: skip
    if json_output:
        print_json(document)
        return
    console = Console(highlight=False)
    show_read(console, [run.table for run in runs])
    _show(console, fits)
    finish(console, written, updated, update)


def _distinct(files: Sequence[Path]) -> Sequence[Path]:
    for number, file in enumerate(files):
        if file in files[:number]:
            raise ConfigurationError(f"{file}: is listed twice")
    return files


def _figures(fits: "Sequence[TacFit]") -> "dict[str, Figure]":
    from lightflyer.lab.figures.tac import tac_figures

    return tac_figures(fits)


def _show(console: Console, fits: "Sequence[TacFit]") -> None:
    from lightflyer.lab.tac_record import mean_tac

    for fit in fits:
        console.print(
            f"{fit.run.source}: heater at {fit.mean_temperature:.2f} K, coefficient of variation "
            f"{_PERCENT * fit.temperature_variation:.2g} %; {fit.rows_used} rows used, "
            f"{fit.rows_dropped} dropped for their temperature",
            markup=False, soft_wrap=True,
        )  # fmt: skip
        names = {"tac": "accommodation coefficient α", "area_ratio": "area ratio δ",
                 "offset": "offset C"}  # fmt: skip
        console.print(estimate_table([(names[name], one) for name, one in fit.estimates().items()]))
        console.print(
            f"rows scatter by {_PERCENT * fit.scatter:.2g} % about the fit; intervals are "
            "profile intervals"
        )
        if fit.residual_correlation > _CORRELATED:
            console.print(
                "neighbouring rows deviate from the fit together (correlation "
                f"{fit.residual_correlation:.2f}): the intervals are too narrow"
            )
    if len(fits) > 1:
        console.print(_runs_table(fits))
        console.print(f"mean accommodation coefficient {mean_tac(fits)}")


def _runs_table(fits: "Sequence[TacFit]") -> Table:
    """Table of runs, like the paper's table S2."""
    table = Table(box=None, padding=(0, 1))
    for heading in ("run", "TAC α", "95 % interval", "area ratio δ", "offset C\n[W/(m² K)]"):
        table.add_column(heading, justify="left" if heading == "run" else "right")
    for fit in fits:
        low, high = fit.tac.interval
        table.add_row(
            fit.run.source, f"{fit.tac.value:.3f}", f"{low:.3f} to {high:.3f}",
            f"{fit.area_ratio.value:.3f}", f"{fit.offset.value:.3f}",
        )  # fmt: skip
    return table
