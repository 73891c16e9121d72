import math

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lightflyer as lf
from lightflyer.core.units import parse, rewrite, scale_and_offset, spell_unit


@pytest.mark.parametrize(
    ("text", "unit", "value", "uncertainty"),
    [
        ("2 cm", "m", 0.02, None),
        ("1.0 g/m^2", "kg/m^2", 1e-3, None),
        ("1.0 ± 0.1 g/m²", "kg/m^2", 1e-3, 1e-4),
        ("1.0 g/m^2 ± 0.01 mg/cm^2", "kg/m^2", 1e-3, 1e-4),
        ("0.90 +/- 0.03", "", 0.9, 0.03),
        ("75 % ± 2 %", "", 0.75, 0.02),
        (0.5, "", 0.5, None),
        ("1.36 kW/m^2", "W/m^2", 1360.0, None),
        ("1360 W m^-2", "W/m^2", 1360.0, None),
        ("45°", "deg", 45.0, None),
        ("0.7853981633974483 rad", "deg", 45.0, None),
        ("30 mTorr", "Pa", 30e-3 * 101325 / 760, None),
        ("1e-3 mbar", "Pa", 0.1, None),
        ("22.0 ± 0.5 °C", "K", 295.15, 0.5),
        ("500 nm", "m", 5e-7, None),
        ("5 µm", "m", 5e-6, None),
        ("5 um", "m", 5e-6, None),
        # https://github.com/hgrecco/pint/issues/3: 212 °F was 381.6 °C
        ("212 °F", "K", 373.15, None),
        # https://github.com/qudt/qudt-public-repo/issues/413: 20 °C was -300 °F
        ("68 °F", "K", 293.15, None),
        # https://github.com/hgrecco/pint/issues/120: 12.3 °C of difference are 22.14 °F
        ("20 ± 12.3 °C", "K", 293.15, 12.3),
        ("68 ± 22.14 °F", "K", 293.15, 12.3),
        # https://github.com/hgrecco/pint/issues/1906: 5 °C of difference were -450 °F
        ("50 ± 9 °F", "K", 283.15, 5.0),
        # https://github.com/jjgomera/iapws/issues/3: a factor of 1000
        ("4.2 kJ/(kg K)", "J/(kg K)", 4200.0, None),
        # https://github.com/hgrecco/pint/issues/1612: of a slope no zero is added
        ("25.4 °C/m", "K/m", 25.4, None),
        *(
            (f"1.8 {unit}", "W/(m*K)", 1.8, None)
            for unit in ("W/(m*K)", "W/(m K)", "W/m/K", "W m^-1 K^-1")
        ),
        ("0.7 mm", "m", 7e-4, None),
        *(
            (zero, unit, 0.0, None)
            for zero in (0, 0.0, "0", "0.0")
            for unit in ("m", "m^4", "Pa", "W/m^2", "")
        ),
    ],
)
def test_readings(text, unit, value, uncertainty):
    measured = parse(text, unit)
    assert measured.value == pytest.approx(value, rel=1e-14, abs=0.0)
    if uncertainty is None:
        assert measured.uncertainty is None
    else:
        assert measured.uncertainty == pytest.approx(uncertainty, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "unit", "message"),
    [
        ("2", "m", 'has no unit; write "2 m"'),
        (2, "m", 'has no unit; write "2 m"'),
        ("2 kg", "m", "is of the wrong kind; give one that converts to m"),
        ("2 furlong", "m", "is unknown"),
        ("0.9 m", "", "write a pure number"),
        ("two cm", "m", "is not a number"),
        ("", "m", "is not a number"),
        ("nan", "", "is not a number"),
        ("1e999", "", "is not a finite number"),
        (math.inf, "", "is not a finite number"),
        ("0.9 ± -0.1", "", "the uncertainty is negative"),
        ("0.9 ± 0.1 ± 0.1", "", "more than one ±"),
        ("0.9 ± 5 %", "", "relative or absolute"),
        ("2 m^", "m", "is not a unit"),
        ("1,5 cm", "m", "has a comma; write a point before decimals"),
        (True, "", "is not a number"),
        (["2 cm"], "m", "is not a number"),
        *(
            (f"1 {unit}", "W/(m*K)", "is not a unit")
            for unit in ("W/(m*K", "W/m*K)", "W/()", "(W)/(m*K)", "J0")
        ),
        *(
            (f"1 {unit}", "Pa", "may be milli or mega; write m")
            for unit in ("MTorr", "MTORR", "Mbar", "MBAR")
        ),
        *((text, "deg", 'south and west as "-45 deg"') for text in ("45 N", "10 E", "3 W", "80 S")),
        (0, "K", "has no unit"),  # zero degrees are not zero kelvin
        ("0", "K", "has no unit"),
        # https://github.com/hgrecco/pint/issues/1381: 20 °C were 293150 m°C
        ("20000 m°C", "K", "unknown"),
    ],
)
def test_mistakes_are_explained(text, unit, message):
    with pytest.raises(lf.ConfigurationError) as error:
        parse(text, unit)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@given(st.one_of(st.text(), st.from_regex(r"\d+ ?[a-zA-Z°%µ²/*^± ]*", fullmatch=True)))
