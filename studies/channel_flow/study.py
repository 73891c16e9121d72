"""Flow through long slots and tubes by the linearised Shakhov equation.

    python studies/channel_flow/study.py

Writes src/lightflyer/data/channels.csv.

The equation is integrated along straight paths, exactly for a given source, and leaves two integral
equations for the velocity u and the heat flow q across the channel:

    u = sum over molecules of c_z h,    q = sum of c_z (c² - 5/2) h

with the source 2 c_z u + (4/15) c_z (c² - 5/2) q of collisions and -c_z (pressure gradient) or
-c_z (c² - 5/2) (temperature gradient). Lengths are in the slot's width or the tube's radius, speeds
in √(2RT).
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
TABLE = HERE.parents[1] / "src" / "lightflyer" / "data" / "channels.csv"

RAREFACTIONS = (
    1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0,
    3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0,
)  # fmt: skip
DENSE = 2.0  # rarefaction from which meshes are finer

HEADER = """\
# Flow through long channels with diffuse walls by the linearised Shakhov equation; made by
# studies/channel_flow.
# rarefaction: p A/(mu sqrt(2 R T)), A the width of a slot or the radius of a round hole;
# flux = (p/sqrt(2RT)) (A/L) (-poiseuille dp/p + creep dT/T)
rarefaction,slot_poiseuille,slot_creep,round_poiseuille,round_creep
"""


def speeds(number=160):
    """Nodes and weights for speeds across the channel, dense at zero where paths are long."""
    place = np.linspace(-4.2, 3.2, number)
    speed = np.exp(place - np.exp(-place))
    weight = speed * (1.0 + np.exp(-place)) * (place[1] - place[0])
    kept = speed < 12.0
    return speed[kept], weight[kept]


def solved(operators, identity, rarefaction, moments):
    """Velocity and heat flow for both gradients.

    ``operators`` integrate along paths with the weights 1, c² and c⁴ of the speed across;
    ``moments`` are what the directions along the channel add.
    """
    zero, second, fourth = operators
    shift, linear, constant = moments
    velocity, mixed = zero, second - shift * zero
    heat = fourth - linear * second + constant * zero
    collisions = rarefaction * np.block(
        [[velocity, 2.0 / 15.0 * mixed], [mixed, 2.0 / 15.0 * heat]]
    )
    ones = np.ones(len(identity))
    sources = 0.5 * np.stack(
        [
            np.concatenate([velocity @ ones, mixed @ ones]),
            np.concatenate([mixed @ ones, heat @ ones]),
        ],
        axis=1,
    )
    whole = np.kron(np.eye(2), identity)
    return np.linalg.solve(whole - collisions, -sources)


def flows(solution, weights):
    """Poiseuille and creep coefficients, and the heat flow that Onsager says equals the creep."""
    size = len(weights)
    return (
        -weights @ solution[:size, 0],
        weights @ solution[:size, 1],
        weights @ solution[size:, 0],
    )


def slot(rarefaction, cells):
    """Coefficients of a slot, sources constant within cells that are narrow at the walls."""
    edges = -0.5 * np.cos(np.pi * np.arange(cells + 1) / cells)
    width = np.diff(edges)
    between = np.tril(edges[:-1][:, None] - edges[1:][None, :], -1)
    below = np.tril(np.ones((cells, cells), bool), -1)
    operators = np.zeros((3, cells, cells))
    for speed, weight in zip(*speeds(), strict=True):
        share = np.exp(-(speed**2)) * weight / np.sqrt(np.pi)
        if share < 1e-30:
            continue
        rate = rarefaction / speed
        absorbed = -np.expm1(-rate * width)
        matrix = np.where(below, np.exp(-rate * between), 0.0) * np.outer(absorbed, absorbed)
        matrix = (matrix + matrix.T) / (speed * rate**2)
        optical = rate * width
        series = width**2 * (0.5 - optical / 6.0 + optical**2 / 24.0)
        within = np.where(optical < 1e-4, series, (optical - absorbed) / rate**2) / speed
        matrix[np.diag_indices(cells)] += 2.0 * within
        operators += share * speed ** np.array([0, 2, 4])[:, None, None] * matrix
    solution = solved(operators, np.diag(width), rarefaction, (0.5, 1.0, 2.25))
    return flows(solution, 2.0 * width)


def slot_extrapolated(rarefaction):
    """Two meshes, of second order."""
    cells = 500 if rarefaction > DENSE else 200
    fine, coarse = (np.array(slot(rarefaction, number)) for number in (cells, cells // 2))
    return (4.0 * fine - coarse) / 3.0


def interpolation(nodes, points):
    """Matrix of barycentric interpolation from Chebyshev nodes."""
    order = np.arange(len(nodes))
    weight = (-1.0) ** order * np.sin((order + 0.5) * np.pi / len(nodes))
    parts = weight / (points[..., None] - nodes)
    return parts / parts.sum(-1, keepdims=True)


def tube(rarefaction, nodes, directions, steps):
    """Coefficients of a tube, u and q as polynomials of the squared radius."""
    angle = (np.arange(nodes) + 0.5) * np.pi / nodes
    squared = 0.5 * (1.0 - np.cos(angle))
    order = np.arange(1, nodes // 2 + 1)
    fejer = (
        1.0 - 2.0 * (np.cos(2.0 * np.outer(angle, order)) / (4.0 * order**2 - 1.0)).sum(1)
    ) / nodes
    place, share = np.polynomial.legendre.leggauss(directions)
    direction, of_direction = 0.5 * np.pi * (place + 1.0), 0.5 * np.pi * share
    place, share = np.polynomial.legendre.leggauss(steps)
    stretch = np.log(1.0 + 60.0 * max(rarefaction, 0.5))  # steps short at the start of a path
    along = (0.5 * (place + 1.0)) ** 2
    step = np.expm1(stretch * along) / np.expm1(stretch)
    of_step = 0.5 * share * (place + 1.0) * stretch * np.exp(stretch * along) / np.expm1(stretch)
    speed, weight = speeds()
    operators = np.zeros((3, nodes, nodes))
    for row, radius in enumerate(np.sqrt(squared)):
        chord = radius * np.cos(direction) + np.sqrt(1.0 - (radius * np.sin(direction)) ** 2)
        path = chord[:, None] * step
        there = radius**2 + path**2 - 2.0 * radius * path * np.cos(direction)[:, None]
        values = interpolation(squared, there)
        left = np.exp(-rarefaction * path[..., None] / speed - speed**2) * weight
        area = (2.0 / np.pi) * chord[:, None] * of_step * of_direction[:, None]
        for power in range(3):
            kernel = (left * speed ** (2 * power)).sum(-1)
            operators[power, row] = np.einsum("ab,abj->j", area * kernel, values)
    solution = solved(operators, np.eye(nodes), rarefaction, (1.0, 2.0, 2.5))
    return flows(solution, 2.0 * fejer)


def tube_converged(rarefaction):
    """On a mesh for the rarefaction."""
    if rarefaction < 2.5 * DENSE:
        return tube(rarefaction, 36, 90, 80)
    return tube(rarefaction, 64, 130, 110)


def main():
    """Write the table."""
    rows, onsager = [], 0.0
    for rarefaction in RAREFACTIONS:
        found = [*slot_extrapolated(rarefaction), *tube_converged(rarefaction)]
        onsager = max(onsager, abs(found[1] / found[2] - 1.0), abs(found[4] / found[5] - 1.0))
        numbers = (found[0], found[1], found[3], found[4])
        rows.append(",".join([f"{rarefaction:g}", *(f"{value:.6g}" for value in numbers)]))
    TABLE.write_text(HEADER + "\n".join(rows) + "\n", encoding="utf-8")
    print(f"creep and the heat flow by pressure differ by {onsager:.1g} at most")


if __name__ == "__main__":
    main()
