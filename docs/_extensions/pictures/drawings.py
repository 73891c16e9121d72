"""Flyers drawn: how each kind works, seen from its edge, and their sizes beside each other."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from html import escape

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


def _arrow(x1: float, y1: float, x2: float, y2: float, style: str) -> str:
    """A line with a head at its end; its style names the head's colour too."""
    long = ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
    u, v = (x2 - x1) / long, (y2 - y1) / long
    back, side = (7.0, 3.5) if "lf-lift" not in style else (11.0, 7.0)
    base = x2 - back * u, y2 - back * v
    left = base[0] - side * v, base[1] + side * u
    right = base[0] + side * v, base[1] - side * u
    head = " ".join(f"{x:.1f},{y:.1f}" for x, y in ((x2, y2), left, right))
    return _line(x1, y1, *base, style) + f'<polygon class="{style}" points="{head}"/>'


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


def _sun(*places: float) -> str:
    return "".join(_arrow(x - 14, 6, x, 34, "lf-sun") for x in places)


def _disk() -> str:
    film = _rect(20, 78, 150, 5, "lf-film")
    above = _arrow(48, 46, 56, 74, "lf-cold") + _arrow(60, 74, 67, 52, "lf-hot")
    below = _arrow(50, 112, 58, 87, "lf-cold") + _arrow(62, 87, 78, 142, "lf-hot")
    words = _text(84, 66, "leave slower", "start") + _text(86, 108, "leave faster", "start")
    return _sun(38, 130) + film + above + below + words + _arrow(222, 120, 222, 44, "lf-lift")


def _pieces(y: float, style: str) -> str:
    return "".join(_rect(30 + 32 * at, y, 20, 4, style) for at in range(5))


def _sandwich() -> str:
    posts = "".join(_line(x, 62, x, 92, "lf-post") for x in (40, 104, 168))
    through = "".join(_arrow(x, 44, x, 132, "lf-hot") for x in (56, 120))
    cold = "".join(_arrow(x, 34, x, 58, "lf-cold") for x in (56, 120))
    words = _text(192, 54, "clear, cold", "start") + _text(192, 116, "dark, warm", "start")
    lift = _arrow(222, 98, 222, 62, "lf-lift")
    films = _pieces(58, "lf-clear") + _pieces(92, "lf-film")
    return _sun(40, 150) + posts + films + through + cold + words + lift


def _plate() -> str:
    walls = "".join(
        _line(x, 62, x, 96, "lf-post") for at in range(5) for x in (30 + 32 * at, 50 + 32 * at)
    )
    through = "".join(_arrow(x, 40, x, 132, "lf-hot") for x in (56, 120))
    words = _text(192, 54, "clear, cold", "start") + _text(192, 118, "dark, warm", "start")
    lift = _arrow(222, 100, 222, 62, "lf-lift")
    films = _pieces(58, "lf-clear") + _pieces(96, "lf-film")
    return _sun(40, 150) + walls + films + through + words + lift


def _hollow() -> str:
    wall = (
        '<path class="lf-porous" d="M86.3 118.1A46 46 0 1 1 123.7 118.1"/>'
        '<path class="lf-porous lf-inside" d="M88.8 112.6A40 40 0 1 1 121.2 112.6"/>'
    )
    inward = "".join(
        _arrow(*ends, "lf-cold")
        for ends in ((40, 50, 66, 64), (170, 50, 144, 64), (34, 92, 62, 86), (176, 92, 148, 86))
    )
    jet = _arrow(105, 96, 105, 146, "lf-hot")
    words = _text(120, 146, "jet", "start") + _text(105, 80, "warm", "middle")
    return _sun(78, 132) + wall + inward + jet + words + _arrow(212, 120, 212, 50, "lf-lift")


def _balloon() -> str:
    envelope = '<path class="lf-envelope" d="M94 124.7A46 46 0 1 1 116 124.7"/>'
    words = (
        _text(105, 76, "warm air,")
        + _text(105, 92, "lighter than")
        + _text(105, 108, "the air around")
    )
    return _sun(60, 150) + envelope + words + _arrow(212, 120, 212, 50, "lf-lift")


_SCHEMATICS: dict[str, tuple[Callable[[], str], str]] = {
    "disk": (_disk, "A film seen from its edge. Molecules leave its lower face faster."),
    "sandwich": (_sandwich, "Two perforated films. Gas streams down through their holes."),
    "plate": (_plate, "Two films joined by channels. Gas streams down through them."),
    "hollow": (_hollow, "A hollow sphere. Gas enters through its wall, leaves as a jet below."),
    "balloon": (_balloon, "A balloon, open below, with warm air inside."),
}
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
    """How a kind works, as a picture."""
    draw, label = _SCHEMATICS[kind]
    return _svg(draw(), _WIDTH, _HEIGHT, label)


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
