"""Force on an unevenly warm sphere in a rarefied gas: the linearised Shakhov equation along rays.

    python studies/sphere_force/study.py

The surface of a sphere at complete accommodation is as warm as T (1 + τ cos ϑ), τ ≪ 1, in gas of
the temperature T. Writes, for each rarefaction δ = pa/(μ√(2RT)), the force and the heat loss over
those to free molecules, and what the laws of `lightflyer.force.spheres` make of them.

Along a straight ray with the direction e and the direction n from the centre to its nearest point
the perturbation is z·(e H + n G), with the axis z; both H and G relax towards a local state whose
density, temperature, velocity and heat flux are moments of the perturbation in turn: a linear
system, solved by GMRES. Incoming molecules far away are those of a point force and a warm dipole.
"""

import itertools
import json
import sys
from pathlib import Path

import numba
import numpy as np
from scipy.optimize import brentq
from scipy.sparse.linalg import LinearOperator, gmres

HERE = Path(__file__).parent
RAREFACTIONS = (0.03, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0, 5.0, 8.0)
DENSE = 6.0  # rarefaction from which on a finer mesh is needed, and a nearer edge will do
FOURIER = 15.0 / 8.0  # heat flux of a temperature gradient, times δ, in units p√(2RT)
FREE_HEAT, FREE_FORCE = 1.0 / np.sqrt(np.pi), -np.pi / 3.0  # to free molecules, per τ
RELAXED, CHAPMAN_ENSKOG = 4.0 / 15.0, 0.8  # Shakhov's heat-flux term at Pr = 2/3; Fourier's law
HIGHEST_SPEED = 5.0  # in √(2RT)


@numba.njit
def source(fields, node, cosine, sine, speed, energy):
    """Parts along the ray and across of the local state; ``fields`` (6, nodes)."""
    scalar = fields[0, node] + fields[1, node] * (energy - 1.5)
    relaxed = RELAXED * speed * (energy - 2.5)
    radial = 2.0 * speed * fields[2, node] + relaxed * fields[4, node]
    tangential = 2.0 * speed * fields[3, node] + relaxed * fields[5, node]
    along = scalar * cosine + radial * cosine**2 + tangential * sine**2
    return along, scalar * sine + (radial - tangential) * cosine * sine


@numba.njit
def advance(perturbation, before, here, depth):
    """Along a step of this optical depth, with a source that is linear between its ends."""
    if depth < 1e-6:
        return perturbation * (1.0 - depth) + 0.5 * depth * (before + here)
    kept = np.exp(-depth)
    mean = (1.0 - kept) / depth
    return perturbation * kept + before * (mean - kept) + here * (1.0 - mean)


@numba.njit(parallel=False)
def sweep(radii, impacts, speeds, delta, fields, wall, push, inward, outward):
    """Both parts of the perturbation at every node, ray and speed, inward and outward bound."""
    last = radii.size - 1
    edge = radii[last]
    for ray in range(impacts.size):
        impact = impacts[ray]
        lowest = 0
        while radii[lowest] < impact - 1e-12:
            lowest += 1
        for number in range(speeds.size):
            speed = speeds[number]
            energy = speed * speed
            # far away: a point force, and a dipole of heat
            sine = impact / edge
            cosine = -np.sqrt(max(1.0 - sine**2, 0.0))
            warm = fields[1, last]
            scalar = push / (4.0 * np.pi * edge**2) + warm * (energy - 2.5)
            scalar -= 2.0 * energy * push / (8.0 * np.pi * edge**2) * (1.0 - 3.0 * cosine**2)
            flow = 2.0 * speed * push * delta / (8.0 * np.pi * edge)
            heat = CHAPMAN_ENSKOG * speed * (energy - 2.5) * FOURIER / delta * warm / edge
            radial, tangential = 2.0 * flow + 2.0 * heat, flow - heat
            h = scalar * cosine + radial * cosine**2 + tangential * sine**2
            g = scalar * sine + (radial - tangential) * cosine * sine
            inward[0, last, ray, number], inward[1, last, ray, number] = h, g
            along = cosine * edge
            before = source(fields, last, cosine, sine, speed, energy)
            for node in range(last - 1, lowest - 1, -1):
                sine = min(impact / radii[node], 1.0)
                cosine = -np.sqrt(1.0 - sine**2)
                place = cosine * radii[node]
                here = source(fields, node, cosine, sine, speed, energy)
                depth = delta * (place - along) / speed
                h = advance(h, before[0], here[0], depth)
                g = advance(g, before[1], here[1], depth)
                inward[0, node, ray, number], inward[1, node, ray, number] = h, g
                before, along = here, place
            if impact < 1.0:
                cosine, sine = np.sqrt(1.0 - impact**2), impact
                emitted = wall[0] + wall[1] * (energy - 2.0)  # diffuse emission
                h, g, along = emitted * cosine, emitted * sine, cosine
                before = source(fields, 0, cosine, sine, speed, energy)
            outward[0, lowest, ray, number], outward[1, lowest, ray, number] = h, g
            for node in range(lowest + 1, last + 1):
                sine = min(impact / radii[node], 1.0)
                cosine = np.sqrt(1.0 - sine**2)
                place = cosine * radii[node]
                here = source(fields, node, cosine, sine, speed, energy)
                depth = delta * (place - along) / speed
                h = advance(h, before[0], here[0], depth)
                g = advance(g, before[1], here[1], depth)
                outward[0, node, ray, number], outward[1, node, ray, number] = h, g
                before, along = here, place


