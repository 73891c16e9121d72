"""The best of a kind by samples that close in on the best, at all altitudes and sizes at once.

    python studies/what_can_fly_where/sampled.py "hollow sphere, corrected"

An alternative to the gradients of study.py for kinds whose models take minutes to compile with
their derivatives: only the model itself is compiled. It begins from 500 designs all over the
bounds and from the row that is there, and looks around the best of each place ever more closely.
Replaces the rows of the kind in results.json.
"""

import sys
import time

import numpy as np
import study
from kinds import KINDS
from scipy.stats import qmc

import lightflyer as lf
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.design.diagnostics import diagnose_at
from lightflyer.statics.equations import FlightEquations
from lightflyer.uncertainty.inputs import draw, uncertain_inputs

COUNT = study.SAMPLES + 12  # designs a place and round; of the last round, samples of the inputs
SPREADS = np.array([0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01, 5e-3, 2e-3])
MOVED = 0.5  # share of the numbers that are moved at once
AT_BOUND = 1e-6
NO_LIFT = "the best design does not lift its weight: none within bounds and constraints flies"


def outcomes_of(design):
    """Outcomes of many designs, each at its altitude."""

    @elementwise_entry_point
    def outcomes(values, altitude):
        setup = design.build(values)
        state = setup.environment.state(altitude)
        found = lf.equilibrium(setup.flyer, state, setup.model, throw=False)
        equations = FlightEquations(setup.flyer, state, setup.model)
        lift = equations.upward_force(found.unknowns)
        payload = equations.largest_payload(lift)
        own = setup.flyer.own_mass + 0.0 * lift
        return {
            "payload": payload,
            "payload_per_area": payload / setup.flyer.area,
            "relative_payload": payload / own,
            "lift_over_weight": lift / (own * state.gravity),
            "temperature": found.temperature,
            "pressure": state.pressure + 0.0 * lift,
            "own_mass": own,
            "buoyancy_share": equations.buoyancy(found.unknowns) / lift,
        }

    return outcomes


