"""Heat from a sphere to a rarefied gas: the linearised Shakhov equation along straight rays.

    python studies/balloon/sphere_conduction.py

Prints, for each rarefaction δ = pa/(μ√(2RT)), the heat loss over that to free molecules, what
`lightflyer.force.convection` makes of it, and what the two limits in series would be. It takes
three minutes.

Every ray has an impact parameter and a speed. Along it the perturbation relaxes towards a
local state that depends on density, temperature and heat flux, which are moments of the
perturbation in turn: a linear system, solved by GMRES. Incoming molecules far away are those of
Fourier's law around a sphere.
"""

import itertools
import json
from pathlib import Path

import numba
import numpy as np
from scipy.optimize import brentq
from scipy.sparse.linalg import LinearOperator, gmres

from lightflyer.force.convection import joined_conductance

HERE = Path(__file__).parent
RAREFACTIONS = (0.03, 0.1, 0.3, 1.0, 2.0, 3.0)
FOURIER = 15.0 / 8.0  # heat flux of a sphere in dense gas, times δ, in units p√(2RT) ΔT/T
FREE = 1.0 / np.sqrt(np.pi)  # the same to free molecules
RELAXED, CHAPMAN_ENSKOG = 4.0 / 15.0, 0.8  # Shakhov's heat-flux term at Pr = 2/3; Fourier's law
HIGHEST_SPEED = 5.0  # in √(2RT)


@numba.njit
def advance(perturbation, before, here, depth):
    """Along a step of this optical depth, with a source that is linear between its ends."""
    if depth < 1e-6:
        return perturbation * (1.0 - depth) + 0.5 * depth * (before + here)
    kept = np.exp(-depth)
    mean = (1.0 - kept) / depth
    return perturbation * kept + before * (mean - kept) + here * (1.0 - mean)


@numba.njit
def sweep(radii, impacts, speeds, delta, density, temperature, heat, wall, far, inward, outward):
    """Perturbation at every node, ray and speed, inward and outward bound."""
    last = radii.size - 1
    for ray in range(impacts.size):
        impact = impacts[ray]
        lowest = 0
        while radii[lowest] < impact - 1e-12:
            lowest += 1
        for number in range(speeds.size):
            speed = speeds[number]
            energy = speed * speed
            shape = RELAXED * speed * (energy - 2.5) * heat
            along = -np.sqrt(max(radii[last] ** 2 - impact**2, 0.0))
            f = far * (energy - 2.5)
            f += CHAPMAN_ENSKOG / RELAXED * shape * along / radii[last] ** 3
            inward[last, ray, number] = f
            before = density[last] + temperature[last] * (energy - 1.5)
            before += shape * along / radii[last] ** 3
            for node in range(last - 1, lowest - 1, -1):
                place = -np.sqrt(max(radii[node] ** 2 - impact**2, 0.0))
                here = density[node] + temperature[node] * (energy - 1.5)
                here += shape * place / radii[node] ** 3
                f = advance(f, before, here, delta * (place - along) / speed)
                inward[node, ray, number] = f
                before, along = here, place
            if impact < 1.0:
                f = wall[0] + wall[1] * (energy - 2.0)  # diffuse emission of the hot sphere
                along = np.sqrt(1.0 - impact**2)
                before = density[0] + temperature[0] * (energy - 1.5) + shape * along
            outward[lowest, ray, number] = f
            for node in range(lowest + 1, last + 1):
                place = np.sqrt(max(radii[node] ** 2 - impact**2, 0.0))
                here = density[node] + temperature[node] * (energy - 1.5)
                here += shape * place / radii[node] ** 3
                f = advance(f, before, here, delta * (place - along) / speed)
                outward[node, ray, number] = f
                before, along = here, place


def mesh(delta, count):
    """Radii from the wall outward in equal ratios of their steps."""
    first = min(4.0, 10.0 / delta) / count
    outermost = 1.0 + max(12.0 / delta, 6.0)

    def excess(ratio):
        return first * (ratio ** (count - 1) - 1.0) / (ratio - 1.0) - (outermost - 1.0)

    ratio = brentq(excess, 1.0 + 1e-9, 3.0)
    radii = 1.0 + first * (ratio ** np.arange(count) - 1.0) / (ratio - 1.0)
    radii[-1] = outermost
    return radii


