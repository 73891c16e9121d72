"""The kinetic force model: its table as smooth functions, and what flyers make of it."""

import csv
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np
import pytest
from kinetic_fits import disk as fits
from kinetic_fits.common import some, table_of
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation
from lightflyer.force.fitted import GASES
from lightflyer.force.kinetic import disk as kinetic_disk
from lightflyer.force.kinetic.collisions import (
    FORCE_ERROR,
    FORCE_HEATED,
    HEAT_ERROR,
    HEAT_HEATED,
    HEATED_ERROR,
    with_collisions,
)
from lightflyer.force.kinetic.ratios import kinetic_fit

COLD = 205.0


def state_at(knudsen, radius=0.01, gas=lf.gas.AIR, **more):
    """The surroundings in which a disk has this Knudsen number."""
    pressure = lf.gas.mean_free_path(1.0, COLD, gas) / (2.0 * radius * knudsen)
    return lf.environment.EnvironmentState(
        pressure, COLD, 9.6, gas, lf.environment.Radiation(), **more
    )


def maxwell_limits(disk, state, excess):
    """Force and heat loss of free molecules at Maxwell walls, from their fluxes."""
    difference = disk.film.tac_bottom - disk.film.tac_top
    force = 0.5 * state.pressure * disk.area * difference * (np.sqrt(1.0 + excess) - 1.0)
    thermal = state.gas.specific_gas_constant * COLD
    arriving = state.pressure / np.sqrt(2.0 * np.pi * thermal)  # mass per area and time
    modes = 3.0 if state.gas.molecules == "diatomic" else 2.0  # two of flux, two of rotation
    energy = modes * thermal * excess  # per mass
    both = disk.film.tac_bottom + disk.film.tac_top
    return force, arriving * energy * both * disk.area


def misfits(fit, table):
    """Relative deviations of the fit's force and heat from a table."""
    where = (
        table.knudsen,
        table.temperature_ratio,
        table.tac,
        table.tac_difference,
        table.viscosity_exponent,
    )
    with lf.float64():
        force, heat = np.asarray(fit.force_ratio(*where)), np.asarray(fit.heat_ratio(*where))
    return abs(force / table.force_ratio - 1.0), abs(heat / table.heat_ratio - 1.0)


@pytest.mark.parametrize("gas", GASES)
def test_fit_follows_the_table(gas):
    """At every temperature ratio, TAC, difference of TACs and viscosity exponent."""
    table = table_of("kinetic", gas)
    force, heat = misfits(kinetic_fit(gas), table)
    dense = table.knudsen < 0.1
    assert np.all(force < np.where(dense, 1e-2, 5e-3))
    assert np.all(heat < np.where(table.tac_difference > 0.1, 5e-3, 3e-3))


@pytest.mark.parametrize("hidden", [0.04, 0.125, 1.5])
def test_fit_predicts_what_it_was_not_shown(hidden):
    """Between the table's Knudsen numbers the fit is as good as its stated error."""
    table = table_of("kinetic", "diatomic")
    rows = table.knudsen == hidden
    fit = fits.fit("diatomic", some(table, ~rows), table_of("kinetic_boundary", "diatomic"))
    stated = float_of(lambda: jax.numpy.stack(kinetic_fit().table_errors(hidden)))
    unlike = table.tac_difference > 0.1  # of which there are fewer rows
    pairs = zip(misfits(fit, table), stated, (0.01, 0.005), strict=True)
    for misfit, error, of_unlike in pairs:
        assert np.all((misfit < np.where(unlike, of_unlike, 4.0 * error))[rows])


def test_the_ends_of_the_table_are_no_kinks(disk):
    """At one, Newton's method finds no temperature of a flyer that levitates there."""
    state, model = state_at(0.2), lf.Kinetic(wall="maxwell")
    excess = np.arange(2.3, 2.8, 1e-3)
    force = jax.vmap(jax.grad(lambda e: model.force(disk, state, (e,))))
    slopes = float_of(lambda: force(excess))
    assert np.abs(np.diff(slopes)).max() < 0.1 * np.ptp(slopes)


