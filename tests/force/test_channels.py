"""A wall with channels as a pump, beside published numbers and limits."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.force.laws.channels import (
    ROUND,
    SLOT,
    GasAround,
    channel_coefficients,
    channel_conductance,
    channel_table,
    direct_share,
    gas_at_faces,
    pumped_flux,
    thermomolecular_exponent,
    thermomolecular_pressure,
)
from lightflyer.gas.molecules import slot_transmission

BOTH = pytest.mark.parametrize("shape", [SLOT, ROUND], ids=lambda shape: shape.name)
LENGTHS = np.array([0.05, 0.5, 1.0, 2.0, 5.0])


@pytest.fixture(autouse=True)
def double_precision():
    with lf.float64():
        yield


def test_slot_beside_published_numbers():
    """Shakhov equation, diffuse walls: the tables of Sharipov and Seleznev (1998)."""
    rarefaction = [0.01, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
    poiseuille = [3.052, 2.040, 1.615, 1.554, 1.611, 2.005, 2.779, 4.400]
    creep = [1.247, 0.733, 0.463, 0.366, 0.274, 0.164, 0.098, 0.054]
    found = channel_coefficients(SLOT, np.array(rarefaction))
    np.testing.assert_allclose(found.poiseuille, poiseuille, rtol=1.5e-3)
    np.testing.assert_allclose(found.creep, creep, atol=8e-4)


def test_tube_beside_published_numbers():
    """BGK equation, diffuse walls: Porodnov and Tuchvetov (1979), who differ by 0.3 %."""
    found = channel_coefficients(ROUND, np.array([0.01, 0.02, 0.04, 0.08]))
    np.testing.assert_allclose(found.poiseuille, [1.4768, 1.4608, 1.4391, 1.4131], rtol=3e-3)


@BOTH
def test_rows_that_the_curves_do_not_go_through(shape):
    table, name = channel_table(), "slot" if shape is SLOT else "round"
    found = channel_coefficients(shape, table["rarefaction"])
    np.testing.assert_allclose(found.poiseuille, table[f"{name}_poiseuille"], rtol=5e-4)
    np.testing.assert_allclose(found.creep, table[f"{name}_creep"], rtol=2.5e-3)


def test_limits_of_endless_channels():
    thin, dense = 1e-9, 1e5
    tube = channel_coefficients(ROUND, np.array([thin, dense]))
    knudsen = 8.0 / (3.0 * np.sqrt(np.pi))
    np.testing.assert_allclose(tube.poiseuille[0], knudsen, rtol=1e-6)
    np.testing.assert_allclose(tube.creep[0], 0.5 * knudsen, rtol=1e-6)
    np.testing.assert_allclose(tube.poiseuille[1], dense / 4.0 + 1.018, rtol=1e-8)
    slot = channel_coefficients(SLOT, np.array([thin, 10.0 * thin, dense]))
    # both grow as the logarithm of the path
    slope = np.log(10.0) / np.sqrt(np.pi)
    np.testing.assert_allclose(slot.poiseuille[0] - slot.poiseuille[1], slope, rtol=1e-6)
    np.testing.assert_allclose(slot.creep[0] - slot.creep[1], 0.5 * slope, rtol=1e-6)
    np.testing.assert_allclose(slot.poiseuille[2], dense / 6.0 + 1.018, rtol=1e-8)
    # Maxwell's creep, whose coefficient by the Shakhov equation is 1.175
    for shape in (SLOT, ROUND):
        creep = dense * channel_coefficients(shape, dense).creep
        assert creep == pytest.approx(1.175, rel=0.02)


def clausing(kernel, leaves, seen, length, nodes):
    """Transmission by Clausing's integral equation, Gauss nodes graded to both ends."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    z, weight = (
        0.5 * length * (1.0 + np.sin(0.5 * np.pi * x)),
        0.25 * np.pi * length * (weight * np.cos(0.5 * np.pi * x)),
    )
    matrix = np.eye(nodes) - kernel(np.abs(z[:, None] - z)) * weight
    escapes = np.linalg.solve(matrix, leaves(length - z))
    return 1.0 - seen(length) + np.sum(weight * escapes * derivative(seen, z))


