"""What passes a film: against tmm, by conservation, and beside measured values."""

import jax
import numpy as np
import pytest
import tmm

import lightflyer as lf
from lightflyer.film import (
    ComputedFilm,
    EmittanceCurve,
    Film,
    Layer,
    Spectrum,
    area_weighted_mean,
    cold_white_led,
    emittance,
    light_shares,
    material,
    planck,
    tabulated_material,
)
from lightflyer.film.computed import with_measurements
from lightflyer.film.optics.averages import heat_shares
from lightflyer.film.properties import FilmProperties

from .conftest import flat

TACS = {"tac_top": lf.Measured(0.8), "tac_bottom": lf.Measured(0.8)}


@pytest.fixture(scope="module")
def film():
    """Layers of which each absorbs, with data everywhere."""
    return Film((Layer(flat(3.0, 0.4), 3e-8), Layer(flat(1.6, 0.02), 1e-6)))


@pytest.fixture(scope="module")
def computed():
    """Germanium on mylar, whose data end at 15 µm."""
    return ComputedFilm.of(Film((Layer(material("Ge"), 2e-8), Layer(material("PET"), 5e-7))), TACS)


def by_tmm(film, side, wavelengths, weights, angles, shares):
    """Absorbed, passed, reflected and scattered, with what each layer absorbs summed up."""
    layers = film.layers if side == "top" else film.layers[::-1]
    d = [np.inf, *(layer.thickness for layer in layers), np.inf]
    index = [1.0, *(complex(*layer.material.index(1e-5)) for layer in layers), 1.0]
    total = np.zeros(4)
    for wavelength, weight in zip(wavelengths, weights, strict=True):
        for angle, share in zip(angles, shares, strict=True):
            for polarisation in "sp":
                data = tmm.coh_tmm(polarisation, index, d, angle, wavelength)
                inside = sum(tmm.absorp_in_each_layer(data)[1:-1])
                total += 0.5 * weight * share * np.array([inside, data["T"], data["R"], 0.0])
    return total


@pytest.mark.parametrize("side", ["top", "bottom"])
def test_shares_of_light_are_those_of_tmm(film, side):
    wavelengths = np.array([0.4e-6, 0.5e-6, 0.8e-6, 1.1e-6])
    weights = np.array([0.05, 0.2, 0.3, 0.15])  # trapezoids of an even spectrum
    light = Spectrum("even", wavelengths, np.ones(4))
    mean = light_shares(film, light, 0.6, side=side)
    expected = by_tmm(film, side, wavelengths, weights / weights.sum(), [0.6], [1.0])
    np.testing.assert_allclose([one.value for one in mean], expected, rtol=1e-12)
    assert sum(one.value for one in mean) == pytest.approx(1.0, abs=1e-12)
    cosines, shares = np.polynomial.legendre.leggauss(16)
    cosines = 0.5 * (cosines + 1.0)
    diffuse = light_shares(film, light, side=side, diffuse=True)
    directions = np.arccos(cosines), shares * cosines
    expected = by_tmm(film, side, wavelengths, weights / weights.sum(), *directions)
    np.testing.assert_allclose([one.value for one in diffuse], expected, rtol=1e-12)


def test_shares_of_heat_radiation_by_an_independent_integration(film):
    """Emittance of a face is the absorptance for light onto it (Kirchhoff)."""
    side = "bottom"
    cosines, shares = np.polynomial.legendre.leggauss(8)
    cosines = 0.5 * (cosines + 1.0)
    wavelengths = np.geomspace(2e-6, 90e-6, 60)
    weights = np.gradient(np.log(wavelengths)) * wavelengths * planck(wavelengths, 400.0)
    directions = np.arccos(cosines), shares * cosines
    expected = by_tmm(film, side, wavelengths, weights / weights.sum(), *directions)
    mean = heat_shares(film, 400.0, side=side)
    np.testing.assert_allclose([one.value for one in mean], expected, rtol=5e-3)
    assert emittance(film, 400.0, side=side).value == pytest.approx(mean[0].value, rel=1e-12)
    several = heat_shares(film, np.array([150.0, 300.0, 900.0]), points_per_e_fold=400)
    np.testing.assert_allclose(sum(one.value for one in several), 1.0, atol=1e-12)


