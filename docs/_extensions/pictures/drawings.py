"""Flyers drawn: how each kind works, seen from its edge, and their sizes beside each other."""

from __future__ import annotations

import tomllib
from html import escape
from importlib import resources

from lightflyer.cli.commands.init import templates
from lightflyer.core.units import scale_and_offset

_WIDTH, _HEIGHT = 270.0, 150.0  # of a schematic [px]
_HAND = 26.0  # px per centimetre, of what fits a hand
_HOUSE = 26.0  # px per metre, of what does not
_PERSON = 1.75  # [m]
_COIN = 0.02  # [m]
_LARGE = 0.3  # from which on a person stands beside a flyer [m]
_ROCKET = 10.0  # that was proposed to carry a kilogram [m]


def _line(x1: float, y1: float, x2: float, y2: float, style: str) -> str:
    return f'<line class="{style}" x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}"/>'


def _rect(x: float, y: float, width: float, height: float, style: str) -> str:
    return (
        f'<rect class="{style}" x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"/>'
    )


def _circle(x: float, y: float, radius: float, style: str) -> str:
    return f'<circle class="{style}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'


def _text(x: float, y: float, text: str, anchor: str = "middle", style: str = "") -> str:
    named = f' class="{style}"' if style else ""
    return f'<text{named} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _svg(content: str, width: float, height: float, label: str) -> str:
    return (
        f'<svg class="lf-drawing" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'aria-label="{escape(label)}">{content}</svg>'
    )


_CARDS = (
    ("disk", "Disk", "flyers.html", "2 cm; 50 to 90 km",
     "One film. Its lower face warms molecules better than its upper one."),
    ("sandwich", "Sandwich", "sandwich.html", "2 cm; 35 to 90 km",
     "Two films with holes. Gas streams towards the warm one."),
    ("plate", "Plate", "plate.html", "8 mm; 35 to 90 km",
     "Two films joined by channels, which pump gas down."),
    ("hollow", "Hollow body", "hollow.html", "10 cm; around 70 km",
     "A porous wall pumps gas in. It leaves as a jet. Nobody has built one."),
    ("balloon", "Balloon", "balloon.html", "5.8 m; below 35 km",
     "Warm air inside. Buoyancy lifts it, no photophoresis needed."),
)  # fmt: skip
"""Kind, title, page, size of its template and where its best design of 10 cm, or of 10 m where it
is a balloon, flies (docs/what-can-fly-where.md), and what it is."""


def of_kind(kind: str) -> str:
    """How a kind works, as the explorer shows it too."""
    file = resources.files("lightflyer.explorer") / "static" / f"kind-{kind}.svg"
    return file.read_text(encoding="utf-8")


def size(kind: str) -> float:
    """Of the template of a kind [m]."""
    flyer = tomllib.loads(templates()["earth" if kind == "disk" else kind].read())["flyer"]
    number, unit = (flyer.get("diameter") or flyer["size"]).split()
    return float(number) * scale_and_offset(unit, "m")[0]


def _hand() -> str:
    """What fits a hand, each with its size."""
    floor, left, found = 268.0, 20.0, []
    for kind, name in (("plate", "plate"), ("disk", "disk"), ("sandwich", "sandwich")):
        wide = size(kind) * 100.0 * _HAND
        style = "lf-film"
        found.append(_rect(left, floor - 4, wide, 3, style))
        if kind != "disk":
            found.append(_rect(left, floor - 9, wide, 3, "lf-clear"))
        found.append(_text(left + wide / 2, floor - 26, name))
        found.append(
            _text(left + wide / 2, floor - 13, f"{size(kind) * 1e3:g} mm", style="lf-quiet")
        )
        left += max(wide, 34) + 26
    radius = size("hollow") * 50.0 * _HAND
    found.append(_circle(left + radius, floor - radius, radius, "lf-porous"))
    found.append(_text(left + radius, floor - radius, "hollow sphere"))
    found.append(
        _text(left + radius, floor - radius + 15, f"{size('hollow') * 100:g} cm", style="lf-quiet")
    )
    wide = left + 2 * radius + 20
    bar = _line(20, 288, 20 + _HAND, 288, "lf-bar") + _text(28 + _HAND, 292, "1 cm", "start")
    label = "Sizes in the hand: plate 8 mm, disk and sandwich 20 mm, hollow sphere 10 cm."
    return _svg("".join(found) + bar, wide, 300, label)


