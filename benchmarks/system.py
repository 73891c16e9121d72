"""Speed of coupled heat balances beside single ones and beside SciPy, in one run.

    python benchmarks/system.py [--designs 1000000] [--repeats 5]

Two bodies that radiate, lose heat to a gas and conduct to each other, against one body alone, both
with the package's own solvers. SciPy has no root-finder for many systems at once:
``scipy.optimize.root`` solves a sample one by one, from the same guesses and with the exact
Jacobian. Ratios are of medians of alternating runs: the machine's own speed drops out of them.
"""

import argparse

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import root
from solver import medians

import lightflyer as lf
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.numerics.rootfind import find_power_root, implicit_root
from lightflyer.numerics.system import solve_system

SAMPLE = 2000
SMALLEST_SHARE = 1e-12


def designs(count):
    rng = np.random.default_rng(1)

    def spread(lowest, highest):
        return np.exp(rng.uniform(np.log(lowest), np.log(highest), count))

    gas, radiation, power = (1e-6, 1e3), (1e-2, 1e1), (1e-2, 1e2)
    return [spread(*ends) for ends in (gas, gas, radiation, radiation, power, power, (1e-6, 1e3))]


def growth(excess):
    return excess * (4.0 + excess * (6.0 + excess * (4.0 + excess)))


def slope(excess):
    return 4.0 * (1.0 + excess) ** 3


def vacuum(ratio):
    """Excess at which radiation alone gives off the power."""
    fourth = lf.xp.sqrt(lf.xp.sqrt(1.0 + ratio))
    return ratio / ((fourth + 1.0) * (fourth**2 + 1.0))


def secant(gas, radiation, power):
    highest = vacuum(power / radiation)
    return highest * power / (gas * highest + power)


def guesses(gas, other_gas, radiation, other_radiation, power, other_power, link):
    """Between each body for itself and both as one, by what the link carries."""
    both = secant(gas + other_gas, radiation + other_radiation, power + other_power)

    def between(alone, power):
        own = power / alone
        return (own * alone + link * both) / (own + link)

    return (
        between(secant(gas, radiation, power), power),
        between(secant(other_gas, other_radiation, other_power), other_power),
    )


@elementwise_entry_point
def one_body(gas, radiation, power):
    def loss(excess):
        return gas * excess + radiation * growth(excess)

    highest = vacuum(power / radiation)

    def search():
        return find_power_root(
            loss, power, SMALLEST_SHARE * highest, highest, highest * power / loss(highest)
        )

    return implicit_root(lambda excess: loss(excess) - power, search, power.shape)


@elementwise_entry_point
def two_bodies(gas, other_gas, radiation, other_radiation, power, other_power, link):
    def residual(excess):
        first, second = excess
        flow = link * (first - second)
        return (
            (gas * first + radiation * growth(first) + flow) / power - 1.0,
            (other_gas * second + other_radiation * growth(second) - flow) / other_power - 1.0,
        )

    guess = guesses(gas, other_gas, radiation, other_radiation, power, other_power, link)
    return solve_system(residual, guess, lower=-1.0)


def scipy_one_by_one(values, firsts):
    found = []
    for (a, b, c, d, p, q, k), first in zip(values, firsts, strict=True):

        def imbalance(x, a=a, b=b, c=c, d=d, p=p, q=q, k=k):
            flow = k * (x[0] - x[1])
            return (
                (a * x[0] + c * growth(x[0]) + flow) / p - 1.0,
                (b * x[1] + d * growth(x[1]) - flow) / q - 1.0,
            )

        def jacobian(x, a=a, b=b, c=c, d=d, p=p, q=q, k=k):
            return (
                ((a + c * slope(x[0]) + k) / p, -k / p),
                (-k / q, (b + d * slope(x[1]) + k) / q),
            )

        result = root(imbalance, first, jac=jacobian, tol=1e-12)
        found.append(result.x if result.success else (np.nan, np.nan))
    return np.transpose(found)


def summed(*values):
    first, second = two_bodies(*values)[0]
    return jnp.sum(first + second)


def compare(count, repeats):
    values = designs(count)
    sample = [column[:SAMPLE] for column in values]
    rows = np.transpose(sample).tolist()
    with lf.float64():
        inputs = [jnp.asarray(column) for column in values]
        firsts = np.transpose(guesses(*sample)).tolist()
        single = jax.jit(lambda *columns: one_body(*columns)[0])
        solve = jax.jit(lambda *columns: two_bodies(*columns)[0])
        gradient = jax.jit(jax.grad(summed, argnums=range(7)))
        times, results = medians(
            {
                "one": lambda: one_body(*values[:6:2]),
                "two": lambda: two_bodies(*values),
                "single": lambda: single(*inputs[:6:2]),
                "whole": lambda: solve(*inputs),
                "gradient": lambda: gradient(*inputs),
                "scipy": lambda: scipy_one_by_one(rows, firsts),
            },
            repeats,
        )
    times["scipy"] *= count / SAMPLE
    excess, outcome = results["two"]
    difference = np.abs(results["scipy"] / np.array([row[:SAMPLE] for row in excess]) - 1.0)
    return times, outcome, difference


LABELS = {
    "one": ("one heat balance", "one"),
    "two": ("two coupled heat balances", "one"),
    "scipy": (f"the same, scipy.optimize.root (from {SAMPLE})", "two"),
    "single": ("one heat balance, all designs in one piece", "one"),
    "whole": ("two, all designs in one piece", "single"),
    "gradient": ("reverse gradient of two in seven inputs, in one piece", "whole"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    times, outcome, difference = compare(options.designs, options.repeats)
    print(f"{options.designs:,} designs, float64, medians of {options.repeats} alternating runs")
    print(f"{'':56}{'seconds':>9}{'ratio':>9}  to")
    for name, (label, base) in LABELS.items():
        print(f"{label:56}{times[name]:9.3f}{times[name] / times[base]:9.2f}  {LABELS[base][0]}")
    print(f"not converged: {np.sum(~outcome.converged)} of the package, "
          f"{np.mean(np.isnan(difference[0])):.1%} of SciPy's sample")  # fmt: skip
    print(f"99 % of relative differences from SciPy below {np.nanquantile(difference, 0.99):.1e}")


if __name__ == "__main__":
    main()