def test_a_film_of_layers_passes_the_beam_diffuse_light_and_heat(computed):
    found = computed.properties
    top, below = light_shares(computed.film), light_shares(computed.film, diffuse=True)
    assert found.transmittance == pytest.approx(float(top.transmittance.value), rel=1e-12)
    assert found.transmittance_bottom == pytest.approx(below.transmittance.value, rel=1e-12)
    assert found.transmittance_below == found.transmittance_bottom
    expected = heat_shares(computed.film, 320.0).transmittance.value
    assert found.infrared_transmittance_at(320.0) == pytest.approx(expected, abs=2e-5)
    report = computed.report()
    assert report["transmittance"]["origin"] == "computed"
    assert report["infrared_transmittance"]["covered"]["350"] == pytest.approx(0.664, abs=1e-3)
    assert any(text.startswith("infrared_transmittance is computed") for text in computed.warnings)


def test_nothing_passes_where_it_does_not_matter(computed):
    alone = ComputedFilm.of(computed.film, TACS, passing=False)
    assert alone.properties.transmittance == 0.0 == alone.properties.infrared_transmittance
    whole = float(computed.properties.absorptance)
    assert alone.properties.absorptance == pytest.approx(whole, rel=1e-12)
    assert set(alone.bounds) == {"absorptance_without_data", "emittance_without_data"}
    assert not any("transmittance" in text for text in alone.warnings)
    assert "transmittance" not in alone.report()


def shares_of(film):
    """What each face absorbs and passes, in light and at the nodes of its curves."""
    nodes = [
        one.at_nodes if isinstance(one, EmittanceCurve) else one
        for one in (film.emittance_top, film.emittance_bottom, film.infrared_transmittance)
    ]
    return [
        film.absorptance + film.transmittance,
        film.absorptance_below + film.transmittance_below,
        nodes[0] + nodes[2],
        nodes[1] + nodes[2],
    ]


def test_bounds_of_missing_data_keep_energy(computed):
    bounds = computed.bounds
    what = ("absorptance", "transmittance", "emittance", "infrared_transmittance")
    assert list(bounds) == [f"{one}_without_data" for one in what]
    for lower, upper in bounds.values():
        for total in (*shares_of(lower), *shares_of(upper)):
            assert np.all(total <= 1.0 + 1e-9)
    missing = 1.0 - computed.averages["absorptance"].covered
    least, most = bounds["transmittance_without_data"]
    assert most.transmittance - least.transmittance == pytest.approx(missing, rel=1e-9)
    least, most = bounds["absorptance_without_data"]
    assert most.absorptance - least.absorptance == pytest.approx(missing, rel=1e-9)
    # what is not absorbed passes in the same share as where there are data
    assert least.transmittance > computed.properties.transmittance > most.transmittance


def test_what_passes_keeps_its_share_beside_a_measured_absorptance(computed):
    """So that no more than all is absorbed and passed."""
    own = computed.properties
    share = own.transmittance / (1.0 - own.absorptance)
    measured = TACS | {"absorptance": lf.Measured(0.9), "emittance_top": lf.Measured(0.5)}
    film = ComputedFilm.of(computed.film, measured).properties
    assert film.transmittance == pytest.approx(0.1 * share, rel=1e-12)
    assert film.absorptance_bottom is None
    assert np.all(np.array(shares_of(film)[:2]) <= 1.0)
    ratio = film.infrared_transmittance.at_nodes / own.infrared_transmittance.at_nodes
    np.testing.assert_allclose(ratio, 0.5 / (1.0 - own.emittance_top.at_nodes), rtol=1e-9)
    black = ComputedFilm.of(computed.film, TACS | {"absorptance": lf.Measured(1.0)}).properties
    assert black.transmittance == 0.0
    # the same where a measured number moves and the optics of layers stay
    for given in ({"absorptance": 0.95}, {"absorptance": 0.95, "emittance_top": 0.6}):
        moved = FilmProperties(**with_measurements(film, TACS_ALONE | given))
        assert moved.transmittance == pytest.approx(0.05 * share, rel=1e-12)
        assert np.all([np.all(total <= 1.0 + 1e-9) for total in shares_of(moved)])
    assert moved.infrared_transmittance.at_nodes == pytest.approx(
        0.8 * film.infrared_transmittance.at_nodes, rel=1e-9
    )


