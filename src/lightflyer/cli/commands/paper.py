"""``lightflyer paper``: the published claims, figures and tables beside ours."""

from pathlib import Path

from lightflyer.cli.options import AS_USUAL, FigureOptions
from lightflyer.cli.output import printer
from lightflyer.files.result_text import table_of


def paper_command(
    *, out: Path = Path("paper"), data: Path | None = None, figures: FigureOptions = AS_USUAL
) -> None:
    """Recompute the paper: every claim, figure and table for which its text gives enough.

    Parameters
    ----------
    out
        Folder for the report (HTML, Markdown, JSON), the figures and their data.
    data
        Your own measured points, drawn in figures 2, 5, S2 and S3: a CSV with columns such as
        "sample, pressure [mTorr], irradiance [W/m^2], diameter [cm], figure".
    figures
        How figures are written; PNG always, for the report.
    """
    figures.check(out)
    from lightflyer.calibration.points import read_points

    points = None if data is None else read_points(data, strict=True)

    from lightflyer.paper.conditions import claims
    from lightflyer.paper.report import reproduce

    console = printer()
    results = reproduce(out, points, formats=figures.endings, dpi=figures.dpi, style=figures.style)
    rows = [
        (str(claim.number), claim.text, str(claim.overall(results.columns)),
         ", ".join(claim.reproducers(results.columns)))
        for claim in claims()
    ]  # fmt: skip
    console.print(table_of(("#", "claim", "verdict", "by"), rows, left=(1, 2, 3)))
    for name in ("report.html", "report.md", "report.json", "figures", "data"):
        console.print(f"wrote {out / name}", soft_wrap=True)
    console.print(f"next: open {out / 'report.html'} in a browser", soft_wrap=True)
