"""The kinetic force model: its table as smooth functions, and what flyers make of it."""

from typing import ClassVar

import jax
import numpy as np
import pytest
from scipy.optimize import approx_fprime

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation
from lightflyer.force import kinetic_table
from lightflyer.force.kinetic_table import kinetic_fit

GASES = kinetic_table.GASES
COLD = 205.0


def state_at(knudsen, radius=0.01, **more):
    """The surroundings in which a disk has this Knudsen number."""
    pressure = lf.gas.mean_free_path(1.0, COLD, lf.gas.AIR) / (2.0 * radius * knudsen)
    return lf.environment.EnvironmentState(
        pressure, COLD, 9.6, lf.gas.AIR, lf.environment.Radiation(), **more
    )


def maxwell_limits(disk, state, excess):
    """Force and heat loss of free molecules at Maxwell walls, from their fluxes."""
    difference = disk.film.tac_bottom - disk.film.tac_top
    force = 0.5 * state.pressure * disk.area * difference * (np.sqrt(1.0 + excess) - 1.0)
    arriving = state.pressure / np.sqrt(2.0 * np.pi * 287.0531 * COLD)  # mass per area and time
    energy = 3.0 * 287.0531 * COLD * excess  # per mass: two modes of flux, two of rotation
    both = disk.film.tac_bottom + disk.film.tac_top
    return force, arriving * energy * both * disk.area


def misfits(fit, table):
    """Relative deviation of the fit from a table, and the table's own relative bounds."""
    where = (table.knudsen, table.temperature_ratio, table.tac)
    with lf.float64():
        force, heat = np.asarray(fit.force_ratio(*where)), np.asarray(fit.heat_ratio(*where))
    return (
        (abs(force / table.force_ratio - 1.0), table.force_ratio_error / table.force_ratio),
        (abs(heat / table.heat_ratio - 1.0), table.heat_ratio_error / table.heat_ratio),
    )


@pytest.mark.parametrize("gas", GASES)
def test_fit_follows_the_table(gas):
    """To half a per cent, at every Knudsen number."""
    for misfit, _ in misfits(kinetic_fit(gas), kinetic_table.kinetic_table(gas)):
        assert np.all(misfit < 5e-3)


@pytest.mark.parametrize("gas", GASES)
def test_fit_predicts_what_it_was_not_shown(gas):
    """Between the table's Knudsen numbers the fit is as good as at them."""
    table = kinetic_table.kinetic_table(gas)
    for hidden in np.unique(table.knudsen)[1:-1]:
        shown, kept = (
            [column[rows] for column in vars(table).values()]
            for rows in (table.knudsen != hidden, table.knudsen == hidden)
        )
        fit = kinetic_table.fit(kinetic_table.Table(*shown), kinetic_table.wall_table(gas))
        for misfit, _ in misfits(fit, kinetic_table.Table(*kept)):
            assert np.all(misfit < 4e-3)


def test_thin_gas_gives_free_molecules(disk):
    state = state_at(1e6)
    force, heat = maxwell_limits(disk, state, 0.8)
    # as ratios: both are too small for an absolute tolerance
    maxwell = lf.Kinetic(wall="maxwell")
    assert maxwell.force(disk, state, (0.8,)) / force == pytest.approx(1.0, rel=1e-5)
    assert lf.Kinetic().heat_loss(disk, state, (0.8,))[0] / heat == pytest.approx(1.0, rel=1e-4)


def test_dense_gas_conducts(disk):
    """8rκΔT of an isothermal disk, with the conductivity of the table's diatomic gas.

    The table ends at three quarters of this; that its continuation arrives there is a check of
    both.
    """
    excess, eucken_translation, eucken_rotation = 1e-3, 2.37, 1.31
    state = state_at(1e-5)
    conductivity = (
        lf.gas.AIR.viscosity(COLD) * 287.0531 * (1.5 * eucken_translation + eucken_rotation)
    )
    conducted = 8.0 * disk.radius * conductivity * COLD * excess
    assert lf.Kinetic().heat_loss(disk, state, (excess,))[0] == pytest.approx(conducted, rel=0.02)


@pytest.mark.parametrize("excess", [1e-3, 0.8, 1.4])
def test_force_goes_on_smoothly_below_the_table(excess):
    """Value and slope are those at the table's end, at every temperature."""
    fit = kinetic_fit()
    end = fit.knudsen_range[0]
    with lf.float64():
        logarithms = [
            float(jax.numpy.log(fit.force_ratio(end * factor, 1.0 + excess, 0.85)))
            for factor in (0.998, 0.999, 1.0, 1.001, 1.002)
        ]
    slopes = np.diff(logarithms) / 1e-3
    assert slopes[0] == pytest.approx(slopes[3], rel=0.01)


