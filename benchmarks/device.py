"""Heat balances and payload optima per second on a kind of device.

    python benchmarks/device.py [--device gpu] [--designs 1048576] [--repeats 5]

Designs are made on the device and results stay there: neither memory of the host nor a disk limits.
All devices of the kind share them. Rows of device.csv for the same device
are replaced, others kept; docs/benchmarks.md shows that file. On a device other than the processor
a sample is compared with the processor's results.
"""

import argparse
import csv
import os
import statistics
import time
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

import lightflyer as lf
from lightflyer.compute.evaluation import OnDevices, find_devices
from lightflyer.environment import EnvironmentState, Radiation

RESULT = Path(__file__).with_name("device.csv")
COLUMNS = ("device", "devices", "model", "task", "designs", "per_second", "largest_difference")
MODELS = {
    "kinetic": (lf.Kinetic(), lf.gas.AIR),
    "lu2023": (lf.Lu2023(), lf.gas.LU2023_AIR),
}
ALTITUDES = np.linspace(30e3, 84e3, 33)
STANDARD_GRAVITY = 9.80665  # m/s²
SAMPLE = 4096
BLOCK = 16_384  # designs at once on a processor: they fit its cache


def designs(number):
    """Disks of solver.py's ranges by a low-discrepancy sequence, from the design's number."""
    # fractional parts of multiples of powers of the generalised golden ratio
    ratio = 1.1673039782614187  # solves x⁶ = x + 1
    share = [jnp.modf(0.5 + number * ratio ** -(k + 1))[0] for k in range(5)]

    def spread(place, lowest, highest):
        return lowest * (highest / lowest) ** place

    return {
        "pressure": spread(share[0], 1e-3, 1e5),
        "cold": 100.0 + 220.0 * share[1],
        "irradiance": spread(share[2], 1.0, 2e4),
        "radius": spread(share[3], 1e-4, 10.0),
        "emittance": spread(share[4], 0.01, 1.0),
    }


def disk(values):
    film = lf.FilmProperties(1e-3, 0.75, values["emittance"], values["emittance"], 0.8, 0.9)
    return lf.Disk(film, values["radius"])


def balances(model, gas, number):
    values = designs(number)
    state = EnvironmentState(
        values["pressure"], values["cold"], STANDARD_GRAVITY, gas, Radiation(values["irradiance"])
    )
    return lf.equilibrium(disk(values), state, model, throw=False).temperature


def optima(model, gas, number):
    """Largest payload over altitude [kg]: the best of a grid, and at the vertex through three."""
    del gas  # that of the atmosphere
    earth = lf.Earth() if isinstance(model, lf.Kinetic) else lf.lu2023_earth()
    body = disk(designs(number))

    def payload(altitude):
        lift = lf.lift(body, earth.state(altitude), model, throw=False)
        return lift / STANDARD_GRAVITY - body.mass

    found = jax.lax.map(lambda altitude: payload(jnp.full(number.shape, altitude)), ALTITUDES)
    best = jnp.clip(jnp.argmax(found, axis=0), 1, len(ALTITUDES) - 2)
    below, there, above = (
        jnp.take_along_axis(found, best[None] + step, axis=0)[0] for step in (-1, 0, 1)
    )
    bend = below - 2.0 * there + above
    offset = jnp.where(bend < 0.0, 0.5 * (below - above) / jnp.where(bend < 0.0, bend, 1.0), 0.0)
    spacing = ALTITUDES[1] - ALTITUDES[0]
    vertex = jnp.asarray(ALTITUDES)[best] + spacing * jnp.clip(offset, -1.0, 1.0)
    return jnp.maximum(there, payload(vertex))


TASKS = {"heat balances": balances, "payload optima": optima}
SHARES = {"payload optima": 1 / 16}  # of the designs: each is looked at 34 times


def in_blocks(function, numbers):
    """The function block by block, as the caches of a processor want it."""
    found = jax.lax.map(function, numbers.reshape(-1, BLOCK))
    return jax.tree.map(lambda part: part.reshape(-1, *part.shape[2:]), found)


def measured(on, function, count, repeats):
    """Median time of a run [s] and its result, for designs that lie on the devices."""
    compiled = jax.jit(on.divide_work(function))
    numbers = on.place(np.arange(count, dtype=float))
    result = jax.block_until_ready(compiled(numbers))
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        jax.block_until_ready(compiled(numbers))
        times.append(time.perf_counter() - start)
    return statistics.median(times), result


def largest_difference(function, result, kind):
    """Relative, from the processor's results for the first designs; empty on the processor."""
    if kind == "cpu" or not isinstance(result, jax.Array):
        return ""
    with jax.default_device(jax.devices("cpu")[0]):
        same = jax.jit(function)(np.arange(SAMPLE, dtype=float))
    return f"{np.max(np.abs(np.asarray(result)[:SAMPLE] / np.asarray(same) - 1.0)):.1e}"


def record(rows):
    """Replace the rows of the same device in the file."""
    old = []
    if RESULT.exists():
        with RESULT.open(newline="") as lines:
            old = list(csv.DictReader(lines))
    names = {row["device"] for row in rows}
    with RESULT.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows([row for row in old if row["device"] not in names] + rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device", choices=["cpu", "gpu"], help="by default a GPU if there is one")
    parser.add_argument("--designs", type=int, default=2**20)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    kind = options.device or ("gpu" if jax.default_backend() == "gpu" else "cpu")
    on, first = OnDevices(kind), find_devices(kind)[0]
    name = first.device_kind if kind == "gpu" else f"{os.cpu_count()} processors"
    rows = []
    with lf.float64():
        for (label, pair), (task, function) in [
            (model, task) for model in MODELS.items() for task in TASKS.items()
        ]:
            share = BLOCK * on.count
            count = max(int(options.designs * SHARES.get(task, 1.0)) // share, 1) * share
            of_model = partial(function, *pair)
            run = partial(in_blocks, of_model) if kind == "cpu" else of_model
            seconds, result = measured(on, run, count, options.repeats)
            rate = count / seconds
            difference = largest_difference(of_model, result, kind)
            found = (name, on.count, label, task, count, f"{rate:.3g}", difference)
            rows.append(dict(zip(COLUMNS, found, strict=True)))
            print(f"{name}, {label}: {rate:,.0f} {task} a second {difference}", flush=True)
    record(rows)


if __name__ == "__main__":
    main()
