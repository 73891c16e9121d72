"""The unit of a column changes no result, where its numbers are scaled and the unit is named."""

import json
import math
import re
import shlex
from decimal import Decimal

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates

NUMBER = re.compile(r"-?\d+(\.\d+)?")
ZERO = Decimal("273.15")
# New unit of numbers, and what these are multiplied by, or raised by, all exact in decimals
MILLI, CENTI = Decimal(1000), Decimal(100)
UNITS = {
    "mTorr": ("Torr", 1 / MILLI), "Pa": ("kPa", 1 / MILLI), "s": ("ms", MILLI), "V": ("mV", MILLI),
    "mA": ("A", 1 / MILLI), "mW": ("W", 1 / MILLI), "ohm": ("mohm", MILLI), "°C": ("K", ZERO),
    "kW/m^2": ("mW/cm^2", CENTI), "W/m^2": ("kW/m^2", 1 / MILLI), "W/m2": ("kW/m2", 1 / MILLI),
    "cm": ("mm", Decimal(10)), "mm": ("cm", Decimal("0.1")), "µm": ("nm", MILLI),
    "um": ("nm", MILLI), "nm": ("um", 1 / MILLI), "cm^-1": ("m^-1", CENTI), "eV": ("meV", MILLI),
    "THz": ("GHz", MILLI), "deg": ("mdeg", MILLI), "%": ("1", 1 / CENTI),
}  # fmt: skip
BARE = {"cm-1": ("m-1", CENTI), "reflectance": ("%", CENTI)} | dict.fromkeys(
    ("incident", "reflected", "transmitted", "dark"), ("mW/m^2", MILLI)
)
"""The same for names of columns without a unit."""

COMMANDS = [
    "lab tac tac-raw.csv --calibration tac-resistance.csv",
    "lab tac tac-reduced.txt --gauge gauge.csv",
    "lab levitation levitation.csv --draws 100",
    "lab levitation launchpads.csv --draws 100",
    "lab thermography thermal.csv --band camera.csv --accuracy '0.5 K' --draws 1000",
    "lab thermography light-meter.csv --light-meter --draws 1000",
    "lab ftir film.csv --reflectance film-reflectance.csv",
    "lab optics angles.toml --starts 1",
    "calibrate points.csv",
    "film lines.toml",
    "film film.toml",
]
OTHER_FILES = {
    "points.csv": re.sub(", +", ",", templates()["points"].read()),
    "camera.csv": "wavelength [um],response\n7,0\n8,1\n13,0.9\n14,0\n",
    "index.csv": "wavelength [um],n,k\n0.2,1.9,0.3\n1,1.7,0.1\n10,1.6,0.2\n100,1.5,0.4\n",
    "lamp.csv": "wavelength [nm],irradiance\n400,1\n600,3\n800,0.5\n",
    "gauge.csv": "shown [Pa],pressure [Pa]\n0.01,0.011\n1,1.2\n200,190\n",
    "psi-delta.csv": "photon_energy [eV],psi [deg],delta [deg],incidence [deg]\n"
    + "".join(
        f"{energy},{36 - 3 * energy + 0.1 * (n % 3)},{95 + 9 * energy},65\n"
        for n, energy in enumerate((1.5, 1.8, 2.1, 2.4, 2.7, 3.0))
    ),
    "angles.toml": """free = [{number = "layers.0.thickness"}]
[[ellipsometry]]
file = "psi-delta.csv"
[film]
layers = [{dispersion = {cauchy = {a = 1.6}}, thickness = "100 nm"}]
substrate = {dispersion = {cauchy = {a = 1.5}}}
""",
    "permittivity.csv": "wavenumber [cm^-1],permittivity_real,permittivity_imaginary\n"
    "50,2.4,0.2\n1000,2.5,0.3\n40000,2.6,0.5\n",
    "energies.csv": "photon_energy [eV],n,k\n0.01,1.6,0.2\n1,1.5,0.01\n6,1.7,0.4\n",
    "frequencies.csv": "frequency [THz],n,k\n1,1.6,0.2\n300,1.5,0.01\n1500,1.7,0.4\n",
    "lines.toml": """[film]
layers = [
  {material = "permittivity.csv", thickness = "80 nm", density = "2 g/cm^3"},
  {material = "energies.csv", thickness = "50 nm", density = "2 g/cm^3"},
  {material = "frequencies.csv", thickness = "90 nm", density = "2 g/cm^3"},
]
tac_top = 0.8
tac_bottom = 0.9
""",
    "film.toml": """[film]
layers = [{material = "index.csv", thickness = "80 nm", density = "2 g/cm^3"}]
spectrum = "lamp.csv"
tac_top = 0.8
tac_bottom = 0.9
""",
}


