"""Optimal pressure and minimum irradiance from levitation points."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab import options

if TYPE_CHECKING:
    from lightflyer.files.result_text import Parts
    from lightflyer.lab.estimate import Estimate
    from lightflyer.lab.result import Outcome


@options.measurement(calibrate="flyer", keep_ground_effect="calibrate", update="calibrate")
def levitation(
    files: list[Path],
    /,
    *,
    columns: str | None = None,
    step: options.WattsPerArea = None,
    gas: Literal["air", "nitrogen", "oxygen", "argon", "helium"] = "air",
    ambient: options.Kelvins = None,
    gauge: options.GaugeOptions = options.AS_SHOWN,
    pressure_accuracy: options.Share = None,
    irradiance_accuracy: options.Share = None,
    span: float = 0.75,
    draws: int = 2000,
    seed: int = 0,
    flyer: Path | None = None,
    calibrate: bool = False,
    keep_ground_effect: bool = False,
    pressure_unit: Literal["Pa", "Torr", "mTorr", "mbar"] = "Pa",
    update: Path | None = None,  # noqa: ARG001  (written by the command)
) -> "Outcome":
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
    gas
        Gas in the chamber, by which the pressure in a heated gauge is corrected.
    ambient
        Temperature of that gas, such as "22 °C". Default: 295 K, assumed.
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
    update
        Flyer file to write the calibrated force coefficients into, with the ± of points and
        instruments; the file's own ± are not counted twice.
    """
    from lightflyer.calibration.calibration import fit_parts
    from lightflyer.calibration.gauge import pirani_doubts
    from lightflyer.files.table import same_text
    from lightflyer.gas import GASES
    from lightflyer.lab.levitation import curve as of_curve
    from lightflyer.lab.levitation.data import read_lift_offs
    from lightflyer.lab.result import Outcome, figures_by, require_distinct

    shown = gauge.build(GASES[gas], ambient)
    read = [read_lift_offs(file, columns=columns, gauge=shown) for file in files]
    tables, lots = [table for _, table in read], [one for lots, _ in read for one in lots]
    seen: dict[str, str] = {}
    for one in lots:
        name = same_text(one.name)
        if name in seen:
            raise ConfigurationError(f"{one.place}: {one.name} is also in {seen[name]}")
        seen[name] = one.place
    require_distinct([(f"{one.place}: {one.name}", (one.pressure, one.irradiance)) for one in lots])
    accuracies = {
        "pressure_accuracy": pressure_accuracy, "irradiance_accuracy": irradiance_accuracy
    }  # fmt: skip
    curves = [
        of_curve.levitation_curve(
            points, span=span, draws=draws, seed=seed + number, step=step or 0.0, **accuracies
        )
        for number, points in enumerate(lots)
    ]
    document = of_curve.summary(curves)
    doubts = pirani_doubts(gas, shown, accuracy_stated=pressure_accuracy is not None)
    warnings = [*doubts, *document["warnings"]]
    models: dict[str, Any] = {}
    values: dict[tuple[str, str], Estimate] = {}
    of_fit: Parts = ()
    if flyer is not None:
        from lightflyer.config.reader import read_flyer_file

        file = read_flyer_file(flyer)
        setups = {"model": file.build()}
        if setups["model"].environment.coordinate.name != "pressure":
            raise ConfigurationError(
                f"{flyer}: levitation points need a chamber as the environment"
            )
        if calibrate:
            fit = of_curve.calibrate_curves(
                curves, file, keep_ground_effect=keep_ground_effect, **accuracies
            )
            setups["calibrated model"] = fit.setup
            found = of_curve.measured_coefficients(fit)
            values = {("force", name): one for name, one in found.items()}
            document["calibration"], of_fit = fit.summary(), fit_parts(fit)
            warnings = list(dict.fromkeys([*warnings, *fit.warnings]))
        models = {
            name: {curve.points.name: of_curve.model_curve(curve.points, one) for curve in curves}
            for name, one in setups.items()
        }
    return Outcome(
        document,
        of_curve.to_dataset(curves, [table.source for table in tables]),
        [*of_curve.curves_parts(curves), *map(str, of_curve.compare(curves)), *of_fit],
        read=tables,
        warnings=warnings,
        figures=figures_by(
            "levitation.figures:levitation_figures", curves, pressure_unit=pressure_unit,
            models=models,
        ),
        tables=of_curve.tables(curves),
        values=values,
        sources=files,
    )  # fmt: skip