class Search:
    """A kind at all its places, a row of arrays each."""

    def __init__(self, kind, known):
        self.kind, self.cases = kind, list(study.cases(kind))
        problems = [study.problem_of(kind, *case) for case in self.cases]
        first = problems[0]
        self.names = [bounds.field.name for bounds in first.bounds]
        self.logarithmic = np.array([bounds.logarithmic for bounds in first.bounds])
        self.low, self.high = (
            np.array([[getattr(one, end) for one in problem.bounds] for problem in problems])
            for end in ("low", "high")
        )
        self.fixed = {
            name: np.array([problem.fixed[name] for problem in problems])
            for name in first.fixed if name != "altitude"
        }  # fmt: skip
        self.inputs = uncertain_inputs(study.flyer_file(kind).design())
        self.altitude = 1e3 * np.array([case[2] for case in self.cases])
        self.per_area = np.array([case[1] == study.OBJECTIVES[1] for case in self.cases])
        self.outcomes = outcomes_of(first.design)
        self.start = np.array([self._unit(known.get(case), i) for i, case in enumerate(self.cases)])

    def _unit(self, row, index):
        """Where a known row is within the bounds, from 0 to 1."""
        if row is None or "design" not in row:
            return np.full(len(self.names), 0.5)
        value = np.array([row["design"][name] for name in self.names])
        low, high = self.low[index], self.high[index]
        with np.errstate(invalid="ignore", divide="ignore"):
            place = np.where(
                self.logarithmic,
                np.log(value / low) / np.log(high / low),
                (value - low) / (high - low),
            )
        return np.clip(place, 0.0, 1.0)

    def values(self, unit):
        """Numbers of designs, of shape (places, designs) each, and of what is not free."""
        low, high = self.low[:, None], self.high[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            free = np.where(self.logarithmic, low * (high / low) ** unit, low + (high - low) * unit)
        shape = unit.shape[:2]
        at_rest = dict(zip(self.inputs.names, self.inputs.values, strict=True))
        found = {name: np.broadcast_to(value, shape) for name, value in at_rest.items()}
        found |= {
            name: np.broadcast_to(value[:, None], shape) for name, value in self.fixed.items()
        }
        return found | {name: free[..., i] for i, name in enumerate(self.names)}

    def score(self, unit):
        """What is maximised; no more than is had at the highest temperature."""
        altitude = np.broadcast_to(self.altitude[:, None], unit.shape[:2])
        found = self.outcomes(self.values(unit), altitude)
        value = np.where(self.per_area[:, None], found["payload_per_area"], found["payload"])
        within = (found["temperature"] <= self.kind.hottest) & np.isfinite(value)
        return np.where(within, value, -np.inf)

    def best(self):
        """The best designs that are found, from 0 to 1 within their bounds."""
        rng = np.random.default_rng(study.SEED)
        places, size = self.start.shape
        unit = np.broadcast_to(qmc.Sobol(size, seed=rng).random(512)[:COUNT], (places, COUNT, size))
        unit = np.concatenate([self.start[:, None], unit[:, 1:]], axis=1)
        found, top = self.start, np.full(places, -np.inf)
        for spread in (None, *np.repeat(SPREADS, 2)):
            if spread is not None:
                moved = rng.random((places, COUNT, size)) < MOVED
                unit = found[:, None] + spread * moved * rng.standard_normal((places, COUNT, size))
                unit[:, 0] = found
            unit = np.clip(unit, 0.0, 1.0)
            score = self.score(unit)
            best = np.argmax(score, axis=1)
            found, top = unit[np.arange(places), best], score.max(axis=1)
            print(f"{spread}: {np.sum(top)}", flush=True)
        return found

    def rows(self):
        """Rows of the results."""
        begun = time.perf_counter()
        found = self.best()
        free = self.values(found[:, None])
        designs = [
            {name: float(f"{value[i, 0]:.6g}") for name, value in free.items()
             if name in self.names or name in self.fixed}
            for i in range(len(found))
        ]  # fmt: skip
        samples = [self.samples(design) for design in designs]
        values = {name: np.array([one[name] for one in samples]) for name in samples[0]}
        altitude = np.broadcast_to(self.altitude[:, None], (len(found), COUNT))
        told = self.outcomes(values, altitude)
        seconds = (time.perf_counter() - begun) / len(found)
        about = {"seconds": round(seconds, 1), "of": study.fingerprint(self.kind)}
        return [
            self.row(i, case, designs[i], found[i], {name: one[i] for name, one in told.items()})
            | about
            for i, case in enumerate(self.cases)
        ]

    def samples(self, design):
        """The design, then what it may be by all ±."""
        inputs = uncertain_inputs(study.flyer_file(self.kind, design).design())
        drawn = np.vstack([inputs.values, draw(inputs, COUNT - 1, study.SEED)])
        exact = {name: np.full(COUNT, value) for name, value in design.items()}
        return exact | dict(zip(inputs.names, drawn.T, strict=True))

    def row(self, index, case, design, unit, told):
        """One row, as :func:`study.best_of` makes it."""
        setup = study.flyer_file(self.kind, design).build()
        warnings = list(diagnose_at(setup, self.altitude[index], told["temperature"][0]))
        if told["payload"][0] < 0.0:
            warnings.append(NO_LIFT)
        ends = {
            name: "low" if place < 0.5 else "high"
            for name, place in zip(self.names, unit, strict=True)
            if min(place, 1.0 - place) < AT_BOUND
        }
        found = {name: float(f"{told[name][0]:.6g}") for name in ("own_mass", *study.REPORTED)}
        found["buoyancy_share"] = float(f"{told['buoyancy_share'][0]:.4g}")
        for name in study.OBJECTIVES:
            band = np.percentile(told[name][1:], study.PERCENTILES)
            found[f"{name}_95"] = [float(f"{end:.4g}") for end in band]
        head = dict(zip(("largest_m", "objective", "altitude_km"), case, strict=True))
        return {"kind": self.kind.name, **head, "design": design, "at_bounds": ends, **found,
                "warnings": warnings}  # fmt: skip


def main():
    """Replace the rows of one kind."""
    (kind,) = (kind for kind in KINDS if kind.name == sys.argv[1])
    rows = study.read()
    known = {(row["largest_m"], row["objective"], row["altitude_km"]): row
             for row in rows if row["kind"] == kind.name}  # fmt: skip
    new = Search(kind, known).rows()
    study.write([row for row in study.read() if row["kind"] != kind.name] + new)


if __name__ == "__main__":
    main()
