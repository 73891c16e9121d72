"""Results of a force model's own, flows and buoyancy, among the outputs."""

import json
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.design import outputs_of
from lightflyer.design.outputs import json_name
from lightflyer.force import ModelResult

AT = 72e3


class Tally(lf.AbstractForceModel):
    """The force of a disk in free molecules, with the heat that the gas takes as a result."""

    flyers: ClassVar = (lf.Disk,)
    results: ClassVar = {
        "gas_power": ModelResult("W", "heat that the gas takes", shown_unit="mW"),
        "speed_of_gas": ModelResult("m/s", "mean speed of molecules"),
    }
    of_disk: lf.AbstractForceModel = lf.Lu2023()

    def heat_loss(self, flyer, state, unknowns):
        return self.of_disk.heat_loss(flyer, state, unknowns)

    def force(self, flyer, state, unknowns):
        return self.of_disk.force(flyer, state, unknowns)

    def own_results(self, flyer, state, unknowns):
        (power,) = self.heat_loss(flyer, state, unknowns)
        return {"gas_power": power, "speed_of_gas": state.gas.mean_speed(state.temperature)}


@pytest.fixture(scope="module")
def setup(film):
    return lf.Setup(lf.Disk(film, 0.01), lf.lu2023_earth(), Tally())


@pytest.fixture(scope="module")
def found(setup):
    return lf.predict(setup, at=[AT])


def expected(setup):
    """Gas power by the heat balance [W], mean speed by kinetic theory [m/s]."""
    state = setup.environment.state(AT)
    balance = lf.equilibrium(setup.flyer, state, setup.model)
    constant = state.gas.specific_gas_constant
    return balance.gas_power, np.sqrt(8.0 * constant * state.temperature / np.pi)


def test_prediction_has_them_everywhere(setup, found, tmp_path):
    power, speed = expected(setup)
    point, best = found.summary()["at"][0], found.summary()["best"]
    assert point["gas_power_mw"] == pytest.approx(1e3 * power, rel=1e-9)
    assert point["speed_of_gas_m_s"] == pytest.approx(speed, rel=1e-9)
    assert {"gas_power_mw", "speed_of_gas_m_s"} <= set(best)
    json.dumps(found.summary(), allow_nan=False)
    assert found.dataset.gas_power.attrs == {
        "units": "W",
        "long_name": "heat that the gas takes",
        "shown_units": "mW",
    }
    assert found.dataset.speed_of_gas.attrs["units"] == "m s-1"
    lf.prediction.write_csv(found, tmp_path / "table.csv")
    header = (tmp_path / "table.csv").read_text("utf-8").splitlines()[0]
    assert "gas_power [W]" in header


def test_uncertainty_is_propagated_to_them(setup, found):
    design = lf.design.ObjectDesign(setup, {"flyer.film.absorptance": 0.02})
    bands = lf.propagate(design, prediction=found, samples=0).summary()["results"]
    band = bands["at[0].gas_power_mw"]["first_order"]
    more, less = (
        expected(design.build({"flyer.film.absorptance": 0.75 + shift}))[0]
        for shift in (1e-4, -1e-4)
    )
    assert band["standard_uncertainty"] == pytest.approx(
        1e3 * (more - less) / 2e-4 * 0.02, rel=1e-4
    )


def test_sweep_and_its_figure_have_them(setup):
    table = lf.sweep(
        setup,
        over={"flyer.radius": ["1 cm", "2 cm"], "altitude": "72 km"},
        outputs=["gas_power", "payload_per_area"],
    )
    power = table.gas_power.values
    assert power[0] == pytest.approx(expected(setup)[0], rel=1e-9)
    from lightflyer.files.display_units import scale_and_label

    factor, label = scale_and_label(table.gas_power)
    assert (factor, label) == (pytest.approx(1e3), "heat that the gas takes [mW]")
    factor, label = scale_and_label(table.payload_per_area)
    assert factor == pytest.approx(1e3)
    assert label.endswith("[g/m²]")
    masses = lf.payload(setup.flyer, setup.environment.state(AT), setup.model)
    per_area = table.payload_per_area.values.ravel()[0]
    assert per_area == pytest.approx(masses / (np.pi * 0.01**2), rel=1e-9)


