import numpy as np
import pytest

import lightflyer as lf

SIGMA = 5.670374419e-8
BOLTZMANN = 1.380649e-23


def sphere_of(**changed):
    numbers = {
        "radius": 2e-6, "absorption_efficiency": 0.8, "emittance": 0.3, "conductivity": 0.4,
        "tac_top": 0.8, "tac_bottom": 0.9, "density": 1500.0,
    }  # fmt: skip
    return lf.Sphere(**(numbers | changed))


def state_at(pressure=5500.0, temperature=220.0, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(pressure, temperature, 9.7, lf.gas.AIR, radiation)


def fluxes(radiance):
    """Mean over a sphere, and net downward on a level face, of a radiance over the cosine.

    ``radiance``: of the direction from which light comes, its cosine to the vertical.
    """
    cosine = np.linspace(-1.0, 1.0, 200001)
    around = 2.0 * np.pi * radiance(cosine)
    mean = 0.25 * np.trapezoid(around, cosine)
    return mean, np.trapezoid(around * cosine, cosine)


@pytest.mark.parametrize("asymmetry", [None, 0.1, -0.2])
def test_light_of_sun_sky_and_ground_is_the_sum_over_directions(asymmetry):
    """Each direction brings its light to the whole, and its asymmetry to the upper half."""
    zenith, view, albedo = 0.6, 0.97, 0.3
    light = {
        "irradiance": 1000.0, "zenith_angle": zenith, "albedo": albedo, "ground_view": view,
        "diffuse_above": 50.0, "infrared_above": 20.0, "infrared_below": 240.0,
    }  # fmt: skip
    flyer, state = sphere_of(asymmetry=asymmetry, infrared_asymmetry=0.05), state_at(**light)
    edge = -np.sqrt(1.0 - view)  # cosine at which the ground begins

    def of_two(sky, ground):
        return fluxes(lambda cosine: np.where(cosine > edge, sky, ground) / np.pi)

    reflected = albedo * 1000.0 * np.cos(zenith)
    mean, net = of_two(50.0, reflected)
    mean, net = mean + 250.0, net + 1000.0 * np.cos(zenith)
    black = SIGMA * 220.0**4
    warm_mean, warm_net = of_two(20.0 - black, 240.0 - black)
    factor = 0.4 if asymmetry is None else asymmetry
    cross = np.pi * 4e-12
    whole = 4.0 * cross * (0.8 * mean + 0.3 * warm_mean)
    uneven = cross * (factor * net + 0.05 * warm_net)
    with lf.float64():
        areas, gains = flyer.beam_areas(state), flyer.heat_gains(state)
    top, bottom = (1000.0 * area + gain for area, gain in zip(areas, gains, strict=True))
    assert top + bottom == pytest.approx(whole, rel=1e-4, abs=0.0)
    assert top - bottom == pytest.approx(2.0 * uneven, rel=1e-4, abs=0.0)


def test_light_from_below_turns_the_sphere_over():
    above, below = (state_at(irradiance=1e3, zenith_angle=angle) for angle in (0.0, np.pi))
    with lf.float64():
        lit, other = sphere_of().beam_areas(above), sphere_of().beam_areas(below)
    np.testing.assert_allclose(lit, other[::-1], rtol=1e-12, atol=1e-24)
    # all that an opaque sphere absorbs is absorbed by its lit half
    np.testing.assert_allclose(lit, (0.8 * np.pi * 4e-12, 0.0), rtol=1e-12, atol=1e-24)


def test_first_harmonic_by_the_heat_equation():
    """In vacuum an opaque sphere loses its difference by conduction and radiation alone."""
    flyer, state = sphere_of(radius=1e-3), state_at(1e-9, 250.0, irradiance=2000.0)
    found = lf.equilibrium(flyer, state, lf.Rohatschek1995())
    top, bottom = found.temperatures
    mean, amplitude = 0.5 * (top + bottom), 0.5 * (top - bottom)
    # absorbed and emitted over the whole sphere, black surroundings at the gas temperature
    emitted = 0.25 * 0.8 * 2000.0 / 0.3 + SIGMA * 250.0**4
    assert mean == pytest.approx((emitted / SIGMA) ** 0.25, rel=1e-8, abs=0.0)
    radiated = 4.0 * 0.3 * SIGMA * mean**3
    assert amplitude == pytest.approx(
        0.4 * 2000.0 * 1e-3 / (0.4 + radiated * 1e-3), rel=1e-8, abs=0.0
    )


def test_an_emittance_may_depend_on_temperature():
    curve = lf.film.EmittanceCurve.through(np.full(lf.film.optics.curve.NODES, 0.3))
    state, light = state_at(1.0, 250.0, irradiance=3000.0), lf.Rohatschek1995()
    plain, curved = (
        lf.equilibrium(sphere_of(emittance=one), state, light).temperatures for one in (0.3, curve)
    )
    np.testing.assert_allclose(curved, plain, rtol=1e-9)


def test_what_holds_it_upright():
    state = state_at()
    mass = 1500.0 * 4.0 / 3.0 * np.pi * 8e-18
    assert sphere_of().own_mass == pytest.approx(mass, rel=1e-14, abs=0.0)
    assert sphere_of().alignment(state) == 0.0
    assert sphere_of(upright="dipole").alignment(state) == 1.0
    for size, offset in ((2.5e-7, 1e-10), (2e-6, 2e-8), (2e-6, 5e-7)):
        held = sphere_of(radius=size, upright="gravity", mass_offset=offset).alignment(state)
        energy = mass * (size / 2e-6) ** 3 * 9.7 * offset / (BOLTZMANN * 220.0)
        cosine = np.linspace(-1.0, 1.0, 100001)
        weight = np.exp(energy * (cosine - 1.0))
        mean = np.trapezoid(weight * cosine, cosine) / np.trapezoid(weight, cosine)
        assert held == pytest.approx(mean, rel=1e-6, abs=0.0)


def test_mass_and_description():
    flyer = sphere_of(density=None, body_mass="5 pg", payload=1e-15)
    assert flyer.mass == pytest.approx(6e-15, rel=1e-14, abs=0.0)
    assert flyer.describe() == "sphere of 4 µm"
    assert sphere_of(radius="2 mm").describe() == "sphere of 4 mm"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"radius": 0.0}, "radius = 0 is not positive"),
        ({"radius": "2 s"}, 'radius = "2 s": unit'),
        ({"absorption_efficiency": -0.1}, "absorption_efficiency = -0.1 is not between 0 and 10"),
        ({"emittance": 0.0}, "emittance = 0 is not"),
        ({"conductivity": -1.0}, "conductivity = -1 is not"),
        ({"tac_bottom": 0.0}, "tac_bottom = 0 is not"),
        ({"density": None}, "needs either its density or its mass"),
        ({"body_mass": 1e-15}, "needs either its density or its mass"),
        ({"asymmetry": 0.61}, "asymmetry is at most 3/4 of absorption_efficiency"),
        ({"asymmetry": -0.61}, "asymmetry is at most 3/4 of absorption_efficiency"),
        ({"infrared_asymmetry": 0.3}, "infrared_asymmetry is at most 3/4 of emittance"),
        ({"upright": "magic"}, 'upright = "magic" is unknown; choose from nothing, gravity'),
        ({"mass_offset": 1e-7}, 'mass_offset, by .* needs upright = "gravity"'),
        ({"mass_offset": 3e-6, "upright": "gravity"}, "mass_offset must be less than the radius"),
        ({"attitude": lf.environment.Attitude(0.1)}, "a sphere has no attitude"),
    ],
)
def test_impossible_numbers_raise(changed, message):
    with pytest.raises(lf.ParameterError, match=message):
        sphere_of(**changed)


def test_a_medium_absorbs_and_emits_by_mie():
    medium = lf.film.material("a-C", extrapolation="hold").with_density(1800.0)
    flyer = lf.Sphere.of(medium, 5e-7, conductivity=0.3, tac_top=0.9)
    assert flyer.density == 1800.0
    dull = lf.Sphere.of(medium, 5e-7, conductivity=0.3, tac_top=0.9, emittance=0.5, body_mass=1e-15)
    assert (dull.emittance, dull.density, dull.own_mass) == (0.5, None, 1e-15)
    model, state = lf.KineticSphere(), state_at(100.0, irradiance=1000.0, infrared_below=240.0)
    warm = lf.equilibrium(flyer, state, model)
    assert warm.absorbed_power == pytest.approx(
        warm.gas_power + warm.radiated_power, rel=1e-9, abs=0.0
    )
