import dataclasses
import math
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erfc

import lightflyer as lf
from lightflyer.array.namespace import by_jax
from lightflyer.budget import Budget, Item, RadioLink, SolarCells, free_space_loss
from lightflyer.budget.payload import REQUIRED_SIGNAL_DB
from lightflyer.comparison.text import needs_table
from lightflyer.config.designs import as_design
from lightflyer.design.diagnostics import diagnose_at
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import evaluate
from lightflyer.prediction.text import payload_line

LINK = RadioLink(
    distance=30e3,
    frequency=434e6,
    data_rate=100.0,
    noise_temperature=300.0,
    transmit_gain_dbi=2.0,
    receive_gain_dbi=12.0,
    losses_db=3.0,
    margin_db=6.0,
    efficiency=0.25,
    duty=0.02,
)
ITEMS = (Item("sensor", mass=5e-8, power=2e-5, duty=0.1), Item("frame", mass=1e-8))
CELLS = SolarCells(efficiency=0.2, areal_density=0.1, conversion=0.8)

WHERE = (np.array([72e3]), np.array([300.0]))  # altitude and temperature of the flyer

TEXT = """
[flyer]
diameter = "2 cm"
[film]
areal_density = "1.0 g/m^2"
absorptance = 0.75
emittance = 0.08
tac_top = 0.8
tac_bottom = 0.9
[force]
model = "lu2023"
[payload]
reserve = 0.2
items = [
  {name = "sensor", mass = "0.05 mg", power = "20 uW", duty = 0.1},
  {name = "frame", mass = "0.01 mg"},
]
[payload.cells]
efficiency = 0.2
areal_density = "0.1 kg/m^2"
[payload.link]
range = "30 km"
frequency = "434 MHz"
data_rate = "0.1 kbit/s"
noise_temperature = "300 K"
"""


def test_link_by_engineers_decibels():
    """Free-space loss 32.45 dB at 1 km and 1 MHz; thermal noise -228.6 dB(W/(K Hz))."""
    loss = 32.4478 + 20.0 * math.log10(30.0) + 20.0 * math.log10(434.0)
    assert 10.0 * math.log10(free_space_loss(30e3, 434e6)) == pytest.approx(loss, abs=1e-3)
    noise = -228.5992 + 10.0 * math.log10(300.0) + 10.0 * math.log10(100.0)
    sent = noise + REQUIRED_SIGNAL_DB + loss + 3.0 + 6.0 - 2.0 - 12.0
    assert 10.0 * math.log10(LINK.transmit_power()) == pytest.approx(sent, abs=1e-3)
    assert LINK.consumed_power() == pytest.approx(LINK.transmit_power() * 0.02 / 0.25)


def test_required_signal_is_that_of_one_wrong_bit_in_1e5():
    wrong = brentq(lambda ratio: 0.5 * erfc(math.sqrt(ratio)) - 1e-5, 1.0, 30.0)
    assert pytest.approx(10.0 * math.log10(wrong), abs=0.02) == REQUIRED_SIGNAL_DB


def test_sums():
    needs = Budget(ITEMS, CELLS, LINK, reserve=0.2).needs(np.array([589.0, 1361.0]))
    power = 1.2 * (2e-6 + float(LINK.consumed_power()))
    area = power / (0.16 * np.array([589.0, 1361.0]))
    np.testing.assert_allclose(needs.power, power, rtol=1e-13)
    np.testing.assert_allclose(needs.cell_area, area, rtol=1e-13)
    np.testing.assert_allclose(needs.mass, 1.2 * 6e-8 + 0.1 * area, rtol=1e-13)


def test_nothing_is_stored():
    dark = Budget(ITEMS, CELLS).needs(0.0)
    assert math.isinf(dark.mass)
    assert math.isinf(dark.cell_area)
    fed = Budget((Item("battery", mass=1e-6),), CELLS).needs(0.0)
    assert fed.mass == pytest.approx(1e-6)
    assert Budget(ITEMS).needs(0.0).cell_area == 0.0


def test_impossible_budgets():
    with pytest.raises(lf.ParameterError, match="needs items or a link"):
        Budget()
    with pytest.raises(lf.ParameterError, match='the name "frame"'):
        Budget((ITEMS[1], ITEMS[1]))
    with pytest.raises(lf.ParameterError, match="efficiency"):
        SolarCells(0.0, 0.1)
    with pytest.raises(lf.ParameterError, match="duty"):
        Item("sensor", duty=2.0)


