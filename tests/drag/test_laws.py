"""Laws of drag against molecules counted one by one, exact limits, and published laws."""

import importlib.util
import math
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.drag import free_molecular
from lightflyer.drag.convex import convex_drag, sphere_outline
from lightflyer.drag.disk import _EDGEWISE_SHARE, EDGEWISE, dense_share, edgewise_disk_drag
from lightflyer.drag.similarity import (
    disk_inertia,
    edgewise_inertia,
    sphere_inertia,
    viscosity_growth,
)
from lightflyer.gas import AIR

STUDIES = Path(__file__).parents[2] / "studies" / "drag"
TEMPERATURE = 220.0
SPEED = math.sqrt(2.0 * 287.05287 * TEMPERATURE)  # of molecules of air


def load(name):
    spec = importlib.util.spec_from_file_location(f"drag_{name}", STUDIES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pressure_at(rarefaction, radius):
    return rarefaction * float(AIR.viscosity(TEMPERATURE)) * SPEED / radius


def push(normal, along, tac, ratio):
    """Force on a part of a wall along the motion, over pA: molecules counted by their speed.

    ``normal`` is the wall's speed along its normal and ``along`` that in its plane, over that of
    molecules; the normal has the cosine normal/hypot to the motion.
    """

    def arriving(power):
        return quad(lambda c: c**power * math.exp(-((c - normal) ** 2)), 0.0, normal + 8.0)[0]

    number = arriving(1) / math.sqrt(math.pi)
    squeezed = 2.0 * arriving(2) / math.sqrt(math.pi)
    emitted = tac * math.sqrt(math.pi) * number * math.sqrt(ratio)
    return (2.0 - tac) * squeezed + emitted, 2.0 * tac * number * along


@pytest.mark.parametrize(("tac", "ratio"), [(1.0, 1.0), (0.7, 2.2)])
def test_free_molecules_on_a_disk_and_a_sphere(tac, ratio):
    for s in (1e-3, 0.3, 0.99, 2.5):
        front, back = (push(sign * s, 0.0, tac, ratio)[0] for sign in (1.0, -1.0))
        with lf.float64():
            disk = float(free_molecular.broadside_disk(s, tac, math.sqrt(ratio)))
            ball = float(free_molecular.sphere(s, tac, math.sqrt(ratio)))
            flat = float(free_molecular.edgewise_disk(tac))
        assert disk * s == pytest.approx(front - back, rel=1e-10)
        assert flat * s == pytest.approx(2.0 * push(0.0, s, tac, ratio)[1], rel=1e-10)
        total = 0.0
        for cosine, weight in zip(*np.polynomial.legendre.leggauss(24), strict=True):
            sine = math.sqrt(1.0 - cosine**2)
            normal, along = push(s * cosine, s * sine, tac, ratio)
            total += weight * 2.0 * (normal * cosine + along * sine)
        assert ball * s == pytest.approx(total, rel=1e-8)


def test_slow_drag_and_its_slope_are_smooth_through_rest():
    with lf.float64():
        for law in (free_molecular.broadside_disk, free_molecular.sphere):
            at_rest, slow, crossing = (float(law(s, 0.9, 1.2)) for s in (0.0, 1e-5, 1e-4))
            assert slow == pytest.approx(at_rest, rel=1e-9)
            assert crossing == pytest.approx(at_rest, rel=1e-7)
            assert float(jax.grad(lambda s, law=law: law(s, 0.9, 1.2))(0.0)) == 0.0


def test_both_limits_of_a_disk():
    thin = {"pressure": pressure_at(1e-8, 0.01), "temperature": TEMPERATURE, "gas": AIR}
    dense = thin | {"pressure": pressure_at(1e7, 0.01)}
    speed, area = 1e-4, math.pi * 0.01**2
    slow = float(AIR.viscosity(TEMPERATURE)) * 0.01 * 1e-12
    for tac, excess in (((0.8, 0.9), (0.0, 0.0)), ((0.3, 0.7), (0.9, 1.4))):
        roots = np.sqrt(1.0 + np.asarray(excess))
        expected = sum(
            0.5 * ((2.0 - a) * 4.0 / math.sqrt(math.pi) + a * math.sqrt(math.pi) * root)
            for a, root in zip(tac, roots, strict=True)
        )
        found = lf.drag.disk_drag(speed, 0.01, **thin, tac=tac, excess=excess)
        scale = thin["pressure"] * area * speed / SPEED
        assert found / scale == pytest.approx(expected, rel=1e-6)
        found = edgewise_disk_drag(speed, 0.01, **thin, tac=tac, excess=excess)
        assert found / scale == pytest.approx(sum(tac) / math.sqrt(math.pi), rel=1e-6)
    assert lf.drag.disk_drag(1e-12, 0.01, **dense) / slow == pytest.approx(16.0, rel=1e-6)
    edgewise = edgewise_disk_drag(1e-12, 0.01, **dense)
    assert edgewise / slow == pytest.approx(32.0 / 3.0, rel=1e-6)


def test_holes_let_thin_gas_pass_and_not_dense_gas():
    """To free molecules the film alone counts; those that pass no longer matter in dense gas."""
    thin, dense = (
        [
            lf.drag.disk_drag(
                1e-6, 0.01, pressure_at(delta, 0.01), TEMPERATURE, AIR, transmission=share
            )
            for share in (0.0, 0.6)
        ]
        for delta in (1e-7, 1e5)
    )
    assert thin[1] / thin[0] == pytest.approx(0.4, rel=1e-6)
    assert dense[1] / dense[0] == pytest.approx(1.0, rel=1e-4)


def test_first_collisions_of_the_table_and_of_the_edgewise_law():
    """The integral over the free flow knows neither mesh nor table."""
    study = load("first_collisions")
    thin = free_molecular.broadside_disk
    with lf.float64():
        limit = float(thin(0.0, 1.0, 1.0))
        share = float(dense_share(0.01, 1.0, "monatomic"))
    expected = -study.first_order(study.broadside) / limit**2 * 16.0 / math.pi
    assert share == pytest.approx(expected, rel=6e-3)
    edgewise = -study.first_order(study.edgewise) / (4.0 / math.pi) * EDGEWISE / math.pi
    constant, offset = _EDGEWISE_SHARE
    assert 1.0 - constant / offset == pytest.approx(edgewise, rel=2e-3)


def test_inertia_of_a_disk_in_its_ranges_and_limits():
    """The published laws, away from where they are joined, and what they have in common there."""
    low, middle = np.array([0.05, 0.3, 0.9]), np.array([3.0, 20.0, 80.0])
    with lf.float64():
        places = np.concatenate([[0.0, 1e-4], low, middle, [400.0]])
        found = np.asarray(disk_inertia(places))
        places = np.array([0.0, 1.499, 1.501, 132.9, 133.1])
        slopes = np.asarray(jax.vmap(jax.grad(disk_inertia))(places))
    assert found[0] == 1.0
    assert found[1] - 1.0 == pytest.approx(1e-4 / (2.0 * np.pi), rel=1e-9)  # Oseen
    decimal = np.log10(low)
    np.testing.assert_allclose(
        found[2:5] - 1.0, 10 ** (-0.883 + 0.906 * decimal - 0.025 * decimal**2)
    )
    np.testing.assert_allclose(found[5:8] - 1.0, 0.138 * middle**0.792)
    assert found[8] * 64.0 / (np.pi * 400.0) == pytest.approx(1.17)
    assert slopes[0] == pytest.approx(1.0 / (2.0 * np.pi))
    assert slopes[1] == pytest.approx(slopes[2], rel=0.01)
    assert slopes[3] == pytest.approx(slopes[4], rel=0.01)


def test_inertia_of_a_sphere_follows_the_standard_drag_curve():
    """Drag coefficients of the standard curve at Re 1, 100 and 1000."""
    reynolds, standard = np.array([1.0, 100.0, 1000.0]), np.array([27.1, 1.09, 0.47])
    found = 24.0 / reynolds * sphere_inertia(reynolds)
    np.testing.assert_allclose(found, standard, rtol=0.05)


def test_a_slow_sphere_follows_cunninghams_law():
    """[AllenRaabe1985]'s fit to measurements, of walls that accommodate nearly all molecules."""
    path = float(lf.gas.mean_free_path(1e3, TEMPERATURE, AIR))
    knudsen = np.array([1e-4, 0.01, 0.1, 0.3, 1.0])
    radius = path / knudsen
    stokes = 6.0 * np.pi * float(AIR.viscosity(TEMPERATURE)) * radius * 1e-6
    measured = stokes / (1.0 + knudsen * (1.142 + 0.558 * np.exp(-0.999 / knudsen)))
    found = convex_drag(1e-6, sphere_outline(radius), 1e3, TEMPERATURE, AIR)
    np.testing.assert_allclose(found, measured, rtol=0.015)
    thinner = convex_drag(1e-6, sphere_outline(0.1 * radius), 1e3, TEMPERATURE, AIR, tac=0.9)
    knudsen *= 10.0
    measured = 0.1 * stokes / (1.0 + knudsen * (1.142 + 0.558 * np.exp(-0.999 / knudsen)))
    np.testing.assert_allclose(thinner[-2:], measured[-2:], rtol=0.03)


def test_dense_gas_is_warmed_by_a_hot_sphere():
    """The flow around a hot sphere gives the share 0.5 of the excess; its force is conserved."""
    study = load("hot_sphere")
    assert study.drag_growth(1.0, 0.74) == pytest.approx(1.0, abs=1e-6)
    assert study.drag_growth(2.0, 0.74, where=20) == pytest.approx(
        study.drag_growth(2.0, 0.74), rel=1e-6
    )
    for ratio, exponent in ((0.8, 0.74), (2.0, 0.66), (2.4, 0.74)):
        growth = (1.0 + 0.5 * (ratio - 1.0)) ** exponent
        assert growth == pytest.approx(study.drag_growth(ratio, exponent), rel=0.025)
        found = viscosity_growth(ratio - 1.0, 1e9, 250.0, AIR)
        expected = AIR.viscosity(125.0 * (1.0 + ratio)) / AIR.viscosity(250.0)
        assert found == pytest.approx(float(expected), rel=1e-6)


def test_growth_between_thin_and_dense_gas_is_that_of_a_disk_broadside():
    """What the kinetic equation leaves to the resistance of dense gas, on the finer mesh."""
    study = load("hot_disk")
    for (mesh, _, tac, knudsen), drag in study.read_points().items():
        rarefaction = np.sqrt(np.pi) / (4.0 * knudsen)
        if mesh != "medium" or rarefaction < 4.0:
            continue
        for (_, resistance), ratio in zip(study.growths(tac, drag), study.RATIOS, strict=True):
            found = float(viscosity_growth(ratio - 1.0, rarefaction, 250.0, AIR))
            assert found == pytest.approx(resistance, abs=0.035)


def test_out_of_range_is_said():
    from lightflyer.drag.disk import disk_diagnostics

    def said(speed, pressure, **options):
        return " ".join(disk_diagnostics(speed, 0.01, pressure, TEMPERATURE, AIR, **options))

    assert said(1.0, 5.0) == ""
    assert "compression" in said(200.0, 5.0)
    assert said(200.0, 1e-3) == ""  # to free molecules every speed is exact
    assert "flutters" in said(2.0, 1e5)
    assert "estimate" in said(1.0, 5.0, direction="edgewise")
    assert "warm disk" in said(1.0, 5.0, body_temperature=500.0)
    assert "warmth" in said(0.1, 500.0, body_temperature=500.0, direction="edgewise")
    assert said(1.0, 0.1, body_temperature=500.0) == ""
    assert "mean TAC" in said(1.0, 5.0, tac=(0.1, 0.1))


def test_edgewise_inertia_is_none_in_slow_flow_and_grows():
    found = [float(edgewise_inertia(reynolds)) for reynolds in (0.0, 1.0, 100.0)]
    np.testing.assert_allclose(found, [1.0, 1.0713, 2.8059], rtol=1e-4)
