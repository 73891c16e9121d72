"""Flyers as structures in predictions, bands, sweeps and searches."""

import dataclasses

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import evaluate
from lightflyer.flyer.hanging import Held
from lightflyer.flyer.shape import BentSheets, core_of_posts, shape_of_film, shape_of_sandwich
from lightflyer.structure import (
    Lamina,
    Laminate,
    Ligaments,
    free_plate_heights,
    laminate_stiffness,
)

ROOM = 293.15
ALUMINA = Laminate([Lamina(1e-7, 1.4e11, 0.24, 4.2e-6, 1.3e8, 1.7e9)])
MYLAR = Laminate([Lamina(5e-7, 4.9e9, 0.38, 1.7e-5, 0.0, 1e8)])
POSTS = Ligaments(1e-4, 1e-5, 1e-7)
FILMS = ("curvature", "deflection", "stress_over_strength", "lift_kept", "lowest_frequency",
         "bearable_acceleration", "bearable_wind")  # fmt: skip
SHAPE = (*FILMS, "gap_closed", "load_over_buckling")


def held(load=0.0, *circle, own=1e-7):
    """Masses whose payload weighs a load where gravity is one."""
    return Held(own, load, 1.0, *circle)


def sandwich(ligaments=POSTS, laminate=ALUMINA, **changed):
    top = lf.FilmProperties(3e-4, 0.02, 0.1, 0.1, 0.8, 0.8, transmittance=0.9, laminate=laminate)
    bottom = lf.FilmProperties(3.7e-4, 0.6, 0.1, 0.1, 0.8, 0.8, laminate=laminate)
    numbers = {"radius": 0.01, "gap": 1.25e-4, "open_fraction": 0.5, "hole_radius": 5e-5,
               "support_fraction": 0.0, "support_conductivity": 1.8,
               "support_density": 3000.0}  # fmt: skip
    return lf.Sandwich(top, bottom, **{**numbers, **changed}, ligaments=ligaments)


def plain(shape):
    """A shape of plain numbers."""
    return type(shape)(*(float(number) for number in shape))


def on_posts(heat=ROOM, posts=POSTS, share=0.0, radius=0.01, load=0.0):
    """Shape of two alumina films 0.1 mm apart, the lower one at another temperature."""
    films = ALUMINA, ALUMINA
    core = core_of_posts(posts, films, 1e-4, share)
    with lf.float64():
        sheets = BentSheets(films, (ROOM, heat), core, 1e-4, share, radius)
        return plain(shape_of_sandwich(sheets, held(load), 0.0))


def mylar(load, *circle):
    """Shape of a 2-cm disk of mylar."""
    with lf.float64():
        return plain(shape_of_film(MYLAR, 0.01, ROOM, held(load, *circle)))


def setup_of(flyer):
    return lf.Setup(flyer, lf.Earth(), lf.force.Schafer2025())


FILM = """
[flyer]
shape = "disk"
diameter = "{diameter}"
payload = "0 mg"
[film]
layers = [
  {{material = "Al2O3", thickness = "50 nm"{first}}},
  {{material = "PET", thickness = "500 nm"}},
]
absorptance = 0.75
transmittance = 0.0
emittance = 0.08
infrared_transmittance = 0
tac_top = 0.8
tac_bottom = 0.9
[environment]
kind = "earth"
irradiance = "1361 W/m^2"
[force]
model = "lu2023"
force_error = 0
"""


@pytest.fixture
def disk_file(write):
    return lambda first="", diameter="2 cm": write(
        FILM.format(first=first, diameter=diameter), "flyer.toml"
    )


def test_ligaments_conduct_and_weigh_as_supports_of_their_share():
    posts, plain = sandwich(), sandwich(None, support_fraction=float(POSTS.fraction))
    assert posts.own_mass == pytest.approx(float(plain.own_mass), rel=1e-14)
    state = lf.Earth().state(70e3)
    one, other = (lf.equilibrium(flyer, state, lf.force.Schafer2025()) for flyer in (posts, plain))
    np.testing.assert_allclose(one.temperatures, other.temperatures, rtol=1e-12)
    without = lf.equilibrium(sandwich(None), state, lf.force.Schafer2025())
    between = [found.temperatures[1] - found.temperatures[0] for found in (one, without)]
    assert between[0] < 0.9 * between[1]
    closed = one.gas_power + one.radiated_power - one.absorbed_power
    assert abs(closed) < 1e-10 * one.absorbed_power


def test_the_shape_changes_nothing_else():
    known, unknown = (
        lf.predict(setup_of(sandwich(laminate=one))) for one in (ALUMINA, None)
    )  # fmt: skip
    for name, column in unknown.table.items():
        np.testing.assert_array_equal(known.table[name], column)
    assert set(known.table) - set(unknown.table) == set(SHAPE)


