"""Force models of one's own, in plain NumPy, as a theorist writes them in a notebook."""

import dataclasses
import math
import traceback
import types
from dataclasses import replace
from typing import ClassVar

import jax
import numpy as np
import pytest
import scipy.special
from jax.extend.core import jaxprs_in_params

import lightflyer as lf
from lightflyer.force.laws.faces import free_molecular_conductance

STATE = lf.Earth().state(72e3)


class Own(lf.AbstractForceModel):
    """Free molecules take the heat; what pushes is the subclass's."""

    flyers: ClassVar = (lf.Disk,)

    def heat_loss(self, flyer, state, unknowns):
        (excess,) = unknowns
        gas = state.gas
        each = free_molecular_conductance(
            2.0 * flyer.area, flyer.film.tac_mean, state.pressure,
            gas.mean_speed(state.temperature), gas.heat_capacity_ratio,
        )  # fmt: skip
        return (each * excess,)

    def force(self, flyer, state, unknowns):
        (excess,) = unknowns
        share = self.share(excess, state)
        return share * 0.25 * state.pressure * flyer.area * flyer.film.tac_difference * excess


def lifts(disk, model, states=STATE):
    return lf.lift(disk, states, model)


def own(share, **content):
    """A model with a share of its own, as a cell of a notebook makes it."""

    def body(namespace):
        namespace |= {"share": share, **content}

    return types.new_class("Notebook", (Own,), {}, body)()


def plain(disk, state=STATE):
    return lifts(disk, own(lambda self, excess, state: 1.0), state)


def excess(disk, state=STATE):
    return lf.equilibrium(disk, state, own(lambda self, excess, state: 1.0)).excess


def test_a_table_by_numpys_interpolation(disk):
    x, y = np.array([0.0, 1.0, 3.0]), np.array([1.0, 0.5, 0.2])
    model = own(lambda self, excess, state: np.interp(excess, x, y))
    expected = np.interp(excess(disk), x, y) * plain(disk)
    assert lifts(disk, model) == pytest.approx(expected, rel=1e-12)


def test_special_functions_of_scipy(disk):
    model = own(lambda self, excess, state: scipy.special.erf(excess))
    expected = math.erf(excess(disk)) * plain(disk)
    assert lifts(disk, model) == pytest.approx(expected, rel=1e-12)


def test_conditions_and_floats(disk):
    def share(self, excess, state):
        return 0.5 if float(state.pressure) < 1.0 else math.sqrt(2.0)

    assert lifts(disk, own(share)) == pytest.approx(math.sqrt(2.0) * plain(disk), rel=1e-12)
    thin = lf.Earth().state(95e3)
    assert lifts(disk, own(share), thin) == pytest.approx(0.5 * plain(disk, thin), rel=1e-12)


def test_a_changed_constant_counts(disk):
    module = types.ModuleType("notebook")
    module.FACTOR = 1.0
    model = own(lambda self, excess, state: module.FACTOR)
    before = lifts(disk, model)
    module.FACTOR = 3.0
    assert lifts(disk, model) == pytest.approx(3.0 * before, rel=1e-15)
    bands = []
    for factor in (3.0, 30.0):
        module.FACTOR = factor
        bands.append(lf.levitation_band(disk, lf.Earth(), model))
    assert bands[1].upper > bands[0].upper


def test_a_changed_constant_counts_for_derivatives_and_a_search_is_traced_once(disk):
    module, calls = types.ModuleType("notebook"), []

    def share(self, excess, state):
        calls.append(1)
        return module.FACTOR

    def slope_of(function):
        return float(jax.grad(lambda radius: function(lf.Disk(disk.film, radius)))(0.01))

    model, slopes = own(share), []
    for module.FACTOR in (1.0, 3.0):
        slopes.append(slope_of(lambda disk: lifts(disk, model)))
    assert slopes[1] == pytest.approx(3.0 * slopes[0], rel=1e-6)
    calls.clear()
    slope_of(lambda disk: lf.levitate(disk, STATE, model).irradiance)
    assert len(calls) <= 3  # one for each shape and type that the search asks for