def test_force_vanishes_faster_than_heat_in_dense_gas(disk):
    model, unknowns = lf.Kinetic(), (1.0,)
    knudsen = (2e-3, 2e-4, 2e-5)
    forces = [model.force(disk, state_at(number), unknowns) for number in knudsen]
    heats = [model.heat_loss(disk, state_at(number), unknowns)[0] for number in knudsen]
    # pressure tenfold: the force falls by the power law of the table's end, the heat loss tends
    # to that of conduction, which does not depend on pressure
    assert np.diff(np.log(forces)) == pytest.approx(np.diff(np.log(forces))[0], abs=0.02)
    assert forces[1] < 0.6 * forces[0]
    assert heats[2] == pytest.approx(heats[1], rel=5e-3)


@pytest.mark.parametrize("gas", GASES)
def test_ratios_lie_between_zero_and_one_and_heat_grows(gas, rng):
    """Far beyond the table too, where a root-find may look."""
    fit, count = kinetic_fit(gas), 20_000
    knudsen = np.exp(rng.uniform(np.log(1e-4), np.log(1e4), count))
    excess, tac = rng.uniform(-0.5, 20.0, count), rng.uniform(0.05, 1.3, count)

    @lf.entry_point
    def look(knudsen, excess, tac):
        def heat(excess):
            return excess * fit.heat_ratio(knudsen, 1.0 + excess, tac)

        slope = jax.jvp(heat, (excess,), (jax.numpy.ones_like(excess),))[1]
        return fit.force_ratio(knudsen, 1.0 + excess, tac), heat(excess) / excess, slope

    force, heat, slope = look(knudsen, excess, tac)
    for ratio in (force, heat):
        assert np.all((ratio > 0.0) & (ratio <= 1.0))
    assert np.all(slope > 0.0)


def test_gradient_is_that_of_differences(film):
    def lift(inputs):
        knudsen, radius, irradiance, wall = inputs
        environment = EnvironmentState(
            1.0 / knudsen, COLD, 9.6, lf.gas.AIR, Radiation(irradiance), wall
        )
        return lf.lift(lf.Disk(film, radius), environment, lf.Kinetic(0.0, 0.0), throw=False) * 1e6

    inputs = np.array([0.4, 0.01, 1000.0, 0.05])
    with lf.float64():
        compiled = jax.jit(lift)
        gradient = np.array(jax.jit(jax.grad(lift))(jax.numpy.asarray(inputs)))
        differences = approx_fprime(inputs, lambda x: float(compiled(x)), 1e-7 * inputs)
    np.testing.assert_allclose(gradient, differences, rtol=1e-5)


def test_walls_far_away_do_nothing_and_near_ones_raise_the_force(disk):
    model, unknowns = lf.Kinetic(), (0.8,)
    states = [state_at(0.3, wall_distance=wall) for wall in (None, 100.0, 0.03)]
    force = [float(model.force(disk, state, unknowns)) for state in states]
    heat = [float(model.heat_loss(disk, state, unknowns)[0]) for state in states]
    assert force[1] == pytest.approx(force[0], rel=1e-3)
    assert heat[1] == pytest.approx(heat[0], rel=1e-3)
    # the solver's own table at three radii and this Knudsen number
    walls = kinetic_table.wall_table("diatomic")
    row = np.argmin(abs(walls.knudsen - 0.3) + abs(walls.boundary - 3.0))
    assert walls.boundary[row] == pytest.approx(3.0, rel=0.1)
    assert force[2] / force[0] == pytest.approx(walls.force_factor[row], rel=0.05)
    assert heat[2] / heat[0] == pytest.approx(walls.heat_factor[row], rel=0.01)


def test_a_chamber_has_its_radius(disk, film):
    small = lf.Chamber(radius=0.04)
    assert small.state(1.0).wall_distance == 0.04
    assert lf.Chamber().state(1.0).wall_distance is None
    with pytest.raises(lf.ParameterError, match="radius = -1 is not positive"):
        lf.Chamber(radius=-1.0)


def test_errors_count_in_the_models_own_standard_errors(disk):
    state, fit = state_at(0.2), kinetic_fit()
    with lf.float64():
        ratio = fit.force_ratio(0.2, 1.8, 0.85)
        of_force = float(fit.relative_force_error(0.2, ratio))
        of_heat = float(fit.relative_heat_error(0.2))
    assert 0.0 < of_heat < of_force < 0.2
    off, on = (lf.Kinetic(*errors, wall="maxwell") for errors in ((), (1.0, -1.0)))
    growth = on.force(disk, state, (0.8,)) / off.force(disk, state, (0.8,))
    assert growth == pytest.approx(1.0 + of_force)
    growth = on.heat_loss(disk, state, (0.8,))[0] / off.heat_loss(disk, state, (0.8,))[0]
    assert growth == pytest.approx(1.0 - of_heat, rel=1e-3)


