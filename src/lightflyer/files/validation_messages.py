"""What is wrong with a section, in words: one line for each of Pydantic's errors."""

import difflib
import re
from collections.abc import Callable, Sequence
from typing import Any

from lightflyer.core.text import in_toml, shortened
from lightflyer.files.section import UNKNOWN


def format_error(mistake: Any, dotted: str) -> str:
    """One line for a mistake that is not an unknown key; key, what is wrong and what is allowed."""
    return _EXPLANATIONS.get(mistake["type"], _other_mistake)(mistake, dotted)


_MEANT = {
    "radius": ("diameter", ", twice the radius"),
    "west": ("east", " with the other sign"),
    "south": ("north", " with the other sign"),
    "down": ("up", " with the other sign"),
    "emissivity": ("emittance", ""),
    "absorptivity": ("absorptance", ""),
}
"""Known keys for what others call so, and how the value changes."""


def did_you_mean(key: str, near: str) -> str:
    """Ask for the known key that stands for another one."""
    meant, how = _MEANT.get(key, ("", ""))
    return f'did you mean "{near}"{how if near == meant else ""}?'


def nearest(key: str, known: Sequence[str]) -> str:
    """The known key that a misspelt one stands for, else empty."""
    if key in _MEANT and _MEANT[key][0] in known:
        return _MEANT[key][0]
    others = [name for name in known if name != key]  # in another kind of file
    return next(iter(difflib.get_close_matches(key, others, n=1, cutoff=0.6)), "")


def choosing_key(mistake: Any) -> list[str]:
    """The key whose value chose an alternative that does not exist."""
    if mistake["type"] != UNKNOWN:
        return []
    base, tag = mistake["ctx"]["base"], mistake["ctx"]["tag"]
    values = tag.split(" ")
    wrong = (
        key
        for (key, _), value in zip(base.choosing_keys, values, strict=False)
        if value not in base.choices(key, tag)
    )
    return [next(wrong)]


def _missing_key(mistake: Any, dotted: str) -> str:
    section, _, key = dotted.rpartition(".")
    keys = mistake.get("keys", [key])
    key = " and ".join(filter(None, (", ".join(keys[:-1]), keys[-1])))
    return f"[{section}] needs {key}" if section else f"the section [{key}] is missing"


def _unknown_alternative(mistake: Any, dotted: str) -> str:
    base, tag = mistake["ctx"]["base"], mistake["ctx"]["tag"]
    key = dotted.rpartition(".")[2]
    found = tag.split(" ")[[name for name, _ in base.choosing_keys].index(key)]
    choices = base.choices(key, tag)
    near = nearest(found, choices)
    hint = f'; did you mean "{near}"?' if near else ""
    return f'{dotted} = "{found}" is unknown; choose from {", ".join(choices)}{hint}'


def _other_mistake(mistake: Any, dotted: str) -> str:
    message = mistake["msg"].removeprefix("Value error, ")
    value = mistake["input"]
    if isinstance(value, dict):
        return f"[{dotted}]: {message}" if dotted else message
    shown = in_toml(value)
    if isinstance(value, str) and shown in message:
        return f"{dotted}: {message}"
    first = message.partition(" ")[0]  # a name of a file keeps its capitals
    text = message[0].lower() + message[1:] if first == first.capitalize() else message
    return f"{dotted} = {shortened(shown)}: {text}"


def _explain_kind(wanted: str) -> Callable[[Any, str], str]:
    """Explanation that a value is not of a kind."""

    def format_error(mistake: Any, dotted: str) -> str:
        return f"{dotted} = {shortened(in_toml(mistake['input']))}: is not {wanted}"

    return format_error


def _explain_limit(words: str) -> Callable[[Any, str], str]:
    """Explanation that a number is on the wrong side of a limit."""

    def format_error(mistake: Any, dotted: str) -> str:
        limit = words.format(**mistake["ctx"])
        return f"{dotted} = {shortened(in_toml(mistake['input']))}: must be {limit}"

    return format_error


def _unknown_word(mistake: Any, dotted: str) -> str:
    known = re.findall("'([^']*)'", mistake["ctx"]["expected"])
    value = mistake["input"]
    near = nearest(value, known) if isinstance(value, str) else ""
    hint = did_you_mean(value, near) if near else f"choose from {', '.join(known)}"
    return f"{dotted} = {shortened(in_toml(value))} is unknown; {hint}"


def _too_few(mistake: Any, dotted: str) -> str:
    least = mistake["ctx"]["min_length"]
    entries = "entry" if least == 1 else "entries"
    return f"{dotted} = {shortened(in_toml(mistake['input']))}: needs at least {least} {entries}"


_EXPLANATIONS: dict[str, Callable[[Any, str], str]] = {
    "missing": _missing_key,
    UNKNOWN: _unknown_alternative,
    "literal_error": _unknown_word,
    **{
        kind: _explain_limit(words)
        for kind, words in {
            "greater_than_equal": "at least {ge}",
            "greater_than": "above {gt}",
            "less_than_equal": "at most {le}",
            "less_than": "below {lt}",
        }.items()
    },
    "too_short": _too_few,
    **dict.fromkeys(("tuple_type", "list_type"), _explain_kind("a list, such as [ ... ]")),
    **dict.fromkeys(
        ("model_type", "model_attributes_type", "dict_type", "mapping_type"),
        _explain_kind("a section, such as [section] followed by its keys"),
    ),
    "string_type": _explain_kind("a text in quotes"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), _explain_kind("a whole number")),
    **dict.fromkeys(("float_type", "float_parsing"), _explain_kind("a number")),
    **dict.fromkeys(("bool_type", "bool_parsing"), _explain_kind("true or false")),
    **dict.fromkeys(
        ("datetime_type", "datetime_parsing", "datetime_from_date_parsing"),
        _explain_kind("a date, such as 2026-06-21T12:00:00"),
    ),
}
