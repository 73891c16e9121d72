"""Published experiments: each number has its source, and shipped results are today's."""

import importlib
import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

STUDY = Path(__file__).parents[2] / "studies" / "experiments"
NEAR = "walls at 4.5 cm"
SHOWN = ("open space", "floor at 4.5 cm, else 10 cm")  # surroundings on the page


@pytest.fixture(scope="module")
def study(study_of):
    names = ("measurements", "disks", "others", "estimates", "figure", "study")
    with study_of("experiments", *names) as modules:
        yield modules


@pytest.fixture(scope="module")
def paper(study):
    return study["measurements"].read()["lu2023"]


@pytest.fixture(scope="module")
def results():
    return json.loads((STUDY / "results.json").read_text("utf-8"))


def numbers(entry):
    """All entries of the file that are numbers."""
    if "kind" in entry:
        yield entry
        return
    for value in entry.values():
        if isinstance(value, dict):
            yield from numbers(value)


def test_each_number_has_a_kind_and_a_source(study):
    found = list(numbers(study["measurements"].read()))
    assert len(found) > 30
    for entry in found:
        assert entry["kind"] in {"printed", "derived", "assumed"}
        assert len(entry["source"]) > 5


@pytest.mark.parametrize(
    "entry",
    [
        {"value": 1.0, "kind": "printed"},
        {"value": 1.0, "source": "Table 1", "kind": "guessed"},
        {"low": 1.0, "source": "Table 1", "kind": "printed"},
        {"value": 1.0, "low": 0.0, "high": 1.0, "source": "Table 1", "kind": "printed"},
    ],
)
def test_a_number_without_them_is_refused(study, entry):
    with pytest.raises(ValueError, match="needs"):
        study["measurements"].number(entry)


def test_weighted_interval_is_that_of_the_weighted_distribution(study):
    """Uniform samples that are weighted as a normal distribution have its quantiles."""
    values = np.linspace(-8.0, 8.0, 20_001)
    found = study["measurements"].interval(values + 10.0, norm.pdf(values), digits=4)
    for name, share in (("low", 0.025), ("median", 0.5), ("high", 0.975)):
        assert found[name] == pytest.approx(10.0 + norm.ppf(share), abs=2e-3)
    endless = study["measurements"].interval(np.array([1.0, 2.0, np.inf]))
    assert endless == {"median": 2.0, "low": 1.0, "high": None}


def test_samples_follow_their_numbers(study):
    number = study["measurements"].number
    source = {"kind": "printed", "source": "Table 1"}
    share = np.array([0.1, 0.5, 0.9])
    assert number({"low": 2.0, "high": 4.0, **source}).at(share) == pytest.approx([2.2, 3.0, 3.8])
    clipped = number({"value": 1.0, "uncertainty": 0.1, "highest": 1.05, **source}).at(share)
    assert clipped == pytest.approx([1.0 - 0.1 * norm.ppf(0.9), 1.0, 1.05])


def test_samples_count_by_what_was_measured_of_the_2_cm_disks(study, paper):
    """The light of each film, apart from the scale of all light, within 5 % of lift-off."""
    one, high = math.exp(0.05), norm.cdf(1.0)  # a scale that is one standard deviation too high
    shares = {"light": np.array([0.5, 0.5, 0.5, high, 0.5])}
    germanium = 1500.0 * np.array([1.0, one, 1.0 / one, 1.05, np.inf])
    nanotubes = 1500.0 / 0.71 * np.array([1.0, 1.0, one, 1.05, 1.0])
    found = {("germanium", 2): (germanium,), ("nanotubes", 2): (nanotubes,)}
    expected = [1.0, math.exp(-0.5), math.exp(-1.0), 1.0, 0.0]
    assert study["disks"].likelihood(paper, found, shares) == pytest.approx(expected, rel=1e-3)


def test_verdicts(study, paper):
    """A bound is met from below, a measured value from both sides."""
    over = {"low": 0.5, "median": 0.7, "high": 0.9}
    names = [f"{film} {size} cm" for film in study["disks"].FILMS for size in (2, 3, 4)]
    missing = {
        "2": {"low": -0.1, "median": 0.1, "high": 0.2},
        "3": {"low": 0.1, "median": 0.2, "high": 0.3},
        "4": {"low": -0.1, "median": 0.2, "high": None},
    }
    found = {"over_measured": dict.fromkeys(names, over), "less_than_measured": missing}
    elsewhere = {"azadi2021": {"over_used": {"low": 1.1, "median": 2.0, "high": None}}}
    inside = study["study"].verdicts(found, paper, elsewhere, known=("germanium 2 cm",))
    wrong = {name for name, right in inside.items() if not right}
    assert wrong == {"nanotubes 2 cm", "reduction 3 cm", "azadi2021"}
    assert "germanium 2 cm" not in inside


