"""One self-contained HTML page: no scripts, no files beside it, nothing fetched.

Every text is escaped here, so that nothing that a file contains becomes markup.
"""

import base64
import html
from collections.abc import Iterable, Sequence
from pathlib import Path

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def page(title: str, parts: Iterable[str]) -> str:
    """A page of parts; ``title``: plain text."""
    body = "\n".join(parts)
    style = (Path(__file__).parents[1] / "data" / "page.css").read_text(encoding="utf-8")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>\n{style}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def heading(text: str, level: int = 2) -> str:
    """A heading, of level 1 to 6."""
    return f"<h{level}>{html.escape(text)}</h{level}>"


def paragraph(text: str, kind: str | None = None) -> str:
    """A paragraph; of kind ``"warning"`` it is set off."""
    style = f' class="{html.escape(kind)}"' if kind else ""
    return f"<p{style}>{html.escape(text)}</p>"


def verdict(parts: Iterable[str]) -> str:
    """What follows from all, at the head of a page."""
    inside = "\n".join(parts)
    return f'<div class="verdict">\n{inside}\n</div>' if inside else ""


def code(text: str) -> str:
    """Lines as they are, in one width."""
    return f"<pre>{html.escape(text)}</pre>"


def table(
    rows: Sequence[Sequence[str]],
    header: Sequence[str] | None = None,
    *,
    right: Sequence[bool] = (),
    caption: str = "",
    note: str = "",
) -> str:
    """A table; ``header``: without one, the first cell of each row is its heading."""
    sides = [*right, *[False] * max(map(len, rows), default=0)]
    lines = [f"<caption>{html.escape(caption)}</caption>"] if caption else []
    if header is not None:
        cells = [_cell("th", text, side, "col") for text, side in zip(header, sides, strict=False)]
        lines.append(f"<thead><tr>{''.join(cells)}</tr></thead>")
    lines.append("<tbody>")
    for row in rows:
        cells = [_cell("td", text, side) for text, side in zip(row, sides, strict=False)]
        if header is None and row:
            cells[0] = _cell("th", row[0], sides[0], "row")
        lines.append(f"<tr>{''.join(cells)}</tr>")
    lines.append("</tbody>")
    whole = _scrolled("\n".join(["<table>", *lines, "</table>"]))
    return whole + (f"\n{paragraph(note)}" if note else "")


def _cell(tag: str, text: str, right: bool, scope: str | None = None) -> str:
    of = f' scope="{scope}"' if scope else ""
    side = ' class="right"' if right else ""
    return f"<{tag}{of}{side}>{html.escape(text)}</{tag}>"


def image(
    content: bytes, kind: str, alternative: str, caption: str = "", width: int | None = None
) -> str:
    """A figure; ``alternative``: what it shows, for those who do not see it.

    ``width``: of the figure [px], which a narrower screen scrolls; by default it shrinks there.
    """
    data = base64.b64encode(content).decode("ascii")
    below = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    size = "" if width is None else f' width="{width}"'
    shown = f'<img alt="{html.escape(alternative)}"{size} src="data:image/{kind};base64,{data}">'
    shown = shown if width is None else _scrolled(shown)
    return f"<figure>{shown}{below}</figure>"


def _scrolled(wide: str) -> str:
    """What scrolls by itself on a narrow screen, by keyboard too."""
    return f'<div class="scroll" tabindex="0">\n{wide}\n</div>'