def test_films_of_one_stress_stay_flat_and_whole():
    found = on_posts(share=0.5)
    assert abs(found.curvature) < 1e-12
    assert abs(found.stress_over_strength) < 1e-9  # a free sandwich lets go of its stress
    assert found.gap_closed < 1e-9


def test_a_warmer_face_makes_the_sandwich_curl_by_its_expansion():
    # a small sandwich of equal, thin faces: expansion times difference over distance
    heat = 10.0
    found = on_posts(ROOM + heat, radius=1e-3)
    assert found.curvature == pytest.approx(4.2e-6 * heat / (1e-4 + 1e-7), rel=1e-3)
    assert found.deflection == pytest.approx(found.curvature * 1e-6 / 2, rel=1e-4)
    # which lets each face have its own length
    held = 1.4e11 / (1 - 0.24) * 4.2e-6 * heat / 1.7e9
    assert abs(found.stress_over_strength) < 0.01 * held


def test_a_point_load_bends_a_film_as_a_plate():
    # so little that the film stays flat
    stiffness, load = laminate_stiffness(MYLAR), 1e-12
    found = mylar(load)
    droop = free_plate_heights(load, 0.01, 1e-4, stiffness.plate, stiffness.poisson)[1]
    assert found.deflection == pytest.approx(float(droop), rel=1e-6)
    folded = mylar(1e-5)
    assert folded.deflection == pytest.approx(0.01, rel=1e-2)  # no more than its radius


def test_a_sandwich_on_firm_posts_bends_as_two_faces_and_on_soft_ones_as_each():
    def droop(**posts):
        return on_posts(posts=dataclasses.replace(POSTS, **posts), load=1e-9).deflection

    face = laminate_stiffness(ALUMINA)
    ring = 1e-4
    alone = free_plate_heights(1e-9, 0.01, ring, 2 * face.plate, 0.24)[1]
    together = face.membrane / (1 - 0.24**2) * (1e-4 + 1e-7) ** 2 / 2 + 2 * face.plate
    stiff = free_plate_heights(1e-9, 0.01, ring, together, 0.24)[1]
    assert droop() > 2 * float(stiff)  # thin films hold the posts' ends weakly
    assert droop() < 0.1 * float(alone)
    assert droop(modulus=1e3, wall=1e-9) == pytest.approx(float(alone), rel=0.02)
    # posts that nearly touch leave the films no room to give way
    near = droop(radius=4.99e-5, wall=1e-6)
    assert float(stiff) < near < droop()


def test_a_payload_on_a_circle_bends_less_than_one_in_the_middle():
    stiffness, load = laminate_stiffness(MYLAR), 1e-12
    ring, edge = free_plate_heights(load, 0.01, 6e-3, stiffness.plate, stiffness.poisson)
    found = mylar(load, 6e-3)
    assert found.deflection == pytest.approx(max(ring, edge, 0.0) - min(ring, edge, 0.0), rel=1e-6)
    assert found.deflection < 0.2 * mylar(load).deflection
    with pytest.raises(lf.ParameterError, match="hanging_radius must be smaller"):
        sandwich(hanging_radius=0.02)


def test_a_film_has_a_shape_where_a_layer_states_mechanics(disk_file):
    silent, stated = (
        lf.read_flyer_file(disk_file(first)).design() for first in ("", ', stress = "130 ± 50 MPa"')
    )
    assert silent.setup.flyer.known_shape == ()
    assert set(FILMS) <= set(outputs_of(stated.setup))
    assert "gap_closed" not in outputs_of(stated.setup)
    alumina, mylar = stated.setup.flyer.film.laminate.layers
    assert (alumina.stress, alumina.modulus, mylar.modulus) == (1.3e8, 1.4e11, 4.9e9)
    assert stated.uncertainties["film.layers.0.stress"] == 5e7
    assert stated.uncertainties["film.layers.1.modulus"] == 2e8
    assert not any("layers" in name for name in silent.uncertainties)


def test_bands_and_warnings_tell_of_a_film_that_curls(disk_file):
    path = disk_file(', stress = "130 ± 50 MPa"')
    prediction = lf.predict(path)
    assert any("does not stay flat" in text for text in prediction.warnings)
    assert prediction.verdict.shape_failures == ("deflection",)
    assert prediction.summary()["verdict"]["shape_failures"] == ["deflection"]
    found = lf.propagate(path, samples=0)
    result = found.summary()["results"]["best.deflection_mm"]
    assert result["first_order"]["standard_uncertainty"] > 0.0
    assert result["value"] > 2.0  # mm, of 10 mm
    # and other results have the bands they had
    plain = lf.propagate(disk_file(), samples=0)
    assert plain is None or "film.layers.0.stress" not in plain.inputs.names


