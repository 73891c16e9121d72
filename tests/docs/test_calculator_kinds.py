"""The calculator of every kind of flyer: JavaScript gives what the package gives."""

import re
import tomllib

import numpy as np
import pytest

from lightflyer.config.flyer_file import FlyerFile

from .conftest import require_outputs, tabulated

model = pytest.importorskip("calculator.model")
from calculator.kinds import KINDS  # noqa: E402
from calculator.page import html  # noqa: E402

pytestmark = pytest.mark.slow  # all the files of the calculator are written

RANDOM = 40
AGREEMENT = 1e-10
OTHERS = [kind for kind in KINDS if kind is not model.DISK]
CASES = [(kind, name) for kind in OTHERS for name in model.force_models(kind)]
NAMES = [f"{kind.name}-{name}" for kind, name in CASES]

_CALLS = """
const { about, defaults, flyerFile } = lightflyerCore;
const names = about.numbers.filter((number) => number.computed).map((number) => number.name);
const named = (row) =>
  ({ ...defaults(), ...Object.fromEntries(names.map((name, at) => [name, row[at]])) });
const others = (name) => about.models[name].uncertain.map(({ value }) => value);
const table = (name, rows) =>
  rows.map((row) => lightflyerModel.functions[name].evaluate(...row, ...others(name)));
const file = (name, row, spreads) => flyerFile(name, named(row), spreads);
"""


def designs(kind, rng):
    """Random designs in the shown units: each number within a factor of two, or in its range."""
    start = np.array([model.described(one, kind)["default"] for one in kind.computed])
    low, high = np.array([(one.low, one.high) for one in kind.computed]).T
    rows = start * 2.0 ** rng.uniform(-1.0, 1.0, (RANDOM, start.size))
    rows = np.clip(np.where(rng.random(rows.shape) < 0.5, start, rows), low, high)
    names = [one.name for one in kind.computed]
    for part in {name.rpartition(".")[0] for name in names if name.endswith(".transmittance")}:
        through, absorbed = (
            names.index(f"{part}.{key}") for key in ("transmittance", "absorptance")
        )
        rows[:, through] = np.minimum(rows[:, through], 1.0 - rows[:, absorbed])
    if "flyer.outlet_diameter" in names:  # within its body
        outlet, body = names.index("flyer.outlet_diameter"), names.index("flyer.size")
        rows[:, outlet] = np.minimum(rows[:, outlet], 0.9 * rows[:, body])
    rows[0] = start
    return rows


def si(kind, rows):
    return rows * np.array([model.factor(one, kind) for one in kind.computed])


@pytest.fixture(scope="module")
def scripts(calculator_files):
    core = (calculator_files / "calculator-core.js").read_text("utf-8")
    return {
        kind.name: (calculator_files / f"calculator-model-{kind.name}.js").read_text("utf-8") + core
        for kind in KINDS
    }


@pytest.mark.parametrize(("kind", "name"), CASES, ids=NAMES)
def test_javascript_gives_what_the_package_gives(kind, name, scripts, run_javascript):
    rows = si(kind, designs(kind, np.random.default_rng(1873)))
    (found,) = run_javascript(scripts[kind.name] + _CALLS, [("table", (name, rows.tolist()))])
    named = {one.name: row for one, row in zip(kind.computed, rows.T, strict=True)}
    setup = model.design(name, kind).build(named)
    expected = tabulated(setup, named[kind.coordinate.name])
    assert np.isfinite(np.asarray(expected["lift_over_weight"])).mean() > 0.9
    require_outputs(found, expected, AGREEMENT)


@pytest.mark.parametrize("kind", KINDS, ids=[kind.name for kind in KINDS])
def test_a_downloaded_file_is_the_design_shown(kind, scripts, run_javascript):
    """Its numbers, and a ± of a fiftieth of TACs, payload and areal densities."""
    row = designs(kind, np.random.default_rng(5))[1]
    spreads = {
        one.name: 0.02 * value
        for one, value in zip(kind.computed, row, strict=True)
        if one.name.rpartition(".")[2] in ("tac_top", "tac_bottom", "payload", "areal_density")
    }
    calls = [("file", (name, row.tolist(), spreads)) for name in model.force_models(kind)]
    for text in run_javascript(scripts[kind.name] + _CALLS, calls):
        design = FlyerFile(**tomllib.loads(text)).design()
        for number, value in zip(kind.computed, si(kind, row), strict=True):
            if number is not kind.coordinate:
                assert design.number(number.name) == pytest.approx(value, rel=1e-14, abs=0.0)
            expected = spreads.get(number.name, 0.0) * model.factor(number, kind)
            found = design.uncertainties.get(number.name, 0.0)
            assert found == pytest.approx(expected, rel=1e-12)
        if kind.coordinate.name == "altitude":
            (altitude,) = re.findall(r'--at "(\S+) km"', text)
            assert float(altitude) == row[kind.computed.index(kind.coordinate)]


@pytest.mark.parametrize("kind", OTHERS, ids=[kind.name for kind in OTHERS])
def test_every_label_is_its_own(kind):
    labels = [number.label for number in kind.numbers]
    assert len(set(labels)) == len(labels)
    assert f'data-kind="{kind.name}"' in html(kind.name)
