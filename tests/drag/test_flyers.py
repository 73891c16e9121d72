"""Drag of every kind of flyer."""

import itertools
import math
from importlib.resources import as_file, files

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.drag.convex import sphere_outline
from lightflyer.flyer.hollow_geometry import FORMS, hollow_outline

KINDS = ("earth", "sandwich", "plate", "hollow", "balloon", "particle")


def flyer_of(kind):
    with as_file(files("lightflyer.data").joinpath(f"flyer-{kind}.toml")) as path:
        return lf.read_flyer_file(path).build().flyer


@pytest.mark.parametrize("kind", KINDS)
def test_drag_is_odd_grows_and_is_differentiable(kind):
    flyer, state = flyer_of(kind), lf.Earth().state(70e3)
    unknowns = (0.1,) * len(flyer.nodes)

    def drag(speed, direction):
        return flyer.drag(state, unknowns, speed, direction)

    with lf.float64():
        speeds = np.array([-2.0, 0.0, 1e-5, 2.0, 20.0])
        for direction in (
            ("broadside", "edgewise") if kind in ("earth", "hollow") else ("broadside",)
        ):
            found = np.asarray(drag(speeds, direction))
            assert found[0] == -found[3]
            assert found[1] == 0.0
            assert np.all(np.diff(found) > 0.0)
            slope = jax.grad(drag)(0.0, direction)
            assert slope == pytest.approx(found[2] / 1e-5, rel=0.01)
    assert isinstance(flyer.drag_diagnostics(state, 1.0), tuple)


def test_a_flyer_without_a_law_says_so(disk):
    class Own(lf.Disk):
        drag = lf.AbstractFlyer.drag

    with pytest.raises(lf.ConfigurationError, match="Own has no law of drag"):
        Own(disk.film, 0.01).drag(lf.Earth().state(70e3), (0.0,), 1.0)


def meridian(form, size, outlet):
    """Points (radius, height) along the surface, closed at the outlet."""
    if form == "cone":
        return [(0.0, size), (0.5 * size, size), (outlet, 0.0), (0.0, 0.0)]
    turns = np.linspace(0.0, 0.5 * np.pi, 4001)
    dome = [(outlet * math.sin(a), size + outlet * math.cos(a)) for a in turns]
    return [*dome, (outlet, 0.0), (0.0, 0.0)]


@pytest.mark.parametrize("form", ["cone", "rocket"])
def test_outline_of_hollow_bodies(form):
    """Sums over rings of the surface."""
    size, outlet = 0.1, 0.02
    surface = along = 0.0
    points = np.array(meridian(form, size, outlet))
    for (r1, z1), (r2, z2) in itertools.pairwise(points):
        length = math.hypot(r2 - r1, z2 - z1)
        ring = math.pi * (r1 + r2) * length
        surface += ring
        along += ring * ((r2 - r1) / length) ** 2
    with lf.float64():
        broadside, edgewise = (
            hollow_outline(form, size, outlet, way) for way in ("broadside", "edgewise")
        )
        seen = FORMS[form].silhouette(size, outlet, 0.0)
    assert broadside.surface == pytest.approx(surface, rel=1e-6)
    assert broadside.facing == pytest.approx(along, rel=1e-6)
    assert edgewise.facing == pytest.approx(0.5 * (surface - along), rel=1e-6)
    assert edgewise.silhouette == pytest.approx(float(seen))


def test_dense_gas_drags_a_disk_by_leiths_rule_as_stokes_says():
    """The rule for any shape, where a shape is known: a disk broadside, 5 % low."""
    disk = lf.drag.Outline(math.pi, 2.0 * math.pi, 2.0 * math.pi)
    with lf.float64():
        assert 6.0 * math.pi * disk.radius == pytest.approx(16.0, rel=0.06)
        assert sphere_outline(0.3).radius == pytest.approx(0.3, rel=1e-12)


def test_holes_above_each_other_and_far_apart(film):
    def sandwich(gap):
        return lf.Sandwich(film, film, 0.01, gap, 0.5, 1e-5, 0.0, 0.0)

    with lf.float64():
        assert sandwich(1e-9).passing_share == pytest.approx(0.5, rel=1e-3)
        assert sandwich(1e-2).passing_share == pytest.approx(1.0 / 3.0, rel=1e-3)


def test_double_precision_without_asking(film):
    """Plain calls, jit and vmap agree to more digits than single precision has."""
    sandwich = lf.Sandwich(film, film, 0.01, 1e-4, 0.5, 1e-5, 0.0, 0.0)
    body = lf.HollowBody(film, film, 0.1, 0.02, 0.5, 1e-4, 1e-4, 5e-8, 1.8, "cone")
    state, speeds = lf.Earth().state(70e3), np.array([0.3, 1.0])
    for flyer in (sandwich, body):
        plain = np.array([flyer.drag(state, (0.1, 0.1), speed) for speed in speeds])
        with lf.float64():
            mapped = jax.jit(jax.vmap(lambda speed, f=flyer: f.drag(state, (0.1, 0.1), speed)))
            np.testing.assert_allclose(plain, mapped(speeds), rtol=1e-12)


def test_wide_holes_are_said_where_they_matter(film):
    dense = lf.Earth().state(0.0)
    narrow, wide = (lf.Sandwich(film, film, 0.01, 1e-4, 0.5, a, 0.0, 0.0) for a in (1e-5, 1e-3))
    assert narrow.drag_diagnostics(dense, 0.1) == ()
    assert any("passes the holes is 0.027" in said for said in wide.drag_diagnostics(dense, 0.1))