def mesh(delta, count, reach):
    """Radii from the wall outward in equal ratios of their steps."""
    first = min(4.0, 10.0 / delta) / count
    outermost = 1.0 + max(reach / delta, 0.5 * reach)

    def excess(ratio):
        return first * (ratio ** (count - 1) - 1.0) / (ratio - 1.0) - (outermost - 1.0)

    ratio = brentq(excess, 1.0 + 1e-9, 3.0)
    radii = 1.0 + first * (ratio ** np.arange(count) - 1.0) / (ratio - 1.0)
    radii[-1] = outermost
    return radii


def angles(radii, impacts, hits):
    """Weights, sines and cosines of rays at each node, inward and outward bound, (2, nodes, rays).

    The weights are those of a mean over all directions.
    """
    weights, cosines = np.zeros((2, radii.size, impacts.size)), np.zeros((radii.size, impacts.size))

    def add(rays, plain, node):
        for one, other in itertools.pairwise(rays):
            plain[node, [one, other]] += 0.25 * abs(cosines[node, one] - cosines[node, other])

    for node, radius in enumerate(radii):
        cosines[node] = np.sqrt(np.maximum(1.0 - (impacts / radius) ** 2, 0.0))
        seen = np.flatnonzero(impacts <= radius + 1e-12)
        if node == 0:
            seen, cosines[node, hits] = seen[seen <= hits], 0.0
        add(seen, weights[0], node)
        # outward the perturbation jumps at the edge of the sphere
        add(seen[seen <= hits], weights[1], node)
        if node > 0:
            add(seen[seen > hits], weights[1], node)
    sines = np.sqrt(1.0 - cosines**2)
    return weights, sines, np.stack([-cosines, cosines])


def ratios(delta, nodes=160, hits=60, speeds=20, reach=20.0):
    """Force and heat loss of the first harmonic over those to free molecules."""
    radii = mesh(delta, nodes, reach)
    inside = np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, hits + 1)[:-1])
    impacts = np.concatenate([inside, [1.0 - 1e-9, 1.0 + 1e-9], radii[1:]])
    points, weights = np.polynomial.legendre.leggauss(speeds)
    share = 0.5 * (points + 1.0)
    c = HIGHEST_SPEED * share**1.5  # more of the slow ones
    density_of = np.sqrt(share) * c**2 * np.exp(-(c**2)) * weights
    density_of /= density_of.sum()
    energy = c**2
    bound = np.zeros((2, 2, nodes, impacts.size, speeds))  # inward and outward, both parts
    weight, sine, cosine = angles(radii, impacts, hits)
    found = {}

    def moments(state, hot):
        fields, (emitted, push) = state[:-2].reshape(6, nodes), state[-2:]
        bound[:] = 0.0
        sweep(radii, impacts, c, delta, fields, np.array([emitted, hot]), push, *bound)
        new, wall = np.zeros((6, nodes)), np.zeros(4)
        leaving = 0.0
        for way in (0, 1):
            h, g = bound[way]
            mu, nu, w = cosine[way], sine, weight[way]
            # of cos ϑ, and of sin ϑ cos ψ
            first = mu[..., None] * h + nu[..., None] * g
            second = nu[..., None] * h - mu[..., None] * g
            plain = np.einsum("ikm,ik->im", first, w)
            radial = np.einsum("ikm,ik->im", first, w * mu)
            tangential = 0.5 * np.einsum("ikm,ik->im", second, w * nu)
            new[0] += plain @ density_of
            new[1] += plain @ (density_of * (energy - 1.5)) * 2.0 / 3.0
            for place, part in ((2, radial), (3, tangential)):
                new[place] += part @ (density_of * c)
                new[place + 2] += part @ (density_of * c * (energy - 2.5))
            stress = np.einsum("km,k->m", first[0], w[0] * mu[0] ** 2)
            stress += np.einsum("km,k->m", second[0], w[0] * mu[0] * nu[0])
            wall[0] += stress @ (density_of * energy) * -8.0 * np.pi / 3.0
            if way == 0:
                leaving = -radial[0] @ (density_of * c)
        rate = np.sum(weight[1, 0] * cosine[1, 0])
        flow = density_of * c * rate
        balanced = (leaving - hot * flow @ (energy - 2.0)) / flow.sum()
        found["force"], found["heat"] = wall[0], new[4, 0]
        return np.concatenate([new.ravel(), [balanced, -wall[0]]])

    size = 6 * nodes + 2
    operator = LinearOperator((size, size), matvec=lambda state: state - moments(state, 0.0))
    start = moments(np.zeros(size), 1.0)
    state, _ = gmres(operator, start, rtol=1e-7, restart=120, maxiter=5)
    moments(state, 1.0)
    return found["force"] / FREE_FORCE, found["heat"] / FREE_HEAT


def main():
    """Print the table and write it."""
    table = {}
    for delta in map(float, sys.argv[1:]) if sys.argv[1:] else RAREFACTIONS:
        counts, reach = ((160, 60), (320, 120)), 20.0
        if delta > DENSE:
            counts, reach = ((320, 120), (480, 180)), 8.0
        coarse, fine = (np.array(ratios(delta, *count, reach=reach)) for count in counts)
        step = counts[1][0] / counts[0][0]
        force, heat = fine + (fine - coarse) / (step**2 - 1.0)  # an error of the second order
        table[str(delta)] = {"force": force, "heat": heat}
        print(f"{delta:11g}  {force:.5f}  {heat:.5f}", flush=True)
    if not sys.argv[1:]:
        text = json.dumps(table, indent=2) + "\n"
        (HERE / "results.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
