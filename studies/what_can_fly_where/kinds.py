"""The kinds of flyers, and within which bounds each may be built."""

from dataclasses import dataclass, field
from typing import Any

CENTIMETRES = (0.1,)
TO_TEN_METRES = (0.1, 1.0, 10.0)
SMALLEST = "2 mm"
HOTTEST = "500 K"  # that films, glue and absorbers are taken to bear

# Film that absorbs: 100 nm of alumina with 10 nm of chromium. Transparent: without the chromium.
ABSORBING, TRANSPARENT = "0.37 ± 0.02 g/m^2", "0.30 ± 0.015 g/m^2"
DARKEST, LEAST_EMITTANCE, MOST_EMITTANCE = 0.9, 0.05, 0.9
TAC_SMALL, TAC_LARGE = "0.80 ± 0.01", "0.90 ± 0.01"


@dataclass(frozen=True)
class Kind:
    """A kind of flyer.

    Attributes
    ----------
    name : str
        As in figures and tables.
    file : dict
        Sections of its flyer file; ± are standard uncertainties.
    size : str
        The number that the largest size bounds.
    sizes : tuple of float
        Largest sizes that are looked at [m].
    free : dict of str to (str or float, str or float)
        Bounds of the other free numbers. Those of lengths and areal densities are searched in
        the logarithm.
    relative : dict of str to float
        Relative standard uncertainty of free numbers.
    absolute : dict of str to float
        The same, absolute.
    shares : dict of str to (float, float)
        Bounds of lengths over the largest size, where they depend on it.
    hottest : float
        Temperature that it withstands [K].
    """

    name: str
    file: dict[str, dict[str, Any]]
    size: str
    sizes: tuple[float, ...]
    free: dict[str, tuple[Any, Any]]
    relative: dict[str, float] = field(default_factory=dict)
    absolute: dict[str, float] = field(default_factory=dict)
    shares: dict[str, tuple[float, float]] = field(default_factory=dict)
    hottest: float = 500.0


_DISK: dict[str, dict[str, Any]] = {
    "flyer": {"shape": "disk", "diameter": "2 cm"},
    "film": {
        "areal_density": ABSORBING,
        "absorptance": 0.8,
        "emittance": 0.08,
        "tac_top": TAC_SMALL,
        "tac_bottom": TAC_LARGE,
        "highest_temperature": HOTTEST,
    },
}
_DISK_FREE = {
    "film.absorptance": (0.3, DARKEST),
    "film.emittance": (LEAST_EMITTANCE, MOST_EMITTANCE),
}
_DISK_SPREADS = {"film.absorptance": 0.03, "film.emittance": 0.01}

_TRANSPARENT_FACE: dict[str, Any] = {
    "areal_density": TRANSPARENT,
    "absorptance": "0.02 ± 0.01",
    "transmittance": 0.9,
    "emittance_top": 0.1,
    "emittance_bottom": 0.1,
    "tac_top": TAC_SMALL,
    "tac_bottom": TAC_SMALL,
    "highest_temperature": HOTTEST,
}
_DARK_FACE: dict[str, Any] = {
    "areal_density": ABSORBING,
    "absorptance": 0.6,
    "emittance_top": 0.1,
    "emittance_bottom": 0.1,
    "tac_top": TAC_SMALL,
    "tac_bottom": TAC_SMALL,
    "highest_temperature": HOTTEST,
}

_SANDWICH: dict[str, dict[str, Any]] = {
    "flyer": {
        "shape": "sandwich",
        "diameter": "2 cm",
        "gap": "125 um",
        "open_fraction": 0.5,
        "hole_radius": "25 um",
        "support_fraction": "1e-4 ± 0.5e-4",
        "support_conductivity": "1.8 ± 0.3 W/(m*K)",
        "support_density": "3.0 g/cm^3",
        "top": _TRANSPARENT_FACE,
        "bottom": _DARK_FACE,
    },
}
_SANDWICH_FREE = {
    "flyer.gap": ("10 um", "1 mm"),
    "flyer.open_fraction": (0.1, 0.8),
    "flyer.bottom.absorptance": (0.3, DARKEST),
    "flyer.bottom.emittance_bottom": (LEAST_EMITTANCE, MOST_EMITTANCE),
}


def _sandwich(name: str, force: dict[str, Any]) -> Kind:
    return Kind(
        name,
        _SANDWICH | {"force": force},
        "flyer.diameter",
        CENTIMETRES,
        _SANDWICH_FREE,
        relative={"flyer.gap": 0.1},
        absolute={
            "flyer.open_fraction": 0.02,
            "flyer.bottom.absorptance": 0.03,
            "flyer.bottom.emittance_bottom": 0.01,
        },
    )


