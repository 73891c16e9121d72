"""Speed of the heat balance beside SciPy's root-finders on the same residual, in one run.

    python benchmarks/solver.py [--designs 1000000] [--repeats 5]

Prints the table of docs/benchmarks.md. Figures are ratios of medians of alternating runs: the
machine's own speed drops out of them. The peers solve the equations of ``numpy_model.py``, which
shares no code with the package; their temperatures are compared with the package's.
"""

import argparse
import resource
import statistics
import time

import jax
import jax.numpy as jnp
import numpy as np
import numpy_model
from scipy.optimize import brentq, elementwise

import lightflyer as lf
from lightflyer.balance import total_loss

SCALAR_SAMPLE = 2000
EMITTANCE_FLOOR, TAC = 0.01, 0.85


def designs(count):
    rng = np.random.default_rng(1)

    def spread(lowest, highest):
        return np.exp(rng.uniform(np.log(lowest), np.log(highest), count))

    return {
        "pressure": spread(1e-3, 1e5),
        "cold": rng.uniform(100.0, 320.0, count),
        "irradiance": spread(1.0, 2e4),
        "radius": spread(1e-4, 10.0),
        "emittance": spread(EMITTANCE_FLOOR, 1.0),
    }


def build(values):
    film = lf.FilmProperties(1e-3, 0.75, values["emittance"], values["emittance"], 0.8, 0.9)
    radiation = lf.Radiation(values["irradiance"], stefan_boltzmann=numpy_model.STEFAN_BOLTZMANN)
    state = lf.EnvironmentState(
        values["pressure"], values["cold"], numpy_model.GRAVITY, lf.LU2023_AIR, radiation
    )
    return lf.Disk(film, values["radius"]), state


def package_temperatures(values):
    return lf.equilibrium(*build(values), lf.Lu2023()).temperature


def peer_problem(values):
    absorbed = 0.75 * values["irradiance"] * np.pi * values["radius"] ** 2
    radiative = 0.75 * values["irradiance"] / (2 * values["emittance"])
    hottest = (values["cold"] ** 4 + radiative / numpy_model.STEFAN_BOLTZMANN) ** 0.25
    arguments = (
        values["cold"], values["pressure"], values["radius"], values["emittance"], absorbed
    )  # fmt: skip

    def residual(hot, cold, pressure, radius, emittance, absorbed):
        lost = numpy_model.lost_power(hot, cold, pressure, radius, TAC, emittance)
        return lost / absorbed - 1.0

    return residual, hottest * (1 + 1e-12), arguments


def scipy_vectorised(values):
    residual, hottest, arguments = peer_problem(values)
    tolerances = {"xatol": 0.0, "xrtol": 1e-11, "fatol": 1e-11, "frtol": 0.0}
    with np.errstate(all="ignore"):
        result = elementwise.find_root(
            residual, (values["cold"], hottest), args=arguments, tolerances=tolerances
        )
    return result.x


def scipy_scalar(values, count):
    residual, hottest, arguments = peer_problem(values)
    columns = [column[:count].tolist() for column in (hottest, *arguments)]
    with np.errstate(all="ignore"):
        return [
            brentq(residual, row[0], hot, args=tuple(row), xtol=1e-9, rtol=1e-11)
            for hot, *row in zip(*columns, strict=True)
        ]


def lift_of_six(radius, pressure, cold, irradiance, emittance, tac_bottom):
    film = lf.FilmProperties(1e-3, 0.75, emittance, emittance, 0.8, tac_bottom)
    state = lf.EnvironmentState(
        pressure, cold, numpy_model.GRAVITY, lf.LU2023_AIR, lf.Radiation(irradiance)
    )
    return lf.lift(lf.Disk(film, radius), state, lf.Lu2023(), throw=False)


def timed(function):
    start = time.perf_counter()
    result = jax.block_until_ready(function())
    return time.perf_counter() - start, result


def medians(functions, repeats):
    """Median time of each function over alternating runs; the last results."""
    times, results = {name: [] for name in functions}, {}
    for name, function in functions.items():
        results[name] = function()  # compiles
    for _ in range(repeats):
        for name, function in functions.items():
            seconds, results[name] = timed(function)
            times[name].append(seconds)
    return {name: statistics.median(series) for name, series in times.items()}, results


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    values = designs(options.designs)

    functions = {"package": lambda: package_temperatures(values)}
    _, results = medians(functions, 1)
    memory_before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    disk, state = build(values)
    with lf.float64():
        six = [jnp.asarray(np.asarray(column, float)) for column in
               (values["radius"], values["pressure"], values["cold"], values["irradiance"],
                values["emittance"], np.full(options.designs, 0.9))]  # fmt: skip
        plain = jax.jit(lift_of_six)
        gradient = jax.jit(jax.grad(lambda *x: lift_of_six(*x).sum(), argnums=range(6)))
        one_residual = jax.jit(lambda excess: total_loss(disk, state, lf.Lu2023(), excess))
        excess = jnp.asarray(results["package"] / values["cold"] - 1.0)
        scalar = {key: column[:SCALAR_SAMPLE] for key, column in values.items()}
        times, results = medians(
            {
                "package": lambda: package_temperatures(values),
                "lift": lambda: plain(*six),
                "gradient of lift": lambda: gradient(*six),
                "one residual": lambda: one_residual(excess),
                "brentq": lambda: scipy_scalar(scalar, SCALAR_SAMPLE),
            },
            options.repeats,
        )
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    vectorised = {
        "package again": lambda: package_temperatures(values),
        "find_root": lambda: scipy_vectorised(values),
    }
    slow, compared = medians(vectorised, 1)
    worst = np.max(np.abs(compared["find_root"] / compared["package again"] - 1.0))
    scalar_time = times["brentq"] * options.designs / SCALAR_SAMPLE

    rows = [
        ("heat balance, package", times["package"], 1.0),
        ("the same, scipy elementwise.find_root", slow["find_root"],
         slow["find_root"] / slow["package again"]),
        (f"the same, scipy brentq (from {SCALAR_SAMPLE})", scalar_time,
         scalar_time / times["package"]),
        ("one evaluation of the residual", times["one residual"],
         times["one residual"] / times["package"]),
        ("lift", times["lift"], times["lift"] / times["package"]),
        ("reverse gradient of lift in six inputs", times["gradient of lift"],
         times["gradient of lift"] / times["lift"]),
    ]  # fmt: skip
    print(f"{options.designs:,} designs, float64, medians of {options.repeats} runs")
    print(f"{'':46}{'seconds':>10}{'ratio':>10}")
    for name, seconds, ratio in rows:
        print(f"{name:46}{seconds:10.3f}{ratio:10.2f}")
    print("ratios are to the package's heat balance; the gradient's is to lift")
    print(f"largest relative difference of temperature from find_root: {worst:.1e}")
    print(f"peak memory: {memory_before:.0f} MB after the solve, {memory:.0f} MB with gradients")


if __name__ == "__main__":
    main()
