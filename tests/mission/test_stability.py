"""A hanging payload against Newton's equations of its parts; tilted disks against closed forms."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.drag.disk import turning_disk_torque
from lightflyer.mission.path.steady import _Body, longest_rod, modes_of

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
RANDOM = np.random.default_rng(5)


def bodies(count):
    """Flyers of random sizes around those of a 2-cm disk."""
    for _ in range(count):
        scale = 10.0 ** RANDOM.uniform(-0.7, 0.7, 5)
        own, inertia, payload, edgewise, turning = scale * [3e-7, 8e-12, 1e-7, 2e-7, 1e-10]
        yield _Body(own, inertia, payload, 9.6, edgewise, turning)


def routh(body, length):
    """Left side of Routh's criterion less its right side, over the right one."""
    total = body.own_mass + body.payload
    left = body.turning_drag * (
        total * body.turning_drag
        + body.inertia * body.edgewise_drag
        + body.payload * length**2 * body.edgewise_drag
    )
    right = (
        (total * body.inertia + body.own_mass * body.payload * length**2)
        * body.payload * body.gravity * length
    )  # fmt: skip
    return left / right - 1.0


def accelerations(body, rod, string, payload_drag, state):
    """Newton's equations of flyer, joint and payload with the pulls of rod and string.

    The joint between rod and string weighs next to nothing. Unknown are the accelerations of the
    flyer (x, z, angle), of joint and payload (x, z), the two parts of the rod's force on the
    joint, for a rod can push sideways, and the pull of the string.
    """
    tilt, swing, *speeds = state[2:]
    vx, vz, turning, swinging = speeds
    joint_mass = 1e-6 * body.payload
    weight = (body.own_mass + body.payload + joint_mass) * body.gravity
    sin, cos = np.sin(tilt), np.cos(tilt)
    sin_s, cos_s = np.sin(swing), np.cos(swing)
    u = vx - rod * cos * turning - string * cos_s * swinging
    w = vz + rod * sin * turning + string * sin_s * swinging
    a, b = np.zeros((10, 10)), np.zeros(10)
    ax, az, aw, jx, jz, px, pz, fx, fz, pull = range(10)
    along = vx * cos - vz * sin
    a[0, [ax, fx]], b[0] = [body.own_mass, 1], weight * sin - body.edgewise_drag * along * cos
    a[1, [az, fz]] = body.own_mass, 1
    b[1] = weight * cos - body.own_mass * body.gravity + body.edgewise_drag * along * sin
    # the joint lies at -rod (sin, cos); the force on the flyer there is -(fx, fz)
    a[2, [aw, fx, fz]] = body.inertia, -rod * cos, rod * sin
    b[2] = -body.turning_drag * turning
    a[3, [jx, fx, pull]], b[3] = [joint_mass, -1, sin_s], 0.0
    a[4, [jz, fz, pull]], b[4] = [joint_mass, -1, cos_s], -joint_mass * body.gravity
    a[5, [px, pull]], b[5] = [body.payload, -sin_s], -payload_drag * u
    a[6, [pz, pull]], b[6] = [body.payload, -cos_s], -body.payload * body.gravity - payload_drag * w
    a[7, [jx, ax, aw]], b[7] = [1, -1, rod * cos], rod * sin * turning**2
    a[8, [jz, az, aw]], b[8] = [1, -1, -rod * sin], rod * cos * turning**2
    # the string keeps its length: the part of the difference of accelerations along it
    a[9, [px, jx, pz, jz]] = sin_s, -sin_s, cos_s, -cos_s
    b[9] = -string * swinging**2
    found = np.linalg.solve(a, b)
    across = (found[px] - found[jx]) * cos_s - (found[pz] - found[jz]) * sin_s
    return np.array([*speeds, found[ax], found[az], found[aw], -across / string])


def test_modes_are_those_of_newtons_equations():
    for body in bodies(5):
        rod, string, payload_drag = 2e-3, 5e-3, 3e-8
        jacobian = np.empty((8, 8))
        for column in range(8):
            step = np.zeros(8)
            step[column] = 1e-6
            both = [accelerations(body, rod, string, payload_drag, sign * step) for sign in (1, -1)]
            jacobian[:, column] = (both[0] - both[1]) / 2e-6
        sway = [2, 3, 4, 6, 7]  # tilt, swing and the speeds; heave and place are apart
        expected = np.linalg.eigvals(jacobian[np.ix_(sway, sway)])
        found = modes_of(body, rod, string, payload_drag)
        for mode in expected:
            # a joint with mass shifts each mode a little
            assert np.abs(found - mode).min() < 1e-3 * np.abs(expected).max()


def test_eigenvalues_agree_with_routh():
    signs = set()
    for body, length in itertools.product(bodies(30), (3e-4, 1e-3, 3e-3, 1e-2)):
        margin = routh(body, length)
        if abs(margin) > 1e-6:
            grows = modes_of(body, length, 0.0, 0.0)[0].real > 0.0
            assert grows == (margin < 0.0)
            signs.add(grows)
    assert signs == {True, False}


def test_the_longest_rod_is_where_oscillations_begin_to_grow():
    for body in bodies(5):
        first = brentq(lambda x, body=body: routh(body, x), 1e-7, longest_rod(body) * 1.001)
        assert longest_rod(body) == pytest.approx(first, rel=1e-6)
        assert modes_of(body, 0.99 * first, 0.0, 0.0)[0].real < 0.0


