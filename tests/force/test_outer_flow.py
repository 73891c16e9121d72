"""Flow through a disk: its limits, and its balance with a pump."""

import csv
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.force.laws.outer_flow import (
    pumped_velocity,
    through_flow_coefficient,
    through_flow_force,
)

STUDY = Path(__file__).parents[2] / "studies" / "outer_flow"
AIR = {"radius": 0.05, "density": 0.04, "viscosity": 1.45e-5}


def test_force_is_that_of_the_navier_stokes_solutions():
    """The finest runs of the study, whose meshes leave half a percent open."""
    with (STUDY / "pumped.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    finest = {
        row["reynolds"]: row for row in sorted(rows, key=lambda row: int(row["cells_around"]))
    }
    assert len(finest) >= 14
    with lf.float64():
        for row in finest.values():
            found = float(through_flow_coefficient(float(row["reynolds"])))
            assert found == pytest.approx(float(row["force_over_mu_a_u"]), rel=0.017)


def test_creeping_flow_is_stokes_law_without_a_linear_correction():
    """The flow is the same up and down, so that inertia counts to second order only."""
    with lf.float64():
        slopes = [(float(through_flow_coefficient(re)) - 16.0) / re for re in (1e-3, 1e-2, 1e-1)]
        assert float(through_flow_coefficient(0.0)) == 16.0
        assert slopes[1] / slopes[0] == pytest.approx(10.0, rel=0.01)
        assert slopes[2] / slopes[1] == pytest.approx(10.0, rel=0.05)
        force = float(through_flow_force(0.01, 1e-9, 1e-3, 1.8e-5))
        assert force == pytest.approx(16.0 * 1.8e-5 * 0.01 * 1e-9, rel=1e-12)
        # less in rarefied gas
        assert float(through_flow_coefficient(0.0, 5.0)) == 5.0


@pytest.mark.parametrize("conductance", [1e-6, 1e-2, 1.0, 1e4])
@pytest.mark.parametrize("stopping", [1e-6, 1e-3, 1.0, 1e3, -1e-2])
def test_pump_and_flow_are_in_balance(conductance, stopping):
    def excess(velocity):
        with lf.float64():
            force = float(through_flow_force(velocity=velocity, **AIR))
        return velocity - conductance * (stopping - force / (np.pi * AIR["radius"] ** 2))

    free = conductance * stopping
    expected = brentq(excess, min(0.0, free), max(0.0, free), rtol=1e-13, xtol=1e-300)
    with lf.float64():
        found = float(pumped_velocity(conductance, stopping, **AIR))
    assert found == pytest.approx(expected, rel=1e-11)


def test_derivatives_of_the_balance(require_derivatives):
    """Of logarithms, of walls and outer flows that resist much and little."""

    def velocities(x):
        return lf.xp.log(lf.xp.stack([
            pumped_velocity(
                conductance * x[0], x[1], radius=x[2], density=0.04, viscosity=x[3],
                creeping=creeping,
            )
            for conductance in (1e-3, 10.0) for creeping in (16.0, 3.0)
        ]))  # fmt: skip

    at = np.array([1.0, 0.3, 0.05, 1.45e-5])
    require_derivatives(velocities, at, rtol=1e-7, atol=1e-9)


def test_no_pressure_pumps_nothing():
    with lf.float64():
        assert float(pumped_velocity(1.0, 0.0, **AIR)) == 0.0
        slope = float(jax.grad(lambda one: pumped_velocity(0.5, one, **AIR))(0.0))
    outside = 0.5 * 16.0 * AIR["viscosity"] / (np.pi * AIR["radius"])
    assert slope == pytest.approx(0.5 / (1.0 + outside), rel=1e-12)
