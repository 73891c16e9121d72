"""The paper's claims, and whether the recomputed numbers agree with them.

A verdict follows from the paper's value, ours and the tolerance in ``data/lu2023.toml``.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from lightflyer.paper.conditions import COLUMNS, facts

DECIDING = "reported"  # Column that decides the verdict on a claim

_ROUNDING = 1e-9  # of floating-point numbers, not of the paper's


class Verdict(StrEnum):
    """Result of comparing a claim with our numbers."""

    REPRODUCED = "reproduced"
    DIFFERS = "differs"
    NOT_RECOMPUTABLE = "reported but not recomputable"


@dataclass(frozen=True)
class Quantity:
    """One number of a claim."""

    key: str
    name: str
    unit: str
    lowest: float  # The paper's value, or the range it gives
    highest: float  # The paper's value, or the range it gives
    tolerance: float  # Largest difference of a reproduced value
    tolerance_note: str = ""  # Reason for a tolerance other than one unit of the last printed digit

    @property
    def paper(self) -> str:
        """The paper's value as text."""
        if self.lowest == self.highest:
            return f"{self.lowest:g}"
        return f"{self.lowest:g}–{self.highest:g}"

    def difference(self, ours: float) -> float:
        """Ours minus the paper's value; zero inside a range."""
        return min(ours - self.lowest, 0.0) + max(ours - self.highest, 0.0)

    def agrees(self, ours: float) -> bool:
        """Whether our value is within tolerance; NaN is not."""
        return abs(self.difference(ours)) <= self.tolerance + _ROUNDING * abs(self.highest)


@dataclass(frozen=True)
class Claim:
    """A claim of the paper."""

    number: int
    text: str
    quantities: tuple[Quantity, ...]
    place: str = ""  # Where the paper makes it
    # What a recomputation needs and the text does not give; empty if nothing is missing
    missing: str = ""
    note: str = ""  # Explanation of a difference, or where the numbers come from

    def verdict(self, values: dict[str, float]) -> Verdict:
        """Verdict on one column's numbers; ``values``: ours, by the quantities' keys."""
        if self.missing:
            return Verdict.NOT_RECOMPUTABLE
        agree = all(quantity.agrees(values[quantity.key]) for quantity in self.quantities)
        return Verdict.REPRODUCED if agree else Verdict.DIFFERS

    def reproducers(self, columns: dict[str, dict[str, float]]) -> list[str]:
        return [
            name for name, values in columns.items() if self.verdict(values) is Verdict.REPRODUCED
        ]

    def overall(self, columns: dict[str, dict[str, float]]) -> Verdict:
        """Verdict by the column that gives the paper's bands of altitude."""
        # One column decides about all claims, so that no reading is picked claim by claim.
        return self.verdict(columns[DECIDING])

    def reason(self, columns: dict[str, dict[str, float]]) -> str:
        """What is missing, or which numbers of which columns are off, and the note."""
        if self.missing:
            return f"missing: {self.missing}. {self.note}".rstrip(" ")
        titles = {column.key: column.title for column in COLUMNS}
        off = {
            titles.get(key, key): [q.name for q in self.quantities if not q.agrees(values[q.key])]
            for key, values in columns.items()
        }
        outside = "; ".join(f"{name} ({', '.join(names)})" for name, names in off.items() if names)
        return f"outside the tolerance: {outside}. {self.note}" if outside else self.note


def claims() -> list[Claim]:
    """The paper's claims, in order."""
    return [
        Claim(
            number=stated["number"],
            text=stated["text"],
            quantities=tuple(map(_quantity, stated.get("quantity", []))),
            place=stated["place"],
            missing=stated.get("missing", ""),
            note=stated.get("note", ""),
        )
        for stated in facts()["claim"]
    ]


def _quantity(stated: dict[str, Any]) -> Quantity:
    lowest, highest = stated.get("range") or (stated["value"], stated["value"])
    return Quantity(
        key=stated["key"],
        name=stated["name"],
        unit=stated["unit"],
        lowest=lowest,
        highest=highest,
        tolerance=stated["tolerance"],
        tolerance_note=stated.get("tolerance_note", ""),
    )
