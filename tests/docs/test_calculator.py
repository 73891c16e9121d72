"""The calculator of the pages: JavaScript gives what the package gives."""

import re

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import read_design
from lightflyer.design.diagnostics import diagnose_at, diagnose_force

from .conftest import require_outputs, tabulated

model = pytest.importorskip("calculator.model")
from calculator.kinds import KINDS  # noqa: E402
from calculator.page import html  # noqa: E402

pytestmark = pytest.mark.slow  # all the files of the calculator are written

MODELS = model.force_models()
RANDOM = 250  # designs of each force model
SLOPED = 6  # of them, whose slopes are compared
STEP = 1e-6  # of a number, over its size
AGREEMENT = 1e-10
LARGEST = 250e3  # bytes of all that a page loads
ALTITUDE = next(i for i, number in enumerate(model.COMPUTED) if number.name == "altitude")


def _si(shown):
    return shown * np.array([model.factor(number) for number in model.COMPUTED])


def _random_designs(rng):
    """Numbers of every kind, over the sliders' ranges; most designs fly somewhere."""
    shares = rng.random((RANDOM, len(model.COMPUTED)))
    names = [number.name for number in model.COMPUTED]
    shares[:, names.index("flyer.payload")] **= 12
    tacs = [names.index("film.tac_top"), names.index("film.tac_bottom")]
    upward = rng.random(RANDOM) < 0.9
    shares[np.ix_(upward, tacs)] = np.sort(shares[np.ix_(upward, tacs)], 1)
    columns = [
        number.low * (number.high / number.low) ** share
        if number.logarithmic
        else number.low + (number.high - number.low) * share
        for number, share in zip(model.COMPUTED, shares.T, strict=True)
    ]
    rows = np.stack(columns, 1)
    # a slope needs neighbours on both sides
    low, high = np.array([(number.low, number.high) for number in model.COMPUTED]).T
    rows[:SLOPED] = np.clip(rows[:SLOPED], low + 1e-3 * (high - low), high - 1e-3 * (high - low))
    return rows


def _edges():
    """One number at a time at the ends of its range, and cases that end a search early."""
    start = np.array([entry["default"] for entry in _entries()])
    names = [number.name for number in model.COMPUTED]
    rows = []

    def changed(**numbers):
        row = start.copy()
        for name, value in numbers.items():
            row[names.index(name.replace("__", "."))] = value
        rows.append(row)

    for number in model.COMPUTED:
        for end in (number.low, number.high):
            changed(**{number.name: end})
    changed(film__tac_top=0.9)  # no force
    changed(film__tac_top=0.95)  # downward
    changed(film__absorptance=0.0)  # no light is absorbed
    changed(environment__irradiance=0.0, environment__infrared_bottom=0.0)  # nothing to absorb
    changed(environment__incidence=90.0)
    changed(flyer__payload=1e6)
    changed(film__areal_density=1e-4, environment__infrared_bottom=400.0)  # flies in the dark
    for altitude in (0.0, 11.0, 20.0, 47.0, 85.999, 86.0, 91.0, 110.0, 150.0):
        changed(altitude=altitude)
    changed()
    return np.array(rows)


def _entries():
    return [model.described(number) for number in model.COMPUTED]


def _nudged(shown):
    """Each number of some designs a little smaller and larger."""
    size = np.maximum(np.abs(shown), [0.1 * number.high for number in model.COMPUTED])
    step = STEP * size[:, None, :] * np.eye(shown.shape[1])
    return np.stack([shown[:, None, :] - step, shown[:, None, :] + step], 2), np.diagonal(
        step, axis1=1, axis2=2
    )


@pytest.fixture(scope="module")
def script(calculator_files):
    """The scripts that need no page."""
    names = ("calculator-model-disk.js", "calculator-core.js")
    return "".join((calculator_files / name).read_text(encoding="utf-8") for name in names)


@pytest.fixture(scope="module")
def designs():
    """Designs of each force model, in the shown units: random ones, then edges."""
    seed = 1887  # Crookes' radiometer is older, Reynolds' theory not much
    rows = np.vstack([_random_designs(np.random.default_rng(seed)), _edges()])
    return dict.fromkeys(MODELS, rows)


