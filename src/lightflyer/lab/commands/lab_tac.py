"""Accommodation coefficient from a heater's power against pressure."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab import options

if TYPE_CHECKING:
    from lightflyer.lab.result import Outcome
    from lightflyer.lab.tac.fit import TacRuns


@options.measurement(face="update", other_face="top")
def tac(
    files: list[Path] | None = None,
    /,
    *,
    top: list[Path] | None = None,
    bottom: list[Path] | None = None,
    other_face: options.KnownNumber = None,
    columns: str | None = None,
    calibration: Path | None = None,
    ambient: options.Kelvins = None,
    diameter: options.KnownMetres = None,
    tolerance: options.KelvinsApart = "1 K",
    emissivity: options.Share = None,
    reading: Literal["kinetic", "printed", "reported"] = "kinetic",
    wall: options.Metres = None,
    gas: Literal[
        "air", "us1976-air", "lu2023-air", "nitrogen", "oxygen", "argon", "helium"
    ] = "air",
    gauge: options.GaugeOptions = options.AS_SHOWN,
    gauge_accuracy: options.Share = None,
    gauge_zero: options.Pascals = None,
    power_accuracy: options.Share = None,
    temperature_accuracy: options.KelvinsApart = None,
    plateau_accuracy: options.Share = None,
    plateau_drift: options.Share = None,
    update: Path | None = None,
    face: options.Face | None = None,
) -> "Outcome":
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
    update
        Flyer file to write the coefficient into, with its total uncertainty; needs --face. With
        --top and --bottom both coefficients and the correlation of their errors are written.
    face
        Face of that film which has the measured surface.
    """
    from lightflyer.calibration.gauge import pirani_doubts
    from lightflyer.config.update import tac_keys
    from lightflyer.core.checks import require_positive, require_range
    from lightflyer.gas import GASES
    from lightflyer.lab.result import Outcome, figures_by, require_distinct
    from lightflyer.lab.tac import data
    from lightflyer.lab.tac.difference import TacDifference, fit_tac_difference
    from lightflyer.lab.tac.fit import TacRuns, fit_tac
    from lightflyer.lab.tac.preparation import LU2023_HEATER_DIAMETER, POSSIBLE_TAC
    from lightflyer.lab.tac.problem import HEAT_LAWS, KINETIC, KineticLaw

    faces = [files] if files else [top, bottom]
    if not all(faces) or (files and (top or bottom)):
        raise ConfigurationError(
            "give either the files of one surface, or those of both faces: --top FILES --bottom "
            "FILES"
        )
    if len(faces) > 1 and face is not None:
        raise ConfigurationError(
            "--face is for runs of one surface; with --top and --bottom both are written"
        )
    if update is not None and face is None and len(faces) == 1:
        raise ConfigurationError(
            "--update needs --face top, bottom or both: a heater gives one coefficient, of the "
            "surface on it; the same on both faces of a flyer gives no force"
        )
    stated = {
        name: value
        for name, value in {
            "gauge": gauge_accuracy, "power": power_accuracy, "plateau": plateau_accuracy,
            "plateau_drift": plateau_drift, "gauge_zero": gauge_zero,
            "temperature": temperature_accuracy, "diameter": diameter and diameter.uncertainty,
        }.items()
        if value is not None
    }  # fmt: skip
    law = HEAT_LAWS[reading]
    if wall is not None:
        if reading != KINETIC:
            raise ConfigurationError(f"--wall is for the reading kinetic only, not for {reading}")
        require_positive(**{"--wall": wall})
        law = KineticLaw(wall)
    settings: dict[str, Any] = {
        "tolerance": tolerance, "law": law, "gas": GASES[gas], "emissivity": emissivity,
        "accuracy": data.TacAccuracy(**stated),
        **({"diameter": diameter.value} if diameter else {}),
    }  # fmt: skip
    if other_face is not None:
        require_range("--other-face", other_face.value, 0.0, POSSIBLE_TAC)
    shown = gauge.build(GASES[gas], ambient)
    thermometer = None if calibration is None else data.read_resistance_calibration(calibration)
    sides = [
        [
            data.read_tac(
                file, columns=columns, thermometer=thermometer, ambient_temperature=ambient,
                gauge=shown,
            )
            for file in side or ()
        ]
        for side in faces
    ]  # fmt: skip
    runs = [run for side in sides for run in side]
    require_distinct([(run.source, (run.pressure, run.power)) for run in runs])
    doubts = pirani_doubts(gas, shown, accuracy_stated="gauge" in stated)
    unstated = data.unstated_accuracies(stated, None if diameter else LU2023_HEATER_DIAMETER)
    found: TacRuns | TacDifference
    values: Any = {}
    if len(sides) == 1:
        found = TacRuns([fit_tac(run, **settings) for run in runs])
        surfaces = [found]
        if face:
            values = dict.fromkeys(tac_keys(face), found.mean())
    else:
        found = fit_tac_difference(*sides, **settings, other_face=other_face)
        surfaces, values = [TacRuns(found.top), TacRuns(found.bottom)], found.film_values()
    warnings = [*doubts, *found.warnings, *_about_flyer(update, surfaces, face), *unstated]
    return Outcome(
        found.summary(),
        found.to_dataset(warnings),
        [found.headline, *found.parts()],
        read=[run.table for run in runs],
        warnings=warnings,
        figures=figures_by("tac.figures:bench_figures", found),
        tables=found.tables(),
        values=values,
        # the difference of both ± keeps the uncertainty of the coefficients' difference
        digits=2 if len(sides) == 1 else 4,
        origin=f"tac, {reading} reading, in {gas}",
        sources=[file for side in faces for file in side or ()],
    )


def _about_flyer(
    flyer: Path | None, surfaces: "Sequence[TacRuns]", face: options.Face | None
) -> list[str]:
    """What to know of coefficients in a flyer file; raises if they are not fit for one."""
    if flyer is None:
        return []
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.gas.pure import AIRS
    from lightflyer.lab.tac.problem import KINETIC

    for one in surfaces:
        reason = one.why_no_property()
        if reason is not None:
            raise ConfigurationError(f"{reason}; {flyer} is unchanged")
    file, first = read_flyer_file(flyer), surfaces[0].fits[0]
    said = []
    film: Any = getattr(file, "film", None)
    other = getattr(film, "tac_bottom" if face == "top" else "tac_top", None)
    if face == "both":
        said.append("the same coefficient on both faces gives a flyer without force")
    elif face is not None and getattr(other, "uncertainty", None):
        said.append(
            "where both faces were measured on this bench, they share the errors of gauge and "
            f"plateau: tac_correlation = {surfaces[0].correlation_between_samples:.2g} says "
            f"so (it is {film.tac_correlation.value:g}), and --top and --bottom, which fit runs of "
            "both together, know it better"
        )
    reading = str(getattr(file.force, "reading", KINETIC))
    if reading != first.reading:
        by_it = first.by_reading.get(reading)
        also = "" if by_it is None else f", by which the same rows give {by_it:.3g}"
        said.append(
            f"its force model {file.force.tag()} takes the heat loss by the reading {reading}"
            f"{also}; the coefficient written is by the reading {first.reading}"
        )
    there = file.environment.build().gas.name  # type: ignore[attr-defined]
    if first.gas != there and not {first.gas, there} <= AIRS.keys():
        said.append(
            f"its flyer is in {there}, and the coefficient written was measured in {first.gas}: a "
            "film has another one in every gas"
        )
    return [f"{flyer}: {text}" for text in said]
