"""``lightflyer calibrate``: force coefficients from measured levitation points."""

import json
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from lightflyer.calibrate import Calibration


def calibrate_command(
    points_file: Path,
    /,
    *,
    flyer: Path | None = None,
    free: str = "c_fm,c_cont",
    out: Path | None = None,
    json_output: Annotated[bool, Parameter(name="--json", negative=())] = False,
) -> None:
    """Fit force coefficients and film properties to measured levitation points.

    Parameters
    ----------
    points_file
        CSV with the columns sample, pressure and irradiance, units in the header such as
        "pressure [mTorr]". Further columns: irradiance_uncertainty, pressure_uncertainty, and
        what differs between samples (diameter, areal_density, emittance, absorptance, tac_top,
        tac_bottom).
    flyer
        Flyer file of a chamber: all that is not fitted, and where the fit starts. Default: the
        paper's 2-cm disk, as "lightflyer init --kind chamber" writes it.
    free
        What is fitted, of c_fm, c_cont, tac_top, tac_bottom, emittance, absorptance; such as
        "c_fm,c_cont,emittance[Ge 2 cm]", where brackets name one sample.
    out
        Folder to write the fit (JSON), the residuals (CSV) and their figure (PNG, SVG) into.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.calibrate import calibrate
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.points import read_points

    points = read_points(points_file)
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as default:
        configuration = read_flyer_file(default if flyer is None else flyer)
    names = [name.strip() for name in free.split(",") if name.strip()]
    fit = calibrate(points, configuration.build(), names)
    written = [] if out is None else _write(out, fit)
    if json_output:
        print(json.dumps(fit.summary(), allow_nan=False))  # noqa: T201
        return
    console = Console(highlight=False)
    if flyer is None:
        console.print("flyer: the paper's 2-cm disk in a chamber at 295 K; --flyer names your own")
    _show(console, fit)
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)
    if out is None:
        console.print("add --out FOLDER to write the fit and a figure of its residuals")


def _write(out: Path, fit: "Calibration") -> list[Path]:
    from lightflyer.calibration_plot import calibration_figure
    from lightflyer.output import output_directory
    from lightflyer.plot import save

    names = ["calibration.json", "residuals.csv", "residuals.png", "residuals.svg"]
    with output_directory(out) as stage:
        paths = [stage(name) for name in names]
        paths[0].write_text(json.dumps(fit.summary(), indent=2) + "\n", encoding="utf-8")
        paths[1].write_text(_residuals_csv(fit), encoding="utf-8")
        save(calibration_figure(fit), paths[2:])
    return [out / name for name in names]


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


def _show(console: Console, fit: "Calibration") -> None:
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
    kind = "estimated from it" if fit.estimated_scatter else "as stated in the file"
    console.print(
        f"{len(fit.points)} points of {len(set(fit.points.samples))} samples scatter by "
        f"{100.0 * fit.scatter:.2g} % of the irradiance; their uncertainty is {kind}"
    )