TACS_ALONE = {"tac_top": 0.8, "tac_bottom": 0.8}


def test_a_measured_transmittance_replaces_both(computed):
    measured = TACS | {
        "transmittance": lf.Measured(0.2),
        "infrared_transmittance": lf.Measured(0.3),
    }
    found = ComputedFilm.of(computed.film, measured)
    assert found.properties.transmittance_below == 0.2
    assert found.properties.infrared_transmittance == 0.3
    upper = found.bounds["absorptance_without_data"][1]
    assert upper.absorptance <= 0.8
    assert np.all(found.bounds["emittance_without_data"][1].emittance_top.at_nodes <= 0.7 + 1e-9)


def test_layers_without_data_in_the_light_pass_an_unknown_share():
    infrared = tabulated_material(
        "infrared only", np.array([5e-6, 5e-5]), np.full(2, 1.5), np.full(2, 0.1), density=1000.0
    )
    film = Film((Layer(infrared, 1e-6),))
    measured = TACS | {"absorptance": lf.Measured(0.3)}
    found = ComputedFilm.of(film, measured, spectrum=cold_white_led())
    assert any(
        text.startswith("transmittance is computed from data for 0 %") for text in found.warnings
    )
    lower, upper = found.bounds["transmittance_without_data"]
    assert (lower.transmittance, upper.transmittance) == pytest.approx((0.0, 0.7), abs=1e-9)


def test_more_than_arrives_is_refused():
    numbers = (1e-3, 0.3, 0.1, 0.1, 0.8, 0.9)
    FilmProperties(*numbers, transmittance=0.6, absorptance_bottom=0.5, transmittance_bottom=0.5)
    with pytest.raises(lf.ParameterError, match=r"transmittance = 0.6 and absorptance_bottom"):
        FilmProperties(*numbers, transmittance=0.6, absorptance_bottom=0.5)
    with pytest.raises(lf.ParameterError, match=r"transmittance_bottom = 0.8 and absorptance = 0"):
        FilmProperties(*numbers, transmittance=0.6, transmittance_bottom=0.8)


def test_a_patterned_film_is_the_mean_over_its_area(computed):
    plain = FilmProperties(5e-4, 0.1, 0.2, 0.3, 0.7, 0.9, highest_temperature=600.0)
    mixed = area_weighted_mean([computed.properties, plain], [0.3, 0.7])
    own = computed.properties
    assert mixed.areal_density == pytest.approx(0.3 * own.areal_density + 0.7 * 5e-4, rel=1e-12)
    assert mixed.absorptance_below == pytest.approx(0.3 * own.absorptance_below + 0.07, rel=1e-12)
    assert mixed.transmittance_below == pytest.approx(0.3 * own.transmittance_below, rel=1e-12)
    assert mixed.tac_bottom == pytest.approx(0.3 * 0.8 + 0.7 * 0.9)
    assert mixed.highest_temperature == 600.0
    top, bottom = mixed.emittances_at(320.0)
    own_top, own_bottom = own.emittances_at(320.0)
    assert float(top) == pytest.approx(0.3 * float(own_top) + 0.7 * 0.2, rel=1e-12)
    assert float(bottom) == pytest.approx(0.3 * float(own_bottom) + 0.7 * 0.3, rel=1e-12)
    same = area_weighted_mean([own, own], [0.5, 0.5])
    np.testing.assert_allclose(same.emittance_top.at_nodes, own.emittance_top.at_nodes, rtol=1e-9)
    with lf.float64():
        slope = jax.grad(lambda x: area_weighted_mean([own, plain], [x, 1.0 - x]).absorptance)(0.3)
    assert float(slope) == pytest.approx(own.absorptance - 0.1, rel=1e-12)
    for shares in ([0.5], [0.5, 0.6]):
        with pytest.raises(lf.ParameterError, match="shares"):
            area_weighted_mean([own, plain], shares)
