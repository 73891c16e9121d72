"""Stacks between media, incoherent layers, rough interfaces and holes.

Against `tmm` (coh_tmm and inc_tmm) and closed forms.
"""

import jax
import numpy as np
import pytest
import tmm

import lightflyer as lf
from lightflyer.config.reader import read_film_file, read_flyer_file
from lightflyer.film import (
    Average,
    ComputedFilm,
    Film,
    FilmSummary,
    Layer,
    absorptance,
    am0,
    light_shares,
    stack_optics,
)
from lightflyer.film.optics.averages import heat_shares
from lightflyer.film.optics.diagnostics import property_warnings, thick_warnings

from .conftest import flat

WAVELENGTH = 7e-7
NOTHING = np.zeros(0)


@pytest.mark.parametrize(
    "coherent",
    [(), (True, True, True), (True, False, True), (False, True, False), (False, False, True)],
)
def test_stacks_between_media_are_those_of_tmm(rng, coherent):
    """R, T and each layer's absorptance, over random stacks."""
    thick, layers = ~np.array(coherent, bool), len(coherent)
    for _ in range(6):
        n = rng.uniform(1.0, 4.0, layers)
        k = np.where(rng.random(layers) < 0.3, 0.0, 10.0 ** rng.uniform(-3.0, 0.5, layers))
        d = 10.0 ** rng.uniform(-8.5, -6.0, layers)
        k[thick] = 10.0 ** rng.uniform(-6.0, -4.0, thick.sum())
        d[thick] = 10.0 ** rng.uniform(-5.0, -3.0, thick.sum())
        above, below = rng.uniform(1.0, 1.6), (rng.uniform(0.5, 4.0), 10.0 ** rng.uniform(-3, 0.8))
        angle = rng.uniform(0.0, 0.6)
        optics = stack_optics(
            n, k, d, WAVELENGTH, angle, above=above, below=below, coherent=coherent
        )
        total = optics.reflectance + optics.transmittance + optics.absorptance
        np.testing.assert_allclose(total, 1.0, atol=1e-13)
        index, depth = [above, *(n + 1j * k), complex(*below)], [np.inf, *d, np.inf]
        kinds = ["i", *np.where(thick, "i", "c"), "i"]
        for row, polarisation in enumerate("sp"):
            start = np.complex128(angle)
            if thick.any():
                data = tmm.inc_tmm(polarisation, index, depth, kinds, start, WAVELENGTH)
                inside = tmm.inc_absorp_in_each_layer(data)[1:-1]
            else:
                data = tmm.coh_tmm(polarisation, index, depth, start, WAVELENGTH)
                inside = tmm.absorp_in_each_layer(data)[1:-1] if layers else []
            ours = [optics.reflectance[row], optics.transmittance[row]]
            ours += [*optics.layer_absorptance[:, row]]
            np.testing.assert_allclose(ours, [data["R"], data["T"], *inside], rtol=0.0, atol=1e-12)


def test_light_does_not_enter_what_it_is_totally_reflected_by():
    optics = stack_optics(NOTHING, NOTHING, NOTHING, WAVELENGTH, 1.0, above=1.5)
    np.testing.assert_allclose(optics.reflectance, 1.0, rtol=1e-14)
    np.testing.assert_array_equal(optics.transmittance, 0.0)


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_a_rough_surface_reflects_less_as_of_bennett_and_porteus(angle):
    """And what it reflects and passes less is scattered."""
    height = 2e-8
    arguments = (NOTHING, NOTHING, NOTHING, WAVELENGTH, angle)
    smooth = stack_optics(*arguments, below=(1.8, 0.0))
    rough = stack_optics(*arguments, below=(1.8, 0.0), roughness=np.array([height]))
    reflected = np.exp(-((4.0 * np.pi * height * np.cos(angle) / WAVELENGTH) ** 2))
    inside = np.sqrt(1.8**2 - np.sin(angle) ** 2)
    passed = np.exp(-((2.0 * np.pi * height * (inside - np.cos(angle)) / WAVELENGTH) ** 2))
    np.testing.assert_allclose(rough.reflectance, smooth.reflectance * reflected, rtol=1e-13)
    np.testing.assert_allclose(rough.transmittance, smooth.transmittance * passed, rtol=1e-13)
    lost = (1.0 - reflected) * smooth.reflectance + (1.0 - passed) * smooth.transmittance
    np.testing.assert_allclose(rough.scattered, lost, rtol=1e-11)


