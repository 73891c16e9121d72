"""Absorption of spheres and its asymmetry to 50 digits, for ``tests/film/test_sphere.py``.

The internal field is summed from Bessel functions of mpmath and integrated over radius and angle by
Gauss and Legendre. Run with mpmath installed; it takes some seconds.
"""

import mpmath as mp
import numpy as np

mp.mp.dps = 50
CASES = [
    ("1.57", "0.038", "10", 30, 34),
    ("1.41", "0.008", "1.9729", 18, 24),
    ("1.5", "1", "5", 24, 34),
    ("3", "2", "0.01", 8, 12),
    ("1.5", "1e-9", "8", 28, 34),
]  # n, k, size parameter, orders, points a dimension


def gauss_legendre(count):
    """Nodes and weights to 50 digits, by Newton's method from those of NumPy."""
    nodes, weights = [], []
    for node in map(mp.mpf, map(float, np.polynomial.legendre.leggauss(count)[0])):
        for _ in range(4):
            before, value = mp.mpf(1), node
            for n in range(2, count + 1):
                before, value = value, ((2 * n - 1) * node * value - (n - 1) * before) / n
            slope = count * (node * value - before) / (node**2 - 1)
            weight = 2 / ((1 - node**2) * slope**2)
            node -= value / slope
        nodes.append(node)
        weights.append(weight)
    return nodes, weights


def spherical(function, n, z):
    """Spherical Bessel function."""
    return mp.sqrt(mp.pi / (2 * z)) * function(n + mp.mpf(1) / 2, z)


def sphere(n, k, size, orders, points):
    """Absorption efficiency and J₁, positive where the lit side is heated."""
    m, x, some = mp.mpc(n, k), mp.mpf(size), range(1, orders + 1)

    def derivative(function, order, z):  # of z times the spherical Bessel function
        return z * spherical(function, order - 1, z) - order * spherical(function, order, z)

    c, d = {}, {}
    for order in some:
        jx, hx = spherical(mp.besselj, order, x), spherical(mp.hankel1, order, x)
        jm, slope = spherical(mp.besselj, order, m * x), derivative(mp.besselj, order, m * x)
        top = jx * derivative(mp.hankel1, order, x) - hx * derivative(mp.besselj, order, x)
        c[order] = top / (jm * derivative(mp.hankel1, order, x) - hx * slope)
        d[order] = m * top / (m**2 * jm * derivative(mp.hankel1, order, x) - hx * slope)

    nodes, weights = gauss_legendre(points)
    angular = []
    for u in nodes:
        pi = [mp.mpf(0), mp.mpf(1)]
        for order in range(2, orders + 1):
            pi.append(((2 * order - 1) * u * pi[-1] - order * pi[-2]) / (order - 1))
        tau = [0] + [order * u * pi[order] - (order + 1) * pi[order - 1] for order in some]
        angular.append((pi, tau))
    power, moment = mp.mpf(0), mp.mpf(0)
    for node, weight in zip(nodes, weights, strict=True):
        r, weight = (node + 1) / 2, weight / 2
        z = m * x * r
        j = [spherical(mp.besselj, order, z) for order in range(orders + 1)]
        scale = {o: mp.mpc(0, 1) ** o * mp.mpf(2 * o + 1) / (o * (o + 1)) for o in some}
        one = {o: scale[o] * c[o] * j[o] for o in some}
        other = {o: -1j * scale[o] * d[o] * (j[o - 1] - o / z * j[o]) for o in some}
        radial = {o: -1j * scale[o] * d[o] * o * (o + 1) * j[o] / z for o in some}
        for u, share, (pi, tau) in zip(nodes, weights, angular, strict=True):
            field = (
                sum(one[o] * pi[o] + other[o] * tau[o] for o in some),
                sum(one[o] * tau[o] + other[o] * pi[o] for o in some),
                mp.sqrt(1 - u**2) * sum(radial[o] * pi[o] for o in some),
            )
            strength = sum(abs(part) ** 2 for part in field) * weight * share * r**2
            power += strength
            moment += strength * r * u  # u is along the light
    factor = 2 * mp.mpf(n) * mp.mpf(k) * x
    return factor * power, -mp.mpf(3) / 4 * factor * moment


if __name__ == "__main__":
    for case in CASES:
        print(case[:3], *(mp.nstr(value, 20) for value in sphere(*case)))
