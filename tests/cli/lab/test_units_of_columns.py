"""The unit of a column changes no result, where its numbers are scaled and the unit is named."""

import json
import math
import re
import shlex
from decimal import Decimal

import pytest

from lightflyer.cli.commands.init import templates

NUMBER = re.compile(r"-?\d+(\.\d+)?")
ZERO = Decimal("273.15")
# New unit of a column, and what its numbers are multiplied by, or raised by, all exact in decimals
MILLI, CENTI, PER_CENT = Decimal(1000), Decimal(100), Decimal("0.01")
COMMANDS = {
    "lab tac": ("tac-raw.csv --calibration tac-resistance.csv", {
        "tac-raw.csv": {
            "time [s]": ("ms", MILLI), "pressure [mTorr]": ("Torr", 1 / MILLI),
            "heater_voltage [V]": ("mV", MILLI), "heater_current [mA]": ("A", 1 / MILLI),
            "ambient_temperature [°C]": ("K", ZERO),
        },
        "tac-resistance.csv": {
            "temperature [°C]": ("K", ZERO), "resistance [ohm]": ("mohm", MILLI),
        },
    }),
    "lab tac ": ("tac-reduced.txt", {
        "tac-reduced.txt": {
            "Pressure (Pa)": ("hPa", 1 / CENTI), "Heater Power (mW)": ("W", 1 / MILLI),
            "Heater Temperature (°C)": ("K", ZERO), "Ambient Temperature (°C)": ("K", ZERO),
        },
    }),
    "lab levitation": ("levitation.csv --draws 100", {
        "levitation.csv": {
            "pressure [mTorr]": ("Torr", 1 / MILLI), "irradiance [kW/m^2]": ("mW/cm^2", CENTI),
        },
    }),
    "lab levitation ": ("launchpads.csv --draws 100", {
        "launchpads.csv": {
            "Diameter (mm)": ("cm", Decimal("0.1")), "Floor gap (mm)": ("um", MILLI),
            "Pressure (Pa)": ("kPa", 1 / MILLI), "Irradiance (W/m2)": ("kW/m2", 1 / MILLI),
        },
    }),
    "lab thermography": ("thermal.csv --band '7.5-14 um' --accuracy '0.5 K' --draws 1000", {
        "thermal.csv": {
            "Hotplate temperature (°C)": ("K", ZERO), "Lower temperature (°C)": ("K", ZERO),
            "Upper temperature (°C)": ("K", ZERO), "Ambient temperature (°C)": ("K", ZERO),
        },
    }),
    "lab ftir": ("film.csv --reflectance film-reflectance.csv", {
        "film.csv": {"Wavelength (µm)": ("nm", MILLI), "Transmittance (%)": ("1", PER_CENT)},
        "film-reflectance.csv": {"cm-1": ("m-1", CENTI), "reflectance": ("%", CENTI)},
    }),
    "lab optics": ("sample.toml --starts 1", {
        "visible-transmittance.csv": {
            "wavelength [nm]": ("um", 1 / MILLI), "transmittance [%]": ("1", PER_CENT),
        },
        "infrared-transmittance.csv": {"wavenumber [cm^-1]": ("m^-1", CENTI)},
    }),
    "lab thermography ": ("thermal.csv --band camera.csv --accuracy '0.5 K' --draws 1000", {
        "camera.csv": {"wavelength [um]": ("nm", MILLI)},
    }),
    "lab thermography  ": ("light-meter.csv --light-meter --draws 1000", {
        "light-meter.csv": dict.fromkeys(
            ("incident", "reflected", "transmitted", "dark"), ("mW/m^2", MILLI)
        ),
    }),
    "calibrate": ("points.csv", {
        "points.csv": {
            "pressure [mTorr]": ("Torr", 1 / MILLI), "irradiance [W/m^2]": ("kW/m^2", 1 / MILLI),
            "irradiance_uncertainty [W/m^2]": ("kW/m^2", 1 / MILLI),
            "diameter [cm]": ("mm", Decimal(10)), "floor_gap [mm]": ("cm", Decimal("0.1")),
        },
    }),
    "lab tac  ": ("tac-reduced.txt --gauge gauge.csv", {
        "gauge.csv": {"shown [Pa]": ("hPa", 1 / CENTI), "pressure [Pa]": ("kPa", 1 / MILLI)},
    }),
    "lab optics ": ("angles.toml --starts 1", {
        "psi-delta.csv": {"photon_energy [eV]": ("meV", MILLI), "psi [deg]": ("mdeg", MILLI),
                          "delta [deg]": ("mdeg", MILLI), "incidence [deg]": ("mdeg", MILLI)},
    }),
    "film ": ("lines.toml", {
        "permittivity.csv": {"wavenumber [cm^-1]": ("m^-1", CENTI)},
        "energies.csv": {"photon_energy [eV]": ("meV", MILLI)},
        "frequencies.csv": {"frequency [THz]": ("GHz", MILLI)},
    }),
    "film": ("film.toml", {
        "index.csv": {"wavelength [um]": ("nm", MILLI)},
        "lamp.csv": {"wavelength [nm]": ("um", 1 / MILLI)},
    }),
}  # fmt: skip
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


def in_other_unit(text, column, unit, size):
    """A table with a column in another unit, its numbers exact; a size of 273.15 is added."""
    lines = text.lstrip("\N{ZERO WIDTH NO-BREAK SPACE}").splitlines()
    mark = ";" if any(";" in line and column in line for line in lines) else ","
    head = next(n for n, line in enumerate(lines) if column in line.split(mark))
    names = lines[head].split(mark)
    place = names.index(column)
    bare = column.partition(" (")[0].partition(" [")[0]
    names[place] = f"{'wavenumber' if bare == 'cm-1' else bare} [{unit}]"
    lines[head] = mark.join(names)
    for row in range(head + 1, len(lines)):
        cells = lines[row].split(mark)
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
        words = command.split()
        folder = examples(words[-1] if words[0] == "lab" else "tac")
        for name, text in OTHER_FILES.items():
            (folder / name).write_text(text, encoding="utf-8")
        arguments, files = COMMANDS[command]
        for file, columns in files.items() if changed else ():
            text = (folder / file).read_text(encoding="utf-8")
            for column, (unit, size) in columns.items():
                text = in_other_unit(text, column, unit, size)
            (folder / file).write_text(text, encoding="utf-8")
        out = prints(*words, *shlex.split(arguments), "--json")
        return dict(numbers_in(json.loads(out)))

    return numbers


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_columns_in_other_units_change_no_result(reduced, command):
    expected, found = reduced(command, changed=False), reduced(command, changed=True)
    assert found.keys() == expected.keys()
    for place, value in expected.items():
        assert math.isclose(found[place], value, rel_tol=1e-5, abs_tol=1e-9), place