@pytest.fixture
def read(write):
    return lambda text: lf.read_flyer_file(write(text, "flyer.toml"))


def test_what_a_file_says_stands_beside_what_the_flyer_carries(read):
    design = read(TEXT).design()
    names = ["payload", "payload_needed", "payload_margin", "cell_area", "transmit_power"]
    assert set(names) <= set(outputs_of(design.setup))
    with by_jax():
        found, _ = jax.jit(lambda altitude: evaluate(design.setup, names, altitude))(72e3)
        heavier = design.build({"payload.items.0.mass": 1e-7})
        needed = evaluate(heavier, ["payload_needed"], 72e3)[0]["payload_needed"]
    assert found["payload_margin"] == pytest.approx(found["payload"] - found["payload_needed"])
    assert needed - found["payload_needed"] == pytest.approx(1.2 * 5e-8)
    sent = RadioLink(30e3, 434e6, 100.0, 300.0).transmit_power()
    assert found["transmit_power"] == pytest.approx(float(sent), rel=1e-6)
    # the sun overhead and what the ground reflects light a level top face once
    power = 1.2 * (2e-6 + float(sent) / 0.3)
    assert found["cell_area"] == pytest.approx(power / (0.2 * 1361.0), rel=1e-6)
    assert "payload.link.range" in design.quantities


def test_what_cells_cannot_do_is_said(read):
    setup = read(TEXT.replace('power = "20 uW"', 'power = "1 W"')).build()
    assert any("times the area of the flyer" in text for text in diagnose_at(setup, *WHERE))
    night = dataclasses.replace(setup.environment.radiation, irradiance=0.0)
    dark = dataclasses.replace(
        setup, environment=dataclasses.replace(setup.environment, radiation=night)
    )
    assert any("have no light" in text for text in diagnose_at(dark, *WHERE))
    assert not any("solar cells" in text for text in diagnose_at(read(TEXT).build(), *WHERE))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('range = "30 km"', 'range = "30 kg"', r":\d+: payload.link.range: .* wrong kind"),
        ('frequency = "434 MHz"', 'frequency = "434"', r":\d+: payload.link.frequency"),
        ('"0.1 kbit/s"', '"-1 bit/s"', r":\d+: payload.link.data_rate"),
        ("efficiency = 0.2", "efficiency = 1.2", r":\d+: payload.cells.efficiency"),
        ("efficiency = 0.2", "eficiency = 0.2", r'did you mean "efficiency"'),
        ('"frame"', '"sensor"', 'two items have the name "sensor"'),
        ("duty = 0.1", "dutty = 0.1", r'did you mean "duty"'),
        ("[payload]", "[payloads]", "payload"),
    ],
)
def test_mistakes_in_a_file_are_named_with_their_line(read, old, new, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        read(TEXT.replace(old, new))


def test_a_budget_of_objects_is_part_of_a_design(film):
    budget = Budget(ITEMS, CELLS, LINK)
    setup = lf.Setup(lf.Disk(film, 0.01), lf.Earth(), lf.Lu2023(), budget=budget)
    design = as_design(setup)
    assert design.number("budget.link.distance") == 30e3
    built = design.build({"budget.link.distance": 60e3}).budget
    assert built.link.transmit_power() == pytest.approx(4.0 * float(LINK.transmit_power()))
    assert any("100 bit/s over 30 km" in text for text in budget.describe())


def best(**changes):
    found = {
        "payload_needed": 2e-7, "payload_margin": 3e-7, "power_needed": 6e-6,
        "cell_area": 6.5e-8, "transmit_power": 2e-7,
    }  # fmt: skip
    return found | changes


def test_terminal_says_what_is_needed_and_left():
    assert payload_line(best()) == (
        "0.2 mg there, 6 µW, 0.065 mm² of solar cells, radio 0.2 µW: 0.3 mg to spare"
    )
    assert payload_line(best(payload_margin=-3e-7)).endswith("0.3 mg too much")
    assert "no light" in payload_line(best(payload_needed=math.inf))


def test_comparison_has_a_row_for_each_flyer(read):
    setups = read(TEXT).build(), read(TEXT.partition("[payload]")[0]).build()
    flyers = [SimpleNamespace(setup=setup, best=SimpleNamespace(values=best())) for setup in setups]
    table = needs_table(SimpleNamespace(flyers=flyers))
    columns = {column.header.split("\n")[0]: list(column.cells) for column in table.columns}
    assert columns["payload margin"] == ["0.3", "–"]
    assert columns["cell area"] == ["0.065", "–"]
