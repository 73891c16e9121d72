"""A result's annotated fields are its JSON object; units of its dataset are those of its tables."""

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
import pytest

from lightflyer.lab.estimate import Estimate
from lightflyer.lab.result import LabResult, Reported, Series, Shown, csv_text, plain, variables


@dataclass(frozen=True, repr=False)
class Spring(LabResult):
    stiffness: Annotated[Estimate, Shown("stiffness k")]
    load: Annotated[np.ndarray, Shown(key="curve.load_n")]
    hidden: float
    rows: Reported[dict[float, Estimate]]
    warnings: tuple[str, ...] = ("stretched",)

    @cached_property
    def longest(self) -> Annotated[float, Shown(key="curve.longest_m")]:
        return float("inf")

    @property
    def count(self) -> Reported[int]:
        return len(self.load)

    def parts(self):
        yield from (f"{name} {one}" for name, one in self.labelled().items())


def test_annotated_fields_and_properties_are_the_json_object():
    one = Estimate(2.0, (1.0, np.inf), "N/m")
    found = Spring(one, np.array([1.0, 2.0]), 3.0, {441.0: one})
    number = {"value": 2.0, "interval_95": [1.0, None], "standard_uncertainty": None, "unit": "N/m"}
    assert json.loads(json.dumps(found.summary())) == {
        "stiffness": number, "rows": {"441": number}, "count": 2,
        "curve": {"load_n": [1.0, 2.0], "longest_m": None}, "warnings": ["stretched"],
    }  # fmt: skip
    assert str(found) == "stiffness k 2 (1 to inf) N/m\nwarning: stretched"


@pytest.mark.parametrize(
    ("unit", "in_dataset"),
    [("W/(m^2 K)", "W m-2 K-1"), ("W/m^2", "W m-2"), ("cm^-1", "cm-1"), ("1/m", "m-1"),
     ("Pa", "Pa"), ("", "1")],
)  # fmt: skip
def test_units_of_tables_and_datasets(unit, in_dataset):
    one = Series("load", np.array([0.5]), unit, "load on the spring")
    over, values, attributes = variables("row", [one], file="a.csv")["load"]
    assert (over, values) == ("row", [0.5])
    assert attributes == {"units": in_dataset, "long_name": "load on the spring", "file": "a.csv"}
    heading = f"load [{unit}]" if unit else "load"
    assert csv_text(["# made"], [one]) == f"# made\n{heading}\n0.5\n"


def test_plain_numbers():
    assert plain({1.5: (np.float64(2.0), float("nan")), "a": np.array([[1]])}) == {
        "1.5": [2.0, None], "a": [[1]],
    }  # fmt: skip
