"""``lightflyer calibrate``: force coefficients from measured levitation points."""

from functools import partial
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions, Samples, Seed, only_with
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import cell_text
from lightflyer.files.quantities import exact, optional_share
from lightflyer.files.result_text import warning_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.calibration.bayes import Posterior
    from lightflyer.calibration.calibration import Calibration


@only_with(samples="posterior", seed="posterior", insist="update")
def calibrate_command(
    points_file: Path,
    /,
    *,
    flyer: Path | None = None,
    free: str = "c_fm,c_cont",
    columns: str | None = None,
    step: str | None = None,
    gauge: Path | None = None,
    gauge_factor: float = 1.0,
    pressure_accuracy: str | None = None,
    irradiance_accuracy: str | None = None,
    scale_errors: Annotated[bool, Parameter(negative=())] = False,
    keep_ground_effect: Annotated[bool, Parameter(negative=())] = False,
    out: Path | None = None,
    update: Path | None = None,
    insist: Annotated[bool, Parameter(negative=())] = False,
    posterior: Annotated[bool, Parameter(negative=())] = False,
    samples: Samples = 2000,
    seed: Seed = 0,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Fit force coefficients and film properties to measured levitation points.

    Parameters
    ----------
    points_file
        Table with the columns pressure and irradiance, units in the header such as
        "pressure [mTorr]", and sample where there is more than one; "lightflyer lab levitation"
        reads the same files. Further columns: irradiance_uncertainty, pressure_uncertainty,
        launchpad, floor_gap, and the properties in which samples differ (diameter,
        areal_density, emittance, absorptance, tac_top, tac_bottom), each with its uncertainty
        (emittance_uncertainty).
    flyer
        Flyer file with a chamber: it gives everything that is not fitted, and the starting
        values; its ± go into the total intervals. Default: the paper's 2-cm disk, as "lightflyer
        init --kind chamber" writes it.
    free
        Parameters to fit, separated by commas: numbers of the flyer file such as c_fm, c_cont,
        tac_top, tac_bottom, emittance, absorptance. Brackets restrict one to a sample:
        "c_fm,c_cont,emittance[Ge 2 cm]".
    columns
        Columns in the order of the file, in place of a header: "pressure [Pa], irradiance
        [W/m^2]"; - skips a column.
    step
        Step in which the light was raised until the sample lifted off, such as "200 W/m^2": what
        suffices lies within the last one.
    gauge
        Calibration of the pressure gauge: a table with the columns shown and pressure.
    gauge_factor
        Pressure over what the gauge shows of it, because of the gas, such as 1.7 for a Pirani gauge
        in argon.
    pressure_accuracy
        Relative standard uncertainty of the pressure gauge's calibration, common to all points,
        such as "0.5 %". Default: 5 %, assumed.
    irradiance_accuracy
        The same of the light meter. Default: 5 %, assumed.
    scale_errors
        Multiply the stated uncertainties of the points by the root of the reduced chi-squared.
    keep_ground_effect
        Fit points also where the floor is nearer than the sample's diameter.
    out
        Folder for the fit (JSON), the residuals (CSV) and their figure, and the draws
        from the posterior (CSV).
    update
        Flyer file to write the values that all samples share into, with their total ± and the
        origin. What is in doubt is refused, and the file left as it is.
    insist
        Have --update write also what is in doubt: not determined, unlikely, of points that do not
        fit or not cover it.
    posterior
        Also draw from the posterior by NUTS, at the inputs as given, without their ±; needs
        numpyro: pip install 'lightflyer[posterior]'.
    samples
        Number of draws from the posterior.
    seed
        Seed of the draws from the posterior.
    json_output
        Print one JSON object instead of a table.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.calibration import bayes
    from lightflyer.calibration.calibration import fit_parts
    from lightflyer.calibration.fitting import calibrate
    from lightflyer.calibration.gauge import read_gauge
    from lightflyer.calibration.points import read_points
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.config.update import require_no_doubt, update_flyer_file

    points = read_points(points_file, columns=columns, gauge=read_gauge(gauge, gauge_factor))
    points = points if keep_ground_effect else points.without_ground_effect()
    points = points.with_step(0.0 if step is None else exact("--step", step, "W/m^2"))
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as default:
        design = read_flyer_file(default if flyer is None else flyer)
    if design.build().environment.coordinate.name != "pressure":
        raise ConfigurationError(f"{flyer}: levitation points need a chamber as the environment")
    names = [name.strip() for name in free.split(",") if name.strip()]
    fit = calibrate(
        design,
        points=points,
        free=names,
        pressure_accuracy=optional_share("--pressure-accuracy", pressure_accuracy),
        irradiance_accuracy=optional_share("--irradiance-accuracy", irradiance_accuracy),
        scale_errors=scale_errors,
    )
    drawn = bayes.posterior(fit, samples=samples, seed=seed) if posterior else None
    summary = fit.summary() | ({} if drawn is None else {"posterior": drawn.summary()})
    files = {"calibration.json": summary, "residuals.csv": partial(_write_residuals, fit)}
    if drawn is not None:
        files["posterior.csv"] = partial(_write_draws, drawn)
    if update is not None:
        require_no_doubt(update, fit.warnings, insist=insist)

    def draw() -> "dict[str, Figure]":
        from lightflyer.calibration.figures import calibration_figure, posterior_figure

        found = {"residuals": calibration_figure(fit)}
        return found if drawn is None else found | {"posterior": posterior_figure(drawn)}

    written, changes = figures.write_folder(out, files, draw), []
    if update is not None:
        origin = f"calibrate, {points_file.name}"
        changes = update_flyer_file(update, fit.for_flyer_file(), origin, insist=insist)
    if json_output:
        print_json(summary)
        return
    console = printer()
    show(console, fit_parts(fit))
    if flyer is None:
        warmth = design.environment.temperature.value  # type: ignore[attr-defined]  # a chamber
        console.print(
            f"flyer: the paper's 2-cm disk in a chamber at {warmth:g} K; use --flyer for yours"
        )
    if drawn is not None:
        show(console, drawn.text_parts())
    show(console, warning_lines(fit.warnings))
    hint = "add --out FOLDER to write the fit and a figure of the residuals"
    figures.tell(console, written, hint)
    for text in changes:
        say(console, f"{update}: {text}")


def _write_draws(drawn: "Posterior", path: Path) -> None:
    """One line per draw: the number of its chain, from 1, and the parameters."""
    header = ",".join(["chain", *(name.replace(",", ";") for name in drawn.names)])
    rows = [
        ",".join([str(number), *(f"{value:.8g}" for value in draw)])
        for number, chain in enumerate(drawn.draws, start=1)
        for draw in chain
    ]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")


def _write_residuals(fit: "Calibration", path: Path) -> None:
    header = (
        "sample,pressure [Pa],irradiance [W/m^2],fitted [W/m^2],"
        "residual of log-irradiance,uncertainty of log-irradiance"
    )
    columns = (
        fit.points.pressure,
        fit.points.irradiance,
        fit.fitted,
        fit.residuals,
        fit.uncertainty,
    )
    rows = [
        ",".join([cell_text(sample.replace(",", ";")), *(f"{value:.8g}" for value in values)])
        for sample, *values in zip(fit.points.samples, *columns, strict=True)
    ]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