def _house() -> str:
    """What does not fit a hand, beside a person."""
    floor, tall = 268.0, _PERSON * _HOUSE
    person = (
        _circle(40, floor - tall + 5, 5, "lf-person")
        + f'<path class="lf-person" d="M33 {floor - tall + 13:g}h14l-2 18h-2v{tall - 31:g}'
        f'h-6v-{tall - 31:g}h-2z"/>'
    )
    radius = size("balloon") / 2.0 * _HOUSE
    balloon = _circle(80 + radius, floor - radius, radius, "lf-envelope")
    words = _text(80 + radius, floor - radius, "balloon") + _text(
        80 + radius, floor - radius + 15, f"{size('balloon'):g} m", style="lf-quiet")  # fmt: skip
    wide, long, left = 0.4 * _ROCKET * _HOUSE, _ROCKET * _HOUSE, 120 + 2 * radius
    rocket = (
        f'<path class="lf-porous" d="M{left:g} {floor:g}V{floor - long + wide / 2:g}'
        f'a{wide / 2:g} {wide / 2:g} 0 0 1 {wide:g} 0V{floor:g}"/>'
    )
    named = "".join(
        _text(left + wide / 2, floor - long / 2 + 15 * at, text, style="lf-quiet" if at else "")
        for at, text in enumerate(("rocket", "10 m,", "proposed"))
    )
    bar = _line(20, 288, 20 + _HOUSE, 288, "lf-bar") + _text(28 + _HOUSE, 292, "1 m", "start")
    label = "Sizes beside a person: balloon 5.8 m, proposed rocket 10 m."
    return _svg(person + balloon + words + rocket + named + bar, left + wide + 20, 300, label)


def to_scale(kind: str, text: str) -> str:
    """A flyer of a size such as ``"2 cm"`` beside a coin, or a person where it is larger."""
    number, unit = text.split()
    metres = float(number) * scale_and_offset(unit, "m")[0]
    beside, name = (_PERSON, "a person") if metres > _LARGE else (_COIN, "a coin of 2 cm")
    pixels = min(110.0 / beside, 110.0 / metres)
    floor, tall, wide = 122.0, beside * pixels, metres * pixels
    if beside == _PERSON:
        other = _rect(45 - 0.14 * tall, floor - 0.85 * tall, 0.28 * tall, 0.85 * tall, "lf-person")
        other += _circle(45, floor - 0.93 * tall, 0.08 * tall, "lf-person")
    else:
        other = _circle(65, floor - tall / 2, tall / 2, "lf-coin")
    if kind in ("hollow", "balloon"):
        style = "lf-porous" if kind == "hollow" else "lf-envelope"
        flyer = _circle(195, floor - wide / 2, wide / 2, style)
    else:
        flyer = _rect(195 - wide / 2, floor - 3, wide, 3, "lf-film")
    words = _text(65, 144, name, style="lf-quiet") + _text(195, 144, text, style="lf-quiet")
    return _svg(other + flyer + words, _WIDTH, _HEIGHT, f"{text} beside {name}, to scale")


def cards() -> str:
    """A card for each kind: how it works."""
    found = "".join(
        f'<li>{of_kind(kind)}<a href="{page}">{title}</a><span class="lf-quiet">{escape(where)}'
        f"</span><p>{escape(words)}</p></li>"
        for kind, title, page, where, words in _CARDS
    )
    return f'<ul class="lf-cards lf-wide">{found}</ul>'


def scales() -> str:
    """Templates of all kinds, to scale."""
    small = "In the hand. All to one scale; films are thinner than any line."
    large = "Beside a person, a hundred times smaller."
    figures = "".join(
        f"<figure>{drawing}<figcaption>{words}</figcaption></figure>"
        for drawing, words in ((_hand(), small), (_house(), large))
    )
    return f'<div class="lf-scales lf-wide">{figures}</div>'