def test_a_heat_balance_may_step_below_zero_kelvin(disk):
    """There must be a slope that leads back."""
    state, model = state_at(0.2), lf.Kinetic()
    steps = np.array([-5.0, -1.5, -1.0, -0.95])
    loss = float_of(lambda: model.heat_loss(disk, state, (steps,))[0])
    assert np.all(np.diff(loss) > 0.0)
    assert loss[-1] < 0.0


def float_of(function):
    """Float64 results of a function without arguments."""
    with lf.float64():
        return np.asarray(function())


@pytest.mark.parametrize(("gas", "heat_capacity", "conductivity"), [
    ("monatomic", 1.5, 15.0 / 4.0),
    ("diatomic", 2.5, 1.5 * 2.37 + 1.31),  # Eucken factors of translation and rotation
])  # fmt: skip
def test_the_table_ends_in_conduction(gas, heat_capacity, conductivity):
    """8rκΔT of an isothermal disk, per 2αA p c̄ (c_v + R/2)ΔT/4RT of free molecules.

    The solver's last Knudsen numbers are within 2 % of it at large TACs, where the jump of
    temperature at the faces is small. The fit goes on to it.
    """
    table = table_of("kinetic", gas)
    rows = (table.knudsen <= 0.013) & (table.tac >= 0.8) & (table.temperature_ratio == 1.0)
    # in units of pr²ΔT √(RT)/T; μ = λp √(2/πRT), λ = 2r Kn, c̄ = √(8RT/π)
    free = 2.0 * np.pi * np.sqrt(8.0 / np.pi) * (heat_capacity + 0.5) / 4.0
    conducted = 8.0 * conductivity * 2.0 * np.sqrt(2.0 / np.pi)
    resistance = (1.0 / table.heat_ratio - 1.0) * table.knudsen / table.tac
    np.testing.assert_allclose(resistance[rows], free / conducted, rtol=0.02)
    ratio = float_of(lambda: kinetic_fit(gas).heat_ratio(1e-6, 1.0, 0.5))
    assert ratio == pytest.approx(conducted / free * 1e-6 / 0.5, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.5, 2.0, 3.5])
@pytest.mark.parametrize("exponent", [0.5, 0.93])
def test_conduction_grows_with_temperature(ratio, exponent):
    """Kirchhoff's integral of the conductivity, which is exact in the continuum."""
    fit, mean = kinetic_fit(), quad(lambda t: t**exponent, 1.0, ratio)[0] / (ratio - 1.0)
    hot, cold = float_of(
        lambda: fit.heat_ratio(1e-6, np.array([ratio, 1.0]), 0.8, viscosity_exponent=exponent)
    )
    assert hot / cold == pytest.approx(mean, rel=2e-3)


@pytest.mark.parametrize("excess", [1e-3, 0.8, 1.4, -0.4])
def test_force_goes_on_smoothly_below_the_table(excess):
    """Value and nearly the slope are those at the table's end, at every temperature."""
    fit = kinetic_fit()
    end = fit.knudsen_range[0]
    knudsen = end * np.array([0.998, 0.999, 1.0, 1.001, 1.002])
    logarithms = np.log(float_of(lambda: fit.force_ratio(knudsen, 1.0 + excess, 0.85)))
    slopes = np.diff(logarithms) / 1e-3
    assert slopes[0] == pytest.approx(2.0, rel=0.01)
    assert slopes[3] == pytest.approx(slopes[0], rel=0.05)


