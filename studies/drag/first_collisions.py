r"""What the first collisions take from the drag of a thin disk in very thin gas.

To first order in the rarefaction, the linear kinetic equation gives :math:`G = G_0 + G_1\delta`. By
reversing the molecules of the free flow :math:`h_0` around the disk,

.. math::
    \pi\,G_1 = \int\left(\varrho^2 - 2u^2 + \tfrac32\tau^2 - \tfrac4{15}q^2\right)d^3x

with the density, velocity, temperature and heat flux of :math:`h_0`, which are integrals over the
directions in which the disk is seen. The last term is Shakhov's; BGK lacks it. Walls are diffuse.

Run as ``python studies/drag/first_collisions.py``.
"""

import argparse
import math

import numpy as np

_SPEEDS = [0.5 * math.gamma(0.5 * (n + 1)) for n in range(10)]  # ∫ cⁿ exp(−c²) dc


def gauss(number: int, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss's quadrature between two ends."""
    nodes, weights = np.polynomial.legendre.leggauss(number)
    return 0.5 * (high - low) * nodes + 0.5 * (high + low), 0.5 * (high - low) * weights


def seen_disk(radius: float, height: float, number: int = 24) -> tuple[np.ndarray, ...]:
    """Directions in which a point sees the disk.

    Returns
    -------
    weight, sine, cosine, half_angle : array, shape (n,)
        For each angle to the axis, and half of the azimuths about the axis that meet the disk.
    """
    corners = {0.0, math.atan(abs(1.0 - radius) / height), math.atan((1.0 + radius) / height)}
    parts = []
    for low, high in zip(sorted(corners)[:-1], sorted(corners)[1:], strict=True):
        # the half angle starts as a root at the corners
        along, weight = gauss(number, 0.0, 0.5 * np.pi)
        angle = low + (high - low) * np.sin(along) ** 2
        weight = weight * (high - low) * np.sin(2.0 * along)
        shift = height * np.tan(angle)
        cosine = (radius**2 + shift**2 - 1.0) / np.maximum(2.0 * radius * shift, 1e-300)
        half = np.arccos(np.clip(cosine, -1.0, 1.0))
        parts.append((weight * np.sin(angle), np.sin(angle), np.cos(angle), half))
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))


def broadside(radius: float, height: float, shakhov: bool) -> float:
    """Integrand of the disk that moves along its axis, averaged over azimuth."""
    weight, sine, cosine, half = seen_disk(radius, height)

    def moment(power: int, shape: np.ndarray) -> float:  # of cᵖ with 2 c_z + √π
        speeds = 2.0 * cosine * _SPEEDS[power + 3] + math.sqrt(np.pi) * _SPEEDS[power + 2]
        return float(np.sum(weight * shape * speeds)) * np.pi**-1.5

    around, outward = 2.0 * half, 2.0 * np.sin(half) * sine
    density = moment(0, around)
    velocity = moment(1, outward) ** 2 + moment(1, around * cosine) ** 2
    temperature = (moment(2, around) - 1.5 * density) * 2.0 / 3.0
    flux = [moment(3, shape) - 2.5 * moment(1, shape) for shape in (outward, around * cosine)]
    heat = 4.0 / 15.0 * (flux[0] ** 2 + flux[1] ** 2) if shakhov else 0.0
    return density**2 - 2.0 * velocity + 1.5 * temperature**2 - heat


def edgewise(radius: float, height: float, shakhov: bool) -> float:
    """The same of the disk that moves in its plane; its flow carries no heat, in either model."""
    del shakhov
    weight, sine, cosine, half = seen_disk(radius, height)

    def moment(power: int, shape: np.ndarray) -> float:  # of cᵖ with 2 c_x
        return float(np.sum(weight * shape * sine)) * 2.0 * _SPEEDS[power + 3] * np.pi**-1.5

    once, both = 2.0 * np.sin(half), 0.5 * np.sin(2.0 * half)
    density = moment(0, once)
    velocity = (
        moment(1, sine * (half + both)) ** 2
        + moment(1, once * cosine) ** 2
        + moment(1, sine * (half - both)) ** 2
    )
    temperature = (moment(2, once) - 1.5 * density) * 2.0 / 3.0
    return 0.5 * (density**2 - 2.0 * velocity + 1.5 * temperature**2)


def first_order(integrand, *, shakhov: bool = True, number: int = 10) -> float:
    """:math:`G_1` of :func:`broadside` or :func:`edgewise`."""
    total = 0.0
    for low, high in ((0.0, 0.5), (0.5, 1.0)):
        for nearness, weight in zip(*gauss(number, low, high), strict=True):
            # oblate spheroidal coordinates, ξ = nearness/(1 − nearness) and η = root²
            xi, stretch = nearness / (1.0 - nearness), 1.0 / (1.0 - nearness) ** 2
            for root, other in zip(*gauss(number, 0.0, 1.0), strict=True):
                eta = root**2
                radius = math.sqrt((1.0 + xi**2) * (1.0 - eta**2))
                volume = weight * stretch * other * 2.0 * root * (xi**2 + eta**2)
                total += volume * integrand(radius, xi * eta, shakhov)
    return 4.0 * total  # 2π around, twice for both sides, over π


def main() -> None:
    """Print the coefficients."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print(f"broadside, BGK      {first_order(broadside, shakhov=False):.5f}")
    print(f"broadside, Shakhov  {first_order(broadside):.5f}")
    print(f"edgewise            {first_order(edgewise):.5f}")


if __name__ == "__main__":
    main()