_PLATE: dict[str, dict[str, Any]] = {
    "flyer": {
        "shape": "plate",
        "diameter": "2 cm",
        "channel_width": "50 um",
        "channel_length": "500 um",
        "spacing": "50 um",
        "height": "100 um",
        "wall_thickness": "50 nm",
        "wall_conductivity": "1.8 ± 0.3 W/(m*K)",
        "wall_density": "3.0 g/cm^3",
        "top": _TRANSPARENT_FACE,
        "bottom": _DARK_FACE,
    },
    "force": {"model": "channel-pump"},
}

_HOLLOW: dict[str, Any] = {
    "shape": "hollow",
    "size": "10 cm",
    "outlet_diameter": "2 cm",
    "open_fraction": 0.5,
    "channel_width": "100 um",
    "wall_thickness": "100 um",
    "sheet_thickness": "50 nm",
    "sheet_conductivity": "1.8 ± 0.3 W/(m*K)",
    "sheet_density": "3.0 g/cm^3",
    "outer": _TRANSPARENT_FACE,
    "inner": _DARK_FACE,
}
_HOLLOW_FREE = {
    "flyer.open_fraction": (0.1, 0.8),
    "flyer.channel_width": ("5 um", "300 um"),
    "flyer.wall_thickness": ("10 um", "1 mm"),
    "flyer.inner.absorptance": (0.3, DARKEST),
    "flyer.inner.emittance_bottom": (LEAST_EMITTANCE, MOST_EMITTANCE),
    "flyer.outer.emittance_top": (LEAST_EMITTANCE, MOST_EMITTANCE),
}
_HOLLOW_SPREADS = {
    "flyer.open_fraction": 0.02,
    "flyer.inner.absorptance": 0.03,
    "flyer.inner.emittance_bottom": 0.01,
    "flyer.outer.emittance_top": 0.01,
}


def _hollow(name: str, form: str, model: str) -> Kind:
    return Kind(
        name,
        {"flyer": _HOLLOW | {"form": form}, "force": {"model": model}},
        "flyer.size",
        TO_TEN_METRES,
        _HOLLOW_FREE,
        relative={"flyer.channel_width": 0.05, "flyer.wall_thickness": 0.05},
        absolute=_HOLLOW_SPREADS,
        shares={"flyer.size": (1.0, 1.0), "flyer.outlet_diameter": (0.05, 0.9)},
    )


KINDS = (
    Kind(
        "disk, kinetic theory",
        _DISK | {"force": {"model": "kinetic"}},
        "flyer.diameter",
        CENTIMETRES,
        _DISK_FREE,
        absolute=_DISK_SPREADS,
    ),
    Kind(
        "disk, fit of Lu et al.",
        _DISK | {"force": {"model": "lu2023"}},
        "flyer.diameter",
        CENTIMETRES,
        _DISK_FREE,
        absolute=_DISK_SPREADS,
    ),
    _sandwich("sandwich, table of Schafer et al.", {"model": "schafer2025"}),
    _sandwich("sandwich, own solver", {"model": "kinetic", "transmission": "wide"}),
    Kind(
        "nanocardboard plate",
        _PLATE,
        "flyer.diameter",
        CENTIMETRES,
        {
            "flyer.channel_width": ("5 um", "400 um"),
            "flyer.spacing": ("5 um", "200 um"),
            "flyer.height": ("10 um", "1 mm"),
            "flyer.bottom.absorptance": (0.3, DARKEST),
            "flyer.bottom.emittance_bottom": (LEAST_EMITTANCE, MOST_EMITTANCE),
        },
        relative={"flyer.channel_width": 0.05, "flyer.spacing": 0.05, "flyer.height": 0.05},
        absolute={"flyer.bottom.absorptance": 0.03, "flyer.bottom.emittance_bottom": 0.01},
    ),
    _hollow("hollow sphere, as published", "sphere", "celenza2023"),
    _hollow("hollow sphere, corrected", "sphere", "hollow-pump"),
    _hollow("hollow rocket, as published", "rocket", "celenza2023"),
    _hollow("hollow rocket, corrected", "rocket", "hollow-pump"),
    Kind(
        "solar balloon",
        {
            "flyer": {"shape": "balloon", "diameter": "10 m"},
            "film": {
                "areal_density": "3.0 ± 0.15 g/m^2",
                "absorptance": 0.8,
                "emittance_top": 0.1,
                "emittance_bottom": 0.1,
                "tac_top": TAC_SMALL,
                "tac_bottom": TAC_SMALL,
                "highest_temperature": "350 K",
            },
            "force": {"model": "balloon"},
        },
        "flyer.diameter",
        TO_TEN_METRES,
        {
            "film.absorptance": (0.3, DARKEST),
            "film.emittance_top": (LEAST_EMITTANCE, MOST_EMITTANCE),
        },
        absolute={"film.absorptance": 0.03, "film.emittance_top": 0.01},
        hottest=350.0,
    ),
)
