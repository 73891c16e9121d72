"""The table of published flyers: its rows, their flyer files, our verdicts on them."""

from __future__ import annotations

import hashlib
import json
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2]
TABLE = DOCS / "published.toml"
VERDICTS = DOCS / "published.json"
_CLAIMS = DOCS.parent / "studies" / "published_claims" / "results.json"
_COMMENT_AT = 36  # column of a flyer file


@dataclass(frozen=True)
class Published:
    """A published flyer.

    Attributes
    ----------
    name : str
        Of its page and flyer file.
    title, kind, source : str
    flew : bool
        Whether it was seen to fly.
    how : str
        The same in a word or two.
    claimed : str
        What the publication says, in a sentence.
    told : list of tuple of str
        What, value, where.
    said : str
        What is to be known of our verdict, in Markdown.
    file : dict
        Values and their sources, by section and key.
    ratio : dict, optional
        Our force over that which the claim needs: ``median``, ``low``, ``high``.
    needed : str
        What that ratio is.
    """

    name: str
    title: str
    kind: str
    source: str
    flew: bool
    how: str
    claimed: str
    told: list[tuple[str, str, str]]
    said: str
    file: dict[str, dict[str, tuple[str, str]]]
    ratio: dict[str, float] | None
    needed: str

    @property
    def guesses(self) -> int:
        """How many numbers of the file are guessed."""
        return sum(
            where.startswith("(guess)") for keys in self.file.values() for _, where in keys.values()
        )

    @property
    def in_calculator(self) -> bool:
        """Whether the calculator can show it: by the gravity of Earth, a particle in its air."""
        around = self.file["environment"]
        in_air = self.kind != "sphere" or around["kind"][0] == "earth"
        return "gravity" not in around and in_air

    def flyer_file(self) -> str:
        """Its flyer file, each number with where it is from."""
        lines = [
            f"# {self.title}, {self.source}: {self.how}.",
            "# What is guessed is marked (guess). Run:  lightflyer predict FILE",
        ]
        for section, keys in self.file.items():
            lines += ["", f"[{section}]"]
            for key, (value, where) in keys.items():
                quoted = json.dumps(value, ensure_ascii=False)
                text = f"{key} = {value if is_number(value) else quoted}"
                lines.append(f"{text:<{_COMMENT_AT}}# {where}" if where else text)
        return "\n".join(lines) + "\n"

    def digest(self) -> str:
        """Of its flyer file."""
        return hashlib.sha256(self.flyer_file().encode()).hexdigest()

    def verdict(self) -> dict[str, Any]:
        """Ours, as :mod:`published.verdicts` has written it.

        Raises
        ------
        LookupError
            If there is none of this flyer file.
        """
        found = _verdicts().get(self.name)
        if found is None or found["digest"] != self.digest():
            raise LookupError(f"no verdict on {self.name} as it is now: run make verdicts")
        return found


def is_number(text: str) -> bool:
    """Whether a text of the table is a plain number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


@cache
def _verdicts() -> dict[str, Any]:
    return json.loads(VERDICTS.read_text(encoding="utf-8")) if VERDICTS.is_file() else {}


@cache
def published() -> list[Published]:
    """All rows, in the order of the table."""
    rows = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return [_row(name, content) for name, content in rows.items()]


def _row(name: str, content: dict[str, Any]) -> Published:
    ratio: Any = None
    if "study" in content:
        ratio = json.loads(_CLAIMS.read_text(encoding="utf-8"))
        for key in content["study"].split("/"):
            ratio = ratio[key]
        ratio = ratio.get("ratio", ratio)
    return Published(
        name=name,
        title=content["name"],
        kind=content["kind"],
        source=content["source"],
        flew=content["flew"],
        how=content.get("how", "flew" if content["flew"] else "computed"),
        claimed=content["claimed"],
        told=[(what, value, where) for what, value, where in content["told"]],
        said=content["said"],
        file={
            section: {key: (value, where) for key, (value, where) in keys.items()}
            for section, keys in content["file"].items()
        },
        ratio=ratio,
        needed=content.get("needed", ""),
    )
