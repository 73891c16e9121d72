"""The explorer's colours and drawings are those of the package."""

from pathlib import Path
from xml.etree import ElementTree

from lightflyer import explorer
from lightflyer.files import palette
from lightflyer.flyer.base import FlyerSection

STATIC = Path(explorer.__file__).parent / "static"


def luminance(colour):
    """Relative luminance, as WCAG 2.2 defines it."""
    parts = [int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)]
    parts = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return sum(w * p for w, p in zip((0.2126, 0.7152, 0.0722), parts, strict=True))


def contrast(one, other):
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_the_style_sheet_is_the_palette():
    text = (STATIC / "palette.css").read_text(encoding="utf-8")
    assert text == palette.style_sheet(':root[data-theme="dark"]')


def test_lines_can_be_seen_on_light_and_on_dark_pages():
    for light, dark in palette.ON_PAGES.values():
        light = "#000000" if light == "black" else light
        assert contrast(light, "#ffffff") >= 3.0, light
        assert contrast(dark, "#161d26") >= 3.0, dark
    assert contrast(palette.ON_PAGES["wrong"][0], "#ffffff") >= 4.5
    assert contrast(palette.ON_PAGES["wrong"][1], "#161d26") >= 4.5


def test_every_kind_of_flyer_has_a_drawing():
    shipped = (
        name.split()[0]
        for name, section in FlyerSection.alternatives.items()
        if section.__module__.startswith("lightflyer.")
    )
    for kind in {*shipped}:
        drawing = ElementTree.fromstring((STATIC / f"kind-{kind}.svg").read_text("utf-8"))
        assert drawing.get("aria-label")
        assert not [one for one in drawing.iter() if one.tag.endswith("script")]
