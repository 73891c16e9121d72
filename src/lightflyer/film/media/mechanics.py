"""Materials as structures: what the library knows of their stiffness, stress and strength."""

import tomllib
from importlib import resources
from typing import Any

from lightflyer.core.units import Measured
from lightflyer.film.media.database import looks_like_page

NUMBERS = ("modulus", "poisson", "expansion", "stress", "strength")  # as in data/mechanics.toml

_DATA = (resources.files("lightflyer") / "data" / "mechanics.toml").read_text(encoding="utf-8")
_KNOWN = tomllib.loads(_DATA)


def mechanics_of(material: str) -> dict[str, Measured]:
    """Mechanical numbers of a material by its name, or by that of a page; empty if unknown."""
    entry = _entry(material)
    return {number: Measured(*entry[number]) for number in NUMBERS if number in entry}


def mechanics_source(material: str) -> str:
    """Where these numbers are from."""
    return str(_entry(material).get("source", ""))


def _entry(material: str) -> dict[str, Any]:
    name = material.split("/")[1] if looks_like_page(material) else material
    return _KNOWN.get(name) or _KNOWN.get(name.partition("-")[0], {})  # such as Ge-20nm