# Kn of hard spheres, temperatures [K], force over its free-molecular value and its standard
# deviation; nitrogen, TACs 0.5 and 1, reservoir at 4 radii
DIRECT_SIMULATIONS = [
    (3.0, 450.0, 300.0, 0.976, 0.022),
    (1.0, 450.0, 300.0, 0.865, 0.015),
    (0.1, 450.0, 300.0, 0.189, 0.017),
    (1.0, 480.0, 205.0, 0.906, 0.008),
]


@pytest.mark.parametrize(("knudsen", "hot", "cold", "simulated", "noise"), DIRECT_SIMULATIONS)
def test_direct_simulations_lie_within_the_stated_error(knudsen, hot, cold, simulated, noise):
    fit, ours = kinetic_fit(), knudsen / (16.0 / (5.0 * np.pi))
    with lf.float64():
        ratio = fit.force_ratio(ours, hot / cold, 0.75)
        error = fit.relative_force_error(ours, ratio)
        wall, _ = fit.wall_factors(ours, 4.0)
    predicted = float(ratio * wall)
    assert abs(predicted - simulated) < 2.0 * np.hypot(noise, float(error) * predicted)


class Argon(lf.gas.AbstractGas):
    """A user's own gas: viscosity by a power law, conductivity by the monatomic Prandtl number."""

    name: ClassVar[str] = "argon"
    molecules: ClassVar[str] = "monatomic"
    specific_gas_constant: float = 208.1
    heat_capacity_ratio: float = 5.0 / 3.0

    def viscosity(self, temperature):
        return 2.125e-5 * (temperature / 273.0) ** 0.72

    def conductivity(self, temperature):
        return 1.5 * self.heat_capacity(temperature) * self.viscosity(temperature)

    def heat_capacity(self, temperature):
        return 2.5 * self.specific_gas_constant + 0.0 * temperature


class CarbonDioxide(Argon):
    name: ClassVar[str] = "carbon dioxide"
    molecules: ClassVar[str] = "polyatomic"


def in_gas(gas):
    return EnvironmentState(3.0, COLD, 9.6, gas, Radiation())


def test_the_table_is_that_of_the_gas(disk):
    """Argon answers by the monatomic table, no longer by that of air."""
    argon, excess = Argon(), 0.8
    state = in_gas(argon)
    knudsen = lf.gas.knudsen_number(3.0, COLD, disk.radius, argon)
    force, _ = maxwell_limits(disk, state, excess)
    with lf.float64():
        ratio = float(kinetic_fit("monatomic").force_ratio(knudsen, 1.0 + excess, 0.85))
        other = float(kinetic_fit("diatomic").force_ratio(knudsen, 1.0 + excess, 0.85))
    found = lf.Kinetic(wall="maxwell").force(disk, state, (excess,))
    assert found == pytest.approx(ratio * force, rel=1e-12)
    assert abs(ratio / other - 1.0) > 0.02


def test_a_gas_without_a_table_is_refused_by_name(disk):
    for function in (lf.equilibrium, lf.levitate, lf.lift):
        with pytest.raises(lf.ParameterError, match="Kinetic is not for carbon dioxide"):
            function(disk, in_gas(CarbonDioxide()), lf.Kinetic())
    assert lf.lift(disk, in_gas(CarbonDioxide()), lf.Lu2023()) > 0.0


def test_in_a_flyer_file_its_error_counts(flyer_file):
    text = flyer_file().read_text("utf-8").partition("[force]")[0] + '[force]\nmodel = "kinetic"\n'
    path = flyer_file(text=text)
    configuration = lf.read_flyer_file(path)
    names = ("force_error", "heat_error", "wall_error")
    assert configuration.uncertainties() == {f"force.{name}": 1.0 for name in names}
    model = configuration.build().model
    assert isinstance(model, lf.Kinetic)
    certain = lf.read_flyer_file(flyer_file(text=text + "\n".join(f"{n} = 0" for n in names)))
    assert certain.uncertainties() == {}


def test_simple_form_of_the_kinetic_force(disk):
    state = state_at(np.geomspace(0.05, 3.0, 30))
    form = lf.force.fit_simple_form(lf.Kinetic(), disk, state, 1.0)
    ours = lf.Kinetic().force(disk, state, (1.0,))
    logarithms = np.log(form.model.force(disk, state, (1.0,)) / ours)
    assert form.deviation == pytest.approx(np.sqrt(np.mean(logarithms**2)), rel=1e-6)
    for change in (0.98, 1.02):  # a minimum
        for other in (
            lf.Lu2023(form.model.c_fm * change, form.model.c_cont),
            lf.Lu2023(form.model.c_fm, form.model.c_cont * change),
        ):
            assert np.sum(np.log(other.force(disk, state, (1.0,)) / ours) ** 2) > np.sum(
                logarithms**2
            )
    with pytest.raises(lf.ParameterError, match="must be positive"):
        lf.force.fit_simple_form(lf.Kinetic(), disk, state, -0.2)
