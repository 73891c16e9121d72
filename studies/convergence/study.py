"""Do all heat balances and levitations of random disks converge? Ten million of each.

    python studies/convergence/study.py [--designs 10000000]

Writes results.csv. Pressures are 1e-4 to 1e5 Pa and radii 0.1 mm to 10 m; a fifth of the disks have
no light, half a sky that is colder than the gas, so that flyers colder than the gas are among them.
A search has converged where the package says so: within 1e-12 of the absorbed power or after a step
below 1e-6, and within 1e-10 by the balance at the end.
"""

import argparse
import csv
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation

RESULT = Path(__file__).with_name("results.csv")
BATCH = 500_000
STANDARD_GRAVITY = 9.80665  # m/s²
MODELS = {
    "kinetic": (lf.Kinetic(), lf.gas.AIR),
    "lu2023": (lf.Lu2023(), lf.gas.LU2023_AIR),
}


def random_designs(rng, count, gas):
    """Disks and where they are."""

    def spread(lowest, highest):
        return np.exp(rng.uniform(np.log(lowest), np.log(highest), count))

    def chosen(share, one, other):
        return np.where(rng.uniform(size=count) < share, one, other)

    film = lf.FilmProperties(
        areal_density=spread(1e-5, 1.0),
        absorptance=rng.uniform(0.0, 1.0, count),
        emittance_top=spread(0.01, 1.0),
        emittance_bottom=spread(0.01, 1.0),
        tac_top=rng.uniform(0.05, 1.0, count),
        tac_bottom=rng.uniform(0.05, 1.0, count),
    )
    cold = rng.uniform(100.0, 320.0, count)
    black = 5.670374e-8 * cold**4  # of surroundings at the gas temperature [W/m²]
    radiation = Radiation(
        chosen(0.2, 0.0, spread(1.0, 2e4)),
        infrared_above=chosen(0.5, black, rng.uniform(0.0, 300.0, count)),
        infrared_below=chosen(0.5, black, rng.uniform(0.0, 500.0, count)),
    )
    state = EnvironmentState(spread(1e-4, 1e5), cold, STANDARD_GRAVITY, gas, radiation)
    return lf.Disk(film, radius=spread(1e-4, 10.0)), state


def row(model, question, results, told):
    """What is written of all results of a model."""
    residual = np.concatenate([np.abs(result.residual) for result in results])
    failed = sum(int(np.count_nonzero(~result.converged)) for result in results)
    return {
        "model": model,
        "question": question,
        "designs": residual.size,
        "not_converged": failed,
        "median_residual": f"{np.median(residual):.1e}",
        "largest_residual": f"{residual.max():.1e}",
        "among_them": told,
    }


def of_model(name, model, gas, count):
    """Rows of a model."""
    rng = np.random.default_rng(7)
    balances, flights, colder, lifted = [], [], 0, 0
    for _ in range(count // BATCH):
        disk, state = random_designs(rng, BATCH, gas)
        balances.append(lf.equilibrium(disk, state, model, throw=False))
        flights.append(lf.levitate(disk, state, model, throw=False))
        colder += int(np.count_nonzero(balances[-1].excess < 0.0))
        lifted += int(np.count_nonzero(flights[-1].levitates))
        # what is written; the rest would fill the memory
        balances[-1], flights[-1] = map(_Kept, (balances[-1], flights[-1]))
    yield row(name, "heat balance", balances, f"{colder} colder than the gas")
    yield row(name, "levitation", flights, f"{lifted} that levitate")


class _Kept:
    def __init__(self, result):
        self.residual, self.converged = result.residual, result.converged


def main():
    """Compute and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=10_000_000)
    options = parser.parse_args()
    rows = [
        found for name, pair in MODELS.items() for found in of_model(name, *pair, options.designs)
    ]
    for found in rows:
        print(found)
    with RESULT.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
