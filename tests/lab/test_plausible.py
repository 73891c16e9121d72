"""Numbers that are unlikely, or do not fit what is stated, are told, and written on demand only."""

import numpy as np
import pytest

from lightflyer.calibration.gauge import Gauge, gauge_of, pirani_doubts, rows_at_the_end
from lightflyer.config.update import require_no_doubt
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.lab.result import joint_warnings
from lightflyer.lab.synthetic.gas import PLATINUM, _power
from lightflyer.lab.tac.data import read_tac
from lightflyer.lab.thermography.data import LIGHT, THERMAL, read_readings
from lightflyer.lab.thermography.reduction import reduce_readings


def reduce(folder, method, header, *rows):
    path = folder / "readings.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return reduce_readings(read_readings(path, method)[0])


def doubts(found):
    return [one for one in found.warnings if isinstance(one, Doubt)]


METER = "incident [{}],reflected [W],transmitted [W],dark [W]"


def test_a_unit_of_its_own_in_each_column(tmp_path):
    """By hand: (0.2717 - 0.0121)/(1.7323 - 0.0121) = 0.1509 and 0.1712/1.7202 = 0.0995."""
    row = "1732.3,0.2717,0.1833,0.0121"
    right = reduce(tmp_path, LIGHT, METER.format("mW"), row)
    assert right.emissivity.value == pytest.approx(1 - 0.2596 / 1.7202 - 0.1712 / 1.7202)
    assert not doubts(right)
    (doubt,) = doubts(reduce(tmp_path, LIGHT, METER.format("W"), row))
    assert "absorptivity 0.9998 is unlikely" in doubt
    assert "is it in mW and they in W?" in doubt


def test_what_is_in_doubt_is_written_on_demand_only(tmp_path):
    warnings = joint_warnings([("a.csv", ["plain"]), ("b.csv", [Doubt("off")])])
    with pytest.raises(ConfigurationError, match=r"b\.csv: off; --insist writes it all the same"):
        require_no_doubt(tmp_path / "flyer.toml", warnings, insist=False)
    require_no_doubt(tmp_path / "flyer.toml", warnings, insist=True)
    require_no_doubt(tmp_path / "flyer.toml", ["plain"], insist=False)


def test_a_meter_may_read_below_zero_in_the_dark(tmp_path):
    head = METER.format("W")
    found = reduce(tmp_path, LIGHT, head, "1.7323,0.2717,0.1833,-0.0003")
    assert found.emissivity.value == pytest.approx(1 - (0.2720 + 0.1836) / 1.7326)
    with pytest.raises(ConfigurationError, match="is its sign right"):
        reduce(tmp_path, LIGHT, head, "1.7323,0.2717,0.1833,-0.5")


CAMERA = (
    "hotplate_temperature [C],lower_temperature [C],upper_temperature [C],ambient_temperature [C]"
)


def test_surroundings_that_were_not_logged(tmp_path):
    assert not doubts(reduce(tmp_path, THERMAL, CAMERA, "150,60,55,22"))
    (doubt,) = doubts(reduce(tmp_path, THERMAL, CAMERA, "150,60,55,0", "150,61,55,0"))
    assert "0 °C is what loggers write where no sensor is connected" in doubt


def test_an_emissivity_of_nothing_is_in_doubt(tmp_path):
    """Lower and upper together show all of the hotplate."""
    found = reduce(tmp_path, THERMAL, CAMERA, "150,99,99,22")
    assert any("emissivity" in one and "is unlikely" in one for one in doubts(found))


def test_rows_farther_apart_than_their_accuracy(tmp_path):
    rows = [f"150,{lower},55,22" for lower in (45, 60, 100, 110)]
    assert "varies by" in doubts(reduce(tmp_path, THERMAL, CAMERA, *rows))[0]
    rng = np.random.default_rng(1)
    rows = [f"150,{60 + rng.normal():.2f},55,22" for _ in range(4)]
    assert not doubts(reduce(tmp_path, THERMAL, CAMERA, *rows))


HEADER = "pressure [Pa],heater_power [mW],heater_temperature [K],ambient_temperature [K]"


def heater(folder, rng, end=np.inf, rows=56, noise=0.01, factor=1.0, highest=200.0):
    """A run of a heater by the kinetic force model, whose gauge shows no more than its end."""
    pressure = np.geomspace(1e-3, highest, rows)
    power = _power(pressure, np.full(rows, 323.0), np.full(rows, 295.0), PLATINUM)
    power = 1e3 * power * (1.0 + noise * rng.normal(size=rows))
    shown = np.minimum(pressure / factor, end)
    path = folder / "run.csv"
    lines = (f"{p:.6g},{w:.6g},323,295" for p, w in zip(shown, power, strict=True))
    path.write_text("\n".join([HEADER, *lines]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("end", [3.0, 5.0, 10.0])
def test_rows_at_the_gauges_end_are_left_out(tmp_path, rng, end):
    run = read_tac(heater(tmp_path, rng, end))
    assert run.pressure.max() < end
    assert any(f"end of its range, {end:g} Pa" in note for note in run.notes)
    assert f"end of its range, {end:g} Pa" in run.table.rejected[0].reason
    assert not read_tac(heater(tmp_path, rng)).notes


def test_pressures_that_were_held_are_kept(tmp_path):
    """Four repeats at each of many pressures; of 40 runs one may look otherwise by chance."""
    rng, told = np.random.default_rng(1), 0
    for _ in range(40):
        pressure = np.repeat(np.geomspace(1e-3, 100.0, 14), 4)
        power = pressure / (1.0 + pressure / 10.0) + 0.3
        power = power * (1.0 + 0.01 * rng.normal(size=pressure.size))
        told += rows_at_the_end(pressure, power).any()
    assert told <= 1


def test_a_pirani_gauge_in_another_gas(tmp_path):
    (doubt,) = pirani_doubts("argon", Gauge(), accuracy_stated=False)
    assert "--gauge-factor 1.7" in doubt
    assert not pirani_doubts("argon", Gauge(1.7), accuracy_stated=False)
    assert not pirani_doubts("argon", Gauge(), accuracy_stated=True)
    assert not pirani_doubts("nitrogen", Gauge(), accuracy_stated=False)


@pytest.mark.parametrize("temperature", [318.15, 373.15])
def test_a_heated_gauge_in_both_limits_and_between(temperature):
    """Knudsen's √(T/T0) in thin gas and nothing in dense; half of it where theory has it.

    Half the effect is at p = 2 η v/d with the mean thermal speed v (arXiv:1308.6794).
    """
    whole = np.sqrt(temperature / 295.0) - 1.0
    shown = np.array([1e-5, 1e4])
    pressure = gauge_of(None, 1.0, temperature, 5e-3, ambient=295.0).correct(shown)[0]
    assert shown / pressure - 1.0 == pytest.approx([whole, 0.0], abs=0.02 * whole)
    middle = 0.5 * (temperature + 295.0)
    speed = np.sqrt(8.0 * 8.314462618 * middle / (np.pi * 28.96e-3))
    half = 2.0 * 1.85e-5 * (middle / 300.0) ** 0.7 * speed / 5e-3
    pressure = gauge_of(None, 1.0, temperature, 5e-3).correct(np.array([half]))[0]
    assert 0.35 < float(half / pressure[0] - 1.0) / whole < 0.65
    with pytest.raises(ConfigurationError, match="go together"):
        gauge_of(None, 1.0, temperature, None)
