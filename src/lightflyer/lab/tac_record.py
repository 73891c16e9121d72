"""Records of fitted accommodation coefficients: the JSON object and the dataset."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.lab.estimate import Estimate, weighted_mean
from lightflyer.lab.record import dataset
from lightflyer.lab.tac import TacFit
from lightflyer.lab.tac_problem import PARAMETERS

if TYPE_CHECKING:
    import xarray as xr


def mean_tac(fits: Sequence[TacFit]) -> Estimate:
    """Mean accommodation coefficient of several runs.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    Estimate
        See :func:`~lightflyer.lab.estimate.weighted_mean`.
    """
    return weighted_mean([fit.tac for fit in fits])


def summary(fits: Sequence[TacFit]) -> dict[str, Any]:
    """One run, or the mean of several with each of them, as a JSON object.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    dict
    """
    if len(fits) == 1:
        return fits[0].summary()
    return {
        **{
            name: weighted_mean([fit.estimates()[name] for fit in fits]).to_json()
            for name in PARAMETERS
        },
        "rows_used": sum(fit.rows_used for fit in fits),
        "rows_dropped": sum(fit.rows_dropped for fit in fits),
        "runs": {fit.run.source: fit.summary() for fit in fits},
    }


def to_dataset(fits: Sequence[TacFit]) -> "xr.Dataset":
    """Measured and fitted rows of all runs.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    xarray.Dataset
        Over ``row``; ``run`` is the position of the file in the attribute ``files``.
    """
    per_area = "W m-2 K-1"

    def joined(values: Sequence[np.ndarray], units: str, long_name: str) -> Any:
        return "row", np.concatenate(values), {"units": units, "long_name": long_name}

    run = [np.full(fit.rows_used, number) for number, fit in enumerate(fits)]
    return dataset(
        "thermal accommodation coefficient",
        {
            "run": joined(run, "1", "position of the file, from 0"),
            "line": joined([fit.run.table.lines[fit.kept] for fit in fits], "1", "line in it"),
            "pressure": joined([fit.pressure for fit in fits], "Pa", "gas pressure"),
            "conductance": joined(
                [fit.conductance for fit in fits], per_area,
                "power per nominal area and temperature difference",
            ),
            "fitted": joined([fit.fitted for fit in fits], per_area, "fitted conductance"),
        },
        [fit.run.source for fit in fits],
    )  # fmt: skip
