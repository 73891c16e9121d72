"""``lightflyer lab force``: the force on a heated vane beside the kinetic equation."""

from pathlib import Path
from typing import Literal

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import deliver, heated, read_parts, read_summary
from lightflyer.cli.options import Json
from lightflyer.cli.quantities import exact, known, quantity, share
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.result_text import warning_lines


def force_command(
    file: Path | None = None,
    /,
    *,
    diameter: str,
    hot: str,
    cold: str,
    gas: Literal["air", "nitrogen", "oxygen", "argon", "helium"] = "argon",
    ambient: str = "295 K",
    tac: str | None = None,
    tac_hot: str | None = None,
    tac_cold: str | None = None,
    wall: Literal["unknown", "maxwell", "accommodated"] = "unknown",
    pressures: str | None = None,
    gauge: Path | None = None,
    gauge_factor: float = 1.0,
    gauge_temperature: str | None = None,
    gauge_tube: str | None = None,
    pressure_accuracy: str | None = None,
    force_accuracy: str = "5 %",
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Predict the force on a heated vane over pressure, and lay measured points over it.

    Parameters
    ----------
    file
        Table with the columns pressure and force, towards the cold face, units in the header such
        as "force [uN]"; force_uncertainty and pressure_uncertainty if known. Without it only the
        curve is drawn.
    diameter
        Diameter of the vane, such as "12 cm".
    hot
        Temperature of the hot face, such as "419 ± 2 K".
    cold
        Temperature of the cold face.
    gas
        Gas in the chamber.
    ambient
        Temperature of the gas far from the vane.
    tac
        Accommodation coefficient of both faces, such as "0.9 ± 0.05", which is assumed by default.
    tac_hot
        That of the hot face alone, with --tac-cold.
    tac_cold
        That of the cold face alone, with --tac-hot.
    wall
        How molecules leave the faces. Unknown walls widen the band: the coefficients do not tell
        how normal motion, tangential motion and rotation share them.
    pressures
        Ends of the curve, such as "0.01 Pa, 10 Pa". Default: a little beyond the points.
    gauge
        Calibration of the pressure gauge: a table with the columns shown and pressure.
    gauge_factor
        Pressure over what the gauge shows of it, because of the gas.
    gauge_temperature
        Temperature at which the gauge is held, such as "45 °C", where it is not that of the
        chamber; with --gauge-tube.
    gauge_tube
        Inner diameter of the tube to that gauge, such as "5 mm".
    pressure_accuracy
        Relative standard uncertainty of the pressure gauge, common to all points. Default: 5 %,
        that of a Pirani gauge, assumed.
    force_accuracy
        The same of the balance.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    json_output
        Print one JSON object instead of a table.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.gas import GASES
    from lightflyer.lab.force import vane as lab
    from lightflyer.lab.force.text import force_parts
    from lightflyer.lab.gauges import gauge_of, pirani_doubts
    from lightflyer.lab.record import dataset

    given = {"--tac": tac, "--tac-hot": tac_hot, "--tac-cold": tac_cold}
    if (tac_hot is None) != (tac_cold is None) or (tac is not None and tac_hot is not None):
        raise ConfigurationError("give either --tac, or both --tac-hot and --tac-cold")
    tacs = {
        option: lab.ASSUMED_TAC if text is None else known(option, text, "")
        for option, text in given.items()
    }
    alike = tac_hot is None
    vane = lab.Vane(
        known("--diameter", diameter, "m"),
        quantity("--hot", hot, "K"),
        quantity("--cold", cold, "K"),
        GASES[gas],
        quantity("--ambient", ambient, "K"),
        tacs["--tac" if alike else "--tac-hot"],
        tacs["--tac" if alike else "--tac-cold"],
        alike,
        wall,
    )
    shown = gauge_of(
        gauge, gauge_factor, *heated(gauge_temperature, gauge_tube),
        gas=vane.gas, ambient=vane.ambient.value,
    )  # fmt: skip
    points = None if file is None else lab.read_forces(file, shown)
    found = lab.compare_forces(
        vane,
        points,
        pressures=None if pressures is None else _ends(pressures),
        pressure_accuracy=share("--pressure-accuracy", pressure_accuracy or "5 %"),
        force_accuracy=share("--force-accuracy", force_accuracy),
    )
    tables = [] if points is None else [points]
    of_gauge = [] if points is None else pirani_doubts(
        gas, shown, accuracy_stated=pressure_accuracy is not None
    )  # fmt: skip
    warnings = [*of_gauge, *found.warnings]
    deliver(
        "force", found.to_json() | {"warnings": warnings} | {"read": read_summary(tables)},
        dataset("force on a heated vane", found.variables, [str(file)] if file else [],
                warnings=warnings),
        lambda: {"force": found.plot()},
        [*force_parts(found), *read_parts(tables), *warning_lines(warnings)],
        out=out, figures=figures, json_output=json_output,
    )  # fmt: skip


def _ends(text: str) -> tuple[float, float]:
    parts = [exact("--pressures", part, "Pa") for part in text.split(",") if part.strip()]
    if len(parts) != 2 or not 0.0 < parts[0] < parts[1]:
        raise ConfigurationError(f'--pressures "{text}": write two that increase, "0.01 Pa, 10 Pa"')
    return parts[0], parts[1]
