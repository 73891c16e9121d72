import re

import numpy as np
import pytest

from lightflyer.lab.tac.preparation import drift_warnings


def sweep(rows, rng):
    """Up, down, up and down again between 0.01 and 100 Pa, with scatter of 1 %."""
    once = np.geomspace(0.01, 100.0, rows // 4)
    pressure = np.concatenate([once, once[::-1], once, once[::-1]])
    return pressure, 0.01 * rng.normal(size=pressure.size)


def percent(text):
    return float(re.search(r"lie ([-+][\d.]+) ±", text)[1])


@pytest.mark.parametrize("rows", [80, 2000])
def test_rows_without_either_say_nothing(rows, rng):
    said = [drift_warnings(*sweep(rows, rng)[::-1], 1.0) for _ in range(100)]
    assert sum(map(bool, said)) <= 1


def test_hysteresis_is_measured(rng):
    pressure, residual = sweep(400, rng)
    rising = np.sign(np.gradient(np.log(pressure)))
    (text,) = drift_warnings(residual + 0.015 * rising, pressure, 1.0)
    assert "while the pressure rose" in text
    assert percent(text) == pytest.approx(3.0, abs=0.4)


def test_drift_is_measured(rng):
    pressure, residual = sweep(400, rng)
    late = np.linspace(-0.5, 0.5, pressure.size)
    (text,) = drift_warnings(residual - 0.04 * late, pressure, 1.0)
    assert "rows at the end" in text
    assert percent(text) == pytest.approx(-4.0, abs=0.8)


def test_one_sweep_cannot_tell_drift_from_the_law(rng):
    pressure = np.geomspace(0.01, 100.0, 200)
    late = np.linspace(-0.5, 0.5, 200)
    assert drift_warnings(0.001 * rng.normal(size=200) + 0.04 * late, pressure, 1.0) == []
