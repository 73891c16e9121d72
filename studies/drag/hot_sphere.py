r"""Drag of a hot sphere in slow flow of dense gas, over that of a sphere as warm as the gas.

The gas around has the temperature of conduction, :math:`T^{1+\omega} = 1 + (\tau^{1+\omega}-1)/r`
with :math:`\mu\propto\kappa\propto T^\omega`, and the density :math:`1/T`. Slow flow over it is
linear. With :math:`v_r = T F(r)\cos\theta` mass is conserved. The flow carries heat, which changes
the temperature by :math:`\mathrm{Re}\,\mathrm{Pr}\,\varphi(r)\cos\theta`. Uneven temperature has a
stress, :math:`\sigma_{ij} = (2/\mathrm{Pr})\,(\mu/p)\,R\,\langle\partial_i\mu\,\partial_j T\rangle`
for BGK's, Shakhov's and Maxwell's molecules [ChapmanCowling1970]_, and its change by the flow is as
large as the viscous stress. What is left are energy and two equations of momentum in :math:`x =
1/r` for :math:`F`, :math:`\varphi` and the pressure, solved by collocation.

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


def drag_growth(ratio: float, exponent: float, where: int = 0, thermal: float = 1.0) -> float:
    r"""Drag of a sphere of the temperature ratio :math:`\tau`, over that of :math:`\tau = 1`.

    Parameters
    ----------
    ratio : float
        T_w/T [1].
    exponent : float
        ω of the viscosity [1].
    where : int
        Node at whose radius the force is summed; it is the same at each.
    thermal : float
        Stress of uneven temperature, over what it is [1].
    """
    x, slope = chebyshev(_POINTS)
    temperature = (1.0 + (ratio ** (1.0 + exponent) - 1.0) * x) ** (1.0 / (1.0 + exponent))
    viscosity = temperature[:, None] ** exponent
    unit, zero, n = np.eye(x.size), np.zeros((x.size, x.size)), x.size
    along = -x[:, None] * slope  # r d/dr
    radial = np.diag(temperature)  # v_r = radial F cos θ
    polar = -temperature[:, None] * (unit + 0.5 * along)  # v_θ = polar F sin θ
    # rates of strain and stresses, times r
    stretch, hoop = along @ radial, radial + polar
    shear = 0.5 * (along @ polar - polar - radial)
    viscous = [
        2.0 * viscosity * part for part in (*_without_trace(stretch, hoop), shear)
    ]  # normal, around, shearing; by F
    # the stress of uneven temperature by φ, with T' and T'' of the gas at rest, times r²
    steep = along @ temperature
    bent = along @ steep - steep
    cubed = temperature ** (2.0 * exponent)
    less = exponent / temperature
    normal = along @ along - along + np.diag(2.0 * less * steep) @ along
    normal += np.diag(less * (2.0 * bent + (2.0 * exponent - 1.0) * steep**2 / temperature))
    around = along - unit + np.diag(2.0 * less * steep)
    shearing = unit - along - np.diag(less * steep)
    uneven = [
        -2.0 * thermal * (x * cubed)[:, None] * part
        for part in (*_without_trace(normal, around), shearing)
    ]
    # momentum along r and θ, times r²; the pressure is P cos θ/r; and energy
    forces = [
        (along @ one + one - 2.0 * two + 2.0 * three, along @ three + 2.0 * three - two)
        for one, two, three in (viscous, uneven)
    ]
    heat = (along @ along + along - 2.0 * unit) @ np.diag(temperature**exponent)
    system = np.block(
        [
            [forces[0][0], unit - along, forces[1][0]],
            [forces[0][1], unit, forces[1][1]],
            [np.diag(slope @ temperature), zero, heat],
        ]
    )
    right = np.zeros(3 * n)
    system[[0, n - 1, n, 2 * n]] = 0.0
    system[0, 0] = 1.0  # no flow into the sphere
    system[n, :n] = along[0]  # nor along it
    system[n - 1, n - 1] = right[n - 1] = 1.0  # uniform flow far away
    system[2 * n, 2 * n] = 1.0  # the wall keeps its temperature
    flow, pressure, warmer = np.split(np.linalg.lstsq(system, right, rcond=None)[0], 3)
    push, _, drawn = (
        (one @ flow + other @ warmer)[where] for one, other in zip(viscous, uneven, strict=True)
    )
    pull = 2.0 / 3.0 * (push - pressure[where])
    force = 2.0 * np.pi / x[where] * (pull - 4.0 / 3.0 * drawn)
    return float(force / (6.0 * np.pi))


def _without_trace(normal: np.ndarray, around: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts along r, and along θ and φ, of a tensor without its trace."""
    third = (normal + 2.0 * around) / 3.0
    return normal - third, around - third


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