def test_a_short_rod_keeps_a_disk_level_and_a_long_one_or_a_string_does_not():
    disk, state = lf.Disk(FILM, radius=0.01, payload=1e-7), lf.Earth().state(70e3)
    found = lf.mission.hanging_stability(disk, state, rod=0.01)
    assert not found.stable
    assert found.growth_rate == pytest.approx(2.8, rel=0.05)
    assert lf.mission.hanging_stability(disk, state, rod=0.001).stable
    string = lf.mission.hanging_stability(disk, state, rod=0.0, string=0.05)
    assert not string.stable  # nothing rights the disk
    assert abs(string.growth_rate) < 1e-9
    assert any("edgewise" in text for text in found.warnings)


def test_a_turning_disk_in_dense_gas_is_a_spheroid_of_jeffery_without_thickness():
    radius, thickness = 1.0, 1e-5

    # Jeffery (1922): 16 πμω (a² + c²) / 3(a²α + c²γ) about a diameter
    def integral(powers):
        # λ = c² sinh²(t) keeps the narrow peak resolved
        def at(t):
            root = thickness * np.sinh(t)
            length = 2.0 * root * thickness * np.cosh(t)
            a, c = radius**2 + root**2, thickness**2 + root**2
            return length / (a ** powers[0] * c ** powers[1])

        return quad(at, 0.0, np.arcsinh(1e4 / thickness), epsabs=0.0, epsrel=1e-10, limit=400)[0]

    along, across = integral((2.0, 0.5)), integral((1.0, 1.5))
    torque = 16.0 * np.pi * (radius**2 + thickness**2) / (
        3.0 * (radius**2 * along + thickness**2 * across)
    )  # fmt: skip
    pressure, temperature, gas = 1e5, 300.0, lf.gas.AIR
    size = 100.0
    found = turning_disk_torque(1.0, size, pressure, temperature, gas)
    assert found == pytest.approx(torque * gas.viscosity(temperature) * size**3, rel=1e-4)


def test_a_turning_disk_in_thin_gas_meets_the_drag_of_its_parts():
    gas, temperature, pressure, radius = lf.gas.AIR, 220.0, 1e-6, 0.01
    thermal = np.sqrt(2.0 * gas.specific_gas_constant * temperature)

    def ring(distance):
        """Drag of a strip at a distance from the diameter, times that distance."""
        strip = 2.0 * np.sqrt(radius**2 - distance**2)
        drag = (4.0 / np.sqrt(np.pi) + np.sqrt(np.pi)) * pressure * distance / thermal
        return strip * drag * distance

    expected = 2.0 * quad(ring, 0.0, radius, epsabs=0.0)[0]
    found = turning_disk_torque(1.0, radius, pressure, temperature, gas)
    assert found / expected == pytest.approx(1.0, rel=1e-5)


@pytest.fixture(scope="module")
def holding():
    """A slightly tilted disk whose payload is such that it neither climbs nor sinks."""
    altitude, tilt = 75e3, 0.1

    def flown(payload):
        disk = lf.Disk(FILM, radius=0.005, payload=payload)
        return disk, lf.mission.steady_drift(
            disk, lf.Earth(), lf.Lu2023(), altitude=altitude, tilt=tilt
        )

    payload = brentq(lambda payload: flown(payload)[1].climb, 0.0, 1e-6, xtol=1e-15)
    return altitude, tilt, *flown(payload)


def test_drift_at_constant_altitude_is_the_closed_form(holding):
    altitude, tilt, disk, found = holding
    state = lf.Earth().state(altitude)
    attitude = lf.environment.Attitude(tilt)
    lying = lf.Disk(FILM, radius=disk.radius, payload=disk.payload, attitude=attitude)
    unknowns = lf.equilibrium(lying, state, lf.Lu2023()).unknowns
    along, across = (
        disk.drag(state, unknowns, 1e-6, name) / 1e-6 for name in ("broadside", "edgewise")
    )
    weight = disk.mass * state.gravity
    assert found.speed == pytest.approx(weight / across * np.tan(tilt), rel=0.01)
    ratio = np.cos(tilt) * (1.0 + along / across * np.tan(tilt) ** 2)
    force = found.force / np.sin(tilt)
    assert force / weight == pytest.approx(ratio, rel=2e-4)
    assert found.lift_over_weight == pytest.approx(force * np.cos(tilt) / weight, rel=1e-12)
    # and where its models are beyond their range
    assert any("lu2023 were fitted to disks of 2 to 4 cm" in text for text in found.warnings)
    assert any("edgewise" in text for text in found.warnings)


def test_drift_goes_where_the_top_face_is_tilted_and_a_level_disk_does_not_drift(holding):
    _, _, disk, _ = holding
    around = lf.Earth(), lf.Lu2023()
    towards, away = (
        lf.mission.steady_drift(disk, *around, altitude=75e3, tilt=0.1, azimuth=angle).speed
        for angle in (1.0, 4.0)
    )
    assert towards == pytest.approx(away, rel=1e-9)
    assert towards > 0.1
    assert lf.mission.steady_drift(disk, *around, altitude=75e3, tilt=0.0).speed == 0.0
