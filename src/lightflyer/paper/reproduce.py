"""Recompute the paper and write the report."""

from collections.abc import Sequence
from pathlib import Path

from lightflyer.calibration.points import Points
from lightflyer.core import progress
from lightflyer.core.atomic_files import output_directory
from lightflyer.files.drawing import DOTS_PER_INCH, save, use_style
from lightflyer.paper import report
from lightflyer.paper.conditions import COLUMNS
from lightflyer.paper.curves import FIGURES, rows
from lightflyer.paper.figures import measured_figures, paper_figure
from lightflyer.paper.results import check_values, column_values, common_values, kinetic_values
from lightflyer.paper.tables import table_1, table_s2, tac_pairs, to_csv


def compute() -> report.Results:
    """Compute the numbers of the report."""
    results, common = report.Results(), common_values()
    for column in COLUMNS:
        progress.report(f"check values, {column.title}")
        results.checks[column.key] = check_values(column)
        progress.report(f"claims, {column.title}")
        results.columns[column.key] = {**common, **column_values(column)}
    progress.report("claims, kinetic theory")
    results.kinetic = kinetic_values()
    return results


def reproduce(
    out: Path,
    points: Points | None = None,
    *,
    formats: Sequence[str] = ("png", "svg"),
    dpi: int = DOTS_PER_INCH,
    style: str | None = None,
) -> report.Results:
    """Write report, figures and data into a folder: everything, or nothing on failure."""
    results = compute()
    endings = dict.fromkeys(("png", *formats))
    with output_directory(out) as stage, use_style(style):
        images = {}
        figures = {}
        for name, (title, curves_of) in FIGURES.items():
            progress.report(f"computing {title}")
            curves = curves_of()
            stage(f"data/{name}.csv").write_text("\n".join(rows(curves)) + "\n", encoding="utf-8")
            figures[name] = paper_figure(name, curves, points)
        if points is not None:
            figures |= measured_figures(points)
        for name, figure in figures.items():
            progress.report(f"drawing {name}")
            files = {ending: stage(f"figures/{name}.{ending}") for ending in endings}
            images[name] = files["png"]
            save(figure, list(files.values()), dpi=dpi)
        stage("data/table-1.csv").write_text(to_csv(table_1()), encoding="utf-8")
        stage("data/table-s2.csv").write_text(to_csv(table_s2()), encoding="utf-8")
        stage("data/tac-pairs.csv").write_text(to_csv(tac_pairs()), encoding="utf-8")
        stage("report.json").write_text(report.dump(results), encoding="utf-8")
        stage("report.md").write_text(report.as_markdown(results), encoding="utf-8")
        stage("report.html").write_text(report.as_html(results, images), encoding="utf-8")
    return results