def test_rods_keep_their_chords_in_the_dark(study):
    """Beside a count of points of the disk."""
    radius, width = 0.01, 1e-3
    rng = np.random.default_rng(2)
    x, y = rng.uniform(-radius, radius, (2, 200_000))
    inside = x * x + y * y < radius**2
    dark = np.abs(np.abs(x) - 0.5 * radius) < 0.5 * width
    counted = 1.0 - np.mean(dark[inside])
    assert study["disks"].lit_share(radius, width) == pytest.approx(counted, abs=3e-3)


def test_updraft_is_the_work_of_warm_gas_on_the_flow_of_a_moving_disk(study):
    """The integral of its page, with Stokes' drag 16 μ a U in the mean flow F/(6πμr)."""
    estimates = study["estimates"]
    pressure, temperature, excess, radius, wall = 10.0, 293.0, 200.0, 0.02, 0.15
    density = pressure / (287.05 * temperature)

    def share(r):
        warm = excess / temperature * (2.0 * radius / math.pi) / r * (1.0 - r / wall)
        moved = 16.0 * radius / (6.0 * math.pi * r) * (1.0 - r / wall) ** 2
        return density * 9.80665 * warm * moved * 4.0 * math.pi * r**2

    expected = quad(share, 0.0, wall)[0]
    found = estimates.updraft(pressure, temperature, excess, radius, wall)
    assert found == pytest.approx(expected, rel=1e-3)


def test_push_of_heat_is_the_moment_of_grads_distribution(study):
    """Momentum of the molecules that arrive at both faces, by quadrature over their velocities."""
    nodes, weights = np.polynomial.hermite.hermgauss(40)
    heat = 0.01  # over p √(2RT)
    axial, half = np.polynomial.legendre.leggauss(80)
    axial, half = 3.5 * (axial + 1.0), 3.5 * half  # away from a face
    x, y, z = np.meshgrid(nodes, nodes, axial, indexing="ij")
    share = np.einsum("i,j,k->ijk", weights, weights, half * np.exp(-(axial**2))) / math.pi**1.5
    grad = 0.8 * heat * z * (x * x + y * y + z * z - 2.5)
    arriving = 2.0 * np.sum(share * z**2 * grad)  # over p; at the other face its opposite
    expected = 2.0 * arriving * (1.0 + 0.2)  # with what is reflected
    air = importlib.import_module("lightflyer.gas").AIR
    speed = math.sqrt(2.0 * 287.05 * 300.0)
    pressure = float(air.conductivity(300.0)) * 50.0 / (heat * speed)
    found = study["estimates"].thermophoresis(300.0, 50.0, 0.8) / pressure
    assert found == pytest.approx(expected, rel=1e-3)


def test_shipped_results_are_todays(study, paper, results):
    """Near walls, for the middle of all samples."""
    study_of = study["study"]
    today = study_of.at_the_middle(paper, study_of.with_walls(study["disks"].Terms(), NEAR))
    then = results["middle"][NEAR]
    for name, place in today["disks"].items():
        assert place["light"] == pytest.approx(then["disks"][name]["light"], rel=0.02)
    assert today["reductions"] == pytest.approx(then["reductions"], abs=0.01)


def test_page_has_the_results(results):
    """Numbers of the page are those of the study."""
    page = (STUDY.parents[1] / "docs" / "experiments.md").read_text("utf-8")
    for found in (results["middle"][name] for name in SHOWN):
        for place in found["disks"].values():
            assert f"{place['light']} ({place['temperature']} K)" in page
    for when in ("before", "given_2_cm"):
        for verdicts in (results["inside"][name][when] for name in SHOWN):
            assert f"{sum(verdicts.values())} of {len(verdicts)}" in page
    bands = results["bands"][SHOWN[1]]["before"]["reductions"]["2"]
    assert f"from −{-100 * bands['low']:.0f} to {100 * bands['high']:.0f} %" in page
    for apart in ("as it is", "nanotubes' faces 0.25 apart", "nanotubes' faces 0.29 apart"):
        plain = results["terms"][apart][SHOWN[1]]["plain"]["reductions"].values()
        saved = ", ".join(f"{100 * one:.0f}".replace("-", "−") for one in plain)
        assert saved in " ".join(page.split())
