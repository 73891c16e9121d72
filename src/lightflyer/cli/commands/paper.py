"""``lightflyer paper``: the published claims, figures and tables beside ours."""

from pathlib import Path

from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions
from lightflyer.cli.output import printer


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

    from lightflyer.paper.claims import claims
    from lightflyer.paper.reproduce import reproduce

    console = printer()
    results = reproduce(out, points, formats=figures.endings, dpi=figures.dpi, style=figures.style)
    table = Table(box=None, padding=(0, 1))
    for heading in ("#", "claim", "verdict", "by"):
        table.add_column(heading, justify="right" if heading == "#" else "left")
    for claim in claims():
        by = ", ".join(claim.reproducing(results.columns))
        table.add_row(str(claim.number), claim.text, str(claim.overall(results.columns)), by)
    console.print(table)
    for name in ("report.html", "report.md", "report.json", "figures", "data"):
        console.print(f"wrote {out / name}", soft_wrap=True)
