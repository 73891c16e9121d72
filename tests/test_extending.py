"""The page *Extending lightflyer*, and the package that it makes, installed from its wheel."""

import importlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf

ROOT = Path(__file__).parents[1]
PLUGIN = ROOT / "examples" / "plugin"
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.S | re.M)
RING_FILE = re.search(r"^```toml\n(.*?)^```", PAGE, re.S | re.M)[1]
CHAMBER_FILE = """
[flyer]
diameter = "2 cm"
[film]
tac_top = 0.8
tac_bottom = 0.9
[[film.layers]]
material = "soot"
thickness = "1 um"
[environment]
kind = "chamber"
gas = "GAS"
temperature = "300 K"
[force]
model = "free-molecular"
"""


@pytest.fixture(scope="module")
def page():
    """What the blocks of the page define; the package is afterwards as it was."""
    names, bases = {"__name__": "page"}, (
        lf.flyer.FlyerSection, lf.force.ForceSection, lf.environment.EnvironmentSection
    )  # fmt: skip
    importlib.import_module("lightflyer.config.flyer_file")  # finds ours, which are to stay
    with pytest.MonkeyPatch.context() as patch:
        for base in bases:
            patch.setattr(base, "alternatives", dict(base.alternatives))
        patch.delitem(lf.gas.GASES, "krypton", raising=False)
        patch.delitem(lf.film.MEDIA, "soot", raising=False)
        for block in BLOCKS:
            exec(compile(block, "extending.md", "exec"), names)
        yield names
        lf.lab.SPECTRUM_FORMATS.pop()
        del lf.gas.GASES["krypton"], lf.film.MEDIA["soot"]


def test_the_page_is_the_module():
    shown = "\n\n\n".join(block.strip("\n") for block in BLOCKS[:-1])
    assert shown + "\n" == (PLUGIN / "lightflyer_ring.py").read_text(encoding="utf-8")
    declared = re.search(r"^```text\n(.*?)^```", PAGE, re.S | re.M)[1]
    assert declared in (PLUGIN / "pyproject.toml").read_text(encoding="utf-8")


def test_the_ring_is_in_balance_by_equations_written_anew(page):
    ring, state, model = page["ring"], page["titan"].state(400e3), page["ThinGas"]()
    found = lf.equilibrium(ring, state, model)
    area = np.pi * (0.01**2 - 0.004**2)
    mean_speed = np.sqrt(8.0 * 296.8 * 170.0 / np.pi)
    black = 5.670374419e-8 * 170.0**4

    def missing(excess):  # power per area
        sun, seen = 14.8, (2574.7 / 2974.7) ** 2
        light = 0.9 * sun * (1.0 + 0.265 * seen)
        heat = 0.05 * (0.0 + 2.83 * seen) - 0.05 * 2.0 * black * (1.0 + excess) ** 4
        gas = 2.0 * 0.675 * (6.0 / 8.0) * mean_speed * float(state.pressure) * excess
        return light + heat - gas

    excess = brentq(missing, 0.0, 3.0, xtol=1e-14)
    assert found.temperature / 170.0 - 1.0 == pytest.approx(excess, rel=2e-3)  # rounded constants
    force = 0.5 * float(state.pressure) * area * (
        np.sqrt(1.0 + 0.95 * excess) - np.sqrt(1.0 + 0.4 * excess)
    )  # fmt: skip
    assert lf.lift(ring, state, model) == pytest.approx(force, rel=2e-3)


def test_the_numbers_on_the_page(page):
    least = lf.levitate(page["ring"], page["titan"].state(400e3), page["ThinGas"]()).irradiance
    assert f"{least:.2f} W/m²" in PAGE
    payloads = ", ".join(f"{1e6 * mass:.3g} mg" for mass in page["table"].payload.values.ravel())
    assert f"# {payloads}\n" in PAGE
    assert page["ring"].own_mass == pytest.approx(2e-5 * np.pi * 8.4e-5, rel=1e-12)
    with pytest.raises(lf.ParameterError, match="inner must be smaller than outer"):
        page["Ring"](page["film"], outer=0.01, inner=0.02)