def test_a_layer_without_numbers_is_asked_for_them(disk_file):
    text = disk_file(', stress = "130 MPa"').read_text().replace("PET", "polyimide")
    path = disk_file()
    path.write_text(text)
    with pytest.raises(lf.ConfigurationError, match="needs its modulus and poisson"):
        lf.predict(path)


@pytest.mark.slow
def test_derivatives_through_the_balance_are_those_of_finite_differences(compiled):
    def outputs(numbers):
        spacing, gap, payload = numbers
        flyer = sandwich(Ligaments(spacing * 1e-4, 1e-5, 1e-7), gap=gap * 1.25e-4,
                         payload=payload * 1e-8)  # fmt: skip
        found = evaluate(setup_of(flyer), SHAPE, 70e3)[0]
        return lf.xp.stack([found[name] for name in SHAPE])

    step = 1e-4 * np.eye(3)
    expected = (outputs(1.0 + step) - outputs(1.0 - step)) / 2e-4
    with lf.float64():  # each element moves in a number of its own
        slopes = compiled(lambda x: jax.jvp(outputs, (x,), (jax.numpy.eye(3),))[1])(np.ones((3, 3)))
    np.testing.assert_allclose(slopes, expected, rtol=1e-3, atol=1e-9)


def test_supports_are_given_one_way_or_the_other(tmp_path):
    from lightflyer.cli.commands.init import templates

    text = templates()["sandwich"].read()
    path = tmp_path / "flyer.toml"
    lines = [line for line in text.splitlines() if not line.startswith("support_fraction")]
    path.write_text("\n".join(lines))
    with pytest.raises(lf.ConfigurationError, match="support_fraction, or a section"):
        lf.read_flyer_file(path)
    posts = ["[flyer.ligaments]", 'spacing = "100 um"', 'diameter = "20 um"', 'wall = "100 nm"']
    place = next(number for number, line in enumerate(lines) if line.startswith("[flyer.top]"))
    path.write_text("\n".join([*lines[:place], *posts, *lines[place:]]))
    flyer = lf.read_flyer_file(path).build().flyer
    assert flyer.solid_support == pytest.approx(float(POSTS.fraction))
    assert flyer.ligaments.radius == pytest.approx(1e-5)
    crowded = "\n".join([*lines[:place], *posts, *lines[place:]]).replace('"20 um"', '"99 um"')
    path.write_text(crowded)
    with pytest.raises(lf.ConfigurationError, match="exceed 1 together"):
        lf.read_flyer_file(path)


def test_a_plate_bends_as_two_faces_whose_walls_shear():
    film = lf.FilmProperties(1.5e-4, 0.02, 0.1, 0.1, 0.8, 0.8, laminate=ALUMINA)
    plate = lf.Plate(film, film, 4e-3, 5e-5, 5e-4, 5e-5, 1e-4, 5e-8, 1.8, payload=1e-9)
    state = lf.Chamber().state(30.0)
    with lf.float64():
        found = plain(plate.shape(state, (ROOM, ROOM), 1e-7))
    share = (1 - plate.open_fraction) / (1 + 2 * plate.open_fraction)
    face = laminate_stiffness(ALUMINA)
    together = share * (face.membrane / (1 - 0.24**2) * (1e-4 + 1e-7) ** 2 / 2 + 2 * face.plate)
    load, ring = 1e-9 * state.gravity, 5.5e-4
    bent = free_plate_heights(load, 4e-3, ring, together, 0.24)[1]
    assert found.deflection == pytest.approx(float(bent), rel=0.03)  # walls hardly shear
    assert found.deflection > float(bent)
    assert found.gap_closed < 1e-3


def test_a_flyer_without_known_layers_has_no_shape():
    flyer = tree.replace_at(lambda one: one.top.laminate, sandwich(), None)
    assert flyer.known_shape == ()
    with pytest.raises(lf.ConfigurationError, match="not known as a structure"):
        flyer.shape(lf.Earth().state(70e3), (300.0, 310.0), 1e-6)


def test_a_prediction_names_what_fails():
    weak = Laminate([Lamina(1e-7, 1.4e11, 0.24, 4.2e-6, 1.3e8, 1e3)])
    far = Ligaments(9e-3, 1e-5, 1e-7)
    found = lf.predict(setup_of(sandwich(far, weak, payload=5e-8)))
    assert found.verdict.shape_failures == (
        *("deflection", "stress_over_strength", "gap_closed", "load_over_buckling"),
    )
    assert any("a layer tears" in text for text in found.warnings)
    assert any("the gap does not stay" in text for text in found.warnings)
    assert any("a membrane wrinkles" in text for text in found.warnings)
    whole = lf.predict(setup_of(sandwich(payload=5e-8)))
    assert whole.verdict.shape_failures == ()
