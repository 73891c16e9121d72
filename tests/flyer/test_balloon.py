import numpy as np
import pytest

import lightflyer as lf

SIGMA = 5.670374419e-8
CUBIC_FOOT = 0.3048**3  # [m³]


def film_of(**changed):
    properties = {
        "areal_density": 0.012, "absorptance": 0.5, "emittance_top": 0.6, "emittance_bottom": 0.3,
        "tac_top": 0.9, "tac_bottom": 0.8, "absorptance_bottom": 0.4, "transmittance": 0.3,
        "infrared_transmittance": 0.2,
    }  # fmt: skip
    return lf.FilmProperties(**(properties | changed))


def balloon_of(**changed):
    return lf.Balloon(**({"film": film_of(), "radius": 3.0, "opening_radius": 0.6} | changed))


def state_at(pressure=5500.0, temperature=220.0, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(pressure, temperature, 9.7, lf.gas.AIR, radiation)


def with_volume(volume, **changed):
    return balloon_of(radius=(0.75 * volume / np.pi) ** (1.0 / 3.0), opening_radius=0.0, **changed)


@pytest.mark.parametrize(("celsius", "lift"), [(99.0, 723.5), (120.0, 867.3)])
def test_lift_of_hot_air_is_the_published_one(celsius, lift):
    """Of 100,000 ft³ of dry air in air of 20 °C at sea level, as tables for pilots have it."""
    flyer, state = with_volume(1e5 * CUBIC_FOOT), state_at(101325.0, 293.15)
    excess = (celsius + 273.15) / 293.15 - 1.0
    with lf.float64():
        found = float(flyer.buoyancy(state, (excess,))) / state.gravity
        assert flyer.buoyancy(state, (0.0,)) == 0.0
    assert found == pytest.approx(lift, rel=2e-3)


def test_small_differences_keep_their_digits():
    flyer, state = balloon_of(), state_at()
    density = 5500.0 / (lf.gas.AIR.specific_gas_constant * 220.0)
    with lf.float64():
        found = float(flyer.buoyancy(state, (1e-12,)))
    assert found == pytest.approx(density * flyer.volume * 9.7 * 1e-12, rel=1e-11)


def test_lift_gases_at_standard_conditions():
    """Helium lifts 1.114 kg/m³ and hydrogen 1.203 kg/m³ in dry air at 0 °C."""
    state = state_at(101325.0, 273.15)
    for molar_mass, lift in ((4.0026e-3, 1.114), (2.016e-3, 1.203)):
        flyer = with_volume(1.0, molar_mass=molar_mass)
        with lf.float64():
            found = float(flyer.buoyancy(state, (0.0,))) / state.gravity
        assert found == pytest.approx(lift, rel=1e-3)


def test_closed_balloon_lifts_the_same_until_it_is_full():
    mass, molar_mass = 1.0, 4.0026e-3
    flyer = balloon_of(opening_radius=0.0, gas_mass=mass, molar_mass=molar_mass)
    lifts = []
    for pressure in (1e5, 3e4, 1e4):
        state = state_at(pressure, 250.0)
        with lf.float64():
            within = flyer.filling(state, 0.1)
            lifts.append(float(flyer.buoyancy(state, (0.1,))) / 9.7)
        assert float(within.overpressure) == 0.0
    ratio = lf.gas.AIR.specific_gas_constant * molar_mass / 8.314462618
    np.testing.assert_allclose(lifts, mass * (1.1 / ratio - 1.0), rtol=1e-9)
    thin = state_at(3e3, 250.0)
    with lf.float64():
        within = flyer.filling(thin, 0.1)
        lift = float(flyer.buoyancy(thin, (0.1,))) / 9.7
    total = mass * 8.314462618 / molar_mass * 275.0 / flyer.volume  # ideal gas
    assert float(within.overpressure) == pytest.approx(total - 3e3, rel=1e-9)
    density = 3e3 / (lf.gas.AIR.specific_gas_constant * 250.0)
    assert lift == pytest.approx(density * flyer.volume - mass, rel=1e-12)


def followed(faces, hole, irradiances, emitted=(0.0, 0.0), bounces=3000):
    """Follow diffuse radiation within a sphere of unit area with a hole from bounce to bounce.

    ``faces`` has absorptance and transmittance of the outer and the inner face; ``irradiances``
    the mean over the sphere and that in the hole. Returns what the film absorbs, net of what it
    emits, and all that leaves.
    """
    (a_out, t_out), (a_in, t_in) = faces
    mean, through_hole = irradiances
    onto_film = mean - hole * through_hole  # power
    absorbed = a_out * onto_film - (1.0 - hole) * sum(emitted)
    leaving = (1.0 - a_out - t_out) * onto_film + (1.0 - hole) * emitted[0]
    within = t_out * onto_film + hole * through_hole + (1.0 - hole) * emitted[1]
    for _ in range(bounces):
        on_film = (1.0 - hole) * within
        leaving += hole * within + t_in * on_film
        absorbed += a_in * on_film
        within = (1.0 - a_in - t_in) * on_film
    return absorbed, leaving


def test_absorbed_radiation_is_the_sum_of_its_bounces():
    flyer = balloon_of()
    hole = 0.6**2 / (4.0 * 3.0**2)
    state = state_at(
        irradiance=1000.0, zenith_angle=0.5, albedo=0.3, diffuse_above=20.0, infrared_above=10.0,
        infrared_below=240.0, ground_view=0.96,
    )  # fmt: skip
    ground = 0.5 * (1.0 - np.sqrt(0.04))
    light, heat = ((0.5, 0.3), (0.4, 0.3)), ((0.6, 0.2), (0.3, 0.2))
    reflected = 0.3 * np.cos(0.5)
    beam, _ = followed(light, hole, (0.25 + reflected * ground, reflected * 0.96))
    diffuse, _ = followed(light, hole, (20.0 * (1.0 - ground), 20.0 * 0.04))
    above, below = 10.0 - SIGMA * 220.0**4, 240.0 - SIGMA * 220.0**4
    infrared, _ = followed(
        heat, hole, (above + ground * (below - above), above + 0.96 * (below - above))
    )
    surface = 4.0 * np.pi * 9.0
    with lf.float64():
        areas, gains = flyer.beam_areas(state), flyer.heat_gains(state)
    np.testing.assert_allclose(areas, (surface * beam,), rtol=1e-12)
    np.testing.assert_allclose(gains, (surface * (diffuse + infrared),), rtol=1e-12)


def test_emission_is_the_sum_of_its_bounces_and_energy_closes():
    flyer, state = balloon_of(), state_at()
    hole, warm = 0.6**2 / 36.0, SIGMA * (220.0**4 * (1.3**4 - 1.0))
    emitted = (0.6 * warm, 0.3 * warm)
    absorbed, leaving = followed(((0.6, 0.2), (0.3, 0.2)), hole, (0.0, 0.0), emitted)
    assert leaving == pytest.approx(-absorbed, rel=1e-12)
    with lf.float64():
        (lost,) = flyer.heat_losses(state, (0.3,))
        assert flyer.heat_losses(state, (0.0,)) == (0.0,)
    assert float(lost) == pytest.approx(4.0 * np.pi * 9.0 * leaving, rel=1e-12)


def test_mass_and_description():
    flyer = balloon_of(payload=2.0)
    area = 4.0 * np.pi * 9.0 - np.pi * 0.36
    assert flyer.own_mass == pytest.approx(0.012 * area, rel=1e-14)
    assert flyer.mass == pytest.approx(0.012 * area + 2.0, rel=1e-14)
    assert flyer.describe() == "open balloon of 6 m"
    assert balloon_of(opening_radius=0.0, gas_mass=1.0).describe() == "closed balloon of 6 m"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"radius": 0.0}, "radius = 0 is not positive"),
        ({"opening_radius": -0.1}, "opening_radius = -0.1 is"),
        ({"opening_radius": 3.0}, "the opening must be smaller than the balloon"),
        ({"gas_mass": 1.0}, "a closed balloon, which has a gas_mass, has no opening"),
        ({"molar_mass": 0.0}, "molar_mass = 0 is not positive"),
        ({"film_strength": 0.0}, "film_strength = 0 is not positive"),
    ],
)
def test_impossible_numbers_raise(changed, message):
    with pytest.raises(lf.ParameterError, match=message):
        balloon_of(**changed)


def test_tilt_turns_the_opening():
    """An opening that faces the sun lets its light in."""
    tilted = balloon_of(attitude=lf.environment.Attitude(np.pi))
    state = state_at(irradiance=1000.0)
    hole = 0.6**2 / 36.0
    absorbed, _ = followed(((0.5, 0.3), (0.4, 0.3)), hole, (0.25, 1.0))
    with lf.float64():
        found = float(tilted.beam_areas(state)[0])
    assert found == pytest.approx(4.0 * np.pi * 9.0 * absorbed, rel=1e-12)
