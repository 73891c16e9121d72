"""The calculator's 95 % bands: those that the package gives for the same samples."""

import re
import tomllib

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.config.flyer_file import FlyerFile
from lightflyer.prediction.text import verdict_lines
from lightflyer.uncertainty.inputs import uncertain_inputs
from lightflyer.uncertainty.propagation import DEFAULT_SAMPLES
from lightflyer.uncertainty.targets import LOWER, UPPER, search_samples, tabulate_samples

from .conftest import tabulated

model = pytest.importorskip("calculator.model")
from calculator.kinds import KINDS  # noqa: E402

pytestmark = pytest.mark.slow  # all the files of the calculator are written

AGREEMENT = 1e-9
FEW = 100  # samples
PLACES = 21
CASES = [(kind, name) for kind in KINDS for name in model.force_models(kind)]
_CALLS = """
const { about } = lightflyerCore;
const { compute, draws } = lightflyerBands;
const given = (spreads, values) =>
  [{ ...lightflyerCore.defaults(), ...values }, { ...lightflyerCore.spreads(), ...spreads }];
const samples = (name, spreads, values) => [...draws(name, ...given(spreads, values))];
const finished = (name, values, spreads, places) => {
  const work = compute(name, values, spreads, places);
  for (;;) {
    const { done, value } = work.next();
    if (done) return value;
  }
};
const bands = (name, spreads, places) => finished(name, ...given(spreads), places);
const words = (name, spreads, values, places) => {
  const shown = given(spreads, values);
  const found = finished(name, ...shown, places);
  const { bands, profile, rest, flightWords, restWords } = lightflyerCore;
  const ranges = bands(name, shown[0], places, profile(name, shown[0], places));
  return [
    flightWords(ranges, places, found),
    restWords(shown[0], rest(name, shown[0], places, ranges), found),
  ];
};
const random = (count) => {
  const next = lightflyerBands.normals();
  return Array.from({ length: count }, next);
};
const file = (name, spreads, values) => lightflyerCore.flyerFile(name, ...given(spreads, values));
"""


@pytest.fixture(scope="module")
def run(calculator_files, run_javascript):
    """A function that makes calls for a kind, with as many samples as predict takes, or fewer."""

    def calls(kind, made, count=DEFAULT_SAMPLES):
        names = (f"model-{kind.name}", "core", "bands")
        texts = [(calculator_files / f"calculator-{one}.js").read_text("utf-8") for one in names]
        usual, fewer = (f'"samples": {one}' for one in (DEFAULT_SAMPLES, count))
        assert usual in texts[0]
        return run_javascript("".join(texts).replace(usual, fewer) + _CALLS, made)

    return calls


def stated(kind):
    """A ± of a fiftieth for TACs, payload and areal densities, in the shown units."""
    numbers = [model.described(one, kind) for one in kind.computed]
    return {
        one["name"]: 0.02 * one["default"]
        for one in numbers
        if one["name"].rpartition(".")[2] in ("tac_top", "tac_bottom", "payload", "areal_density")
    }


def places_of(kind, count=PLACES):
    low, high = kind.coordinate.low, kind.coordinate.high
    spaced = np.geomspace if kind.coordinate.logarithmic else np.linspace
    return spaced(low, high, count) * model.factor(kind.coordinate, kind)


def ends(values, *, endless):
    values = np.where(np.isfinite(values), values, np.inf) if endless else values
    values = values[~np.isnan(values) & (np.isfinite(values) | endless)]
    return [
        np.percentile(values, share, method=method)
        for share, method in ((2.5, "lower"), (97.5, "higher"))
    ]


def columns_of(kind, name, samples):
    names = (*(one.name for one in kind.computed), *model.uncertain(name, kind))
    return dict(zip(names, np.array(samples, float).T, strict=True))


