"""``lightflyer lab tac``: accommodation coefficients from a heater's power."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import Insist, deliver, heated, read_parts, read_summary, updater
from lightflyer.cli.lab.tac_results import OneFace, TwoFaces
from lightflyer.cli.options import Json, only_with
from lightflyer.cli.quantities import difference, exact, known, optional_share, share
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.result_text import warning_lines

if TYPE_CHECKING:
    from lightflyer.lab.estimate import Estimate
    from lightflyer.lab.tac.fit import TacFit
    from lightflyer.lab.tac.heat_law import AbstractHeatLaw

_Runs = Annotated[list[Path] | None, Parameter(consume_multiple=True, negative=())]
_KINETIC = "kinetic"  # reading of force models that have none of the paper's


@only_with(face="update", insist="update", other_face="top")
def tac_command(
    files: _Runs = None,
    /,
    *,
    top: _Runs = None,
    bottom: _Runs = None,
    other_face: str | None = None,
    columns: str | None = None,
    calibration: Path | None = None,
    ambient: str | None = None,
    diameter: str | None = None,
    tolerance: str = "1 K",
    emissivity: str | None = None,
    reading: Literal["kinetic", "printed", "reported"] = "kinetic",
    wall: str | None = None,
    gas: Literal[
        "air", "us1976-air", "lu2023-air", "nitrogen", "oxygen", "argon", "helium"
    ] = "air",
    gauge: Path | None = None,
    gauge_factor: float = 1.0,
    gauge_temperature: str | None = None,
    gauge_tube: str | None = None,
    gauge_accuracy: str | None = None,
    gauge_zero: str | None = None,
    power_accuracy: str | None = None,
    temperature_accuracy: str | None = None,
    plateau_accuracy: str | None = None,
    plateau_drift: str | None = None,
    out: Path | None = None,
    update: Path | None = None,
    insist: Insist = False,
    face: Literal["top", "bottom", "both"] | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Fit accommodation coefficient, area ratio and offset to a heater's power against pressure.

    Parameters
    ----------
    files
        Tables, one per run, with the columns pressure, heater_power (or heater_voltage and
        heater_current), heater_temperature and ambient_temperature, units in the header such as
        "pressure [mTorr]". Several runs are averaged.
    top
        Tables of runs of a sample's top face, in place of files; with --bottom. Runs of both faces
        are fitted together, so that what they share, such as the gauge's error, drops out of the
        difference of their coefficients.
    bottom
        The same of its bottom face.
    other_face
        Coefficient of the heater's other face, such as "0.80 ± 0.05", where the sample covers one
        face only; for --top and --bottom. By default the surface measured is on both faces.
    columns
        Columns in the order of the files, in place of a header: "pressure [Pa], -,
        heater_power [mW]"; - skips a column.
    calibration
        Table of resistance and temperature; voltage over current then gives the heater's
        temperature.
    ambient
        Temperature of gas and walls where the files have no such column, such as "22 °C".
    diameter
        Diameter of the heater, such as "20.0 ± 0.1 mm". Default: the paper's 24 mm; of the ±,
        0.1 mm, assumed.
    tolerance
        Largest distance of the heater temperature from its median; other rows are dropped.
    emissivity
        Emissivity of the heater; its radiation is then counted apart from the offset.
    reading
        Law of the heat loss: kinetic is the kinetic equation; printed and reported are the paper's
        formulas, whose coefficients come out larger; reported counts the continuum loss twice.
    wall
        Distance of the chamber's walls from the heater's centre, such as "15 cm"; by default they
        are far away. For the reading kinetic.
    gas
        Gas in the chamber.
    gauge
        Calibration of the pressure gauge: a table with the columns shown and pressure.
    gauge_factor
        Pressure over what the gauge shows of it, because of the gas, such as 1.7 for a Pirani gauge
        in argon.
    gauge_temperature
        Temperature at which the gauge is held, such as "45 °C", where it is not that of the
        chamber; with --gauge-tube.
    gauge_tube
        Inner diameter of the tube to that gauge, such as "5 mm".
    gauge_accuracy
        Relative standard uncertainty of the pressure gauge's calibration, common to all rows, such
        as "0.5 %" for a capacitance manometer. Default: 5 %, that of a Pirani gauge, assumed.
    gauge_zero
        Standard uncertainty of the gauge's zero. Default: 0.01 Pa, assumed.
    power_accuracy
        Relative standard uncertainty of the power. Default: 1 %, assumed.
    temperature_accuracy
        Standard uncertainty of the temperature difference between heater and gas. Default: 1 K,
        assumed.
    plateau_accuracy
        Relative standard uncertainty of the heat loss in dense gas by the law: walls, thickness of
        the heater, natural convection. Default: 5 %, assumed.
    plateau_drift
        Standard uncertainty of that heat loss's change from the first row to the last, such as
        "3 %". Default: none.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    update
        Flyer file to write the coefficient into, with its total uncertainty; needs --face. With
        --top and --bottom both coefficients and the correlation of their errors are written.
    insist
        Have --update write also what is in doubt: of a wrong unit, not determined, or of data that
        do not fit or not cover it.
    face
        Face of that film which has the measured surface.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.core.checks import require_range
    from lightflyer.gas import GASES
    from lightflyer.lab.gauges import gauge_of, pirani_doubts
    from lightflyer.lab.record import require_distinct
    from lightflyer.lab.tac import fit as tac
    from lightflyer.lab.tac.accuracy import TacAccuracy, unstated_accuracies
    from lightflyer.lab.tac.data import read_resistance_calibration, read_tac
    from lightflyer.lab.tac.diagnostics import POSSIBLE_TAC
    from lightflyer.lab.tac.difference import fit_tac_difference

    faces = _faces(files, top, bottom)
    _require_face(update, face, len(faces))
    thermometer = None if calibration is None else read_resistance_calibration(calibration)
    width, stated = _stated_value(
        diameter, gauge_accuracy, gauge_zero, power_accuracy, temperature_accuracy,
        plateau_accuracy, plateau_drift,
    )  # fmt: skip
    options: dict[str, Any] = {
        "tolerance": difference("--tolerance", tolerance, "K"),
        "law": _law(reading, wall),
        "gas": GASES[gas],
        "accuracy": TacAccuracy(**stated),
        "emissivity": optional_share("--emissivity", emissivity),
    }
    if width is not None:
        options["diameter"] = width
    other = None if other_face is None else known("--other-face", other_face, "")
    if other is not None:
        require_range("--other-face", other.value, 0.0, POSSIBLE_TAC)
    surroundings = None if ambient is None else exact("--ambient", ambient, "K")
    shown = gauge_of(
        gauge, gauge_factor, *heated(gauge_temperature, gauge_tube),
        gas=GASES[gas], ambient=surroundings,
    )  # fmt: skip
    how: dict[str, Any] = {
        "columns": columns, "thermometer": thermometer, "ambient_temperature": surroundings,
        "gauge": shown,
    }  # fmt: skip
    sides = [[read_tac(file, **how) for file in side] for side in faces]
    runs = [run for side in sides for run in side]
    require_distinct([(run.source, (run.pressure, run.power)) for run in runs])
    found: OneFace | TwoFaces
    if len(sides) == 1:
        found = OneFace([tac.fit_tac(run, **options) for run in runs], face)
    else:
        found = TwoFaces(fit_tac_difference(*sides, **options, other_face=other))
    values, about_flyer = _for_flyer_file(found, update)
    doubts = pirani_doubts(gas, shown, accuracy_stated="gauge" in stated)
    warnings = [*doubts, *found.warnings, *about_flyer, *unstated_accuracies(stated)]
    read = {"read": read_summary([run.table for run in runs])}
    document = found.summary() | read | {"warnings": warnings}
    given = [file for side in faces for file in side]
    deliver(
        "tac", document, found.dataset(warnings), found.figures,
        [
            found.finding, *read_parts(run.table for run in runs), *found.parts(),
            *warning_lines(warnings),
        ],
        out=out, figures=figures, json_output=json_output, tables=found.tables(),
        update=updater(
            update, values, f"tac, {reading} reading, in {gas}", given, insist=insist,
            digits=found.digits, warnings=warnings,
        ),
    )  # fmt: skip


def _faces(
    files: list[Path] | None, top: list[Path] | None, bottom: list[Path] | None
) -> list[list[Path]]:
    """Files of one surface, or of the top and the bottom face."""
    if files and not (top or bottom):
        return [files]
    if top and bottom and not files:
        return [top, bottom]
    raise ConfigurationError(
        "give either the files of one surface, or those of both faces: --top FILES --bottom FILES"
    )


def _require_face(update: Path | None, face: str | None, faces: int) -> None:
    if faces > 1 and face is not None:
        raise ConfigurationError(
            "--face is for runs of one surface; with --top and --bottom both are written"
        )
    if update is not None and face is None and faces == 1:
        raise ConfigurationError(
            "--update needs --face top, bottom or both: a heater gives one coefficient, of the "
            "surface on it; the same on both faces of a flyer gives no force"
        )


def _law(reading: str, wall: str | None) -> "AbstractHeatLaw":
    from lightflyer.core.checks import require_positive
    from lightflyer.lab.tac.heat_law import HEAT_LAWS, KINETIC, KineticLaw

    if wall is None:
        return HEAT_LAWS[reading]
    if reading != KINETIC:
        raise ConfigurationError(f"--wall is for the reading kinetic only, not for {reading}")
    distance = exact("--wall", wall, "m")
    require_positive(**{"--wall": distance})
    return KineticLaw(distance)


def _stated_value(
    diameter: str | None, gauge: str | None, zero: str | None, power: str | None,
    temperature: str | None, plateau: str | None, drift: str | None,
) -> tuple[float | None, dict[str, float]]:  # fmt: skip
    """Diameter, and the accuracies that are stated, by names of `TacAccuracy`."""
    found: dict[str, float] = {}
    for name, text in (("gauge", gauge), ("power", power), ("plateau", plateau)):
        if text is not None:
            found[name] = share(f"--{name}-accuracy", text)
    if drift is not None:
        found["plateau_drift"] = share("--plateau-drift", drift)
    if zero is not None:
        found["gauge_zero"] = exact("--gauge-zero", zero, "Pa")
    if temperature is not None:
        found["temperature"] = difference("--temperature-accuracy", temperature, "K")
    width, spread = (None, None) if diameter is None else known("--diameter", diameter, "m")
    return width, found if spread is None else found | {"diameter": spread}


def _for_flyer_file(
    found: OneFace | TwoFaces, flyer: Path | None
) -> "tuple[dict[tuple[str, str], Estimate], list[str]]":
    """Values for a flyer file and what to know about them; raises if they are not fit for one."""
    if flyer is None:
        return {}, []
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.lab.tac.record import why_no_property

    for fits in found.sides:
        reason = why_no_property(fits)
        if reason is not None:
            raise ConfigurationError(f"{reason}; {flyer} is unchanged")
    file, first = read_flyer_file(flyer), found.sides[0][0]
    texts = [found.about_faces(file), _about_reading(first, file), _about_gas(first.gas, file)]
    return found.values(), [f"{flyer}: {text}" for text in texts if text]


def _about_gas(gas: str, file: Any) -> str:
    from lightflyer.gas.registry import AIRS

    around = file.environment.build().gas.name
    if gas == around or {gas, around} <= AIRS.keys():
        return ""
    return (
        f"its flyer is in {around}, and the coefficient written was measured in {gas}: a film has "
        "another one in every gas"
    )


def _about_reading(fit: "TacFit", file: Any) -> str:
    reading = str(getattr(file.force, "reading", _KINETIC))
    if reading == fit.reading:
        return ""
    other = fit.by_reading.get(reading)
    also = "" if other is None else f", by which the same rows give {other:.3g}"
    return (
        f"its force model {file.force.model} takes the heat loss by the reading {reading}{also}; "
        f"the coefficient written is by the reading {fit.reading}"
    )
