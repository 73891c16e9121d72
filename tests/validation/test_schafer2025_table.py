"""The smooth functions beside the table they are fitted to, and both beside simulations."""

import csv
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from kinetic_fits.perforated import fit, perforated_disk_table

import lightflyer as lf
from lightflyer.force.membranes.sandwich import perforated_disk_fit

PUBLISHED = Path(__file__).with_name("schafer2025.csv")  # not packed: of another licence
WIDE = 2.0  # rarefaction up to which the published reservoir is known, or nearly
THIN = 10.0  # rarefaction up to which the published force is smooth to a percent
INNER = slice(1, 6)  # open fractions 0.2 to 0.9


def rows_of(text):
    """β, δ, force, heat of the cold and of the hot face, each (open fractions, rarefactions)."""
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    names = ("beta", "delta", "force", "heat_top", "heat_bottom")
    return np.array([[float(row[name]) for name in names] for row in rows]).T.reshape(5, 7, -1)


@pytest.fixture(scope="module")
def solved():
    return rows_of(files("lightflyer.data").joinpath("perforated_disk.csv").read_text("utf-8"))


@pytest.fixture(scope="module")
def published():
    """Simulations of [Schafer2025]_ in helium, where our table has them too."""
    if not PUBLISHED.exists():
        pytest.skip("the published simulations are not packed")
    return rows_of(PUBLISHED.read_text("utf-8"))[..., :10]


def coefficients(found, beta, delta):
    """Force and heat of both faces in the table's own units, at its temperatures of 4 : 3."""
    with lf.float64():
        free = np.asarray(found.force_ratio(beta, delta))
        heat = found.heat_ratios(beta, delta)
    solid, excess = 1.0 - beta, 1.0 / 3.0
    force = 0.5 * solid * free * (np.sqrt(1.0 + excess) - 1.0) / excess
    return force, np.asarray(heat.cross) / np.sqrt(np.pi), np.asarray(heat.own) / np.sqrt(np.pi)


def test_table_is_that_of_the_published_simulations(solved, published):
    beta, delta, force, cross, own = solved
    np.testing.assert_array_equal((beta, delta), published[:2])
    off = np.abs(force / published[2] - 1.0)
    assert off[:, delta[0] <= WIDE].max() < 0.024
    assert off[:, delta[0] <= THIN].max() < 0.03
    assert off[INNER].max() < 0.08
    assert np.abs(own / published[4] - 1.0)[INNER].max() < 0.025
    assert np.abs((cross - published[3]) / published[4])[INNER].max() < 0.012


def test_fit_gives_the_rows_of_the_table(solved):
    beta, delta, *expected = solved
    force, cross, own = coefficients(perforated_disk_fit(), beta, delta)
    off = np.abs(force / expected[0] - 1.0)
    assert off[:, delta[0] <= WIDE].max() < 0.0025
    assert off[:, delta[0] <= THIN].max() < 0.0135
    assert off[:6].max() < 0.035
    assert off[6].max() < 0.058
    assert np.abs(own / expected[2] - 1.0).max() < 0.01
    assert np.abs((cross - expected[1]) / expected[2]).max() < 0.0125


def test_fit_predicts_rows_it_has_not_seen(solved):
    beta, delta, *expected = solved
    for row in range(1, 6):
        kept = np.ones(beta.shape, bool)
        kept[row] = False
        force, cross, own = coefficients(fit(perforated_disk_table(), kept), beta, delta)
        off = np.abs(force / expected[0] - 1.0)[row]
        assert off[delta[row] <= THIN].max() < 0.015
        assert off.max() < 0.043
        assert np.abs(own / expected[2] - 1.0)[row].max() < 0.0055
        assert np.abs((cross - expected[1]) / expected[2])[row].max() < 0.009


@pytest.mark.parametrize("name", ["solved", "published"])
def test_limit_is_a_face_at_four_thirds_of_the_gas_temperature(name, request):
    """The thinnest two columns, continued to no gas at all, are the force of free molecules."""
    beta, _, force, _, hot = request.getfixturevalue(name)
    limit = np.mean((2.0 * force[:, 0] - force[:, 1]) / (1.0 - beta[:, 0]))
    assert limit == pytest.approx(1.5 * (np.sqrt(4.0 / 3.0) - 1.0), rel=5e-3)
    heat = np.mean((2.0 * hot[:, 0] - hot[:, 1]) / (1.0 - beta[:, 0]))
    assert heat == pytest.approx(1.0 / np.sqrt(np.pi), rel=1e-3)
