"""Speed of the flyers' heat balances beside that of a disk, in one run.

    python benchmarks/flyers.py [--designs 1000000] [--repeats 5] [--kinds disk sandwich ...]

Random flyers over pressures, temperatures, light and sizes. Each contender runs in turn; the
smallest time of a contender counts, by the clock and of the processors, so that what else the
machine does drops out. Ratios are to the disk, and of a gradient to its own plain call.
"""

import argparse
import time

import jax
import jax.numpy as jnp
import numpy as np

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation
from lightflyer.film import EmittanceCurve
from lightflyer.film.optics.curve import node_temperatures

MOST_SOLID = 0.99  # of what the holes leave, so that supports stand on film


def designs(count):
    rng = np.random.default_rng(1)

    def spread(lowest, highest):
        return np.exp(rng.uniform(np.log(lowest), np.log(highest), count))

    open_fraction = rng.uniform(0.05, 0.9, count)
    return {
        "radius": spread(1e-3, 0.3),
        "emittance": spread(0.02, 1.0),
        "pressure": spread(1e-3, 1e4),
        "cold": rng.uniform(150.0, 320.0, count),
        "irradiance": spread(10.0, 2e4),
        "open_fraction": open_fraction,
        "gap": spread(1e-5, 1e-2),
        "supports": np.minimum(spread(1e-6, 1e-2), MOST_SOLID * (1.0 - open_fraction)),
    }


def surroundings(pressure, cold, irradiance):
    radiation = Radiation(irradiance, albedo=0.3, infrared_below=240.0)
    return EnvironmentState(pressure, cold, 9.8, lf.gas.AIR, radiation)


def disk(radius, emittance):
    return lf.Disk(lf.FilmProperties(1e-3, 0.6, emittance, emittance, 0.8, 0.9), radius)


def sandwich(radius, emittance, open_fraction, gap, supports, upper=0.1):
    top = lf.FilmProperties(3e-4, 0.02, upper, upper, 0.8, 0.8, transmittance=0.9)
    bottom = lf.FilmProperties(3.7e-4, 0.6, emittance, emittance, 0.8, 0.8)
    return lf.Sandwich(top, bottom, radius, gap, open_fraction, 1e-5, supports, 1.8)


def plate(radius, emittance, open_fraction, gap):
    """Channels whose width is that of the walls between them times a ratio."""
    film = lf.FilmProperties(1.5e-4, 0.01, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
    dark = lf.FilmProperties(2.5e-4, 0.9, emittance, emittance, 0.8, 0.8)
    width = 1e-4 * open_fraction
    return lf.Plate(film, dark, radius, width, 4.0 * width, 1e-4, gap, 5e-8, 1.8)


def hollow(radius, emittance, open_fraction, gap):
    """A sphere whose channels are as wide as its wall is thick."""
    outer = lf.FilmProperties(2e-4, 0.02, 0.8, 0.1, 0.9, 0.9, transmittance=0.95)
    inner = lf.FilmProperties(3e-4, 0.9, emittance, emittance, 0.9, 0.9)
    width = jnp.minimum(gap, 0.05 * radius)
    return lf.HollowBody(
        outer, inner, 2.0 * radius, 0.8 * radius, open_fraction, width, width, 25e-9, 1.8
    )


def balloon(radius, emittance):
    """An open one, of metres."""
    film = lf.FilmProperties(1e-2, 0.9, emittance, emittance, 0.9, 0.9, transmittance=0.05)
    return lf.Balloon(film, 20.0 * radius, radius)


CURVE = EmittanceCurve.through(0.1 + 0.02 * np.log(node_temperatures() / 300.0))
"""Emittance that depends on temperature, as that of layers does."""

SIZES = ("radius", "emittance")
AROUND = ("pressure", "cold", "irradiance")
HOLES = ("open_fraction", "gap", "supports")
FLYERS = {
    "disk": (disk, SIZES, lf.Lu2023()),
    "sandwich": (sandwich, (*SIZES, *HOLES), lf.Schafer2025()),
    "sandwich, upper film of layers": (
        lambda *values: sandwich(*values, upper=CURVE), (*SIZES, *HOLES), lf.Schafer2025()
    ),
    "plate": (plate, (*SIZES, *HOLES[:2]), lf.ChannelPump()),
    "hollow": (hollow, (*SIZES, *HOLES[:2]), lf.HollowPump()),
    "balloon": (balloon, SIZES, lf.BalloonConvection()),
}  # fmt: skip


def balance(kind, values):
    make, names, model = FLYERS[kind]
    state = surroundings(*(values[name] for name in AROUND))
    return lf.equilibrium(make(*(values[name] for name in names)), state, model, throw=False)


def lift(kind):
    """Sum of the lift, in one piece as in a user's own function, and its gradient in all inputs."""
    make, names, model = FLYERS[kind]

    def of(*columns):
        state = surroundings(*columns[: len(AROUND)])
        return lf.lift(make(*columns[len(AROUND) :]), state, model, throw=False)

    inputs = (*AROUND, *names)
    gradient = jax.grad(lambda *columns: of(*columns).sum(), argnums=range(len(inputs)))
    return jax.jit(of), jax.jit(gradient), inputs


def smallest(functions, repeats):
    """Smallest time of each function by the clock and of the processors; the last results."""
    times, results = {name: [np.inf, np.inf] for name in functions}, {}
    for run in range(repeats + 1):
        for name, function in functions.items():
            clock, processors = time.perf_counter(), time.process_time()
            results[name] = jax.block_until_ready(function())
            found = time.perf_counter() - clock, time.process_time() - processors
            if run:  # the first compiles
                times[name] = [min(pair) for pair in zip(times[name], found, strict=True)]
    return times, results


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--kinds", nargs="+", choices=FLYERS, default=[*FLYERS])
    options = parser.parse_args()
    kinds = ["disk", *(kind for kind in options.kinds if kind != "disk")]
    values = designs(options.designs)
    functions = {kind: lambda kind=kind: balance(kind, values) for kind in kinds}
    with lf.float64():
        for kind in kinds:
            plain, gradient, names = lift(kind)
            columns = [jnp.asarray(values[name]) for name in names]
            functions[f"lift, {kind}"] = lambda f=plain, c=columns: f(*c)
            functions[f"gradient, {kind}"] = lambda f=gradient, c=columns: f(*c)
        times, results = smallest(functions, options.repeats)
    print(f"{options.designs:,} designs, float64, smallest of {options.repeats} alternating runs")
    print(f"{'':48}{'clock [s]':>10}{'ratio':>7}{'CPU [s]':>9}{'ratio':>7}  to")
    for name, (clock, processors) in times.items():
        base = name.replace("gradient", "lift") if "gradient" in name else "disk"
        base = "lift, disk" if name.startswith("lift") else base
        ratios = clock / times[base][0], processors / times[base][1]
        print(f"{name:48}{clock:10.3f}{ratios[0]:7.2f}{processors:9.3f}{ratios[1]:7.2f}  {base}")
    for kind in kinds:
        print(f"{kind}: {int(np.sum(~np.asarray(results[kind].converged)))} not converged")


if __name__ == "__main__":
    main()