@pytest.mark.parametrize("gas", [lf.gas.AIR, lf.gas.HELIUM, lf.gas.ARGON])
@pytest.mark.parametrize(("cold", "hot"), [(205.0, 480.0), (295.0, 500.0), (205.0, 150.0)])
def test_viscosity_exponent_is_that_between_the_temperatures(gas, cold, hot):
    between = np.log(gas.viscosity(hot) / gas.viscosity(cold)) / np.log(hot / cold)
    found = kinetic_disk.viscosity_exponent(gas, cold, hot / cold)
    assert float(found) == pytest.approx(float(between), abs=0.007)


def test_a_small_difference_can_be_reversed():
    """Warmer or colder than the gas, the ratios leave the linear ones with the same slope."""
    fit = kinetic_fit()
    for function in (fit.force_ratio, fit.heat_ratio):
        cold, linear, hot = float_of(lambda: function(0.1, np.array([0.99, 1.0, 1.01]), 0.8))  # noqa: B023
        assert hot - linear == pytest.approx(linear - cold, rel=0.03)


@pytest.mark.parametrize("gas", GASES)
def test_ratios_lie_between_zero_and_one_and_heat_grows(gas, rng):
    """Far beyond the table too, where a root-find may look."""
    fit, count = kinetic_fit(gas), 20_000
    apart = rng.uniform(-1.9, 1.9, count)  # times the mean: both TACs are positive
    knudsen = np.exp(rng.uniform(np.log(1e-4), np.log(1e4), count))
    excess, tac = rng.uniform(-0.5, 20.0, count), rng.uniform(0.05, 1.3, count)

    @lf.entry_point
    def look(knudsen, excess, tac):
        def heat(excess):
            return excess * fit.heat_ratio(knudsen, 1.0 + excess, tac, apart * tac, 0.9)

        slope = jax.jvp(heat, (excess,), (jax.numpy.ones_like(excess),))[1]
        force = fit.force_ratio(knudsen, 1.0 + excess, tac, apart * tac, 0.9)
        return force, heat(excess) / excess, slope

    force, heat, slope = look(knudsen, excess, tac)
    for ratio in (force, heat):
        assert np.all((ratio > 0.0) & (ratio <= 1.0))
    assert np.all(slope > 0.0)


def test_gradient_is_that_of_differences(require_derivatives, film):
    def lift(inputs):
        knudsen, radius, irradiance, wall = inputs
        environment = EnvironmentState(
            1.0 / knudsen, COLD, 9.6, lf.gas.AIR, Radiation(irradiance), wall
        )
        lifted = lf.lift(lf.Disk(film, radius), environment, lf.Kinetic(0.0, 0.0), throw=False)
        return 1e6 * lifted[None]

    require_derivatives(lift, np.array([0.4, 0.01, 1000.0, 0.05]), rtol=1e-5, atol=1e-9)


# Knudsen number, half-width [radii], T_h/T_c, factors of force and heat of the non-linear problem
# by the coarse mesh: Maxwell's walls, TACs 0.8 and 0.9, diatomic
HOT_RESERVOIR = [
    (0.3, 2.0, 2.34, 1.3509, 1.0739),
    (0.3, 4.0, 3.3, 1.2282, 1.0489),
    (0.1, 4.0, 2.34, 1.4476, 1.0746),
    (1.0, 2.0, 2.34, 1.0849, 1.0200),
]


@pytest.mark.parametrize(("knudsen", "distance", "ratio", "force", "heat"), HOT_RESERVOIR)
def test_a_reservoir_around_a_hot_disk(disk, knudsen, distance, ratio, force, heat):
    """The gas near it is hot, and the share of its resistance that is left is less."""
    model = lf.Kinetic(wall="maxwell", collisions="shakhov")
    walled, opened = (
        state_at(knudsen, wall_distance=wall) for wall in (float(disk.radius) * distance, None)
    )
    excess = (ratio - 1.0,)
    found = model.force(disk, walled, excess) / model.force(disk, opened, excess)
    assert found == pytest.approx(force, rel=0.015)
    (warm,), (in_the_open,) = (model.heat_loss(disk, where, excess) for where in (walled, opened))
    assert warm / in_the_open == pytest.approx(heat, rel=3e-3)