def test_what_no_step_of_a_search_changes_is_in_no_loop(disk):
    def share(self, excess, state):
        return 1.0 + 0.1 * lf.xp.sin(state.pressure) * lf.xp.cos(excess)

    def light(pressure):
        state = dataclasses.replace(STATE, pressure=pressure)
        return lf.levitate(disk, state, own(share)).irradiance

    def in_loops(program, within=False):
        for step in program.eqns:
            if within:
                yield step.primitive.name
            for part in jaxprs_in_params(step.params):
                yield from in_loops(part, within or step.primitive.name == "while")

    with lf.float64():
        names = {*in_loops(jax.make_jaxpr(light)(3.0).jaxpr)}
    assert "cos" in names
    assert "sin" not in names


def test_a_class_attribute_and_a_replaced_method_count(disk):
    model = own(lambda self, excess, state: self.factor, factor=1.0)
    before = lifts(disk, model)
    type(model).factor = 2.0
    assert lifts(disk, model) == pytest.approx(2.0 * before, rel=1e-15)
    type(model).share = lambda self, excess, state: 5.0
    assert lifts(disk, model) == pytest.approx(5.0 * before, rel=1e-15)


def test_an_exception_ends_in_the_users_line(disk):
    def share(self, excess, state):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine") as caught:
        lifts(disk, own(share))
    assert traceback.extract_tb(caught.value.__traceback__)[-1].filename == __file__


def test_print_shows_numbers(disk, capsys):
    def share(self, excess, state):
        print(f"excess {excess:.3f} in {state.pressure:.2f} Pa")  # noqa: T201
        return 1.0

    lifts(disk, own(share))
    said = capsys.readouterr().out
    assert f"excess {float(excess(disk)):.3f} in {float(STATE.pressure):.2f} Pa" in said
    assert "Tracer" not in said


def test_a_force_of_none_is_none(disk):
    model = own(lambda self, excess, state: 0.0, force=lambda self, *given: 0)
    assert lifts(disk, model) == 0.0
    assert not lf.predict(disk, lf.Earth(), model).bands


def test_what_a_constructor_sets_must_be_a_field(disk):
    def body(namespace):
        def init(self, factor):
            self.factor = factor

        namespace["__init__"] = init

    lost = types.new_class("Notebook", (Own,), {}, body)
    with pytest.raises(TypeError, match=r"Notebook sets factor, .* write factor: float, or"):
        lost(2.0)

    class Kept(Own):
        factor: float

        def __init__(self, factor):
            self.factor = 2.0 * factor

        def share(self, excess, state):
            return self.factor

    assert lifts(disk, Kept(1.5)) == pytest.approx(3.0 * plain(disk), rel=1e-12, abs=0.0)


def test_bands_of_a_prediction_are_of_its_model_or_none(disk):
    """They are computed when they are asked for, and what the model reads may have changed."""
    share = [1.0]
    model = own(
        lambda self, excess, state: share[0] * (1.0 + 0.1 * (0.0 + self.force_error)),
        __annotations__={"force_error": lf.quantity.StandardErrors | None}, force_error=None,
    )  # fmt: skip
    found, later = (lf.predict(disk, lf.Earth(), replace(model, force_error=0.0)) for _ in "ab")
    design = lf.design.ObjectDesign(found.setup, {"force.force_error": 1.0})
    assert lf.propagate(design, prediction=found, samples=0).bands
    share[0] = 2.0
    with pytest.warns(lf.ParameterWarning, match="other numbers than when this was predicted"):
        assert lf.propagate(design, prediction=later, samples=0) is None


def loses(given):
    """A heat loss that gives something of the power."""
    return {"heat_loss": lambda self, *state: given(1e-5 * np.float64(state[-1][0]))}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"force": lambda self, *given: np.nan}, r"force\(\) of Notebook gives NaN at"),
        (
            {"force": lambda self, *given: np.inf},
            r"force\(\) of Notebook gives an infinite",
        ),
        ({"force": lambda self, *given: np.ones(3)}, r"force\(\) .* of shape \(3,\) where flyer"),
        ({"force": lambda self, *given: np.array(1j)}, r"force\(\) .* must give real numbers"),
        ({"force": lambda self, *given: np.float32(1e-9)}, r"force\(\) .* float32, too coarse"),
        (loses(lambda each: (each * np.ones(3),)), r"heat_loss\(\) .* of"),
        (loses(lambda each: (None,)), r"heat_loss\(\) .* must give real numbers"),
        (loses(lambda each: (each, each)), "a power for each node of the flyer.* not 2"),
        (loses(lambda each: each), "a power for each node of the flyer.* not float64"),
    ],
)
def test_what_is_no_real_number_of_the_right_shape_is_said(disk, content, said):
    model = own(lambda self, excess, state: 1.0, **content)
    for compute in (lf.levitate, lf.lift)["gives" in said :]:  # a search may end elsewhere
        with pytest.raises(lf.ParameterError, match=said):
            compute(disk, STATE, model)


