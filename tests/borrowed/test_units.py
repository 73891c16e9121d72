"""Public reports of units: their definitions by hand."""

import pytest

import lightflyer as lf
from lightflyer.core.units import parse


@pytest.mark.parametrize(
    ("text", "kelvin", "uncertainty"),
    [
        # https://github.com/hgrecco/pint/issues/3: 212 °F was 381.6 °C
        ("212 °F", 373.15, None),
        ("100 degC", 373.15, None),
        # https://github.com/qudt/qudt-public-repo/issues/413: 20 °C was -300 °F
        ("68 °F", 293.15, None),
        # https://github.com/hgrecco/pint/issues/120: 12.3 °C of difference are 22.14 °F
        ("20 ± 12.3 °C", 293.15, 12.3),
        ("68 ± 22.14 °F", 293.15, 12.3),
        # https://github.com/hgrecco/pint/issues/1906: 5 °C of difference were -450 °F
        ("50 ± 9 °F", 283.15, 5.0),
    ],
)
def test_temperatures_and_their_differences(text, kelvin, uncertainty):
    found = parse(text, "K")
    assert found.value == pytest.approx(kelvin, rel=1e-12)
    assert (found.uncertainty or 0.0) == pytest.approx(uncertainty or 0.0, rel=1e-9)


def test_a_prefix_before_a_scale_of_temperature():
    """https://github.com/hgrecco/pint/issues/1381: 20 °C were 293150 m°C."""
    with pytest.raises(lf.ConfigurationError, match="unknown"):
        parse("20000 m°C", "K")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        # https://github.com/jjgomera/iapws/issues/3: a factor of 1000
        ("4.2 kJ/(kg K)", "J/(kg K)", 4200.0),
        # https://github.com/hgrecco/pint/issues/1612: of a slope no zero is added
        ("25.4 °C/m", "K/m", 25.4),
        # https://github.com/openrocket/openrocket/issues/2699: inches of mercury
        ("30.05 inHg", "Pa", 101761.0),
    ],
)
def test_compound_units(text, unit, value):
    assert parse(text, unit).value == pytest.approx(value, rel=1e-6)
