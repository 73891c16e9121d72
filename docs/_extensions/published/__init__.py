"""A page for each published flyer, a table of all, and two of them beside each other.

``docs/published.toml`` is the table, ``table`` reads it, ``verdicts`` computes ours. The directives
``{published-flyers}`` and ``{published-pair}`` stand on the page that lists them.
"""

from __future__ import annotations

import json
import shutil
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from sphinx.util import logging

from lightflyer.core.units import scale_and_offset

from .sources import linked, online
from .table import DOCS, TABLE, VERDICTS, Published, is_number, published

LOGGER = logging.getLogger(__name__)
_HERE = Path(__file__).parent
_PAGES = "flyers-published"  # folder of the pages, which are made, and of the flyer files
_UP = "../"  # from these pages to the others
_SCRIPT = "published.js"
_KILO, _PICOGRAM, _NANOGRAM, _MILLIGRAM, _GRAM = 1e3, 1e-15, 1e-12, 1e-6, 1e-3
_WAS = {"flew": "flew.", "computed": "was computed, and has not been built."}


def page(flyer: Published) -> str:
    """The page of a flyer, in Markdown."""
    found = flyer.verdict()
    told = "\n".join(
        f"| {what} | {value} | {linked(where, _UP)} |" for what, value, where in flyer.told
    )
    numbers = "\n".join(
        f"| `{section}.{key}` | {value} | {linked(where, _UP)} |"
        for section, keys in flyer.file.items()
        for key, (value, where) in keys.items()
        if where
    )
    lines = "\n".join(f"- {line}" for line in found["lines"])
    return (
        (_HERE / "page.md")
        .read_text(encoding="utf-8")
        .format(
            name=flyer.name,
            title=flyer.title,
            kind=flyer.kind,
            size=_size(flyer),
            source=flyer.source,
            cited=linked(flyer.source, _UP) + online(flyer.source),
            status=f"It {_WAS.get(flyer.how, f'was {flyer.how}.')}",
            claimed=flyer.claimed,
            told=told,
            lines=lines,
            ratio=_ratio_line(flyer),
            said=flyer.said,
            numbers=numbers,
            guesses=flyer.guesses,
            version=found["version"],
            link=_calculator_link(flyer),
        )
    )


def _ratio_line(flyer: Published) -> str:
    if flyer.ratio is None:
        return ""
    median, low, high = (f"{flyer.ratio[at]:.2g}" for at in ("median", "low", "high"))
    return (
        f"**Over all that is not published**, {flyer.needed} is {median} (95 %: {low} to {high}), "
        "by a few hundred samples ([how](../other-claims.md#how-the-numbers-are-made)).\n\n"
    )


def calculator_state(flyer: Published) -> tuple[str, str]:
    """Kind of the calculator that has a flyer, and the address that shows it there."""
    from calculator.kinds import KINDS

    name = {"earth": "disk"}.get(flyer.file["environment"]["kind"][0], "chamber")
    name = name if flyer.kind == "disk" else flyer.kind
    kind = next(one for one in KINDS if one.name == name)
    given = {"flyer.payload": (0.0, 0.0, kind.payload.unit)} | _numbers_of(flyer)
    parts = [f"model={flyer.file['force']['model'][0]}"]
    for number in kind.numbers:
        if number.name in given:
            *measured, unit = given[number.name]
            scale = scale_and_offset(unit, number.unit)[0] if number.unit else 1.0
            value, spread = (f"{float(f'{one * scale:.6g}'):g}" for one in measured)
            parts.append(f"{number.name}={value}" + (f"+-{spread}" if measured[1] else ""))
    return name, f"#design:{'&'.join(parts)}"


def _numbers_of(flyer: Published) -> dict[str, tuple[float, float, str]]:
    """Numbers of its file with ± and unit, an emittance of both faces as two."""
    found = {}
    for section, keys in flyer.file.items():
        for key, (text, _) in keys.items():
            value, _, unit = text.partition("±")[0].strip().partition(" ")
            spread = text.partition("±")[2].split()[:1] or ["0"]
            unit = unit or text.split()[-1]
            if not is_number(value):
                continue
            ends = ("_top", "_bottom") if key == "emittance" else ("",)
            measured = float(value), float(spread[0]), unit
            found |= {f"{section}.{key}{end}": measured for end in ends}
    return found


def _calculator_link(flyer: Published) -> str:
    from calculator.kinds import KINDS
    from calculator.page import page_of

    if not flyer.in_calculator:
        return ""
    name, link = calculator_state(flyer)
    page = page_of(next(one for one in KINDS if one.name == name))
    return f' The <a href="../{page}{escape(link)}">calculator</a> shows it.'


def _band(flyer: Published) -> str:
    """Where it flies, in a few characters."""
    found = flyer.verdict()
    if not found["bands"]:
        return "nowhere"
    low, high = found["bands"][0][0], found["bands"][-1][1]
    scale, unit, digits = (1.0, "Pa", 2) if found["coordinate"] == "pressure" else (_KILO, "km", 3)
    first, last = (f"{float(f'{end / scale:.{digits}g}'):g}" for end in (low, high))
    below = "below " if "from below" in found["lines"][1] else ""
    return f"{below}{first} to {last} {unit}"


