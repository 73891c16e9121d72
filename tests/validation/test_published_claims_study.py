"""Claims of other flyers: the shipped results are those that the models give today."""

import json
from pathlib import Path

import numpy as np
import pytest

STUDY = Path(__file__).parents[2] / "studies" / "published_claims"


@pytest.fixture(scope="module")
def study(study_of):
    with study_of("published_claims", "sampling", "plates", "sandwiches", "hollow") as modules:
        yield modules


@pytest.fixture(scope="module")
def results():
    return json.loads((STUDY / "results.json").read_text("utf-8"))


def test_plate(study, results):
    plates = study["plates"]
    middle = study["sampling"].central(plates.GUESSES)
    today = plates.levitation(middle)[0]
    seen = np.isin(plates.AROUND, plates.OBSERVED)
    assert today[seen].min() == pytest.approx(results["plate"]["central"], rel=0.01)


def test_device(study, results):
    sandwiches = study["sandwiches"]
    middle = study["sampling"].central(sandwiches.DEVICE_GUESSES)
    today = sandwiches.device(middle, [sandwiches.BEST])[sandwiches.BEST][0]
    assert today == pytest.approx(results["device"]["central"], rel=0.01)


def test_kilogram(study, results):
    hollow = study["hollow"]
    middle = study["sampling"].central(hollow.GUESSES)
    today = hollow.kilogram(guesses=middle)[0]
    assert today == pytest.approx(results["kilogram"]["central"], rel=0.01)


def test_stratosphere_is_that_of_its_own_study(results):
    other = STUDY.parent / "outer_flow" / "results.json"
    claim = json.loads(other.read_text("utf-8"))["claim"]
    assert results["stratosphere"]["ratio"] == claim["over_needed"]


def test_middle_is_within_the_interval(results):
    for name in ("plate", "device", "kilogram"):
        ratio = results[name].get("by_model", {}).get("kinetic", results[name]["ratio"])
        assert ratio["low"] < results[name]["central"] < ratio["high"]


def test_samples_are_within_their_ranges(study):
    sampling = study["sampling"]
    guesses = {"plain": sampling.Guess(2.0, 4.0), "log": sampling.Guess(1e-4, 1e-2, True)}
    found = sampling.drawn(guesses, 256)
    assert found["plain"].mean() == pytest.approx(3.0, abs=0.01)
    assert np.log10(found["log"]).mean() == pytest.approx(-3.0, abs=0.01)
    assert 2.0 <= found["plain"].min() < 2.02
    assert 3.98 < found["plain"].max() <= 4.0
    assert sampling.interval(found["plain"])["low"] == pytest.approx(2.05, abs=0.02)