# mean TAC, factors of force and heat of the linear problem by the coarse mesh: diatomic, Kn 0.3, a
# reservoir at 3 radii
CHAMBER = [(0.1, 1.2299, 1.0056), (0.35, 1.2424, 1.0184), (0.85, 1.2617, 1.0395)]


@pytest.mark.parametrize(("tac", "force", "heat"), CHAMBER)
def test_walls_around_smooth_disks(tac, force, heat):
    """The table of walls is for one mean TAC; others follow from it."""
    found = float_of(lambda: jax.numpy.stack(kinetic_fit().wall_factors(0.3, 3.0, tac)))
    np.testing.assert_allclose(found - 1.0, [force - 1.0, heat - 1.0], rtol=0.04)


@pytest.mark.parametrize(
    ("distance", "force", "heat"), [(2.0, 0.3542, 0.5670), (4.0, 0.2698, 0.5433)]
)
def test_walls_around_very_unlike_faces(distance, force, heat):
    """Solved for TACs of 0.01 and 1 by the coarse mesh: linear, diatomic, Kn 0.0982."""
    fit, faces = kinetic_fit(), (0.505, 0.99)
    walls = float_of(lambda: jax.numpy.stack(fit.wall_factors(0.0982, distance, *faces)))
    opened = [function(0.0982, 1.0, *faces) for function in (fit.force_ratio, fit.heat_ratio)]
    np.testing.assert_allclose(walls * opened, [force, heat], rtol=0.012)
    assert walls[1] * opened[1] == pytest.approx(heat, rel=5e-3)


@pytest.mark.parametrize(
    ("collisions", "of_force", "of_heat"),
    # of what collisions take, and of the heat itself for the model equation
    [("vhs", 0.036, None), ("shakhov", 0.165, 0.0035)],
)
def test_errors_count_in_the_models_own_standard_errors(disk, collisions, of_force, of_heat):
    state, unknowns = state_at(0.2), (0.8,)
    force, heat = maxwell_limits(disk, state, 0.8)
    off, on = (
        lf.Kinetic(*errors, wall="maxwell", collisions=collisions) for errors in ((), (1.0, -1.0))
    )
    ratio = off.force(disk, state, unknowns) / force
    table = float_of(lambda: jax.numpy.stack(kinetic_fit().table_errors(0.2)))
    growth = on.force(disk, state, unknowns) / off.force(disk, state, unknowns)
    if collisions == "vhs":  # what heating does to them is an error as well
        exponent = kinetic_disk.viscosity_exponent(lf.gas.AIR, COLD, 1.8)
        of_force = np.hypot(of_force, HEATED_ERROR * 0.389 * (0.838 - exponent) * np.log(1.8))
    assert growth == pytest.approx(1.0 + np.hypot(table[0], of_force * (1.0 - ratio)))
    (cold,) = off.heat_loss(disk, state, unknowns)
    if of_heat is None:
        of_heat = 0.009 * (1.0 - cold / heat)
    growth = on.heat_loss(disk, state, unknowns)[0] / cold
    assert growth == pytest.approx(1.0 - np.hypot(table[1], of_heat), rel=1e-4)


STUDY = Path(__file__).parents[2] / "studies" / "kinetic_collisions"


@pytest.fixture
def comparison(study_of):
    """Simulations, and solutions of model equation and linear factors beside each."""
    with study_of("kinetic_collisions", "comparison") as module:
        yield module


