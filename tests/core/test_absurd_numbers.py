"""Numbers that cannot be meant are refused, each with the limit and its reason."""

import re

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core import quantity
from lightflyer.core.quantity import Quantity, quantity_of
from lightflyer.core.units import parse, scale_and_offset

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
RADIATION = lf.environment.Radiation


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: lf.Chamber(temperature=1e6), ""),
        (lambda: lf.Chamber().state(1e12), ""),
        (lambda: lf.Disk(FILM, 1e30), "must be at most 10000 m: atoms are larger"),
        (lambda: lf.Disk(FILM, 1e-30), "must be at least 1e-10 m: "),
        (lambda: lf.Disk(FILM, np.array([0.01, 1e30])), "must be at most 10000 m: "),
        (lambda: RADIATION(1e30), "must be at most 1e+08 W/m^2: the surface of the sun"),
        (lambda: lf.Disk(FILM, 0.01, payload=1e6), "must be at most 10000 kg: no flyer carries"),
        (lambda: lf.FilmProperties(1e-12, 0.7, 0.1, 0.1, 0.8, 0.9), ""),
    ],
)
def test_constructors_refuse_with_the_limit_and_its_reason(make, message):
    with pytest.raises(lf.ParameterError, match=r"must be at (most|least) \S+ \S+: \w+") as caught:
        make()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('diameter = "2 cm"', 'diameter = "1e30 m"', "must be at most 10000 m: atoms are larger"),
        ("tac_top = 0.8", 'tac_top = "0.8 ± 100"', "uncertainty must be at most 1.3"),
    ],
)
def test_files_refuse_in_one_line(old, new, message, flyer_file):
    with pytest.raises(lf.ConfigurationError, match=re.escape(message)) as caught:
        lf.read_flyer_file(flyer_file(old, new))
    assert re.search(r"flyer.toml:\d+: [^\n]*$", str(caught.value))


def test_every_number_with_a_unit_has_plausible_sizes():
    kinds = {
        name: quantity_of(kind)
        for name, kind in vars(quantity).items()
        if name[0].isupper() and quantity_of(kind) is not None
    }
    assert len(kinds) > 20
    for name, kind in kinds.items():
        bounded = np.isfinite([kind.lowest, kind.highest]).all() or kind.sizes[1] < np.inf
        assert bounded or not kind.unit, name
        assert not kind.sizes[1] < np.inf or kind.why, name


def test_zero_is_no_size():
    quantity = Quantity("m", 0.0, sizes=(1e-3, 1.0), why="reasons")
    quantity.check("gap", 0.0)
    quantity.check("gap", np.array([0.0, 0.5]))
    with pytest.raises(lf.ParameterError, match=r"gap = 0.0001 must be at least 0.001 m: reasons"):
        quantity.check("gap", 1e-4)


@pytest.mark.parametrize("read", [parse, scale_and_offset])
@pytest.mark.parametrize(
    "text",
    [
        "9" * 400,
        int("9" * 400),
        "2 " + "*".join(["cm"] * 1000),
        "1e" + "9" * 300 + " m",
        "m" * 5000,
        "*".join(["cm"] * 1000),
    ],
    ids=["digits", "whole number", "factors", "exponent", "unit", "product"],
)
def test_endless_texts_are_one_short_line(read, text):
    with pytest.raises(lf.ConfigurationError) as caught:
        read(str(text) if read is scale_and_offset else text, "m")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < (500 if read is scale_and_offset else 200)