@pytest.mark.parametrize("coherent", [(), (True, False, True)])
def test_rough_stacks_keep_energy_and_reciprocity(rng, coherent):
    for _ in range(20):
        n, d = rng.uniform(1.0, 4.0, 3), 10.0 ** rng.uniform(-8.0, -6.0, 3)
        heights = rng.uniform(0.0, 4e-8, 4)
        down = stack_optics(
            n, np.zeros(3), d, WAVELENGTH, 0.7, roughness=heights, coherent=coherent
        )
        up = stack_optics(n[::-1], np.zeros(3), d[::-1], WAVELENGTH, 0.7,
                          roughness=heights[::-1], coherent=coherent)  # fmt: skip
        assert np.all(np.abs(down.layer_absorptance) < 1e-13)
        assert np.all((down.scattered > 0.0) & (down.scattered < 1.0))
        np.testing.assert_allclose(down.transmittance, up.transmittance, rtol=1e-11)
    k = np.array([0.1, 0.0, 2.0])
    smooth = stack_optics(n, k, d, WAVELENGTH, 0.7, coherent=coherent)
    flat_ = stack_optics(n, k, d, WAVELENGTH, 0.7, roughness=np.zeros(4), coherent=coherent)
    for name in ("reflectance", "transmittance", "layer_absorptance"):
        np.testing.assert_allclose(getattr(flat_, name), getattr(smooth, name), atol=1e-14)
    np.testing.assert_allclose(flat_.scattered, 0.0, atol=1e-14)


# n and k of a layer, thickness / 100 nm, wavelength / 500 nm, angle, index above, n and k below,
# roughness of two faces / 100 nm
POINT = np.array([1.7, 0.02, 1.3, 1.1, 0.7, 1.2, 2.0, 0.3, 0.1, 0.05])


def test_samples_are_differentiable(compiled):
    """In all numbers of a rough, incoherent layer between media; forward and reverse."""

    def outcomes(x):
        optics = stack_optics(
            x[:1], x[1:2], 1e-7 * x[2:3], 5e-7 * x[3], x[4], above=x[5], below=(x[6], x[7]),
            roughness=1e-7 * x[8:], coherent=(False,),
        )  # fmt: skip
        return (optics.reflectance + 2.0 * optics.transmittance + 3.0 * optics.absorptance).sum()

    way = np.cos(np.arange(POINT.size))
    with lf.float64():
        _, forward = compiled(lambda x: jax.jvp(outcomes, (x,), (way,)))(POINT)
        reverse = np.asarray(compiled(jax.grad(outcomes))(POINT)) @ way
        difference = outcomes(POINT + 1e-5 * way) - outcomes(POINT - 1e-5 * way)
    assert forward == pytest.approx(float(difference) / 2e-5, rel=1e-7)
    assert reverse == pytest.approx(float(forward), rel=1e-12)


@pytest.fixture(scope="module")
def sample():
    """A rough absorber on a thick transparent plate."""
    layers = (
        Layer(flat(3.0, 0.4), 5e-8, roughness=1e-8),
        Layer(flat(1.5, 1e-6), 1e-3, coherent=False),
    )
    return Film(layers, roughness_below=3e-9)


def test_films_turn_over_with_all_they_have(sample):
    down, up = sample.optics(WAVELENGTH, 0.4), sample.optics(WAVELENGTH, 0.4, side="bottom")
    direct = stack_optics(
        [3.0, 1.5], [0.4, 1e-6], [5e-8, 1e-3], WAVELENGTH, 0.4,
        roughness=np.array([1e-8, 0.0, 3e-9]), coherent=(True, False),
    )  # fmt: skip
    np.testing.assert_allclose(down.layer_absorptance, direct.layer_absorptance, rtol=1e-13)
    np.testing.assert_allclose(down.transmittance, up.transmittance, rtol=1e-11)
    assert sample.flip().flip() == sample
    between = Film(sample.layers, above=flat(1.2, 0.0), below=flat(2.0, 0.1))
    assert (between.flip().above, between.flip().below) == (between.below, between.above)
    assert between.lit_sides == ("top",)
    with pytest.raises(lf.ParameterError, match="is above the film and absorbs light"):
        between.optics(WAVELENGTH, side="bottom")


def test_averages_of_a_sample_have_the_sum_one(sample):
    on_silicon = Film(sample.layers[:1], above=flat(1.3, 0.0), below=flat(3.5, 0.01))
    for film in (sample, on_silicon):
        shares = light_shares(film, incidence=0.5)
        heat = heat_shares(film, np.array([250.0, 400.0]), points_per_e_fold=100)
        for found in (shares, heat):
            np.testing.assert_allclose(sum(one.value for one in found), 1.0, atol=1e-12)
            assert np.all(found.scattered.value > 0.0)
            np.testing.assert_array_equal(found.absorptance.scattered, found.scattered.value)


def test_holes_pass_all_light():
    whole = Film((Layer(flat(3.0, 0.4), 5e-8),))
    pierced = Film(whole.layers, open_fraction=0.25)
    assert pierced.areal_density == pytest.approx(0.75 * whole.areal_density, rel=1e-14)
    assert absorptance(pierced).value == pytest.approx(0.75 * absorptance(whole).value, rel=1e-13)
    ours, all_of_it = pierced.optics(WAVELENGTH, 0.3), whole.optics(WAVELENGTH, 0.3)
    expected = 0.75 * all_of_it.transmittance + 0.25
    np.testing.assert_allclose(ours.transmittance, expected, rtol=1e-14)
    with lf.float64():
        slope = jax.grad(lambda x: absorptance(Film(whole.layers, open_fraction=x)).value)(0.25)
    assert slope == pytest.approx(-absorptance(whole).value, rel=1e-6)
    with pytest.raises(lf.ParameterError, match="behind the holes"):
        Film(whole.layers, below=flat(1.5, 0.0), open_fraction=0.25)


