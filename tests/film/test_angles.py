"""Shares by angle and polarisation: against tmm, closed forms and the hemispherical averages."""

import csv
import dataclasses

import numpy as np
import pytest
import tmm

from lightflyer.film import (
    AngularSummary,
    Film,
    Layer,
    Spectrum,
    am0,
    emittance,
    light_by_angle,
)
from lightflyer.film.angles import heat_by_angle, write_csv, write_spectral_csv
from lightflyer.film.figures import angle_figures

from .conftest import flat

ANGLES = np.radians([0.0, 35.0, 80.0])
COARSE = 100


@pytest.fixture(scope="module")
def film():
    return Film((Layer(flat(3.0, 0.4), 3e-8), Layer(flat(1.6, 0.02), 1e-6)))


@pytest.fixture(scope="module")
def summary(film):
    rough = dataclasses.replace(film, roughness_below=1e-8)
    return AngularSummary.of(rough, am0(), ANGLES, np.array([250.0, 400.0]))


def test_light_by_angle_is_that_of_tmm(film):
    wavelengths = np.array([0.4e-6, 0.5e-6, 0.8e-6, 1.1e-6])
    weights = np.array([0.05, 0.2, 0.3, 0.15])  # trapezoids of an even spectrum
    found = light_by_angle(film, ANGLES, Spectrum("even", wavelengths, np.ones(4)), side="bottom")
    index, depth = [1.0, 1.6 + 0.02j, 3.0 + 0.4j, 1.0], [np.inf, 1e-6, 3e-8, np.inf]
    for row, polarisation in enumerate("sp"):
        for place, angle in enumerate(ANGLES):
            data = [tmm.coh_tmm(polarisation, index, depth, angle, one) for one in wavelengths]
            for name, key in (("reflectance", "R"), ("transmittance", "T")):
                expected = np.average([one[key] for one in data], weights=weights)
                assert getattr(found, name)[row, place] == pytest.approx(expected, rel=1e-11)
    np.testing.assert_allclose(sum(found), 1.0, atol=1e-13)


def test_directional_emittances_add_up_to_the_hemispherical_one(film):
    """By another quadrature, even in the angle itself."""
    side = "bottom"
    nodes, weights = np.polynomial.legendre.leggauss(32)
    angles, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    temperatures = np.array([250.0, 441.0])
    found = heat_by_angle(film, angles, temperatures, side=side, points_per_e_fold=COARSE)
    mean = (weights * np.sin(2.0 * angles)) @ found.polarisation_mean().absorptance
    expected = emittance(film, temperatures, side=side, points_per_e_fold=COARSE).value
    np.testing.assert_allclose(mean, expected, rtol=1e-6)


def test_a_black_lake_obeys_fresnel():
    """All wavelengths alike: an opaque absorber emits 1 - R, the closed form of its surface."""
    lake = Film((Layer(flat(1.33, 0.5), 0.01),))
    found = heat_by_angle(lake, ANGLES, 300.0, points_per_e_fold=COARSE).absorptance
    inside = np.sqrt((1.33 + 0.5j) ** 2 - np.sin(ANGLES) ** 2)
    s = (np.cos(ANGLES) - inside) / (np.cos(ANGLES) + inside)
    p = ((1.33 + 0.5j) ** 2 * np.cos(ANGLES) - inside) / (
        (1.33 + 0.5j) ** 2 * np.cos(ANGLES) + inside
    )
    np.testing.assert_allclose(found, 1.0 - np.abs([s, p]) ** 2, rtol=1e-8)


def test_tables_and_datasets_hold_the_same_numbers(summary, tmp_path):
    write_csv(summary, tmp_path / "mean.csv")
    write_spectral_csv(summary, tmp_path / "spectral.csv")
    with (tmp_path / "mean.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 3 * 3  # spectra, angles, polarisations
    names = ("reflectance", "transmittance", "absorptance", "scattered")
    for row in rows:
        assert sum(float(row[f"{name} [1]"]) for name in names) == pytest.approx(1.0, abs=1e-7)
    (chosen,) = (row for row in rows if row["spectrum"] == "black body 400 K"
                 and row["polarisation"] == "mean" and row["angle [deg]"] == "35")  # fmt: skip
    data = summary.to_dataset()
    found = data.thermal_absorptance.sel(polarisation="mean", temperature=400.0)
    assert float(found[1]) == pytest.approx(float(chosen["absorptance [1]"]), rel=1e-7)
    assert data.absorptance.dims == ("polarisation", "angle", "wavelength")
    assert data.angle.attrs["units"] == "degree"
    lines = (tmp_path / "spectral.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + 3 * data.wavelength.size * 3


def test_figures_show_angles_and_polarisations(summary):
    figures = angle_figures(summary)
    assert list(figures) == ["film-angles", "film-angles-map"]
    light, heat = figures["film-angles"].axes
    assert light.get_xlabel() == heat.get_xlabel() == "angle to the film's normal [°]"
    labels = light.get_legend_handles_labels()[1]
    assert {"reflectance", "scattered", "s polarisation"} <= set(labels)
