"""``lightflyer calibrate``: force coefficients from measured levitation points."""

import json
import sys
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from lightflyer.calibration.bayes import Posterior
    from lightflyer.calibration.calibration import Calibration


def calibrate_command(
    points_file: Path,
    /,
    *,
    flyer: Path | None = None,
    free: str = "c_fm,c_cont",
    out: Path | None = None,
    posterior: Annotated[bool, Parameter(negative=())] = False,
    samples: int = 2000,
    seed: int = 0,
    json_output: Annotated[bool, Parameter(name="--json", negative=())] = False,
) -> None:
    """Fit force coefficients and film properties to measured levitation points.

    Parameters
    ----------
    points_file
        CSV with the columns sample, pressure and irradiance, units in the header such as
        "pressure [mTorr]". Further columns: irradiance_uncertainty, pressure_uncertainty, and
        the properties in which samples differ (diameter, areal_density, emittance, absorptance,
        tac_top, tac_bottom).
    flyer
        Flyer file with a chamber: it gives everything that is not fitted, and the starting
        values. Default: the paper's 2-cm disk, as "lightflyer init --kind chamber" writes it.
    free
        Parameters to fit, separated by commas: numbers of the flyer file such as c_fm, c_cont,
        tac_top, tac_bottom, emittance, absorptance. Brackets restrict one to a sample:
        "c_fm,c_cont,emittance[Ge 2 cm]".
    out
        Folder for the fit (JSON), the residuals (CSV) and their figure (PNG, SVG), and the draws
        from the posterior (CSV).
    posterior
        Also draw from the posterior by NUTS; needs numpyro: pip install 'lightflyer[posterior]'.
    samples
        Number of draws from the posterior.
    seed
        Seed of the draws from the posterior.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.calibration.calibration import calibrate
    from lightflyer.calibration.points import read_points
    from lightflyer.config.reader import read_flyer_file

    points = read_points(points_file)
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as default:
        design = read_flyer_file(default if flyer is None else flyer)
    names = [name.strip() for name in free.split(",") if name.strip()]
    fit = calibrate(points, design, free=names)
    drawn = _draw(fit, samples, seed) if posterior else None
    written = [] if out is None else _write(out, fit, drawn)
    if json_output:
        print(json.dumps(_summary(fit, drawn), allow_nan=False))  # noqa: T201
        return
    console = Console(highlight=False)
    if flyer is None:
        console.print("flyer: the paper's 2-cm disk in a chamber at 295 K; use --flyer for yours")
    _show(console, fit, drawn)
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)
    if out is None:
        console.print("add --out FOLDER to write the fit and a figure of the residuals")


def _draw(fit: "Calibration", samples: int, seed: int) -> "Posterior":
    from lightflyer.calibration.bayes import posterior

    return posterior(fit, samples=samples, seed=seed, progress=sys.stderr.isatty())


def _summary(fit: "Calibration", drawn: "Posterior | None") -> dict[str, Any]:
    return fit.summary() | ({} if drawn is None else {"posterior": drawn.summary()})


def _write(out: Path, fit: "Calibration", drawn: "Posterior | None") -> list[Path]:
    from lightflyer.calibration.figures import calibration_figure
    from lightflyer.foundation.drawing import save
    from lightflyer.foundation.files import output_directory

    names = ["calibration.json", "residuals.csv", "residuals.png", "residuals.svg"]
    if drawn is not None:
        names.append("posterior.csv")
    with output_directory(out) as stage:
        paths = [stage(name) for name in names]
        text = json.dumps(_summary(fit, drawn), indent=2)
        paths[0].write_text(text + "\n", encoding="utf-8")
        paths[1].write_text(_residuals_csv(fit), encoding="utf-8")
        save(calibration_figure(fit), paths[2:4])
        if drawn is not None:
            paths[4].write_text(_draws_csv(drawn), encoding="utf-8")
    return [out / name for name in names]


def _draws_csv(drawn: "Posterior") -> str:
    """One line per draw: the number of its chain, from 1, and the parameters."""
    header = ",".join(["chain", *(name.replace(",", ";") for name in drawn.names)])
    rows = [
        ",".join([str(number), *(f"{value:.8g}" for value in draw)])
        for number, chain in enumerate(drawn.draws, start=1)
        for draw in chain
    ]
    return "\n".join([header, *rows]) + "\n"


def _residuals_csv(fit: "Calibration") -> str:
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
        ",".join([sample.replace(",", ";"), *(f"{value:.8g}" for value in values)])
        for sample, *values in zip(fit.points.samples, *columns, strict=True)
    ]
    return "\n".join([header, *rows]) + "\n"


def _show(console: Console, fit: "Calibration", drawn: "Posterior | None") -> None:
    table = Table(box=None, padding=(0, 1))
    for heading in ("parameter", "value", "standard\nuncertainty", "95 % interval"):
        table.add_column(heading, justify="left" if heading == "parameter" else "right")
    for name, value, spread, (low, high) in zip(
        fit.names, fit.values, fit.standard_uncertainties, fit.intervals, strict=True
    ):
        table.add_row(
            name.replace("[", "\\["), f"{value:.4g}", f"{spread:.2g}", f"{low:.4g} to {high:.4g}"
        )
    console.print(table)
    kind = "estimated from the scatter" if fit.estimated_scatter else "as stated in the file"
    console.print(
        f"{len(fit.points)} points of {len(set(fit.points.samples))} samples scatter by "
        f"{100.0 * fit.scatter:.2g} % of the irradiance; their uncertainty is {kind}"
    )
    if drawn is not None:
        _show_posterior(console, drawn)


def _show_posterior(console: Console, drawn: "Posterior") -> None:
    table = Table(box=None, padding=(0, 1))
    headings = ("posterior", "mean", "standard\ndeviation", "95 % interval", "R-hat", "effective")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "posterior" else "right")
    for name, found in drawn.summary()["parameters"].items():
        low, high = found["interval_95"]
        table.add_row(
            name.replace("[", "\\["),
            f"{found['mean']:.4g}",
            f"{found['standard_deviation']:.2g}",
            f"{low:.4g} to {high:.4g}",
            f"{found['r_hat']:.3f}",
            f"{found['effective_draws']:.0f}",
        )
    console.print(table)
    chains, draws = drawn.draws.shape[:2]
    console.print(f"{chains * draws} draws in {chains} chains, {drawn.divergences} divergent")
