"""Compare the corrected kinetic force and heat with direct simulation at finite differences.

Run as ``python studies/kinetic_collisions/comparison.py``. The model equation is solved where there
are simulations (``studies/direct_simulation``), once; what collisions then take more or less is
compared with the factors of the linear problem at the same place. Their change with temperature
is fitted to six simulations of gases other than nitrogen and tried on all others.
"""

import json
import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares
from study import ratios

from lightflyer.force.kinetic.collisions import (
    FORCE_ERROR,
    FORCE_HEATED,
    HEAT_ERROR,
    HEAT_HEATED,
    HEATED_ERROR,
)
from lightflyer.kinetic_theory.collisions.brackets import Molecule
from lightflyer.kinetic_theory.collisions.problem import solve_molecules
from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, Case, solve_case
from lightflyer.kinetic_theory.model_gases import gas_model

FOLDER = Path(__file__).parent
SIMULATIONS = FOLDER.parent / "direct_simulation"
SOLVED = FOLDER / "solved.jsonl"
FITTED = 4.0  # half-width of the reservoirs of the simulations that serve the fit [radii]
FORCE_BIAS, HEAT_BIAS = -0.002, 0.0005  # of our simulations: see their README

EXPONENTS = {
    "hard spheres": 0.5, "helium": 0.66, "nitrogen": 0.74, "argon": 0.81, "carbon dioxide": 0.93,
}  # fmt: skip
EXCHANGES = {"nitrogen": 0.2, "carbon dioxide": 0.4}  # of the simulated molecules, if they rotate


@dataclass(frozen=True)
class Place:
    """Where a simulation was made."""

    gas: str
    knudsen: float
    temperature_ratio: float
    tac_top: float
    tac_bottom: float
    boundary: float

    @property
    def exponent(self) -> float:
        """Viscosity exponent of the simulated molecules."""
        return EXPONENTS[self.gas]

    @property
    def kind(self) -> str:
        """Kind of gas in the tables."""
        return "diatomic" if self.gas in EXCHANGES else "monatomic"

    @property
    def molecule(self) -> Molecule:
        """The simulated molecules."""
        exchange = EXCHANGES.get(self.gas, 0.0)
        return Molecule(self.exponent, exchange, exchange > 0.0)

    @property
    def case(self) -> Case:
        """The same disk in a gas of the model equation."""
        gas = replace(gas_model(self.kind), viscosity_exponent=self.exponent)
        return Case(
            rarefaction=float(np.sqrt(np.pi) / (4.0 * self.knudsen)),
            tac=(self.tac_top, self.tac_bottom),
            temperature=(self.temperature_ratio, self.temperature_ratio),
            linear=False,
            gas=gas,
            boundary=self.boundary,
        )


@dataclass(frozen=True)
class Simulated:
    """Ratios to free molecules by direct simulation, with standard errors."""

    place: Place
    force: float
    force_error: float
    heat: float
    heat_error: float


def simulated() -> Iterator[Simulated]:
    """All simulations: of another program, and ours at Maxwell walls in reservoirs."""
    for row in read_rows(SIMULATIONS / "peer.csv"):
        place = {name: row[name] for name in Place.__dataclass_fields__}
        numbers = {k: v if k == "gas" else float(v) for k, v in place.items()}
        values = (float(row[k]) for k in ("force", "force_error", "heat", "heat_error"))
        yield Simulated(Place(**numbers), *values)
    runs = defaultdict(list)
    for line in (SIMULATIONS / "points.jsonl").read_text(encoding="utf-8").splitlines():
        point, _, _, found = json.loads(line)
        if point["wall"] == "maxwell" and point.get("floor") is None:
            place = Place(**{name: point[name] for name in Place.__dataclass_fields__})
            runs[place].append((found["force"], found["heat"]))
    for place, results in runs.items():
        values = np.array(results)
        (force, heat), errors = values[..., 0].mean(axis=0), np.hypot.reduce(values[..., 1])
        force_error, heat_error = errors / len(results)
        yield Simulated(place, force - FORCE_BIAS, force_error, heat - HEAT_BIAS, heat_error)