def test_a_prediction_without_a_force_says_whose_it_is(disk):
    model = own(lambda self, excess, state: np.where(excess < 0.1, 1.0, np.nan))
    with pytest.raises(lf.ParameterError, match=r"force\(\) of Notebook gives NaN at \d+ of 301"):
        lf.predict(disk, lf.Earth(), model)


def test_a_heat_loss_that_is_no_number_does_not_mean_that_nothing_levitates(disk):
    model = own(
        lambda self, excess, state: 1.0,
        heat_loss=lambda self, flyer, state, unknowns: (np.nan * unknowns[0],),
    )
    with pytest.raises(lf.ConvergenceError, match=r"heat_loss\(\) and force\(\) of the model give"):
        lf.levitate(disk, STATE, model)


def test_derivatives_say_what_to_write(disk):
    model = own(lambda self, excess, state: np.sqrt(excess))

    def lift_of(radius):
        return lf.lift(lf.Disk(disk.film, radius), STATE, model)

    assert float(lift_of(0.01)) > 0.0
    with pytest.raises(
        lf.ParameterError, match=r"test_own_models.py:\d+.*lightflyer\.xp"
    ) as caught:
        jax.grad(lift_of)(0.01)
    assert len(str(caught.value).splitlines()) == 1
    other = own(lambda self, excess, state: lf.xp.sqrt(excess))
    with lf.float64():
        slope = jax.grad(lambda radius: lf.lift(lf.Disk(disk.film, radius), STATE, other))(0.01)
    step = 1e-5
    ends = [lf.lift(lf.Disk(disk.film, 0.01 + way * step), STATE, other) for way in (1, -1)]
    assert float(slope) == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-6)


def test_many_designs_in_plain_numpy(disk, monkeypatch):
    """Also where XLA would compute: a model that it cannot run is run by NumPy."""
    monkeypatch.setattr("lightflyer.compute.evaluation.FEW", 0)
    model = own(lambda self, excess, state: np.where(np.sqrt(excess) > 0.0, 1.0, 0.0))
    over = {"flyer.radius": [0.005, 0.01], "altitude": ["70 km", "75 km"]}
    swept = lf.sweep(disk, lf.Earth(), model, over=over, outputs=["lift"])
    one = plain(lf.Disk(disk.film, 0.01), lf.Earth().state(75e3))
    assert float(swept.lift[1, 1]) == pytest.approx(float(one), rel=1e-10)


def test_a_model_in_jax_is_given_numbers_of_numpy(disk):
    """Eagerly, JAX would compile every operation of the search for every shape."""
    seen = set()

    def heat_loss(self, flyer, state, unknowns):
        seen.update(map(type, unknowns))
        return tuple(map(jax.numpy.asarray, Own.heat_loss(self, flyer, state, unknowns)))

    def share(self, excess, state):
        seen.add(type(excess))
        return jax.numpy.exp(0.0 * excess)

    class Warm(lf.environment.AbstractAtmosphere):
        altitude_range = (20e3, 90e3)

        def temperature(self, altitude, place=None):
            return 250.0 + 0.0 * altitude

        def pressure(self, altitude, place=None):
            return 1e5 * jax.numpy.exp(-altitude / 7e3)

        def molar_mass_ratio(self, altitude, place=None):
            return 1.0

    earth = lf.environment.Earth(atmosphere=Warm())
    found = lf.predict(disk, earth, own(share, heat_loss=heat_loss))
    assert seen <= {np.ndarray, np.float64}, seen
    expected = lf.predict(disk, earth, own(lambda self, excess, state: 1.0))
    np.testing.assert_allclose(found.bands, expected.bands, rtol=1e-9)
