"""Colours of all figures and pages: one for each meaning, on paper, on light and on dark pages.

They are those of Okabe and Ito [OkabeIto2008]_, which people with any colour vision can tell apart.
"""

BLUE, ORANGE, GREEN, VERMILION, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#777777"
SKY, PURPLE, YELLOW = "#56B4E9", "#CC79A7", "#F0E442"
WINE = "#882255"  # in place of yellow, which is too light for lines on white
PALETTE = (BLUE, VERMILION, GREEN, ORANGE, "black", SKY, PURPLE, GREY, WINE)
"""Colours of series that have no meaning of their own, in order."""

COMPUTED, AVAILABLE, LIMIT, FLIES = BLUE, ORANGE, VERMILION, GREEN
MEASURED, PUBLISHED, OUTSIDE = "black", WINE, GREY
MORE, LESS = BLUE, VERMILION  # sign: what grows, what falls
HOT, COLD = VERMILION, BLUE
QUANTITY_MAP, SIGN_MAP = "cividis", "RdBu"  # of maps: a quantity; its sign, MORE being blue

ON_PAGES = {
    "computed": (COMPUTED, SKY),
    "available": ("#B87D00", ORANGE),  # orange is too light for a line on white
    "limit": (LIMIT, "#FF8B4A"),
    "flies": (FLIES, "#2DC79A"),
    "measured": ("#16202C", "#E6ECF2"),
    "published": (PUBLISHED, PURPLE),
    "outside": (GREY, "#9AA3AD"),
    "more": (MORE, SKY),
    "less": (LESS, "#FF8B4A"),
    "hot": (HOT, "#FF8B4A"),
    "cold": (COLD, SKY),
    "wrong": ("#A8270F", "#FF9C86"),  # words about a mistake
}
"""Colours of meanings on light and on dark pages; style sheets call them ``--lf-<meaning>``."""

SERIES_ON_DARK = {
    BLUE: SKY,
    VERMILION: "#FF8B4A",
    GREEN: "#2DC79A",
    GREY: "#9AA3AD",
    SKY: "#A6D8F5",
}
"""Colours of series on a dark page, of those that would be too dark there."""


def style_sheet(dark: str, unless_light: str = "") -> str:
    """Custom properties of all meanings.

    Parameters
    ----------
    dark : str
        Selector of a page whose reader chose dark.
    unless_light : str
        Selector of one that follows the system; none does where empty.
    """
    light_of, dark_of = (
        "".join(f"--lf-{meaning}:{shades[at].lower()};" for meaning, shades in ON_PAGES.items())
        for at in (0, 1)
    )
    text = f":root{{{light_of}}}\n{dark}{{{dark_of}}}\n"
    if unless_light:
        text += f"@media (prefers-color-scheme:dark){{{unless_light}{{{dark_of}}}}}\n"
    return text
