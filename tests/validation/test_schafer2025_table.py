"""The smooth functions beside the published simulations they are fitted to."""

import csv
from importlib.resources import files

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.force.membranes.schafer2025_table import (
    fit,
    perforated_disk_fit,
    perforated_disk_table,
)

THIN = 10.0  # rarefaction up to which the force of the table is smooth to a percent
INNER = slice(1, 6)  # open fractions 0.2 to 0.9


@pytest.fixture(scope="module")
def published():
    """The rows of the file, read here: β, δ, force, heat of the cold and of the hot face."""
    text = files("lightflyer.data").joinpath("schafer2025.csv").read_text("utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    names = ("beta", "delta", "force", "heat_top", "heat_bottom")
    columns = np.array([[float(row[name]) for name in names] for row in rows]).T
    assert columns.shape == (5, 77)
    return columns.reshape(5, 7, 11)


def coefficients(found, beta, delta):
    """Force and heat of both faces in the table's own units, at its temperatures of 4 : 3."""
    with lf.float64():
        free = np.asarray(found.force_ratio(beta, delta))
        heat = found.heat_ratios(beta, delta)
    solid, excess = 1.0 - beta, 1.0 / 3.0
    force = 0.5 * solid * free * (np.sqrt(1.0 + excess) - 1.0) / excess
    return force, np.asarray(heat.cross) / np.sqrt(np.pi), np.asarray(heat.own) / np.sqrt(np.pi)


def test_fit_gives_the_published_rows(published):
    beta, delta, *expected = published
    force, cross, own = coefficients(perforated_disk_fit(), beta, delta)
    force_error = np.abs(force / expected[0] - 1.0)
    thin = delta[0] <= THIN
    assert force_error[:, thin].max() < 0.0125
    assert force_error[:6, ~thin].max() < 0.033
    assert force_error[6, ~thin].max() < 0.058
    assert np.sqrt(np.mean(force_error[:, thin] ** 2)) < 0.0037
    assert np.abs(own / expected[2] - 1.0)[:6].max() < 0.0075
    assert np.abs(own / expected[2] - 1.0)[6].max() < 0.0135
    assert np.abs((cross - expected[1]) / expected[2]).max() < 0.008


def test_fit_predicts_rows_it_has_not_seen(published):
    beta, delta, *expected = published
    table = perforated_disk_table()
    for row in range(1, 6):
        kept = np.ones(beta.shape, bool)
        kept[row] = False
        force, cross, own = coefficients(fit(table, kept), beta, delta)
        force_error = np.abs(force / expected[0] - 1.0)[row]
        thin = delta[row] <= THIN
        assert force_error[thin].max() < 0.013
        assert force_error[~thin].max() < 0.04
        assert np.abs(own / expected[2] - 1.0)[row].max() < 0.01
        assert np.abs((cross - expected[1]) / expected[2])[row].max() < 0.011


def test_tables_limit_is_a_face_at_four_thirds_of_the_gas_temperature(published):
    """The thinnest two columns, continued to no gas at all, are the force of free molecules."""
    beta, _, force, _, hot = published
    limit = np.mean((2.0 * force[:, 0] - force[:, 1]) / (1.0 - beta[:, 0]))
    assert limit == pytest.approx(1.5 * (np.sqrt(4.0 / 3.0) - 1.0), rel=5e-3)
    heat = np.mean((2.0 * hot[:, 0] - hot[:, 1]) / (1.0 - beta[:, 0]))
    assert heat == pytest.approx(1.0 / np.sqrt(np.pi), rel=1e-3)