def read_rows(path: Path) -> Iterator[dict[str, str]]:
    """Rows of a CSV file whose comments start with #."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    names = lines[0].split(",")
    for line in lines[1:]:
        yield dict(zip(names, line.split(","), strict=True))


@dataclass(frozen=True)
class Solved:
    """What the solver says at a place: ratios of the model equation, and linear factors."""

    force: float
    heat: float
    force_factor: float
    heat_factor: float


def solved() -> dict[Place, Solved]:
    """Solutions at all places, solved where they are missing."""
    found = {}
    if SOLVED.exists():
        for line in SOLVED.read_text().splitlines():
            place, values = json.loads(line)
            found[Place(**place)] = Solved(**values)
    for point in simulated():
        if point.place in found:
            continue
        model = ratios(point.place.case, solve_case(point.place.case, MEDIUM))
        linear = replace(point.place.case, linear=True, temperature=(1.0, 1.0))
        molecules = solve_molecules(linear, COARSE, point.place.molecule)
        pairs = zip(
            ratios(linear, molecules), ratios(linear, solve_case(linear, COARSE)), strict=True
        )
        factors = [(1.0 / real - 1.0) / (1.0 / other - 1.0) for real, other in pairs]
        found[point.place] = Solved(*model, *factors)
        with SOLVED.open("a") as file:
            file.write(json.dumps([asdict(point.place), asdict(found[point.place])]) + "\n")
        print(point.place, found[point.place], flush=True)
    return found


@dataclass(frozen=True)
class Compared:
    """Factor by which collisions take more than in the model equation, three times."""

    place: Place
    simulated: float
    error: float
    linear: float

    def excess(self, slope: float, monatomic: float, diatomic: float) -> float:
        """Deviation of the simulation from the heated linear factor, in standard errors.

        The factor is heated by a slope, which vanishes at the neutral exponent of a kind of gas.
        """
        heating = np.log(self.place.temperature_ratio)
        neutral = monatomic if self.place.kind == "monatomic" else diatomic
        factor = self.linear * np.exp(slope * heating * (neutral - self.place.exponent))
        return float((self.simulated - factor) / self.error)


def compared(quantity: str) -> list[Compared]:
    """Factors of force or heat at all simulations."""
    model, found = solved(), []
    for point in simulated():
        place = point.place
        ratio = getattr(model[place], quantity)
        value, error = getattr(point, quantity), getattr(point, f"{quantity}_error")
        taken = 1.0 / ratio - 1.0
        linear = getattr(model[place], f"{quantity}_factor")
        found.append(Compared(place, (1.0 / value - 1.0) / taken, error / value**2 / taken, linear))
    return found


def residual(x: np.ndarray, chosen: list[Compared]) -> np.ndarray:
    """Deviations at places, for a slope and neutral exponents [standard errors]."""
    return np.array([point.excess(*x) for point in chosen])


def left(x: np.ndarray, chosen: list[Compared]) -> float:
    """Weighted r.m.s. deviation of factors that the simulations' errors do not explain."""
    errors = np.array([point.error for point in chosen])
    deviations = residual(x, chosen) * errors

    def excess(variance: float) -> float:
        return float(np.sum(deviations**2 / (errors**2 + variance)) - len(chosen))

    return 0.0 if excess(0.0) < 0.0 else float(np.sqrt(brentq(excess, 0.0, 1.0)))


def show(quantity: str) -> None:
    """Fit what heating does to the factors of force or heat, and print how well they hold."""
    points = compared(quantity)
    fitted, unseen = (
        [p for p in points if (p.place.gas != "nitrogen" and p.place.boundary == FITTED) is chosen]
        for chosen in (True, False)
    )
    nitrogen = [point for point in unseen if point.place.gas == "nitrogen"]
    fit = least_squares(residual, [0.4, 0.8, 0.8], args=(fitted,))
    errors = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    print(
        f"{quantity}: slope {fit.x[0]:.3f} ± {errors[0]:.3f}, neutral exponents: monatomic "
        f"{fit.x[1]:.3f} ± {errors[1]:.3f}, diatomic {fit.x[2]:.3f} ± {errors[2]:.3f}"
    )
    for point in points:
        p = point.place
        print(
            f"  {p.gas:14s} Kn {p.knudsen:.3f} T {p.temperature_ratio:.2f} "
            f"TAC {p.tac_top:g}/{p.tac_bottom:g} D {p.boundary:g}: simulated "
            f"{point.simulated:.3f} ± {point.error:.3f}, linear {point.linear:.3f}, "
            f"{point.excess(0.0, 0.0, 0.0):+.1f} σ; heated {point.excess(*fit.x):+.1f} σ"
        )
    for name, chosen in (("fitted", fitted), ("unseen", unseen)):
        square = float(np.sum(residual(fit.x, chosen) ** 2))
        print(f"  {name}: chi² {square:.1f} of {len(chosen)} points")
    print(f"  left of nitrogen's factors, r.m.s.: {left(fit.x, nitrogen):.4f}")
    print(f"  unseen within the model's error: {contained(quantity, unseen)} of {len(unseen)}")


def contained(quantity: str, points: list[Compared]) -> int:
    """Number of simulations within 1.96 standard errors of the force model and their own."""
    heated, own = (FORCE_HEATED, FORCE_ERROR) if quantity == "force" else (HEAT_HEATED, HEAT_ERROR)
    found = 0
    for point in points:
        place = point.place.kind, point.place.temperature_ratio, point.place.exponent
        change = float(heated.logarithm(*place))
        error = math.hypot(own, HEATED_ERROR * change if quantity == "force" else 0.0)
        off = point.simulated - point.linear * math.exp(change)
        found += abs(off) < 1.96 * math.hypot(error * point.linear, point.error)
    return found


def main() -> None:
    """Compare force and heat."""
    for quantity in ("force", "heat"):
        show(quantity)


if __name__ == "__main__":
    main()
