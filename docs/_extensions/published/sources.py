"""Links to what a published flyer's numbers are from."""

from __future__ import annotations

import re
from functools import cache
from html import escape

from .table import DOCS

_KEY = re.compile(r"\b[A-Z][A-Za-z]+\d{4}[a-z]?\b")
_LISTED = re.compile(r"^\.\. \[(\w+)\](.*?)(?=^\.\. |\Z)", re.M | re.S)
_ADDRESS = re.compile(r"https?://[^\s;]+")


@cache
def addresses() -> dict[str, str]:
    """Keys of the page of references, each with the first address of its entry, or none."""
    text = (DOCS / "references.rst").read_text(encoding="utf-8")
    found = ((key, _ADDRESS.search(entry)) for key, entry in _LISTED.findall(text))
    return {key: address[0].rstrip(".") if address else "" for key, address in found}


def linked(text: str, up: str = "") -> str:
    """A text of the table in HTML, in which each key of a reference is a link to it.

    Parameters
    ----------
    text : str
    up : str
        From the page to the folder of the page of references, such as ``"../"``.
    """

    def link(found: re.Match[str]) -> str:
        key = found[0]
        if key not in addresses():
            return key
        return f'<a href="{up}references.html#{key.lower()}">{key}</a>'

    return _KEY.sub(link, escape(text, quote=False))


def online(key: str) -> str:
    """Link in HTML to a publication itself, empty where its reference has no address."""
    address = addresses().get(key, "")
    name = "DOI" if "doi.org" in address else "online"
    return f' (<a href="{escape(address)}">{name}</a>)' if address else ""
