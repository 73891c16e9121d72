"""The calculator on a page: labels, sliders and empty figures, which a script fills."""

from __future__ import annotations

from html import escape

from .kinds import DISK, KINDS, Kind, Number
from .model import TITLES, design, force_models

_STEPS = 1000  # of a logarithmic slider
_CLOSED = ("Light and heat around",)
_ASSUMED = (
    "at rest, level and in the steady state",
    "films whose absorptance, emittances and TACs do not depend on temperature or direction",
)
_OVER_GROUND = (
    "light from the sun above; from below what the ground reflects of it, and heat radiation, "
    "both less with altitude as the ground fills less of the view"
)


def html(name: str = DISK.name) -> str:
    """The calculator of a kind in HTML; all texts are the package's own."""
    kind = next(one for one in KINDS if one.name == name)
    groups = "".join(
        f"<details{'' if title in _open(kind) else ' open'}><summary>{escape(title)}</summary>"
        f"{''.join(map(_number, numbers))}</details>"
        for title, numbers in kind.groups.items()
    )
    assumptions = design(force_models(kind)[0], kind).setup.environment.assumptions_of_air()
    over_ground = [_OVER_GROUND] if kind.coordinate.name == "altitude" else []
    texts = (kind.assumed, *_ASSUMED, *over_ground, *assumptions)
    assumed = "".join(f"<li>{escape(text)}</li>" for text in texts)
    models = "".join(
        f'<option value="{model}">{escape(TITLES.get(model, model))}</option>'
        for model in force_models(kind)
    )
    presets = "".join(
        f'<option value="{escape(link)}">{escape(title)}</option>' for title, link in _presets(kind)
    )
    kinds = "".join(
        f'<a href="{page_of(one)}"{_here(one, kind)}>{escape(one.title)}</a>' for one in KINDS
    )
    return _PAGE.format(
        kind=kind.name,
        kinds=kinds,
        groups=groups,
        models=models,
        assumed=assumed,
        presets=presets,
        another=_another(kind),
    )


def page_of(kind: Kind) -> str:
    """Name of the page that has a kind's calculator."""
    return "calculator.html" if kind == DISK else f"calculator-{kind.name}.html"


def _here(one: Kind, kind: Kind) -> str:
    return ' aria-current="page"' if one == kind else ""


def _open(kind: Kind) -> tuple[str, ...]:
    """Headings that are closed at first."""
    return tuple(kind.groups)[1:] if len(kind.groups) > 3 else _CLOSED


def _presets(kind: Kind) -> list[tuple[str, str]]:
    """Designs to begin with, each with the address that shows it."""
    from published import calculator_state, published

    found = (
        (f"{one.source}: {one.title}", calculator_state(one))
        for one in published()
        if one.in_calculator
    )
    links = [(title, link) for title, (name, link) in found if name == kind.name]
    return [(f"that of lightflyer init --kind {kind.template}", "#design:"), *links]


def _another(kind: Kind) -> str:
    if not kind.another:
        return ""
    title, numbers = kind.another
    return f'<p class="lf-another"><a href="#design:{escape(numbers)}">{escape(title)}</a></p>'


def _number(number: Number) -> str:
    key = "lf-" + number.name.replace(".", "-")
    unit = number.unit.replace("^2", "²").replace("deg", "°").replace("um", "µm")
    label, shown = escape(number.label), f" <span>[{escape(unit)}]</span>" if unit else ""
    low, high, step = number.low, number.high, 10.0**-number.digits
    if number.logarithmic:
        low, high, step = 0, _STEPS, 1
    return (
        f'<div class="lf-number"><label for="{key}">{label}{shown}</label>'
        f'<span class="lf-tools"><button type="button" id="{key}-reset" hidden '
        f'aria-label="Reset {label}" title="Reset">↺</button>'
        f'<button type="button" id="{key}-play" aria-label="Play {label}" title="Play" '
        f'aria-pressed="false">▶</button></span>'
        f'<input type="range" id="{key}" '
        f'min="{low:g}" max="{high:g}" step="{step:g}">'
        f'<input type="text" inputmode="decimal" id="{key}-box" '
        f'autocomplete="off" aria-label="{label}{", " + escape(unit) if unit else ""}" '
        f'aria-describedby="{key}-error">'
        f'<p class="lf-error" id="{key}-error" role="alert"></p></div>'
    )


_PAGE = """\
<div class="lf-calculator lf-wide" id="lf-calculator" data-kind="{kind}">
<nav class="lf-kinds-nav" aria-label="Kinds of flyers">{kinds}</nav>
<noscript><p>The calculator needs JavaScript; <code>lightflyer predict</code> does not.</p>
</noscript>
<p class="lf-verdict" id="lf-verdict"></p>
<form class="lf-controls" autocomplete="off" aria-label="Design">
<div class="lf-model"><label for="lf-preset">start from</label>
<select id="lf-preset"><option value="">a published flyer …</option>{presets}</select></div>
<div class="lf-model"><label for="lf-model">force model</label>
<select id="lf-model">{models}</select></div>
{another}{groups}
<div class="lf-buttons"><button type="button" id="lf-undo" disabled>Undo</button>
<button type="button" id="lf-reset">Reset</button>
<button type="button" id="lf-link">Copy link</button>
<button type="button" id="lf-embed">Copy embed code</button>
<button type="button" id="lf-download">Download flyer.toml</button></div>
<p id="lf-told" role="status"></p>
<p class="lf-error" id="lf-link-error" role="alert"></p>
</form>
<section class="lf-results" aria-label="Results">
<p class="lf-hidden" id="lf-spoken" role="status" aria-live="polite"></p>
<div><figure><svg id="lf-curve" role="img"></svg>
<div class="lf-legend" id="lf-curve-legend" aria-hidden="true"></div>
<figcaption id="lf-curve-text"></figcaption></figure>
<ul id="lf-warnings" aria-label="Warnings"></ul>
<dl id="lf-values"></dl>
<p><input type="checkbox" id="lf-bands" checked> <label for="lf-bands">95 % bands:</label>
<span id="lf-bands-from"></span></p></div>
<div><figure><div class="lf-map"><canvas id="lf-map" aria-hidden="true"></canvas>
<svg id="lf-map-axes" role="img"></svg></div>
<figcaption id="lf-map-text"></figcaption></figure>
<table><caption>Change of the irradiance to levitate if a number grows by 1 %</caption>
<tbody id="lf-slopes"></tbody></table>
<p id="lf-slopes-empty">Nothing to show: no light lifts it here, or it needs none.</p>
<details><summary>What is assumed</summary><ul>{assumed}</ul></details></div>
</section>
</div>
"""