def derivative(function, z, step=1e-6):
    return (function(z + step) - function(z - step)) / (2.0 * step)


def slot_by_clausing(length):
    return clausing(
        lambda d: 0.5 / (1.0 + d**2) ** 1.5,
        lambda d: 0.5 * (1.0 - d / np.sqrt(1.0 + d**2)),
        lambda z: 1.0 - (np.sqrt(1.0 + z**2) - z),
        length,
        nodes=100,
    )


def tube_by_clausing(length):
    return clausing(
        lambda d: 0.5 * (1.0 - d * (d**2 + 6.0) / (d**2 + 4.0) ** 1.5),
        lambda d: 0.5 * ((d**2 + 2.0) / np.sqrt(d**2 + 4.0) - d),
        lambda z: 0.5 * (z * np.sqrt(z**2 + 4.0) - z**2),
        length,
        nodes=200,  # the kernel has a kink
    )


@pytest.mark.parametrize(
    ("shape", "integral", "within"),
    [(SLOT, slot_by_clausing, 2e-3), (ROUND, tube_by_clausing, 7e-3)],
)
def test_free_molecules_pass_as_clausing_says(shape, integral, within):
    expected = [integral(length) for length in LENGTHS]
    found = np.sqrt(np.pi) * channel_conductance(shape, 1e-9, LENGTHS)
    np.testing.assert_allclose(found, expected, rtol=within)


def test_transmission_of_a_slot():
    found = slot_transmission(np.array([1e-9, 1e-5, 3e-4, 1.0, 1e4]))
    np.testing.assert_allclose(found.through + found.back, 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.back[:3], [5e-10, 5e-6, 1.4998e-4], rtol=1e-4)
    np.testing.assert_allclose(found.through[-1], (np.log(2e4) - 0.5) / 1e4, rtol=1e-3)


@BOTH
def test_a_hole_in_a_thin_wall_is_an_orifice(shape):
    rarefaction = np.array([1e-9, 1.0, 1e3])
    g = channel_conductance(shape, rarefaction, 1e-9)
    kappa = {"slot": np.pi**1.5 / 16.0, "round hole": 2.0 / (3.0 * np.sqrt(np.pi))}[shape.name]
    np.testing.assert_allclose(g, (1.0 + kappa * rarefaction) / np.sqrt(np.pi), rtol=1e-6)
    assert shape.entrance == pytest.approx({"slot": 0.348, "round hole": 0.376}[shape.name], 1e-3)
    # Sampson's flow Δp r³/(3μ) and that through a slit, π Δp w²/(32 μ), in SI units
    mu, speed, density, size = 1.8e-5, 400.0, 1.2, 1e-3
    pressure = 0.5 * density * speed**2
    delta = pressure * size / (mu * speed)
    flux = pumped_flux(1.0, channel_conductance(shape, delta, 1e-9), speed, 1.0)
    flow = size**3 / (3.0 * mu) if shape is ROUND else np.pi * size**2 / (32.0 * mu)
    area = np.pi * size**2 if shape is ROUND else size
    assert flux == pytest.approx(density * flow / area, rel=1e-3)


@BOTH
def test_exponent_is_one_half_to_free_molecules(shape):
    for length in (1e-3, 1.0, 50.0):
        assert thermomolecular_exponent(shape, 1e-12, length) == pytest.approx(0.5, rel=1e-6)
    pressure = thermomolecular_pressure(0.5, 7.0, 0.5, -0.2)
    warm, cold = 7.0 * (1.5 / 0.8) ** 0.25, 7.0 * (1.5 / 0.8) ** -0.25
    assert pressure == pytest.approx(warm - cold, rel=1e-12)
    assert thermomolecular_pressure(0.3, 7.0, 1e-9, 0.0) == pytest.approx(2.1e-9, rel=1e-8)