def _mass(kilograms: float) -> str:
    if kilograms < _NANOGRAM:
        return f"{kilograms / _PICOGRAM:.3g} pg"
    if kilograms < _GRAM:
        return f"{kilograms / _MILLIGRAM:.3g} mg"
    return f"{kilograms / _GRAM:.3g} g" if kilograms < 1.0 else f"{kilograms:.3g} kg"


def _size(flyer: Published) -> str:
    keys = flyer.file["flyer"]
    return _plain_unit((keys.get("diameter") or keys["size"])[0])


def _plain_unit(text: str) -> str:
    number, unit = text.split()[0], text.split()[-1]
    return f"{number} {unit}"


def _ratio(flyer: Published) -> str:
    if flyer.ratio is None:
        return "–"
    median, low, high = (f"{flyer.ratio[at]:.2g}" for at in ("median", "low", "high"))
    return f"{median} ({low} to {high})"


def _flyer_table() -> str:
    rows = "".join(
        f'<tr><th scope="row"><a href="{_PAGES}/{one.name}.html">{escape(one.title)}</a></th>'
        f"<td>{linked(one.source)}{online(one.source)}</td>"
        f"<td>{one.how}</td>"
        f"<td>{escape(one.claimed)}</td><td>{escape(_band(one))}</td></tr>"
        for one in published()
    )
    heads = ("flyer", "source", "how", "published", "we find that it flies")
    head = "".join(f'<th scope="col">{one}</th>' for one in heads)
    return (
        f'<div class="table-wrapper lf-wide"><table class="docutils lf-published"><thead>'
        f"<tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
    )


def _pair() -> str:
    from pictures.drawings import of_kind

    about = [
        {
            "name": one.name,
            "kind": one.kind,
            "page": f"{_PAGES}/{one.name}.html",
            "rows": [
                ["source", one.source],
                ["published", one.claimed],
                ["seen to fly", {"flew": "yes", "computed": "no, computed"}.get(one.how, one.how)],
                ["size", _size(one)],
                ["own mass", _mass(one.verdict()["own_mass"])],
                ["we find that it flies", _band(one)],
                ["our verdict", " ".join(one.verdict()["lines"][1:])],
                ["our force over that needed", _ratio(one)],
                ["guessed numbers", str(one.guesses)],
            ],
        }
        for one in published()
    ]
    names = [one.title for one in published()]
    choices = "".join(
        f'<option value="{at}">{escape(name)}</option>' for at, name in enumerate(names)
    )
    selects = "".join(
        f'<label>{label} <select id="lf-pair-{at}">{choices}</select></label>'
        for at, label in enumerate(("First flyer", "Second flyer"))
    )
    drawings = "".join(
        f'<template data-kind="{kind}">{of_kind(kind)}</template>'
        for kind in dict.fromkeys(one.kind for one in published())
    )
    return (
        f'<section class="lf-pair" id="lf-pair" data-flyers="{escape(json.dumps(about))}" '
        f'aria-label="Two flyers beside each other">{drawings}'
        f'<div class="lf-pair-choice">{selects}</div><div class="table-wrapper">'
        '<table class="docutils"><tbody id="lf-pair-rows"></tbody></table></div><noscript>'
        "<p>The comparison needs JavaScript; the table has the same.</p></noscript></section>"
    )


def _directive(draw: Any) -> type[Directive]:
    class Shown(Directive):
        def run(self) -> list[nodes.Node]:
            return [nodes.raw("", draw(), format="html")]

    return Shown


def _write(app: Sphinx) -> None:
    folder = Path(app.srcdir) / _PAGES
    folder.mkdir(exist_ok=True)
    wanted = set()
    for flyer in published():
        try:
            texts = {f"{flyer.name}.md": page(flyer), f"{flyer.name}.toml": flyer.flyer_file()}
        except LookupError as error:
            LOGGER.warning("%s", error)
            continue
        wanted |= set(texts)
        for name, text in texts.items():
            path = folder / name
            if not path.is_file() or path.read_text(encoding="utf-8") != text:
                path.write_text(text, encoding="utf-8")
    for path in folder.iterdir():
        if path.name not in wanted:
            path.unlink()
    made = Path(app.doctreedir) / "published"
    made.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(_HERE / _SCRIPT, made / _SCRIPT)
    app.config.html_static_path.append(str(made))


def _load(app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    if 'id="lf-pair"' in context.get("body", ""):
        app.add_js_file(_SCRIPT, loading_method="defer")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register pages and directives."""
    app.add_directive("published-flyers", _directive(_flyer_table))
    app.add_directive("published-pair", _directive(_pair))
    app.connect("builder-inited", _write)
    app.connect("html-page-context", _load)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


__all__ = ["DOCS", "TABLE", "VERDICTS", "calculator_state", "page", "published", "setup"]
