"""One trace, run by NumPy and by XLA: what each costs. Prints the constants of the entry points.

Run ``python benchmarks/programs.py [FLYER.toml]``, by default for the disk of ``lightflyer init``.
"""

import sys
import tempfile
import time
from pathlib import Path

import jax
import numpy as np

from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import read_design
from lightflyer.core.precision import float64
from lightflyer.design.tables import tabulate
from lightflyer.program.numpy_backend import Meter, run
from lightflyer.program.tracing import trace

LENGTHS = (1, 301, 5000, 50_000)


def setup_of(arguments):
    if arguments:
        return read_design(Path(arguments[0])).setup
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "flyer.toml")
        path.write_text(templates()["earth"].read(), encoding="utf-8")
        return read_design(path).setup


def timed(function):
    start = time.perf_counter()
    found = function()
    return found, time.perf_counter() - start


def main():
    setup = setup_of(sys.argv[1:])
    leaves, structure = jax.tree.flatten(setup)
    leaves = [np.asarray(leaf, float) for leaf in leaves]
    shapes = [leaf.shape for leaf in leaves] + [("n0",), ("n0",)]

    def flat(values):
        *parts, coordinate, light = values
        return tabulate(jax.tree.unflatten(structure, parts), coordinate, light)

    with float64():
        (program, _), tracing = timed(lambda: trace(flat, shapes, [np.dtype(float)] * len(shapes)))
        example = [*leaves, *np.ones((2, LENGTHS[-1]))]
        compiled, compilation = timed(lambda: jax.jit(flat).lower(example).compile())
    print(f"{program.size} operations, traced in {tracing:.2f} s, kept in "
          f"{len(program.to_bytes()) / 1e3:.0f} kB")  # fmt: skip
    print(
        f"XLA compiles in {compilation:.1f} s: "
        f"{compilation / program.size * 1e3:.2f} ms an operation"
    )
    rows = []
    for length in LENGTHS:
        places = np.linspace(*setup.searched, length)
        inputs = [*leaves, places, np.full(length, 1361.0)]
        run(program, inputs)
        meter = Meter()
        _, spent = timed(lambda inputs=inputs, meter=meter: run(program, inputs, meter))
        rows.append((meter.calls, meter.work, spent))
        print(
            f"NumPy, {length:6} places: {spent:8.4f} s, {spent / meter.calls * 1e6:6.2f} µs a call"
        )
    with float64():
        inputs = [*leaves, places, np.full(length, 1361.0)]
        jax.block_until_ready(compiled(inputs))
        _, spent = timed(lambda: jax.block_until_ready(compiled(inputs)))
    print(
        f"XLA,   {length:6} places: {spent:8.4f} s, {spent / rows[-1][1] * 1e9:.2f} ns an element"
    )
    work = np.array(rows)
    call, element = np.linalg.lstsq(work[:, :2], work[:, 2], rcond=None)[0]
    print(f"NumPy: {call * 1e6:.2f} µs a call and {element * 1e9:.2f} ns an element of its result")


if __name__ == "__main__":
    main()
