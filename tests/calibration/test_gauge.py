import numpy as np
import pytest

import lightflyer as lf
from lightflyer.calibration.gauge import Gauge, read_gauge
from lightflyer.calibration.points import read_points
from lightflyer.lab.levitation.curve import levitation_curve
from lightflyer.lab.levitation.data import read_lift_offs

TABLE = "shown [mTorr],pressure [Pa]\n1,0.2\n10,1.5\n1000,200\n"


def test_a_calibration_is_met_at_its_points_and_straight_between(write):
    gauge = read_gauge(write(TABLE, "gauge.csv"))
    torr = 101325.0 / 760.0
    found, said = gauge.correct(np.array([1e-3, 1e-2, 0.1, 1.0]) * torr)
    # halfway between 10 and 1000 mTorr in logarithms: the geometric mean
    assert found == pytest.approx([0.2, 1.5, np.sqrt(1.5 * 200.0), 200.0])
    assert said == []
    found, said = gauge.correct(np.array([1e-4, 1e-2, 2.0]) * torr)
    assert found == pytest.approx([0.02, 1.5, 400.0])
    assert said[0].startswith("2 pressures are beyond the gauge's calibration")


def test_a_factor_moves_every_pressure_with_its_uncertainty(write):
    text = "pressure [Pa],pressure_uncertainty [Pa],irradiance [W/m^2]\n1,0.1,900\n2,0.3,800\n"
    points = read_points(write(text, "points.csv"), gauge=Gauge(1.7))
    assert points.pressure == pytest.approx([1.7, 3.4])
    assert points.numbers["pressure_uncertainty"] == pytest.approx([0.17, 0.51])


def test_what_is_held_beyond_a_calibration_is_a_warning(write):
    gauge = read_gauge(write("shown [Pa],pressure [Pa]\n2,2.2\n9,9.9\n", "gauge.csv"))
    rows = "".join(f"{p},{1000 + 9 * (p - 4) ** 2}\n" for p in range(1, 10))
    path = write(f"pressure [Pa],irradiance [W/m^2]\n{rows}", "points.csv")
    (points,), _ = read_lift_offs(path, gauge=gauge)
    said = levitation_curve(points, draws=100).warnings
    assert said[0].startswith("1 pressure is beyond the gauge's calibration")


@pytest.mark.parametrize("rows", ["1,1\n", "1,1\n1,2\n", "1,2\n2,1\n", "1,1\n2,x\n", "1,-1\n2,2\n"])
def test_what_is_no_calibration_is_refused(write, rows):
    path = write(f"shown [Pa],pressure [Pa]\n{rows}", "gauge.csv")
    with pytest.raises(lf.ConfigurationError, match=r"gauge\.csv"):
        read_gauge(path)


def test_a_gauge_in_a_wrong_unit_is_said(write):
    gauge = read_gauge(write(TABLE.replace("mTorr", "Pa"), "gauge.csv"))
    with pytest.raises(lf.ConfigurationError, match="is within its calibration; check the units"):
        gauge.correct(np.array([1e-3, 0.5]))
    assert "pressure over shown = 0.2 is unlikely" in gauge.correct(np.array([2.0]))[1][0]
    assert "pressure over shown = 20 is unlikely" in Gauge(20.0).correct(np.ones(1))[1][0]
    path = write(TABLE.replace("[Pa]", "[kPa]").replace("mTorr", "Pa"), "gauge.csv")
    with pytest.raises(lf.ParameterError, match=r"gauge.csv: pressure over shown = 200 must be"):
        read_gauge(path)


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, 1000.0])
def test_an_impossible_factor_is_refused(factor):
    with pytest.raises(lf.ParameterError, match="gauge_factor"):
        Gauge(factor)
