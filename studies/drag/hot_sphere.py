r"""Drag of a hot sphere in slow flow of dense gas, over that of a sphere as warm as the gas.

The gas around has the temperature of conduction, :math:`T^{1+\omega} = 1 + (\tau^{1+\omega}-1)/r`
with :math:`\mu\propto\kappa\propto T^\omega`, and the density :math:`1/T`. Slow flow over it is
linear. With :math:`v_r = T F(r)\cos\theta` mass is conserved, and what is left are two equations of
momentum in :math:`x = 1/r` for :math:`F` and the pressure, solved by collocation.

Run as ``python studies/drag/hot_sphere.py``.
"""

import argparse

import numpy as np

_POINTS = 40


def chebyshev(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes from 1 to 0, and the matrix of the derivative."""
    index = np.arange(points + 1)
    nodes = np.cos(np.pi * index / points)
    scale = np.where((index == 0) | (index == points), 2.0, 1.0) * (-1.0) ** index
    difference = nodes[:, None] - nodes[None, :] + np.eye(points + 1)
    matrix = scale[:, None] / scale[None, :] / difference
    matrix -= np.diag(matrix.sum(axis=1))
    return 0.5 * (nodes + 1.0), 2.0 * matrix


def drag_growth(ratio: float, exponent: float, where: int = 0) -> float:
    r"""Drag of a sphere of the temperature ratio :math:`\tau`, over that of :math:`\tau = 1`.

    Parameters
    ----------
    ratio : float
        T_w/T [1].
    exponent : float
        ω of the viscosity [1].
    where : int
        Node at whose radius the force is summed; it is the same at each.
    """
    x, slope = chebyshev(_POINTS)
    temperature = (1.0 + (ratio ** (1.0 + exponent) - 1.0) * x) ** (1.0 / (1.0 + exponent))
    viscosity = temperature[:, None] ** exponent
    unit = np.eye(x.size)
    along = -x[:, None] * slope  # r d/dr
    radial = np.diag(temperature)  # v_r = radial F cos θ
    polar = -temperature[:, None] * (unit + 0.5 * along)  # v_θ = polar F sin θ
    # rates of strain and stresses, times r
    stretch, hoop = along @ radial, radial + polar
    shear = 0.5 * (along @ polar - polar - radial)
    dilation = stretch + 2.0 * hoop
    normal = 2.0 * viscosity * (stretch - dilation / 3.0)
    around = 2.0 * viscosity * (hoop - dilation / 3.0)
    shearing = 2.0 * viscosity * shear
    # momentum along r and θ, times r²; the pressure is P cos θ/r
    n = x.size
    system = np.block(
        [
            [along @ normal + normal - 2.0 * around + 2.0 * shearing, unit - along],
            [along @ shearing + 2.0 * shearing - around, unit],
        ]
    )
    right = np.zeros(2 * n)
    system[[0, n - 1, n]] = 0.0
    system[0, 0] = 1.0  # no flow into the sphere
    system[n, :n] = along[0]  # nor along it
    system[n - 1, n - 1] = right[n - 1] = 1.0  # uniform flow far away
    found = np.linalg.lstsq(system, right, rcond=None)[0]
    flow, pressure = found[:n], found[n:]
    pull = 2.0 / 3.0 * ((normal @ flow)[where] - pressure[where])
    force = 2.0 * np.pi / x[where] * (pull - 4.0 / 3.0 * (shearing @ flow)[where])
    return float(force / (6.0 * np.pi))


def film_share(ratio: float, exponent: float) -> float:
    """Share of the excess at which the viscosity of the gas gives this drag."""
    return (drag_growth(ratio, exponent) ** (1.0 / exponent) - 1.0) / (ratio - 1.0)


def main() -> None:
    """Print the growth of the drag, and the share of the excess that stands for it."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("T_w/T  omega  drag growth  share of the excess")
    for exponent in (0.66, 0.74):
        for ratio in (0.8, 1.2, 1.5, 2.0, 2.5):
            growth = drag_growth(ratio, exponent)
            print(f"{ratio:5.1f} {exponent:6.2f} {growth:12.4f} {film_share(ratio, exponent):9.3f}")


if __name__ == "__main__":
    main()
