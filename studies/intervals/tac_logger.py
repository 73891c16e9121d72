"""``lab tac`` of a logger's many rows: cases of :mod:`tac`, which take seconds each."""

import numpy as np
from tac import Condition, errors_of, run_of
from trial import Trial

import lightflyer as lf

COMMAND = "lab tac, 50,000 rows"

_USUAL = (1e-3, 200.0, 50_000, 0.05, 0.01)
CONDITIONS = {
    "the law": Condition(*_USUAL),
    "Sherman's law": Condition(*_USUAL, "Sherman"),
    "drift not stated": Condition(*_USUAL, drift=0.05, stated=False),
}
_FIRST_SEED = 9


def trials(seed):
    """Intervals of one run under each condition."""
    found = []
    for number, (name, condition) in enumerate(CONDITIONS.items(), _FIRST_SEED):
        rng = np.random.default_rng([seed, number])
        run, truth = run_of(rng, condition, errors_of(rng, condition))
        fit = lf.lab.fit_tac(run, accuracy=condition.accuracy())
        truth["slope"] = truth["tac"] * truth["area_ratio"]
        for parameter, one in (fit.estimates() | {"slope": fit.slope}).items():
            found.append(Trial(f"{parameter}, {name}", truth[parameter], *one.interval))
    return found