@BOTH
def test_no_flow_without_a_temperature_difference(shape):
    exponent = thermomolecular_exponent(shape, 0.7, 2.0)
    assert thermomolecular_pressure(exponent, 5.0, 0.3, 0.3) == 0.0
    # one temperature of the wall, whatever is around it
    for common, difference in ((0.0, 0.3), (2.0, 5.0)):
        warm, cold = gas_at_faces(0.3, 0.3, 0.6, 0.6, 0.4, GasAround(common, difference))
        assert warm == pytest.approx(float(cold), rel=1e-15)
    # a body much smaller than the mean free path, whatever its faces' temperatures
    warm, cold = gas_at_faces(0.5, 0.1, 0.7, 0.6, 0.3, GasAround(1e9, 2e9))
    assert abs(thermomolecular_pressure(0.5, 1.0, warm, cold)) < 1e-6


@BOTH
def test_a_longer_channel_resists_more_and_never_conducts_more_than_an_orifice(shape):
    for delta in (1e-3, 0.1, 1.0, 10.0):
        g = np.asarray(channel_conductance(shape, delta, np.geomspace(1e-3, 1e3, 60)))
        assert np.all(np.diff(g) < 0.0)
        assert g[0] < (1.0 + shape.entrance * delta) / np.sqrt(np.pi)


def test_a_share_of_molecules_through_a_thin_wall():
    """Half the wall open, its faces of two temperatures: a wide wall between two gases.

    Molecules that come to a face leave it as warm as it is, or pass. The temperatures of those that
    come to both sides are found by following them.
    """
    beta, lower, upper = 0.4, 0.3, 0.1
    below, above = 0.0, 0.0
    for _ in range(200):  # what leaves a side comes back to it as warm, where no heat leaves
        below, above = (
            (1.0 - beta) * lower + beta * above,
            (1.0 - beta) * upper + beta * below,
        )
    here = GasAround(0.0, 0.0)
    found = gas_at_faces(lower, upper, 1.0 - beta, 1.0 - beta, beta, here)
    np.testing.assert_allclose(found, [below, above], rtol=1e-12)
    difference = (1.0 - beta) / (1.0 + beta) * (lower - upper)
    assert below - above == pytest.approx(difference, rel=1e-12)


def test_heat_of_the_gas_at_faces_closes():
    """Faces that differ in everything: what they give arrives far away."""
    around = GasAround(0.7, 1.9)
    one, other = gas_at_faces(0.5, -0.2, 0.9, 0.4, 0.25, around)
    given = 0.9 * (0.5 - one) + 0.4 * (-0.2 - other)
    assert given == pytest.approx(float(around.common * (one + other)), rel=1e-12)
    through = 0.9 * (0.5 - one) - 0.4 * (-0.2 - other)
    expected = (2.0 * 0.25 + around.difference) * (one - other)
    assert through == pytest.approx(float(expected), rel=1e-12)


def test_straight_paths():
    for length in (0.1, 1.0, 7.0):
        # crossed strings between parallel strips, and the view factor of coaxial discs
        np.testing.assert_allclose(direct_share(SLOT, length), np.hypot(1.0, length) - length)
        big = 2.0 + length**2
        disc = 0.5 * (big - np.sqrt(big**2 - 4.0))
        np.testing.assert_allclose(direct_share(ROUND, length), disc, rtol=1e-9)


def test_derivatives_and_broadcasting(require_derivatives):
    def flux(shape, delta, length, phi, warm):
        g = channel_conductance(shape, delta, length, phi)
        exponent = thermomolecular_exponent(shape, delta, length)
        return pumped_flux(phi, g, 400.0, thermomolecular_pressure(exponent, 10.0, warm, 0.0))

    def both(x):
        return lf.xp.stack([flux(shape, *x) for shape in (SLOT, ROUND)])

    require_derivatives(both, np.array([0.8, 1.7, 0.4, 0.2]), rtol=1e-6, atol=1e-12)
