"""The calculator on a page: labels, sliders and empty figures, which a script fills."""

from __future__ import annotations

from html import escape

from .model import GROUPS, TITLES, Number, design, force_models

_OWN = "disk of lightflyer init"

_STEPS = 1000  # of a logarithmic slider
_CLOSED = ("Light and heat around",)
_ASSUMED = (
    "a level, flat, thin disk of one temperature, at rest, in the steady state",
    "a film whose absorptance, emittances and TACs do not depend on temperature or direction",
    "light from the sun or a lamp above; from below what the ground reflects of it, and heat "
    "radiation, both less with altitude as the ground fills less of the view",
    "dry air, and free fall that is weaker at altitude",
)


def html() -> str:
    """The calculator in HTML; all texts are the package's own."""
    groups = "".join(
        f"<details{'' if title in _CLOSED else ' open'}><summary>{escape(title)}</summary>"
        f"{''.join(map(_number, numbers))}</details>"
        for title, numbers in GROUPS.items()
    )
    air = design(force_models()[0]).setup.environment.assumptions_of_air()
    assumed = "".join(f"<li>{escape(text)}</li>" for text in (*_ASSUMED, *air))
    models = "".join(
        f'<option value="{name}">{escape(TITLES.get(name, name))}</option>'
        for name in force_models()
    )
    presets = "".join(
        f'<option value="{escape(link)}">{escape(title)}</option>' for title, link in _presets()
    )
    return _PAGE.format(groups=groups, models=models, assumed=assumed, presets=presets)


def _presets() -> list[tuple[str, str]]:
    """Designs to begin with, each with the address that shows it."""
    from published import calculator_hash, published

    links = [(f"{one.source}: {one.title}", calculator_hash(one)) for one in published()]
    return [(_OWN, "#design:"), *((title, link) for title, link in links if link)]


def _number(number: Number) -> str:
    key = "lf-" + number.name.replace(".", "-")
    unit = number.unit.replace("^2", "²").replace("deg", "°")
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
<div class="lf-calculator lf-wide" id="lf-calculator">
<noscript><p>The calculator needs JavaScript; <code>lightflyer predict</code> does not.</p>
</noscript>
<p class="lf-verdict" id="lf-verdict"></p>
<form class="lf-controls" autocomplete="off" aria-label="Design">
<div class="lf-model"><label for="lf-preset">start from</label>
<select id="lf-preset"><option value="">…</option>{presets}</select></div>
<div class="lf-model"><label for="lf-model">force model</label>
<select id="lf-model">{models}</select></div>
{groups}
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
<dl id="lf-values"></dl></div>
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