def test_any_text_is_read_or_refused_in_one_way(text):
    try:
        measured = parse(text, "m")
    except lf.ConfigurationError:
        return
    assert math.isfinite(measured.value)


# NIST SP 811 (2008), appendix B.8, but for torr and suns; ITS-90 for temperatures
@pytest.mark.parametrize(
    ("text", "unit", "value", "digits"),
    [
        *[(f"1 {torr}", "Pa", 133.3224, 7) for torr in ("torr", "Torr", "TORR", "mmHg", "mm Hg")],
        ("1 mTORR", "Pa", 0.1333224, 7),
        ("1 micron", "Pa", 0.1333224, 7),
        ("1 micron", "m", 1e-6, 12),
        ("1 Pascal", "Pa", 1.0, 12),
        ("1 hPa", "Pa", 100.0, 12),
        ("1 inHg", "Pa", 3386.389, 7),
        ("1 in. Hg", "Pa", 3386.389, 7),
        ("32 °F", "K", 273.15, 12),
        ("212 degF", "K", 373.15, 12),
        ("68 ± 9 F", "K", 293.15, 12),
        ("30.05 inHg", "Pa", 101761.0, 6),  # https://github.com/openrocket/openrocket/issues/2699
        ("25 ℃", "K", 298.15, 12),
        ("25 degC", "K", 298.15, 12),
        ("25 C", "K", 298.15, 12),
        ("1.5 suns", "W/m^2", 1500.0, 12),
        ("1 W m⁻²", "W/m^2", 1.0, 12),
        ("1 W·m−2", "W/m^2", 1.0, 12),
        ("1 mW/cm2", "W/m^2", 10.0, 12),
        ("1 W/cm²", "W/m^2", 1e4, 12),
        ("1 µm", "m", 1e-6, 12),
        ("1 μm", "m", 1e-6, 12),
        ("1 Å", "m", 1e-10, 12),
        ("1 angstrom", "m", 1e-10, 12),
        ("1 eV", "J", 1.602176634e-19, 12),
        ("100 Ω", "ohm", 100.0, 12),
    ],
)
def test_spellings_of_laboratories(text, unit, value, digits):
    measured = parse(text, unit)
    assert measured.value == pytest.approx(value, rel=0.5 * 10.0 ** (1 - digits))
    if measured.uncertainty is not None:
        assert measured.uncertainty == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("spelled", "unit"),
    [("m.s-1", "m/s"), ("m s**-1", "m/s"), ("W.m-2", "W/m^2"), ("m/sec", "m/s"), ("kts", "knot"),
     ("knots", "knot"), ("mb", "hPa"), ("hpa", "hPa"), ("Hectopascals", "hPa"),
     # a product with a degree has a difference of temperatures
     ("W/(m °C)", "W/(m*K)"), ("W/m K", "W*K/m")],
)  # fmt: skip
def test_units_as_weather_files_spell_them(spelled, unit):
    assert scale_and_offset(spelled, unit) == (1.0, 0.0)


def test_factors_are_exact():
    assert scale_and_offset("g/cm^3", "kg/m^3")[0] == 1000.0
    assert scale_and_offset("W/(m °F)", "W/(m*K)")[0] == pytest.approx(1.8)
    assert scale_and_offset("°C", "K") == (1.0, 273.15)


# units without a prefix that Pint's own list has by the same name
OF_PINT = """
m metre meter s second minute min hour h day d rad radian degree deg inch in foot ft g gram
angstrom percent kelvin K ampere A bit Hz hertz newton N pascal Pa bar atmosphere atm torr mmHg
psi inHg joule J eV watt W volt V ohm knot kt mph
"""
PINT = pint.UnitRegistry()


@pytest.mark.parametrize("name", OF_PINT.split())
def test_a_unit_is_that_of_pint(name):
    theirs = PINT.Quantity(1.0, name)
    base = f"{theirs.to_base_units().units:~C}".replace("**", "^") or "dimensionless"
    factor, offset = scale_and_offset(name, base)
    digits = 2e-7 if name in {"psi", "inHg", "mmHg", "torr"} else 1e-15  # rounded in Pint's list
    assert factor == pytest.approx(theirs.to_base_units().magnitude, rel=digits)
    assert offset == 0.0


@pytest.mark.parametrize("prefix", ["T", "giga", "M", "k", "hecto", "c", "milli", "µ", "u", "n"])
def test_a_prefix_is_that_of_pint(prefix):
    theirs = PINT.Quantity(1.0, f"{prefix}Pa").to("Pa").magnitude
    assert scale_and_offset(f"{prefix}Pa", "Pa")[0] == pytest.approx(theirs, rel=1e-15)


def test_units_of_instruments_are_spelled_as_files_spell_them():
    assert (spell_unit("TORR", "Pa"), spell_unit("micron", "Pa")) == ("Torr", "mTorr")
    assert spell_unit("micron", "m") == "um"


def test_another_value_keeps_unit_and_uncertainty_of_a_text():
    assert rewrite("2 ± 0.1 cm", 0.0312, "m") == "3.12 ± 0.1 cm"
    assert rewrite("", 0.0312, "m") == "0.0312 m"
