"""Speed of the heat balance beside SciPy's root-finders on the same residual, in one run.

    python benchmarks/solver.py [--designs 1000000] [--repeats 5]

Prints the numbers of docs/benchmarks.md. Figures are ratios of medians of alternating runs: the
machine's own speed drops out of them. The peers solve the equations of ``numpy_model.py``, which
shares no code with the package; their temperatures are compared with the package's.
"""

import argparse
import statistics
import subprocess
import sys
import time

import jax
import jax.numpy as jnp
import numpy as np
import numpy_model
from scipy.optimize import brentq, elementwise

import lightflyer as lf
from lightflyer.environment import EnvironmentState, Radiation
from lightflyer.statics.equations import FlightEquations

SCALAR_SAMPLE = 2000
EMITTANCE_FLOOR, TAC = 0.01, 0.85
# The package stops where the residual is 1e-12 of the absorbed power; so may the peer.
SAME_RESIDUAL = {"fatol": 1e-12, "frtol": 0.0, "xatol": 0.0, "xrtol": 0.0}


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


def build(values, gas=lf.gas.LU2023_AIR):
    film = lf.FilmProperties(1e-3, 0.75, values["emittance"], values["emittance"], 0.8, 0.9)
    radiation = Radiation(values["irradiance"], stefan_boltzmann=numpy_model.STEFAN_BOLTZMANN)
    state = EnvironmentState(
        values["pressure"], values["cold"], numpy_model.GRAVITY, gas, radiation
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


def scipy_vectorised(values, tolerances=None):
    residual, hottest, arguments = peer_problem(values)
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
            brentq(residual, row[0], hot, args=tuple(row), xtol=1e-12)
            for hot, *row in zip(*columns, strict=True)
        ]


def lift_of_six(radius, pressure, cold, irradiance, emittance, tac_bottom):
    film = lf.FilmProperties(1e-3, 0.75, emittance, emittance, 0.8, tac_bottom)
    state = EnvironmentState(
        pressure, cold, numpy_model.GRAVITY, lf.gas.LU2023_AIR, Radiation(irradiance)
    )
    return lf.lift(lf.Disk(film, radius), state, lf.Lu2023(), throw=False)


def timed(function):
    start = time.perf_counter()
    result = jax.block_until_ready(function())
    return time.perf_counter() - start, result


def medians(functions, repeats):
    """Median time of each function over alternating runs; the last results.

    Before each timed run comes one that is not: it compiles, and it takes from the system what
    memory the function before it gave back, which would otherwise be charged to this one.
    """
    times, results = {name: [] for name in functions}, {}
    for _ in range(repeats):
        for name, function in functions.items():
            jax.block_until_ready(function())
            seconds, results[name] = timed(function)
            times[name].append(seconds)
    return {name: statistics.median(series) for name, series in times.items()}, results


def gradient_inputs(values):
    columns = [values[name] for name in ("radius", "pressure", "cold", "irradiance", "emittance")]
    return [jnp.asarray(column) for column in (*columns, np.full_like(columns[0], 0.9))]


def lift_and_gradient():
    return jax.jit(lift_of_six), jax.jit(
        jax.grad(lambda *inputs: lift_of_six(*inputs).sum(), argnums=range(6))
    )


def run_alone(task, values):
    """One task in a process of its own, whose peak memory is then its own."""
    if task == "solve":
        package_temperatures(values)
    else:
        with lf.float64():
            jax.block_until_ready(lift_and_gradient()[1](*gradient_inputs(values)))
    # not resource.getrusage: a child inherits its parent's peak there
    with open("/proc/self/status") as lines:
        status = dict(line.split(":", 1) for line in lines)
    print(int(status["VmHWM"].split()[0]) / 1024)


def peak_memory(task, count):
    command = [sys.executable, __file__, "--designs", str(count), "--alone", task]
    return float(subprocess.run(command, capture_output=True, check=True, text=True).stdout)


def residual_of(disk, state, model):
    """One evaluation of a heat balance's residual, at its solution."""
    compiled = jax.jit(lambda excess: FlightEquations(disk, state, model).losses((excess,)))
    excess = jnp.asarray(lf.equilibrium(disk, state, model).unknowns[0])
    return lambda: compiled(excess)


def compare(count, repeats):
    values = designs(count)
    sample = {key: column[:SCALAR_SAMPLE] for key, column in values.items()}
    kinetic = *build(values, lf.gas.AIR), lf.Kinetic()
    with lf.float64():
        six = gradient_inputs(values)
        lift, gradient = lift_and_gradient()
        times, results = medians(
            {
                "package": lambda: package_temperatures(values),
                "find_root": lambda: scipy_vectorised(values),
                "find_root, loose": lambda: scipy_vectorised(values, SAME_RESIDUAL),
                "brentq": lambda: scipy_scalar(sample, SCALAR_SAMPLE),
                "lift": lambda: lift(*six),
                "gradient": lambda: gradient(*six),
                "residual": residual_of(*build(values), lf.Lu2023()),
                "kinetic": lambda: lf.equilibrium(*kinetic),
                "kinetic residual": residual_of(*kinetic),
                "levitation": lambda: lf.levitate(*kinetic),
            },
            repeats,
        )
    times["brentq"] *= count / SCALAR_SAMPLE
    worst = np.max(np.abs(results["find_root"] / results["package"] - 1.0))
    return times, worst


LABELS = {
    "package": "heat balance, package",
    "find_root": "the same, scipy elementwise.find_root, its tolerances",
    "find_root, loose": "the same, stopped at the package's tolerance",
    "brentq": f"the same, scipy brentq (from {SCALAR_SAMPLE})",
    "residual": "one evaluation of the residual",
    "lift": "lift",
    "gradient": "reverse gradient of lift in six inputs",
    "kinetic": "heat balance by the kinetic force",
    "kinetic residual": "one evaluation of its residual",
    "levitation": "levitation by the kinetic force",
}
BASES = {"gradient": "lift", "kinetic residual": "kinetic", "levitation": "kinetic"}


def evaluations(times):
    lu2023, kinetic = (
        times[solve] / times[residual]
        for solve, residual in (("package", "residual"), ("kinetic", "kinetic residual"))
    )
    return f"{lu2023:.1f} (kinetic {kinetic:.1f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--alone", choices=["solve", "gradient"], help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.alone:
        run_alone(options.alone, designs(options.designs))
        return
    times, worst = compare(options.designs, options.repeats)
    print(f"{options.designs:,} designs, float64, medians of {options.repeats} alternating runs")
    print(f"{'':56}{'seconds':>9}{'ratio':>9}")
    for name, label in LABELS.items():
        ratio = times[name] / times[BASES.get(name, "package")]
        print(f"{label:56}{times[name]:9.3f}{ratio:9.2f}")
    print("ratios are to the package's heat balance, the gradient's to lift, the last two to the")
    print("kinetic one; a solve costs as much as", evaluations(times), "evaluations")
    print(f"largest relative difference of temperature from find_root: {worst:.1e}")
    for task in ("solve", "gradient"):
        print(f"peak memory, {task} alone: {peak_memory(task, options.designs):.0f} MB")


if __name__ == "__main__":
    main()
