"""``lab tac`` of a logger's many rows: cases of :mod:`tac`, which take seconds each."""

import numpy as np
from tac import Condition, run_of
from trial import Trial

import lightflyer as lf

COMMAND = "lab tac, 50,000 rows"

_USUAL = (1e-3, 200.0, 50_000, 0.05, 0.01)
CONDITIONS = {
    "the law": Condition(*_USUAL),
    "Sherman's law": Condition(*_USUAL, in_series=True),
    "plateau drifts": Condition(*_USUAL, drift=1.0),
}
_FIRST_SEED = 9


def trials(seed):
    """Intervals of one run under each condition."""
    found = []
    for number, (name, condition) in enumerate(CONDITIONS.items(), _FIRST_SEED):
        accuracy = lf.lab.TacAccuracy(gauge=condition.gauge, gauge_zero=condition.zero)
        run, truth = run_of(np.random.default_rng([seed, number]), condition, accuracy)
        fit = lf.lab.fit_tac(run, accuracy=accuracy)
        truth["slope"] = truth["tac"] * truth["area_ratio"]
        for parameter, one in (fit.estimates() | {"slope": fit.slope}).items():
            found.append(Trial(f"{parameter}, {name}", truth[parameter], *one.interval))
    return found