@pytest.mark.parametrize(
    ("kind", "name"), CASES, ids=[f"{kind.name}-{name}" for kind, name in CASES]
)
def test_bands_are_those_of_the_package_for_the_same_samples(kind, name, run):
    spreads, place = stated(kind), float(places_of(kind)[PLACES // 2])
    calls = [("samples", (name, spreads)), ("bands", (name, spreads, [place]))]
    samples, found = run(kind, calls, FEW)
    columns = columns_of(kind, name, samples)
    setup = model.design(name, kind).build(columns)
    table = tabulated(setup, columns[kind.coordinate.name])
    assert found["samples"] == len(samples) == FEW
    mass, moved = float(np.max(setup.flyer.own_mass)), 0
    for output, band in found["here"].items():
        if output not in table:
            continue
        values = np.broadcast_to(np.asarray(table[output]), FEW)
        if band is None:
            assert not np.isfinite(values).any()
            continue
        expected = ends(values, endless=output == "levitation_irradiance")
        size = {"payload": mass, "relative_payload": 1.0}.get(output, 0.0)  # a difference
        band = [float("inf" if end is None else end) for end in band]
        np.testing.assert_allclose(band, expected, rtol=AGREEMENT, atol=AGREEMENT * size)
        moved += band[0] < band[1]
    assert moved >= 3
    (band,) = found["light"]
    light = np.asarray(tabulated(setup, np.full(FEW, place))["levitation_irradiance"])
    band = [float("inf" if end is None else end) for end in band]
    np.testing.assert_allclose(band, ends(light, endless=True), rtol=AGREEMENT)


@pytest.mark.parametrize("kind", [KINDS[0], KINDS[2]], ids=["disk", "chamber"])
def test_edges_and_shares_are_those_of_the_package_for_the_same_samples(kind, run):
    name, places = "kinetic", places_of(kind)
    calls = [("samples", (name, {})), ("bands", (name, {}, places.tolist()))]
    samples, found = run(kind, calls, FEW)
    inputs = uncertain_inputs(model.design(name, kind))
    columns = columns_of(kind, name, samples)
    drawn = np.stack([columns[one] for one in inputs.names], 1)
    wanted = (
        ("lift_over_weight", "payload", "temperature"),
        ("levitation_irradiance", "levitation_temperature"),
    )
    tables = [(places, tabulate_samples(inputs, drawn, places, names)) for names in wanted]
    searched = search_samples(inputs, drawn, tables)
    for mover, band in zip((LOWER, UPPER), found["edges"], strict=True):
        # the package takes an edge where lift over weight is within 1e-7 of one
        np.testing.assert_allclose(band, ends(searched[mover][0], endless=False), rtol=1e-5)
    assert found["flies"] == pytest.approx(np.isfinite(searched[LOWER][0]).mean(), abs=0.003)
    assert 0.2 < found["flies"] < 0.9
    if kind.coordinate.name == "altitude":
        rest = searched[UPPER][1]["temperature"]
        np.testing.assert_allclose(found["rest"], ends(rest, endless=False), rtol=1e-5)
        highest = float(inputs.design.setup.flyer.highest_temperature)
        assert found["survives"] == pytest.approx(np.mean(rest <= highest), abs=0.003)


def test_a_band_between_two_places_is_found(run):
    kind = KINDS[0]
    calls = [("bands", ("kinetic", {}, places_of(kind)[::step].tolist())) for step in (1, 2)]
    fine, coarse = (found["flies"] for found in run(kind, calls))
    assert coarse == pytest.approx(fine, abs=0.01)


def test_samples_are_normal_and_independent(run):
    kind, name = KINDS[0], "kinetic"
    (samples,) = run(kind, [("samples", (name, {"flyer.payload": 0.001}))])
    assert len(samples) == DEFAULT_SAMPLES
    columns = columns_of(kind, name, samples)
    errors = [columns[one] for one in model.uncertain(name, kind)]
    payload = (columns["flyer.payload"] / 1e-6 - 0.03) / 0.001
    drawn = np.array([*errors, payload])
    np.testing.assert_allclose(drawn.mean(1), 0.0, atol=0.1)
    np.testing.assert_allclose(np.cov(drawn), np.eye(len(drawn)), atol=0.15)
    for row in drawn:
        np.testing.assert_allclose(ends(row, endless=False), [-1.96, 1.96], atol=0.35)


@pytest.mark.parametrize("apart", [0.0, 0.001], ids=["one emittance", "an emittance a face"])
def test_errors_are_shared_as_in_the_downloaded_file(run, apart):
    kind, name = KINDS[0], "kinetic"
    spreads = {"film.emittance_top": 0.02, "film.emittance_bottom": 0.02 + apart}
    spreads |= {"film.tac_top": 0.01, "film.tac_bottom": 0.02}
    given = (name, spreads, {"film.tac_correlation": 0.9})
    samples, text = run(kind, [("samples", given), ("file", given)])
    inputs = uncertain_inputs(FlyerFile(**tomllib.loads(text)).design())
    columns = columns_of(kind, name, samples)
    columns["film.emittance"] = columns["film.emittance_top"]
    assert ("film.emittance" in inputs.names) == (apart == 0.0)
    is_one = np.array_equal(columns["film.emittance_top"], columns["film.emittance_bottom"])
    assert is_one == (apart == 0.0)
    drawn = np.stack([columns[one] for one in inputs.names])
    np.testing.assert_allclose(drawn.std(1), inputs.spreads, rtol=0.1)
    np.testing.assert_allclose(np.corrcoef(drawn), inputs.correlation, atol=0.25)


def test_impossible_samples_are_left_out(run):
    kind, name = KINDS[0], "kinetic"
    (samples,) = run(kind, [("samples", (name, {"film.tac_bottom": 0.2, "film.absorptance": 0.5}))])
    columns = columns_of(kind, name, samples)
    for number in ("film.tac_bottom", "film.absorptance"):
        assert 0.0 <= columns[number].min() < 0.5
        assert 0.9 < columns[number].max() <= 1.0


FLYERS = {  # kind, force model, ± and values that are not the template's
    "laden": (KINDS[0], "kinetic", {}, {}),
    "bare": (KINDS[0], "kinetic", {}, {"flyer.diameter": 2.0, "flyer.payload": 0.0}),
    "TACs": (KINDS[0], "lu2023", {"film.tac_top": 0.02, "film.tac_bottom": 0.02}, {}),
    "impossible draws": (KINDS[0], "kinetic", {"film.absorptance": 0.2}, {}),
    "grounded": (KINDS[0], "kinetic", {}, {"film.tac_top": 0.83}),
    "chamber": (
        KINDS[2],
        "lu2023",
        {"film.emittance_top": 0.01, "film.emittance_bottom": 0.01},
        {},
    ),
    "sandwich": (KINDS[3], "schafer2025", {}, {}),
}


@pytest.mark.snippets  # seconds
@pytest.mark.parametrize(("kind", "name", "spreads", "values"), FLYERS.values(), ids=FLYERS)
def test_it_says_what_predict_says(run, kind, name, spreads, values):
    given = (name, spreads, values)
    calls = [("words", (*given, places_of(kind, 161).tolist())), ("file", given)]
    (flight, rest), text = run(kind, calls)
    found = lf.predict(lf.FlyerFile(**tomllib.loads(text)).design())
    _, expected, *others = verdict_lines(found, found.uncertainty.bands, found.uncertainty.shares)
    if found.bands:
        assert flight == re.sub("; after .* in the dark it is below that", "", expected)
        assert rest in ("", others[0])
        assert (rest == "") == (kind.coordinate.name == "pressure")
    else:  # predict adds how much is lacking
        assert re.sub(" between .* km", "", flight) == f"{expected.partition(':')[0]}."


def test_random_numbers_are_those_of_predict(run):
    (found,) = run(KINDS[0], [("random", (100_000,))])
    np.testing.assert_allclose(found, np.random.default_rng(0).standard_normal(100_000), rtol=1e-9)


def test_nothing_uncertain_has_no_bands(run):
    (found,) = run(KINDS[0], [("bands", ("free-molecular", {}, [75e3]))])
    assert found is None