def in_other_units(text):
    """A table with its columns in other units, its numbers exact; a size of 273.15 is added."""
    lines = text.lstrip("\N{ZERO WIDTH NO-BREAK SPACE}").splitlines()
    head = next(n for n, line in enumerate(lines) if not line.startswith("#"))
    mark = ";" if ";" in lines[head] else ","
    names = lines[head].split(mark)
    changes = {}
    for place, name in enumerate(names):
        bare, unit = re.fullmatch(r"(.*?)(?: [\[(](.*)[\])])?", name.strip()).groups()
        new = UNITS[unit] if unit else BARE.get(bare)
        if new is not None:
            changes[place] = new[1]
            names[place] = f"{'wavenumber' if bare == 'cm-1' else bare} [{new[0]}]"
    lines[head] = mark.join(names)
    for row in range(head + 1, len(lines)):
        cells = lines[row].split(mark)
        for place, size in changes.items():
            text = "".join(cells[place : place + 1]).replace(",", ".")
            if NUMBER.fullmatch(text):  # the others are faults, whose rows are left out
                number = Decimal(text) + size if size == ZERO else Decimal(text) * size
                cells[place] = f"{number:f}".replace(".", "." if mark == "," else ",")
        lines[row] = mark.join(cells)
    return "\n".join(lines) + "\n"


def numbers_in(found, path=""):
    """Every number of a JSON object, by its place."""
    items = found.items() if isinstance(found, dict) else enumerate(found)
    for key, value in items:
        if isinstance(value, dict | list):
            yield from numbers_in(value, f"{path}.{key}")
        elif isinstance(value, int | float):
            yield f"{path}.{key}", value


@pytest.fixture
def reduced(prints, examples, monkeypatch):
    """Numbers that a command finds, after a change of its files."""

    monkeypatch.setenv("COLUMNS", "200")

    def numbers(command, *, changed):
        words = shlex.split(command)
        folder = examples(words[1] if words[0] == "lab" else "tac")
        for name, text in OTHER_FILES.items():
            (folder / name).write_text(text, encoding="utf-8")
        for path in [*folder.glob("*.csv"), *folder.glob("*.txt")] if changed else ():
            text = in_other_units(path.read_text(encoding="utf-8"))
            path.write_text(text, encoding="utf-8")
        return dict(numbers_in(json.loads(prints(*words, "--json"))))

    return numbers


@pytest.mark.parametrize("command", COMMANDS)
def test_columns_in_other_units_change_no_result(reduced, command):
    expected, found = reduced(command, changed=False), reduced(command, changed=True)
    assert found.keys() == expected.keys()
    for place, value in expected.items():
        assert math.isclose(found[place], value, rel_tol=1e-5, abs_tol=1e-9), place


@pytest.mark.parametrize("name", ["visible-reflectance.csv", "infrared-transmittance.csv"])
def test_a_spectrum_in_other_units_is_the_same(examples, name):
    path = examples("optics") / name
    expected = lf.lab.read_spectrum(path)
    path.write_text(in_other_units(path.read_text(encoding="utf-8")), encoding="utf-8")
    found = lf.lab.read_spectrum(path)
    np.testing.assert_allclose(found.wavenumber, expected.wavenumber, rtol=1e-9)
    np.testing.assert_allclose(found.value, expected.value, rtol=1e-9)
