"""``lightflyer lab levitation``: optimal pressure and minimum irradiance of samples."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import (
    Files,
    Insist,
    deliver,
    heated,
    read_parts,
    read_summary,
    updater,
)
from lightflyer.cli.options import Json, Seed, Whole, only_with
from lightflyer.cli.quantities import exact, optional_share
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.result_text import warning_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.calibration.calibration import Calibration
    from lightflyer.lab.estimate import Estimate
    from lightflyer.lab.levitation.curve import LevitationCurve


@only_with(calibrate="flyer", keep_ground_effect="calibrate", update="calibrate", insist="update")
def levitation_command(
    files: Files,
    /,
    *,
    columns: str | None = None,
    step: str | None = None,
    gauge: Path | None = None,
    gauge_factor: float = 1.0,
    gauge_temperature: str | None = None,
    gauge_tube: str | None = None,
    pressure_accuracy: str | None = None,
    irradiance_accuracy: str | None = None,
    span: float = 0.75,
    draws: Whole = 2000,
    seed: Seed = 0,
    flyer: Path | None = None,
    calibrate: Annotated[bool, Parameter(negative=())] = False,
    keep_ground_effect: Annotated[bool, Parameter(negative=())] = False,
    pressure_unit: Literal["Pa", "Torr", "mTorr", "mbar"] = "Pa",
    out: Path | None = None,
    update: Path | None = None,
    insist: Insist = False,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Find the minimum irradiance of samples and its pressure; compare samples and launchpads.

    Parameters
    ----------
    files
        Tables of points at which a sample just lifted off, with the columns pressure and
        irradiance, units in the header such as "pressure [mTorr]", and sample where there is
        more than one. Further columns: launchpad, floor_gap and, for the model's curve, diameter,
        areal_density, emittance, absorptance, tac_top, tac_bottom.
    columns
        Columns in the order of the files, in place of a header: "pressure [Pa], irradiance
        [W/m^2]"; - skips a column.
    step
        Step in which the light was raised until the sample lifted off, such as "200 W/m^2": what
        suffices lies within the last one. Default: it was raised steadily.
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
    pressure_accuracy
        Relative standard uncertainty of the pressure gauge's calibration, common to all points,
        such as "0.5 %". Default: 5 %, assumed.
    irradiance_accuracy
        The same of the light meter. Default: 5 %, assumed.
    span
        Fraction of a sample's points in each local fit.
    draws
        Number of simulated measurements for the intervals.
    seed
        Seed of the simulation.
    flyer
        Flyer file of a chamber; draws its predicted curve.
    calibrate
        Fit the force coefficients to the points, starting from that flyer, and draw the curve.
        Points in ground effect are left out.
    keep_ground_effect
        Fit them too.
    pressure_unit
        Unit of the figure's axis.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    update
        Flyer file to write the calibrated force coefficients into, with the ± of points and
        instruments; the file's own ± are not counted twice.
    insist
        Have --update write also what is in doubt: of a wrong unit, not determined, or of data that
        do not fit or not cover it.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.calibration.text import fit_parts
    from lightflyer.lab.gauges import gauge_of
    from lightflyer.lab.levitation import curve as levitation
    from lightflyer.lab.levitation.data import read_lift_offs
    from lightflyer.lab.levitation.text import curves_parts

    shown = gauge_of(gauge, gauge_factor, *heated(gauge_temperature, gauge_tube))
    read = [read_lift_offs(file, columns=columns, gauge=shown) for file in files]
    accuracies = {
        "pressure_accuracy": optional_share("--pressure-accuracy", pressure_accuracy),
        "irradiance_accuracy": optional_share("--irradiance-accuracy", irradiance_accuracy),
    }
    light_step = 0.0 if step is None else exact("--step", step, "W/m^2")
    curves = [
        levitation.levitation_curve(
            points, span=span, draws=draws, seed=seed + number, step=light_step, **accuracies
        )
        for number, points in enumerate(_distinct([one for lots, _ in read for one in lots]))
    ]
    models, fit = _models(
        curves, flyer, calibrate=calibrate, keep_ground_effect=keep_ground_effect, **accuracies
    )
    tables = [table for _, table in read]
    document = levitation.summary(curves) | {"read": read_summary(tables)}
    values = {} if fit is None else _coefficients(fit)
    if fit is not None:
        document["calibration"] = fit.summary()
        document["warnings"] = list(dict.fromkeys([*document["warnings"], *fit.warnings]))

    def draw() -> "dict[str, Figure]":
        from lightflyer.lab.levitation.figures import levitation_figures

        return levitation_figures(curves, pressure_unit=pressure_unit, models=models)

    deliver(
        "levitation", document, levitation.to_dataset(curves, [t.source for t in tables]), draw,
        [
            *curves_parts(curves), *map(str, levitation.compare(curves)),
            *(() if fit is None else fit_parts(fit)), *read_parts(tables),
            *warning_lines(document["warnings"]),
        ],
        out=out, figures=figures, json_output=json_output,
        tables=levitation.tables(curves),
        update=updater(update, values, "levitation", files, insist=insist,
                       warnings=document["warnings"]),
    )  # fmt: skip


def _coefficients(fit: "Calibration") -> "dict[tuple[str, str], Estimate]":
    from lightflyer.lab.levitation.model import measured_coefficients

    return {("force", name): one for name, one in measured_coefficients(fit).items()}


def _distinct(lots: Sequence[Any]) -> Sequence[Any]:
    from lightflyer.files.table import same_text
    from lightflyer.lab.record import require_distinct

    seen: dict[str, str] = {}
    for one in lots:
        name = same_text(one.name)
        if name in seen:
            raise ConfigurationError(f"{one.place}: {one.name} is also in {seen[name]}")
        seen[name] = one.place
    require_distinct([(f"{one.place}: {one.name}", (one.pressure, one.irradiance)) for one in lots])
    return lots


def _models(
    curves: "Sequence[LevitationCurve]",
    flyer: Path | None,
    *,
    calibrate: bool,
    keep_ground_effect: bool,
    **accuracies: float | None,
) -> tuple[dict[str, Any], "Calibration | None"]:
    """Curves of the model and of the calibrated model, by label."""
    if flyer is None:
        return {}, None
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.lab.levitation.model import calibrate_curves, model_curve

    file = read_flyer_file(flyer)
    setup = file.build()
    if setup.environment.coordinate.name != "pressure":
        raise ConfigurationError(f"{flyer}: levitation points need a chamber as the environment")
    setups, fit = {"model": setup}, None
    if calibrate:
        fit = calibrate_curves(curves, file, keep_ground_effect=keep_ground_effect, **accuracies)
        setups["calibrated model"] = fit.setup
    return {
        name: {curve.points.name: model_curve(curve.points, one) for curve in curves}
        for name, one in setups.items()
    }, fit