def test_a_summary_says_what_its_numbers_leave_out():
    rough = Layer(flat(4.0, 0.4), 5e-8, roughness=2e-8)
    summary = FilmSummary.of(Film((rough,), below=flat(1.5, 0.0)), am0(), np.array([300.0]))
    text = "\n".join(summary.warnings)
    assert "is scattered at rough faces and not followed" in text
    assert "face 1 from the top has a roughness of 20 nm" in text
    assert "holds up to about 9.95 nm" in text  # 500 nm / (4 pi 4)
    assert "has no lower face" in text
    assert set(summary.thermal) == {"top"}
    assert "emittance_bottom" not in summary.values()
    holes = Film((Layer(flat(4.0, 0.4), 5e-8),), open_fraction=0.1, hole_diameter=5e-6)
    summary = FilmSummary.of(holes, am0(), np.array([300.0]))
    assert any(text.startswith("holes of 5 µm are narrow") for text in summary.warnings)


def test_what_the_theory_of_rough_faces_cannot_do_is_said():
    """Less than nothing scattered, as for some rough faces between two metals."""
    impossible = Average(value=np.array(0.5), covered=np.array(1.0), scattered=np.array(-0.01))
    film = Film((Layer(flat(0.1, 3.0), 1e-8),))
    (text,) = property_warnings("absorptance", impossible, film)
    assert text.startswith("rough faces scatter -0.01, less than nothing")


@pytest.mark.parametrize(("thickness", "coherent", "said"), [(1e-5, True, False),
                                                            (2e-5, True, True),
                                                            (1e-3, False, False)])  # fmt: skip
def test_layers_with_too_many_fringes_are_named(thickness, coherent, said):
    film = Film((Layer(flat(1.5, 1e-3), thickness, coherent=coherent),))
    assert bool(thick_warnings(film)) is said


def test_a_flyers_film_stands_free():
    tacs = {"tac_top": lf.Measured(0.8), "tac_bottom": lf.Measured(0.8)}
    layers = (Layer(flat(3.0, 0.4), 5e-8, roughness=1e-8),)
    with pytest.raises(lf.ParameterError, match="substrate: a flyer's film stands free"):
        ComputedFilm.of(Film(layers, below=flat(1.5, 0.0)), tacs)
    with pytest.raises(lf.ParameterError, match="open_fraction: a flyer's holes"):
        ComputedFilm.of(Film(layers, open_fraction=0.2), tacs)
    film = ComputedFilm.of(Film(layers), tacs)
    assert any(text.startswith("rough faces scatter") for text in film.warnings)


FILE = '[film]\nlayers = [{material = "Ge", thickness = "50 nm", roughness = "3 nm"}]\n'


@pytest.fixture
def read(write):
    return lambda text, reader=read_film_file: reader(write(FILE + text, "sample.toml"))


def test_samples_in_files(read):
    film = read(
        'ambient = {material = "SiO2"}\n'
        'substrate = {material = "Si", thickness = "0.5 mm"}\nroughness_bottom = "1 um"\n'
    ).film()
    assert [layer.coherent for layer in film.layers] == [True, False]
    assert film.faces == (pytest.approx(3e-9), None, pytest.approx(1e-6))
    assert film.above.name == "SiO2"
    endless = read('substrate = {material = "Si", roughness = "2 nm"}\n').film()
    assert endless.below.name == "Si"
    assert endless.faces == pytest.approx((3e-9, 2e-9))
    assert read('open_fraction = "20 %"\nhole_diameter = "5 um"').film().open_fraction == 0.2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            'substrate = {material = "Si"}\nopen_fraction = 0.2',
            "a film with holes has no substrate",
        ),
        ('hole_diameter = "2 um"', "hole_diameter needs open_fraction"),
        ('ambient = {material = "Si", thickness = "2 nm"}', "ambient has no thickness"),
        ('substrate = {material = "Sii"}', ':3: film.substrate.material: material "Sii"'),
        ('roughness_bottom = "-2 nm"', ":3: film.roughness_bottom"),
        ('substrate = {material = "Si", roughness = "1 kg"}', "converts to m"),
    ],
)
def test_bad_samples_get_one_line(read, text, message):
    with pytest.raises(lf.ConfigurationError) as caught:
        read(text)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_flyer_files_have_no_samples(read):
    for key in ('substrate = {material = "Si"}', "open_fraction = 0.2"):
        with pytest.raises(lf.ConfigurationError, match=r"is for samples, which .lightflyer film"):
            read(key + '\n[flyer]\ndiameter = "1 cm"\n', read_flyer_file)