@pytest.mark.parametrize(
    ("quantity", "heated", "error", "of_heating"),
    [
        ("force", FORCE_HEATED, FORCE_ERROR, HEATED_ERROR),
        ("heat", HEAT_HEATED, HEAT_ERROR, 0.0),
    ],
)
def test_direct_simulations_lie_within_the_stated_error(
    comparison, quantity, heated, error, of_heating
):
    """Other walls and gases than those to which what heating does was fitted, and these."""
    solved, found = comparison.solved(), {True: [], False: []}
    for one in comparison.simulated():
        place, model = one.place, solved[one.place]
        at = place.kind, place.temperature_ratio, place.exponent
        with lf.float64():
            factor = getattr(model, f"{quantity}_factor") * float(heated(*at))
            corrected = float(with_collisions(getattr(model, quantity), factor))
            own = np.hypot(error, of_heating * float(heated.logarithm(*at)))
        own *= corrected * (1.0 - corrected)
        off = getattr(one, quantity) - corrected
        fitted = place.gas != "nitrogen" and place.boundary == comparison.FITTED
        found[fitted].append(off / np.hypot(getattr(one, f"{quantity}_error"), own))
    assert len(found[True]) >= 6
    assert len(found[False]) >= 22
    for deviations in found.values():
        assert np.mean(np.square(deviations)) < 2.0
        assert max(map(abs, deviations)) < 3.0
    assert np.mean(np.abs(found[False]) < 1.96) >= 0.9


def test_simulations_in_reservoirs_lie_within_the_whole_models_error(disk):
    """Maxwell's walls, three gases; force and heat by all tables: 95 % bounds."""
    table = (STUDY.parent / "direct_simulation" / "peer.csv").read_text().splitlines()
    deviations = []
    for row in csv.DictReader(line for line in table if not line.startswith("#")):
        if row["gas"] not in ("nitrogen", "argon", "helium"):
            continue
        film = replace(
            disk.film, tac_top=float(row["tac_top"]), tac_bottom=float(row["tac_bottom"])
        )
        body, gas = replace(disk, film=film), getattr(lf.gas, row["gas"].upper())
        where = float(row["boundary"]) * float(disk.radius)
        state = state_at(float(row["knudsen"]), gas=gas, wall_distance=where)
        excess = float(row["temperature_ratio"]) - 1.0
        force, heat = maxwell_limits(body, state, excess)

        def ratios(*errors, body=body, state=state, excess=(excess,), limits=(force, heat)):
            model = lf.Kinetic(*errors, wall="maxwell")
            found = model.force(body, state, excess), *model.heat_loss(body, state, excess)
            return np.array(
                [float(one) / float(limit) for one, limit in zip(found, limits, strict=True)]
            )

        stated = ratios(1.0, 1.0) - ratios()
        simulated, noise = (
            np.array([float(row[f"{name}{end}"]) for name in ("force", "heat")])
            for end in ("", "_error")
        )
        # the simulation's bias is known
        deviations.append((ratios() - simulated - [0.002, -0.0005]) / np.hypot(stated, noise))
    assert len(deviations) >= 12
    inside = np.abs(deviations) < 1.96
    assert (inside.mean(axis=0) >= 0.95).all(), np.round(deviations, 1)


def test_the_table_is_that_of_the_gas(disk):
    """Argon answers by the monatomic table, no longer by that of air."""
    argon, excess = lf.gas.ARGON, 0.8
    state = EnvironmentState(3.0, COLD, 9.6, argon, Radiation())
    knudsen = lf.gas.knudsen_number(3.0, COLD, disk.radius, argon)
    force, _ = maxwell_limits(disk, state, excess)
    with lf.float64():
        exponent = kinetic_disk.viscosity_exponent(argon, COLD, 1.0 + excess)
        where = (knudsen, 1.0 + excess, 0.85, 0.1, exponent)
        ratio = float(kinetic_fit("monatomic").force_ratio(*where))
        other = float(kinetic_fit("diatomic").force_ratio(*where))
    found = lf.Kinetic(wall="maxwell", collisions="shakhov").force(disk, state, (excess,))
    assert found == pytest.approx(ratio * force, rel=1e-12)
    assert abs(ratio / other - 1.0) > 0.02


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
