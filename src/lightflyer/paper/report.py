"""Recompute the paper: its numbers beside ours, as JSON, Markdown and one HTML page."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import lightflyer
from lightflyer.calibration.points import Points
from lightflyer.core import progress
from lightflyer.core.atomic_files import output_directory
from lightflyer.files import page
from lightflyer.files.drawing import DOTS_PER_INCH, save, use_style
from lightflyer.paper.conditions import COLUMNS, DECIDING, KINETIC, Claim, claims, facts
from lightflyer.paper.figures import FIGURES, captions, measured_figures, paper_figure, rows
from lightflyer.paper.results import (
    Row,
    check_values,
    column_values,
    common_values,
    kinetic_values,
    table_1,
    table_s2,
    tac_pairs,
    to_csv,
)

SOURCE = (
    "Z. Lu, G. Aldan, D. Levin, M. F. Campbell, I. Bargatin, “Photophoretic Light-flyers with "
    "Germanium Coatings as Selective Absorbers”, arXiv:2305.19382 (2023)"
)

# Digits after the point in the check table.
_CHECK_FORMATS = {
    "altitude_km": ("altitude [km]", "g"),
    "gas_temperature_k": ("T_c [K]", ".4f"),
    "pressure_pa": ("p [Pa]", ".6g"),
    "levitation_temperature_k": ("T_h to levitate [K]", ".4f"),
    "levitation_irradiance_w_m2": ("I to levitate [W/m²]", ".3f"),
    "temperature_k": ("T_h at 1360 W/m² [K]", ".4f"),
    "lift_over_weight": ("lift/weight at 1360 W/m²", ".6f"),
}


@dataclass
class Results:
    """All numbers of the report."""

    columns: dict[str, dict[str, float]] = field(default_factory=dict)  # Values by column and key
    # The check table by column
    checks: dict[str, list[dict[str, float]]] = field(default_factory=dict)
    # Values by kinetic theory, which decide nothing; None where the disk flies nowhere
    kinetic: dict[str, float | None] = field(default_factory=dict)


def as_json(results: Results) -> dict[str, Any]:
    """The report as a JSON object."""
    columns, described = results.columns, []
    for claim in claims():
        quantities = []
        for one in claim.quantities:
            ours = {name: values[one.key] for name, values in columns.items()}
            quantities.append(
                {
                    "key": one.key,
                    "name": one.name,
                    "unit": one.unit,
                    "paper": [one.lowest, one.highest],
                    "tolerance": one.tolerance,
                    "ours": ours,
                    "difference": {name: one.difference(value) for name, value in ours.items()},
                    "agrees": {name: one.agrees(value) for name, value in ours.items()},
                }
            )
        described.append(
            {
                "number": claim.number,
                "claim": claim.text,
                "place": claim.place,
                "verdict": str(claim.overall(columns)),
                "why": claim.reason(columns),
                "reproduced_by": claim.reproducers(columns),
                "verdicts": {name: str(claim.verdict(values)) for name, values in columns.items()},
                "quantities": quantities,
            }
        )
    return {
        "source": SOURCE,
        "lightflyer_version": lightflyer.__version__,
        "columns": {column.key: column.description for column in COLUMNS},
        "chamber": facts()["chamber"]["note"],
        "claims": described,
        "check": results.checks,
        "values": results.columns,
        "kinetic": results.kinetic,
        "table_1": table_1(),
        "table_s2": table_s2(),
        "tac_pairs": tac_pairs(),
        "figures": captions(),
    }


@dataclass(frozen=True)
class _Block:
    """A heading, paragraph, table or image of the report."""

    kind: str
    text: str = ""
    rows: tuple[tuple[str, ...], ...] = ()
    image: str = ""


def _blocks(results: Results) -> list[_Block]:
    counts: dict[str, int] = {}
    for claim in claims():
        verdict = str(claim.overall(results.columns))
        counts[verdict] = counts.get(verdict, 0) + 1
    tally = ", ".join(f"{verdict}: {count}" for verdict, count in counts.items())
    by_column = "; ".join(
        f"{column.title}: {sum(column.key in c.reproducers(results.columns) for c in claims())}"
        for column in COLUMNS
    )
    blocks = [
        _Block("h1", "The paper, reproduced"),
        _Block("p", f"The numbers of {SOURCE}, beside those that lightflyer computes."),
        _Block("p", f"Verdicts on {len(claims())} claims: {tally}."),
        _Block("p", f"Claims that each column reproduces: {by_column}."),
        _Block(
            "p",
            "A column reproduces a claim if each number of the claim is within the tolerance "
            "shown. The tolerance is one unit of the last digit that the paper prints, unless "
            "stated otherwise. The column “reported” alone decides the verdict, so that no reading "
            "is picked claim by claim; “by” names every column that reproduces the claim. Numbers "
            "in brackets belong to claims that cannot be recomputed; they decide nothing.",
        ),
        *(_Block("p", f"Column “{column.title}”: {column.description}.") for column in COLUMNS),
        _Block("h2", "Claims"),
        _claims_overview(results),
    ]
    for claim in claims():
        blocks += _claim_blocks(claim, results)
    lift = results.kinetic["largest_lift"]
    blocks += [
        _Block("h2", "By kinetic theory"),
        _Block("p", _KINETIC_TEXT.format(lift=lift)),
        _kinetic_table(results),
    ]
    blocks += [_Block("h2", "Check values"), _Block("p", _CHECK_TEXT)]
    header = tuple(title for title, _ in _CHECK_FORMATS.values())
    for column in COLUMNS:
        rows = [
            tuple(format(row[name], style) for name, (_, style) in _CHECK_FORMATS.items())
            for row in results.checks[column.key]
        ]
        blocks += [
            _Block("p", f"Column “{column.title}”:"),
            _Block("table", rows=(header, *rows)),
        ]
    blocks += _table_blocks()
    blocks += [_Block("h2", "Figures")]
    for name, (title, _) in FIGURES.items():
        blocks += [
            _Block("h3", title),
            _Block("p", captions()[name]),
            _Block("img", title, image=name),
        ]
    return blocks


_KINETIC_TEXT = (
    "What follows for the mesosphere if the force is that of the kinetic equation, with nothing "
    "fitted, and all else is as in the paper. The paper's coefficients were fitted in a chamber "
    "whose floor and walls lift disks, the more the larger they are; in open air nothing does. "
    "The largest lift over weight of the 2-cm disk is {lift:.3g}, with an error of several per "
    "cent by collisions and unknown walls: whether it flies in these surroundings is open. "
    "Over Earth light from below helps, and it flies in a wider band."
)


def _kinetic_table(results: Results) -> _Block:
    rows = [("claim", "quantity", "paper", DECIDING, KINETIC.title)]
    for claim in claims():
        for quantity in claim.quantities:
            if quantity.key not in results.kinetic:
                continue
            unit = f" {quantity.unit}" if quantity.unit else ""
            ours = results.kinetic[quantity.key]
            fitted = results.columns[DECIDING][quantity.key]
            found = "flies nowhere" if ours is None else f"{ours:.3g}{unit}"
            paper = f"{quantity.paper}{unit}"
            rows.append((str(claim.number), quantity.name, paper, f"{fitted:.3g}{unit}", found))
    return _Block("table", rows=tuple(rows))


_CHECK_TEXT = (
    "The 2-cm disk (TAC 0.8 and 0.9, emittance 0.08, absorptance 0.75, 1.0 g/m², coefficients 0.4 "
    "and 3) in the paper's atmosphere, with more digits than the paper gives, for checking other "
    "programs."
)


def _claims_overview(results: Results) -> _Block:
    header = ("#", "claim", "in the paper", "verdict", "by", "why")
    titles = {column.key: column.title for column in COLUMNS}
    rows = [
        (
            str(claim.number),
            claim.text,
            claim.place,
            str(claim.overall(results.columns)),
            "; ".join(titles[key] for key in claim.reproducers(results.columns)),
            claim.reason(results.columns),
        )
        for claim in claims()
    ]
    return _Block("table", rows=(header, *rows))


def _claim_blocks(claim: Claim, results: Results) -> list[_Block]:
    if not claim.quantities:
        return []
    header = ["quantity", "paper", "tolerance"]
    for column in COLUMNS:
        header += [column.title, "difference"]
    rows = []
    for quantity in claim.quantities:
        unit = f" {quantity.unit}" if quantity.unit else ""
        note = f" ({quantity.tolerance_note})" if quantity.tolerance_note else ""
        row = [quantity.name, f"{quantity.paper}{unit}", f"{quantity.tolerance:g}{unit}{note}"]
        for column in COLUMNS:
            ours = results.columns[column.key][quantity.key]
            value, difference = f"{ours:.5g}", f"{quantity.difference(ours):+.3g}"
            mark = "✓" if quantity.agrees(ours) else "✗"
            row += (
                [f"({value})", f"({difference})"]
                if claim.missing
                else [f"{value} {mark}", difference]
            )
        rows.append(tuple(row))
    table = _Block("table", rows=(tuple(header), *rows))
    return [_Block("h3", f"Claim {claim.number}: {claim.text}"), table]


def _table_blocks() -> list[_Block]:
    return [
        _Block("h2", "Tables"),
        _Block("h3", "Table 1: optical properties"),
        _Block(
            "p",
            "What is absorbed is the emissivity in the infrared and the absorptivity in the "
            "visible: as printed, and 1 − t − r of the printed transmittance and reflectance. Its "
            "uncertainty is given for independent errors and as the sum of the two, which is what "
            "the paper prints. The bound from FTIR assumes no reflectance; beside it is that of "
            "the same assumption with the camera's transmittance.",
        ),
        _plain_table(table_1()),
        _Block("h3", "Table S2: thermal accommodation coefficients"),
        _Block(
            "p",
            "Each test with its 95 % interval; the mean and the standard deviation of the tests; "
            "and what Table 1 and the text print.",
        ),
        _plain_table(table_s2()),
        _Block("h3", "Pairs of faces"),
        _Block(
            "p",
            "What drives the flyer is the difference of two TACs. Its uncertainty is given twice: "
            "for independent errors, and for fully correlated ones, such as a common systematic "
            "error.",
        ),
        _plain_table(tac_pairs()),
    ]


def _plain_table(rows: list[Row]) -> _Block:
    header = tuple(name.replace("_", " ") for name in rows[0])
    cells = [
        tuple(
            "–" if value is None else f"{value:.3g}" if isinstance(value, float) else value
            for value in row.values()
        )
        for row in rows
    ]
    return _Block("table", rows=(header, *cells))


def as_markdown(results: Results) -> str:
    """The report as Markdown; figures are links to files in ``figures/``."""
    parts = []
    for block in _blocks(results):
        if block.kind == "p":
            parts.append(block.text)
        elif block.kind == "img":
            parts.append(f"![{block.text}](figures/{block.image}.png)")
        elif block.kind == "table":
            header, *rows = block.rows
            lines = [header, ("---",) * len(header), *rows]
            parts.append("\n".join("| " + " | ".join(line) + " |" for line in lines))
        else:
            parts.append("#" * int(block.kind[1]) + " " + block.text)
    return "\n\n".join(parts) + "\n"


def as_html(results: Results, images: dict[str, Path]) -> str:
    """The report as one self-contained page; ``images``: PNG file of each figure, by name."""
    parts = []
    for block in _blocks(results):
        if block.kind == "img":
            parts.append(page.image(images[block.image].read_bytes(), "png", block.text))
        elif block.kind == "table":
            header, *rows = block.rows
            parts.append(page.table(rows, header))
        elif block.kind == "p":
            parts.append(page.paragraph(block.text))
        else:
            parts.append(page.heading(block.text, int(block.kind[1])))
    return page.page("The paper, reproduced", parts)


def dump(results: Results) -> str:
    """The report's JSON text."""
    return json.dumps(as_json(results), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def compute() -> Results:
    """Compute the numbers of the report."""
    results, common = Results(), common_values()
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
) -> Results:
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
        stage("report.json").write_text(dump(results), encoding="utf-8")
        stage("report.md").write_text(as_markdown(results), encoding="utf-8")
        stage("report.html").write_text(as_html(results, images), encoding="utf-8")
    return results
