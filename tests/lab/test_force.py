"""Heated vanes: the predicted force, and measured ones beside it."""

import math
from functools import partial

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core.units import Measured
from lightflyer.files.table import Table
from lightflyer.lab import force as module

PRESSURES = np.geomspace(0.01, 5.0, 9)


def vane(hot=419.0, cold=394.0, tac=0.9, **others):
    others = {"ambient": Measured(300.0)} | others
    number = Measured(tac)
    return lf.lab.Vane(
        Measured(0.12), Measured(hot), Measured(cold), tac_hot=number, tac_cold=number, **others
    )


def table(force, **columns):
    return Table("points.csv", np.arange(force.size), {
        "pressure": PRESSURES, "force": force, **columns}, {})  # fmt: skip


@pytest.mark.parametrize("tac", [0.3, 1.0])
def test_free_molecules_push_with_what_leaves_each_face(tac):
    """The share TAC of a Maxwellian leaves at the temperature of the face."""
    pressure = np.array([1e-5])
    pushed = 0.5 * tac * (math.sqrt(419.0 / 300.0) - math.sqrt(394.0 / 300.0))
    expected = pushed * pressure * math.pi * 0.06**2
    np.testing.assert_allclose(vane(tac=tac).force(pressure), expected, rtol=1e-3)


def test_the_force_is_that_of_the_solved_equation(monkeypatch):
    """F/(pA) of solve(Kn, 0.9, 0.9, temperature_ratio=(394/300, 419/300)), some minutes each."""
    solved = {0.05: 0.0019251, 0.1: 0.0040676, 0.2: 0.0072700, 0.5: 0.0117352, 1.0: 0.0140288}
    hot = vane()
    pressure = hot.knudsen(np.array([1.0])) / np.array(list(solved))
    # the package's own also has the collisions of molecules, which this equation has not
    monkeypatch.setattr(module, "Kinetic", partial(lf.Kinetic, collisions="shakhov"))
    found = hot.force(pressure) / (pressure * math.pi * 0.06**2)
    np.testing.assert_allclose(found, list(solved.values()), rtol=0.006)


def test_the_page_of_vanes_has_its_numbers():
    found = lf.lab.compare_forces(
        lf.lab.Vane(Measured(0.12), Measured(419.0), Measured(394.0)), pressures=(0.006, 6.0)
    )
    at, most = found.largest
    low, high = (end[found.pressure == at][0] for end in found.band)
    assert [round(force * 1e6) for force in (most, low, high)] == [27, 20, 34]
    assert at == pytest.approx(0.6, rel=0.03)
    for gas in (lf.gas.ARGON, lf.gas.HELIUM):
        of_gas = vane(gas=gas)
        curve = lf.lab.compare_forces(of_gas, pressures=(0.006, 30.0))
        assert of_gas.knudsen(np.array([curve.largest[0]]))[0] == pytest.approx(0.10, abs=0.005)


def test_a_factor_is_found():
    sure = {"pressure_accuracy": 0.0, "force_accuracy": 0.0}
    force = 1.2 * vane().force(PRESSURES)
    near = lf.lab.compare_forces(vane(), table(force), **sure).ratio
    assert near.value == pytest.approx(1.2, rel=1e-9)
    low, high = near.interval
    usual = lf.lab.compare_forces(vane(), table(force)).ratio.interval
    assert usual[0] < low < 1.2 < high < usual[1]
    alone = lf.lab.compare_forces(vane(), table(force), **{**sure, "pressure_accuracy": 0.3}).ratio
    # where the force is the largest, pressure does not matter; below, it does in proportion
    thin = vane().force(PRESSURES[:1])
    one = Table("points.csv", np.arange(1), {"pressure": PRESSURES[:1], "force": thin}, {})
    wide = lf.lab.compare_forces(vane(), one, **{**sure, "pressure_accuracy": 0.3}).ratio.interval
    assert wide[1] / wide[0] == pytest.approx(math.exp(2 * 1.96 * 0.3), rel=0.1)
    assert alone.interval[1] / alone.interval[0] < wide[1] / wide[0]


def test_points_count_by_their_spread_along_the_slope_of_the_curve():
    """At the top of the curve an uncertain pressure takes nothing from a point."""
    hot, step = vane(), 1e-4
    force, spread = hot.force(PRESSURES), np.where(np.arange(9) % 2, 0.3, 0.02)
    above, below = (hot.force(PRESSURES * np.exp(end)) for end in (step, -step))
    slope = np.log(above / below) / (2.0 * step)
    factor = np.linspace(0.8, 1.3, 9)
    points = table(
        factor * force, force_uncertainty=0.01 * factor * force,
        pressure_uncertainty=spread * PRESSURES,
    )  # fmt: skip
    weight = 1.0 / (0.01**2 + (slope * spread) ** 2)
    expected = np.exp(np.sum(weight * np.log(factor)) / np.sum(weight))
    found = lf.lab.compare_forces(hot, points).ratio.value
    assert found == pytest.approx(expected, rel=1e-3)
    blunt = 1.0 / (0.01**2 + spread**2)
    assert abs(found / np.exp(np.sum(blunt * np.log(factor)) / np.sum(blunt)) - 1.0) > 0.01