def test_what_a_model_gets_wrong_is_named(setup):
    class Silent(Tally):
        def own_results(self, flyer, state, unknowns):
            return {"gas_power": jnp.zeros(())}

    class Taken(Tally):
        results: ClassVar = {"payload": ModelResult("kg", "payload")}

    class Unreadable(Tally):
        results: ClassVar = {"gas_power": ModelResult("W", "power", shown_unit="km")}

    def with_model(model):
        return lf.Setup(setup.flyer, setup.environment, model)

    with pytest.raises(lf.ParameterError, match="declares the results gas_power, speed_of_gas and"):
        lf.design.OperatingPoint(with_model(Silent()), AT).own_results  # noqa: B018
    with pytest.raises(lf.ParameterError, match='"payload" has the name of an output'):
        outputs_of(with_model(Taken()))
    with pytest.raises(lf.ParameterError, match=r"gas_power\": .*km"):
        outputs_of(with_model(Unreadable()))


class Balloonet(lf.AbstractFlyer):
    """A black bag in whose wall a leak is driven by the excess; it displaces gas."""

    nodes: ClassVar[tuple[str, ...]] = ("wall",)
    flows: ClassVar[tuple[str, ...]] = ("leak_rate",)
    payload: float = 0.0
    attitude: None = None

    area = 1e-4
    own_mass = 1e-9
    displaced_volume = 2e-6

    def beam_areas(self, state):
        return (self.area,)

    def heat_gains(self, state):
        return (0.0,)

    def heat_losses(self, state, unknowns):
        return (4.0 * self.area * 5.67e-8 * state.temperature**4 * unknowns[0],)

    def describe(self):
        return "bag"


class Leak(lf.AbstractForceModel):
    flyers: ClassVar = (Balloonet,)

    def heat_loss(self, flyer, state, unknowns):
        return (0.0 * unknowns[0],)

    def force(self, flyer, state, unknowns):
        return 0.0 * unknowns[0]

    def flow_balance(self, flyer, state, unknowns):
        excess, leak = unknowns
        return (leak - 3.0 * excess,)


class NamedLeak(Leak):
    results: ClassVar = {"leak_rate": ModelResult("kg/s", "gas that leaks", shown_unit="mg/s")}


def test_flows_and_buoyancy_are_outputs(setup):
    plain = lf.Setup(Balloonet(), lf.lu2023_earth(), Leak())
    assert outputs_of(plain)["leak_rate"].unit == ""
    assert "buoyancy" not in outputs_of(setup)
    named = lf.Setup(Balloonet(), lf.lu2023_earth(), NamedLeak())
    names = ["leak_rate", "buoyancy", "lift"]
    table = lf.sweep(named, over={"altitude": "72 km"}, outputs=names)
    assert table.leak_rate.attrs["long_name"] == "gas that leaks"
    state = named.environment.state(AT)
    light, black = float(state.radiation.irradiance), 5.67e-8 * float(state.temperature) ** 4
    assert float(table.leak_rate) == pytest.approx(3.0 * light / (4.0 * black), rel=1e-9)
    weight_of_gas = float(state.pressure * 2e-6 * state.gravity) / (
        state.gas.specific_gas_constant * float(state.temperature)
    )
    assert float(table.buoyancy) == pytest.approx(weight_of_gas, rel=1e-9)
    assert float(table.lift) == pytest.approx(weight_of_gas, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("payload", 3e-7, "0.3 mg"),
        ("payload", -2.5e-3, "-2500 mg"),
        ("payload", 0.3, "300 g"),
        ("payload", 1700.0, "1700 kg"),
        ("lift", 3e-6, "3 µN"),
        ("lift", 56.11, "56.11 N"),
        ("temperature", 5e4, "50000 K"),
    ],
)
def test_units_suit_the_values(name, value, shown):
    factor, unit = lf.design.OUTPUTS[name].display_unit_for([value, 0.1 * value, np.inf, np.nan])
    assert f"{value * factor:g} {unit}" == shown


def test_names_in_json_end_with_the_unit():
    assert json_name("levitation_irradiance", "W/m^2") == "levitation_irradiance_w_m2"