_CALLS = """
const { about, bands, defaults, elasticities, evaluate, flyerFile, profile, rest } = lightflyerCore;
const names = about.numbers.filter((number) => number.computed).map((number) => number.name);
const named = (row) =>
  ({ ...defaults(), ...Object.fromEntries(names.map((name, at) => [name, row[at]])) });
const altitudes = Array.from({ length: 161 }, (_, at) => 20e3 + 625 * at);
const whole = (name, row) =>
  [...row, ...about.models[name].uncertain.map(({ value }) => value)];
const calls = {
  table: (name, rows) =>
    rows.map((row) => lightflyerModel.functions[name].evaluate(...whole(name, row))),
  slopes: (name, rows) =>
    rows.map((row) => {
      const light = evaluate(name, named(row)).levitation_irradiance;
      const found = elasticities(name, named(row), light);
      return names.map((name) => found.find(({ number }) => number.name === name)?.value ?? 0);
    }),
  warnings: (name, rows) => rows.map((row) => evaluate(name, named(row)).warnings),
  files: (name, rows) => rows.map((row) => flyerFile(name, named(row))),
  bands: (name, [row]) =>
    bands(name, named(row), altitudes, profile(name, named(row), altitudes)),
  rest: (name, [row]) => rest(name, named(row), altitudes, calls.bands(name, [row])),
};
"""


@pytest.fixture(scope="module")
def computed(script, designs, run_javascript):
    """All that JavaScript computes, in one process."""
    calls = {}
    for name, rows in designs.items():
        calls[name, "table"] = _si(rows)
        calls[name, "slopes"] = rows[:SLOPED]
        calls[name, "warnings"] = rows
        calls[name, "files"] = rows[-1:]
        calls[name, "bands"] = calls[name, "rest"] = rows[-1:]
    found = run_javascript(
        script + _CALLS,
        [(f"calls.{kind}", (name, rows.tolist())) for (name, kind), rows in calls.items()],
    )
    return dict(zip(calls, found, strict=True))


@pytest.fixture(scope="module")
def expected(designs):
    """What the package computes: its own tables, of all designs at once."""
    found = {}
    for name in MODELS:
        nudged, _ = _nudged(designs[name][:SLOPED])
        rows = _si(np.vstack([designs[name], nudged.reshape(-1, len(model.COMPUTED))]))
        named = {number.name: row for number, row in zip(model.COMPUTED, rows.T, strict=True)}
        setup = model.design(name).build(named)
        found[name] = tabulated(setup, rows[:, ALTITUDE])
    return found


def _first(table, count):
    return {name: np.asarray(column)[:count] for name, column in table.items()}


@pytest.mark.parametrize("name", MODELS)
def test_javascript_gives_what_the_package_gives(name, computed, expected, designs):
    table = _first(expected[name], len(designs[name]))
    require_outputs(computed[name, "table"], table, AGREEMENT)
    converged = [row[len(model.SHOWN)] for row in computed[name, "table"]]
    np.testing.assert_array_equal(converged, table["converged"] > 0.5)


def test_designs_are_of_every_kind(expected):
    for name in MODELS:
        light = np.asarray(expected[name]["levitation_irradiance"])
        ratio = np.asarray(expected[name]["lift_over_weight"])
        assert np.isinf(light).any()
        assert (light == 0.0).any()
        assert (ratio > 1.0).any()
        assert (ratio < 0.0).any()
        assert np.mean(np.isfinite(light)[:RANDOM]) > 0.3


def test_a_formula_that_is_off_by_a_billionth_is_seen(script, designs, expected, run_javascript):
    name, rows = MODELS[0], designs[MODELS[0]][:50]
    power = re.search(r"5\.67037\d*e-8", script)
    assert power is not None
    changed = script.replace(power[0], repr(float(power[0]) * (1.0 + 1e-9)))
    (found,) = run_javascript(changed + _CALLS, [("calls.table", (name, _si(rows).tolist()))])
    with pytest.raises(AssertionError, match="levitation_irradiance"):
        require_outputs(found, _first(expected[name], len(rows)), AGREEMENT)


