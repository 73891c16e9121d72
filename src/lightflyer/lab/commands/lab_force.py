"""Force on a heated vane over pressure, beside the kinetic equation."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from lightflyer.core.errors import ConfigurationError
from lightflyer.files.quantities import exact
from lightflyer.lab import options

if TYPE_CHECKING:
    from lightflyer.lab.result import Outcome


def _read_ends(option: str, text: str) -> tuple[float, float]:
    parts = [exact(option, part, "Pa") for part in text.split(",") if part.strip()]
    if len(parts) != 2 or not 0.0 < parts[0] < parts[1]:
        raise ConfigurationError(f'{option} "{text}": write two that increase, "0.01 Pa, 10 Pa"')
    return parts[0], parts[1]


def force(
    file: Path | None = None,
    /,
    *,
    diameter: options.KnownMetres,
    hot: options.MeasuredKelvins,
    cold: options.MeasuredKelvins,
    gas: Literal["air", "nitrogen", "oxygen", "argon", "helium"] = "argon",
    ambient: options.MeasuredKelvins = "295 K",
    tac: options.KnownNumber = None,
    tac_hot: options.KnownNumber = None,
    tac_cold: options.KnownNumber = None,
    wall: Literal["unknown", "maxwell", "accommodated"] = "unknown",
    pressures: Annotated[Any, _read_ends] = None,
    gauge: options.GaugeOptions = options.AS_SHOWN,
    pressure_accuracy: options.Share = None,
    force_accuracy: options.Share = "5 %",
) -> "Outcome":
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
    pressure_accuracy
        Relative standard uncertainty of the pressure gauge, common to all points. Default: 5 %,
        that of a Pirani gauge, assumed.
    force_accuracy
        The same of the balance.
    """
    from lightflyer.calibration.gauge import pirani_doubts
    from lightflyer.gas import GASES
    from lightflyer.lab.force import ASSUMED_TAC, Vane, compare_forces, read_forces
    from lightflyer.lab.result import Outcome, dataset

    if (tac_hot is None) != (tac_cold is None) or (tac is not None and tac_hot is not None):
        raise ConfigurationError("give either --tac, or both --tac-hot and --tac-cold")
    alike = tac_hot is None
    of_hot, of_cold = (one or ASSUMED_TAC for one in (tac_hot or tac, tac_cold or tac))
    vane = Vane(diameter, hot, cold, GASES[gas], ambient, of_hot, of_cold, alike, wall)
    shown = gauge.build(vane.gas, ambient.value)
    points = None if file is None else read_forces(file, shown)
    stated = pressure_accuracy is not None
    found = compare_forces(
        vane, points, pressures=pressures,
        pressure_accuracy=pressure_accuracy if stated else 0.05, force_accuracy=force_accuracy,
    )  # fmt: skip
    tables = [] if points is None else [points]
    of_gauge = pirani_doubts(gas, shown, accuracy_stated=stated) if tables else []
    warnings = [*of_gauge, *found.warnings]
    return Outcome(
        found.to_json(),
        dataset("force on a heated vane", found.variables, [str(file)] if file else [],
                warnings=warnings),
        found.parts(),
        read=tables,
        warnings=warnings,
        figures=lambda: {"force": found.plot()},
    )  # fmt: skip