def test_gas_material_and_format_are_known_by_their_names(page, tmp_path):
    gas = lf.gas.GASES["krypton"]
    assert gas.viscosity(300.0) == pytest.approx(25.6e-6, rel=0.01)  # CRC Handbook
    file = tmp_path / "flyer.toml"
    file.write_text(CHAMBER_FILE.replace("GAS", "krypton"))
    setup = lf.read_flyer_file(file).build()
    assert setup.environment.gas is gas
    assert setup.flyer.film.areal_density == pytest.approx(1.8e-3, rel=1e-12)
    file.write_text(CHAMBER_FILE.replace("GAS", "kripton"))
    with pytest.raises(lf.ConfigurationError, match='"kripton" is unknown; did you mean "krypton"'):
        lf.read_flyer_file(file)
    assert "soot" in lf.film.material_names()
    (tmp_path / "film.dat").write_text("OUR LAMP 3000\n400 12.5\n800 50\n")
    spectrum = lf.lab.read_spectrum(tmp_path / "film.dat")
    assert spectrum.quantity == "transmittance"
    np.testing.assert_allclose(sorted(spectrum.value), [0.125, 0.5], rtol=1e-12)
    np.testing.assert_allclose(sorted(spectrum.wavelength), [400e-9, 800e-9], rtol=1e-12)


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    """Run lightflyer in a process that has the package, and a broken one, installed."""
    folder = tmp_path_factory.mktemp("site")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--target", str(folder)]
    subprocess.run([*pip, *offline, str(PLUGIN)], check=True)
    (folder / "broken.py").write_text('raise ZeroDivisionError("no\\nreason")\n')
    about = folder / "broken-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[lightflyer]\nbroken = broken\nbreak = broken:run\n")
    (folder / "ring.toml").write_text(RING_FILE)
    paths = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]

    def run(*words):
        return subprocess.run(
            [sys.executable, "-m", "lightflyer", *words],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


BROKEN = (
    "lightflyer: warning: plug-in broken (broken) cannot be imported and is left out:\n"
    "ZeroDivisionError: no reason\n"
)


def test_predict_knows_an_installed_package_and_warns_once_of_a_broken_one(command):
    done = command("predict", "ring.toml", "--json")
    assert done.stderr == BROKEN
    found = json.loads(done.stdout)
    assert found["assumptions"][0].startswith("light: 14.8 W/m²")


def test_its_command_is_one_of_ours(command):
    done = command("weigh", "ring.toml")
    assert (done.stdout, done.stderr) == ("ring of 2 cm: 0.005 mg\n", BROKEN)
    assert "ring of 2 cm: 0.005 mg" in PAGE
    listed = command("--help")
    assert re.search(r"weigh +Weigh a flyer", listed.stdout)
    assert listed.stderr == ""


def test_a_broken_command_is_named(command):
    done = command("break")
    assert done.returncode == 2
    warning, _, error = " ".join(done.stderr.split()).partition(" lightflyer: error")
    broken = " ".join(BROKEN.split())
    assert warning == broken.replace("broken (broken)", "break (broken:run)")
    assert 'Unknown command "break"' in error


def test_commands_of_one_broken_module_are_no_traceback(tmp_path):
    about = tmp_path / "lf_twice-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: lf-twice\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[lightflyer]\none = lf_twice:one\nother = lf_twice:other\n"
    )
    (tmp_path / "lf_twice.py").write_text("raise TypeError('boom')\n")
    paths = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-m", "lightflyer", "one"],
        env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    warning, _, error = " ".join(done.stderr.split()).partition(" lightflyer: error")
    assert "plug-in one (lf_twice:one) cannot be imported" in warning
    assert 'Unknown command "one"' in error


def test_other_commands_warn_of_it_too(command):
    done = command("materials", "--search", "soot", "--json")
    assert done.stderr == BROKEN
    assert json.loads(done.stdout)["materials"][0]["name"] == "soot"
