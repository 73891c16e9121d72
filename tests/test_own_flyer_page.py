"""The pages' own code, as a reader would run it."""

import re
from pathlib import Path

import jax
import numpy as np
import pydantic
import pytest

import lightflyer as lf

DOCS = Path(__file__).parents[1] / "docs"


def run_page(name):
    """Run a page's Python in the order of the page; returns what it defines."""
    blocks = re.findall(r"^```python\n(.*?)^```", (DOCS / name).read_text("utf-8"), re.S | re.M)
    assert blocks
    namespace = {"__name__": f"page_{Path(name).stem.replace('-', '_')}"}
    for block in blocks:
        exec(compile(block, name, "exec"), namespace)
    return namespace


@pytest.fixture(scope="module")
def page():
    found = run_page("own-flyer.md")
    del lf.flyer.FlyerSection.alternatives["disk-with-instrument"]  # no part of the package
    del lf.force.ForceSection.alternatives["carried"]
    return found


def test_page_says_what_comes_out(page):
    flyer, model, earth = page["flyer"], page["model"], page["earth"]
    balance = lf.equilibrium(flyer, earth.state(72e3), model)
    assert [f"{value:.0f}" for value in balance.temperatures] == ["409", "301"]
    lost = balance.gas_power + balance.radiated_power
    assert balance.absorbed_power == pytest.approx(lost, rel=1e-10)
    irradiance = lf.levitate(flyer, earth.state(72e3), model).irradiance
    assert f"{irradiance:.0f}" == "753"
    band = lf.levitation_band(flyer, earth, model)
    assert (f"{band.lower:.3g}", f"{band.upper:.3g}") == ("6.77e+04", "7.86e+04")
    table = page["table"]
    assert table.sizes == {"flyer.wires": 3, "altitude": 3}
    assert table.temperature_instrument.attrs["units"] == "K"
    here = table.temperature_instrument.sel(altitude=72e3)
    assert [f"{float(value):.0f}" for value in here] == ["256", "301", "379"]
    power = [f"{1e3 * float(value):.3g}" for value in table.wire_power.sel(altitude=72e3)]
    assert power == ["0", "0.108", "0.297"]
    through_wires = 1e-6 * (balance.temperatures[0] - balance.temperatures[1])
    assert float(table.wire_power.sel(altitude=72e3)[1]) == pytest.approx(through_wires, rel=1e-9)
    # heat that the wires draw from the film is lost to the lift
    assert np.all(np.diff(table.lift_over_weight, axis=0) < 0.0)
    assert lf.payload(page["many"], earth.state(72e3), model).shape == (7,)


def test_flyer_without_wires_is_two_bodies(page):
    """The film is a disk's; the instrument gives to free molecules what it dissipates."""
    disk, model = lf.Disk(page["film"], 0.01), page["model"]
    flyer = page["DiskWithInstrument"](disk, 2e-4, power=1e-4, wires=0.0, payload=5e-8)
    state = lf.Earth().state(72e3)
    found = lf.equilibrium(flyer, state, model)
    alone = lf.equilibrium(disk, state, lf.Lu2023())
    assert found.temperature_of("film") == pytest.approx(alone.temperature, rel=1e-12)
    # molecules that arrive, times what each carries away per kelvin, (4/2) k + (2/2) k
    gas_constant, surface = state.gas.specific_gas_constant, 4.0 * np.pi * 2e-4**2
    arriving = state.pressure / np.sqrt(2.0 * np.pi * gas_constant * state.temperature)
    warmer = 1e-4 / (0.9 * surface * arriving * 3.0 * gas_constant)
    expected = state.temperature + warmer
    assert found.temperature_of("instrument") == pytest.approx(expected, rel=1e-10)
    assert lf.lift(flyer, state, model) == pytest.approx(
        lf.lift(disk, state, lf.Lu2023()), rel=1e-10
    )


def test_its_derivatives_and_its_mistakes(page):
    make, disk = page["DiskWithInstrument"], lf.Disk(page["film"], 0.01)
    state, model = lf.Earth().state(72e3), page["model"]

    def lift(wires):
        return lf.lift(make(disk, 2e-4, power=1e-4, wires=wires), state, model)

    with lf.float64():
        slope = jax.grad(lift)(1e-5)
    expected = (lift(1.01e-5) - lift(0.99e-5)) / 2e-7
    assert float(slope) == pytest.approx(expected, rel=1e-4)
    with pytest.raises(lf.ParameterError, match="radius = -1 is not positive"):
        make(disk, -1.0, 1e-4, 1e-6)
    with pytest.raises(lf.ParameterError, match="Lu2023 is not for DiskWithInstrument"):
        lf.lift(page["flyer"], state, lf.Lu2023())


def test_its_sections_have_the_fields_of_the_classes(page):
    section = page["InstrumentSection"](
        shape="disk-with-instrument",
        diameter="2 cm",
        radius="0.2 mm",
        power="0.1 mW",
        wires=1e-6,
        payload="50 ug",
    )
    flyer, model = section.build(page["film"], 0.0), page["CarriedSection"](model="carried").build()
    assert flyer.disk.radius == 0.01
    state = page["earth"].state(72e3)
    expected = lf.levitate(page["flyer"], state, page["model"]).irradiance
    assert lf.levitate(flyer, state, model).irradiance == pytest.approx(expected, rel=1e-12)
    with pytest.raises(pydantic.ValidationError, match="must be positive"):
        page["InstrumentSection"](**section.model_dump() | {"radius": "-1 mm"})


def test_sandwich_page():
    names = run_page("sandwich.md")
    masses = lf.payload(names["sandwich"], names["state"], lf.Schafer2025())
    assert masses.shape == names["gaps"].shape
    assert np.all(masses > 0.0)


def test_compare_page():
    found = run_page("compare.md")["found"]
    assert found.best.name == "4 cm"
    assert found.best.prediction.best.values["payload"] == pytest.approx(6.45e-7, rel=1e-3)
    there = found.dataset.payload_per_area.sel(altitude=72e3, method="nearest")
    assert [f"{1e3 * float(value):.2g}" for value in there] == ["1.2", "1", "0.16"]