def angles(radii, impacts, hits):
    """Weights of rays at each node for integrals over the cosine, and over cosine times it."""
    weights = np.zeros((4, radii.size, impacts.size))

    def add(cosines, rays, plain, first, node):
        for one, other in itertools.pairwise(rays):
            a, b = cosines[one], cosines[other]
            width = abs(a - b)
            plain[node, [one, other]] += 0.5 * width
            first[node, one] += width * (2.0 * a + b) / 6.0
            first[node, other] += width * (2.0 * b + a) / 6.0

    for node, radius in enumerate(radii):
        cosines = np.sqrt(np.maximum(1.0 - (impacts / radius) ** 2, 0.0))
        seen = np.flatnonzero(impacts <= radius + 1e-12)
        if node == 0:
            seen, cosines[hits] = seen[seen <= hits], 0.0
        add(cosines, seen, weights[0], weights[1], node)
        # outward the perturbation jumps at the edge of the sphere
        add(cosines, seen[seen <= hits], weights[2], weights[3], node)
        if node > 0:
            add(cosines, seen[seen > hits], weights[2], weights[3], node)
    return weights


def heat_ratio(delta, nodes=400, hits=140, speeds=24):
    """Heat loss of a sphere over that to free molecules, at complete accommodation."""
    radii = mesh(delta, nodes)
    inside = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, hits + 1)[:-1])
    impacts = np.concatenate([inside, [1.0 - 1e-9, 1.0 + 1e-9], radii[1:]])
    points, weights = np.polynomial.legendre.leggauss(speeds)
    share = 0.5 * (points + 1.0)
    c = HIGHEST_SPEED * share**1.5  # more of the slow ones
    density_of = np.sqrt(share) * c**2 * np.exp(-(c**2)) * weights
    density_of /= density_of.sum()
    energy = c**2
    inward = np.zeros((nodes, impacts.size, speeds))
    outward = np.zeros_like(inward)
    angle = angles(radii, impacts, hits)

    def moments(state, hot):
        density, temperature, (heat, emitted) = np.split(state, [nodes, 2 * nodes])
        inward[:] = outward[:] = 0.0
        far = delta * heat / (FOURIER * radii[-1])
        wall = np.array([emitted, hot])
        sweep(
            radii, impacts, c, delta, density, temperature, heat, wall, far, inward, outward
        )  # fmt: skip
        mean = 0.5 * (
            np.einsum("ikm,ik->im", inward, angle[0]) + np.einsum("ikm,ik->im", outward, angle[2])
        )
        arriving = 0.5 * np.einsum("km,k->m", inward[0], angle[1, 0])
        leaving = 0.5 * np.einsum("km,k->m", outward[0], angle[3, 0])
        flux = (leaving - arriving) @ (density_of * c * (energy - 2.5))
        rate = 0.5 * angle[3, 0].sum() * density_of * c
        balanced = (arriving @ (density_of * c) - hot * rate @ (energy - 2.0)) / rate.sum()
        hotter = mean @ (density_of * (energy - 1.5)) * 2.0 / 3.0
        return np.concatenate([mean @ density_of, hotter, [flux, balanced]])

    size = 2 * nodes + 2
    operator = LinearOperator((size, size), matvec=lambda state: state - moments(state, 0.0))
    found, _ = gmres(operator, moments(np.zeros(size), 1.0), rtol=1e-8, restart=80, maxiter=6)
    return float(found[2 * nodes] / FREE)


def main():
    """Print the table and write it."""
    table = {}
    print("rarefaction  solved  convection.py  limits in series")
    for delta in RAREFACTIONS:
        dense = FOURIER / delta / FREE
        row = {
            "solved": heat_ratio(delta),
            "convection": float(joined_conductance(1.0, dense, 1.0)),
            "series": dense / (1.0 + dense),
        }
        table[str(delta)] = row
        print(f"{delta:11g}" + "".join(f"  {value:.5f}" for value in row.values()), flush=True)
    text = json.dumps(table, indent=2) + "\n"
    (HERE / "sphere_conduction.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