@pytest.mark.parametrize("name", MODELS)
def test_slopes_are_those_of_the_results(name, computed, expected, designs):
    _, steps = _nudged(designs[name][:SLOPED])
    shape = (SLOPED, len(model.COMPUTED), 2)
    light = np.asarray(expected[name]["levitation_irradiance"])[len(designs[name]) :].reshape(shape)
    with np.errstate(invalid="ignore"):  # where no light suffices
        differences = (light[..., 1] - light[..., 0]) / (2.0 * _si(steps))
    middle = np.asarray(expected[name]["levitation_irradiance"])[:SLOPED, None]
    with np.errstate(invalid="ignore"):
        expected_change = differences * _si(designs[name][:SLOPED]) / middle
    found = np.array(computed[name, "slopes"], float)
    compared = np.isfinite(expected_change)
    compared[:, ALTITUDE] = False  # not shown
    assert compared.sum() > len(model.COMPUTED)
    off = np.abs(found[compared] - expected_change[compared])
    # three digits are shown, of what is more than rounding
    assert (off <= 1e-5 * np.abs(expected_change[compared]) + 1e-6).all()


@pytest.mark.parametrize("name", MODELS)
def test_warnings_are_those_of_the_package(name, computed, expected, designs):
    table, kinds = expected[name], set()
    for index, row in enumerate(designs[name][:: RANDOM // 25]):
        index *= RANDOM // 25
        number_of = {one.name: x for one, x in zip(model.COMPUTED, _si(row), strict=True)}
        setup = model.design(name).build(number_of)
        hot = np.atleast_1d(table["temperature"][index])
        told = {*diagnose_at(setup, _si(row)[ALTITUDE : ALTITUDE + 1], hot)}
        lift = table["lift"][index : index + 1]
        if lift[0] <= 0.0:
            told |= {*diagnose_force(setup.flyer, {"lift": lift})}
        assert set(computed[name, "warnings"][index]) == told
        kinds |= {text.split(" is ")[0] for text in told}
    assert len(kinds) > 1


@pytest.mark.snippets  # seconds
def test_predict_reproduces_a_downloaded_file(computed, designs, tmp_path):
    name = MODELS[0]
    file = tmp_path / "flyer.toml"
    file.write_text(computed[name, "files"][-1], encoding="utf-8")
    predicted = lf.predict(file, at=[designs[name][-1, ALTITUDE] * 1e3])
    shown = dict(zip(model.SHOWN, computed[name, "table"][-1], strict=False))
    for output in ("levitation_irradiance", "temperature", "lift_over_weight"):
        assert predicted.at[output][0] == pytest.approx(float(shown[output]), rel=AGREEMENT)
    np.testing.assert_allclose(computed[name, "bands"], predicted.bands, rtol=1e-9)
    rest, found = computed[name, "rest"], predicted.verdict.rest
    assert rest["altitude"] == pytest.approx(found.coordinate, rel=1e-9)
    assert rest["temperature"] == pytest.approx(found.values["temperature"], rel=1e-7)


def test_the_start_is_the_file_of_init(tmp_path):
    file = tmp_path / "flyer.toml"
    file.write_text(templates()["laden"].read(), encoding="utf-8")
    start, ours = read_design(file), model.design(MODELS[0])
    assert start.setup.model == ours.setup.model
    assert start.setup.flyer == ours.setup.flyer
    split = {"film.emittance", "film.emittance_top", "film.emittance_bottom"}
    assert start.number("film.emittance") == ours.number("film.emittance_top")
    assert start.number("film.emittance") == ours.number("film.emittance_bottom")
    for name in start.fields.keys() - split:
        assert start.number(name) == ours.number(name)


def test_the_page_is_safe_and_labelled(calculator_files):
    page = html()
    assert not re.search(r"<script|<style|\son\w+=|\sstyle=|javascript:", page)
    labels = set(re.findall(r'<label for="([^"]+)"', page))
    inputs = re.findall(r"<(?:input|select)[^>]*>", page)
    assert len(inputs) == 2 * len(model.NUMBERS) + 3  # presets, force models, bands
    for text in inputs:
        assert "aria-label" in text or re.search(r'\bid="([^"]+)"', text)[1] in labels
    scripts = "".join(file.read_text(encoding="utf-8") for file in calculator_files.glob("*.js"))
    unsafe = r"\beval\(|new Function|innerHTML|document\.write|fetch\(|XMLHttpRequest"
    assert not re.search(unsafe, scripts)
    assert set(re.findall(r"https?://[^\s\"']*", scripts)) == {"http://www.w3.org/2000/svg"}


def test_all_that_a_page_loads_is_small(calculator_files):
    sizes = {file.name: file.stat().st_size for file in calculator_files.iterdir()}
    models = [sizes.pop(name) for name in list(sizes) if name.startswith("calculator-model-")]
    assert len(models) == len(KINDS)
    assert max(models) + sum(sizes.values()) + len(html()) < LARGEST