def test_the_interval_of_the_ratio_is_as_wide_as_one_is_off():
    """Vanes drawn from a stated one, with instruments and points that err as stated."""
    stated = lf.lab.Vane(
        Measured(0.12, 0.001), Measured(419.0, 1.0), Measured(394.0, 1.0),
        ambient=Measured(296.0, 2.0), tac_hot=Measured(0.8, 0.03), tac_cold=Measured(0.8, 0.03),
    )  # fmt: skip
    rng, errors = np.random.default_rng(7), []
    for _ in range(5):
        wide, hot, cold, around, tac, gauge, balance = rng.standard_normal(7)
        true = lf.lab.Vane(
            Measured(0.12 + 0.001 * wide), Measured(419.0 + hot), Measured(394.0 + cold),
            ambient=Measured(296.0 + 2.0 * around), tac_hot=Measured(0.8 + 0.03 * tac),
            tac_cold=Measured(0.8 + 0.03 * tac),
        )  # fmt: skip
        force = true.force(PRESSURES * (1.0 + 0.05 * gauge)) * (1.0 + 0.05 * balance)
        force *= 1.0 + 0.03 * rng.standard_normal(PRESSURES.size)
        ratio = lf.lab.compare_forces(stated, table(force, force_uncertainty=0.03 * force)).ratio
        low, high = ratio.interval
        errors.append(1.96 * (2.0 - low - high) / (high - low))  # in standard ones
    assert max(np.abs(errors)) < 4.0
    # the error of the force model, which no draw has, is in the interval
    assert np.sqrt(np.mean(np.square(errors))) < 0.75


def test_what_looks_wrong_is_said(write):
    force = vane().force(PRESSURES)
    found = lf.lab.compare_forces(vane(), table(1e3 * force))
    assert any("1e+03 times those predicted: check their unit" in text for text in found.warnings)
    assert any("no ± of the forces" in text for text in found.warnings)
    known = table(force, force_uncertainty=0.1 * force)
    (dense,) = lf.lab.compare_forces(vane(), known).warnings
    assert "what heat does to force or heat loss outside its table" in dense
    assert not lf.lab.compare_forces(vane(), known, pressures=(0.1, 0.9)).warnings
    path = write("pressure [Pa], force [uN]\n1, 20\n2, -20\n", "vane.csv")
    with pytest.raises(lf.ConfigurationError, match=r"vane.csv:3: force = -20 uN is not pos"):
        lf.lab.read_forces(path)
    text = lf.lab.Vane("12 cm", "419 ± 2 K", 394.0, tac_hot="0.9", tac_cold=0.9, ambient=300.0)
    assert (text.diameter, text.hot) == (Measured(0.12), Measured(419.0, 2.0))
    np.testing.assert_array_equal(text.force(PRESSURES), vane().force(PRESSURES))
    with pytest.raises(lf.ConfigurationError, match="12 kg"):
        lf.lab.Vane("12 kg", 419.0, 394.0)
    with pytest.raises(lf.ParameterError, match="diameter"):
        lf.lab.Vane(-0.12, 419.0, 394.0)
    for wrong, match in (
        ({"hot": 390.0}, "the hot face has 390 K"),
        ({"tac": 1.2}, "tac = 1.2 is not between"),
        ({"gas": lf.gas.CARBON_DIOXIDE}, "polyatomic"),
    ):
        with pytest.raises(lf.ParameterError, match=match):
            vane(**wrong)
    with pytest.raises(lf.ParameterError, match="give points, or the pressures"):
        lf.lab.compare_forces(vane())


def test_errors_of_two_surfaces_push_by_their_difference():
    """Free molecules push with TAC times what leaves each face; errors of one surface are one."""
    tacs = {"tac_hot": Measured(0.8, 0.05), "tac_cold": Measured(0.8, 0.05)}
    spreads = []
    for alike in (True, False):
        faces = lf.lab.Vane(
            "12 cm", 419.0, 394.0, ambient=300.0, alike=alike, wall="maxwell", **tacs
        )
        thin = faces.forces(np.array([1e-4]), 4000)[:, 0]
        spreads.append(thin.std() / thin.mean())
    hot, cold = math.sqrt(419.0 / 300.0) - 1.0, math.sqrt(394.0 / 300.0) - 1.0
    assert spreads[0] == pytest.approx(0.05 / 0.8, rel=0.1)
    assert spreads[1] == pytest.approx(0.05 / 0.8 * math.hypot(hot, cold) / (hot - cold), rel=0.1)
