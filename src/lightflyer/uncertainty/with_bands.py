"""A prediction with its bands: what ``lightflyer predict`` prints."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from lightflyer.config.designs import as_design
from lightflyer.design.design import AbstractDesign
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.environment.section import warn_of_kilometres
from lightflyer.force.base import AbstractForceModel
from lightflyer.prediction.prediction import Prediction, predict_design
from lightflyer.uncertainty.propagation import (
    DEFAULT_SAMPLES,
    propagate,
    require_samples,
)


def predict(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    at: Sequence[float] | None = None,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
) -> Prediction:
    """Predict what a flyer does in its environment, with 95 % bands.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path or AbstractDesign
        One flyer: every number a scalar.
    environment, model : optional
        Where ``what`` is a flyer.
    at : sequence of float, optional
        Altitudes [m] or, in a chamber, pressures [Pa] to report one by one.
    samples : int
        Of Monte Carlo, for the bands; 0 leaves these out.
    seed : int
        Of the random numbers: the same seed gives the same samples.

    Returns
    -------
    Prediction
        Prints as ``lightflyer predict`` does. Its bands, ``uncertainty``, are computed when it is
        first printed, drawn or summed up, or they are asked for.

    Raises
    ------
    ParameterError
        If an altitude or pressure is outside the environment's range, or the model is not for the
        flyer or the gas, or ``samples`` is neither zero nor at least 100.
    ConvergenceError
        If a heat balance has not converged.

    Notes
    -----
    The bands are from every ± of a flyer file or an
    :class:`~lightflyer.design.design.ObjectDesign`, and from the force model's own errors, unless
    they are stated.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> found = lf.predict(lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023())
    >>> [f"{edge / 1e3:.2f} km" for edge in found.bands[0]]
    ['68.02 km', '78.05 km']
    >>> [f"{edge:.0f} km" for edge in found.uncertainty.bands["altitude_band_km.lower"]]
    ['66 km', '71 km']
    """
    design = as_design(what, environment, model)
    if design.setup.environment.coordinate.name == "altitude":
        warn_of_kilometres(at)
    return predict_with_bands(design, at, samples, seed) if samples else predict_design(design, at)


def predict_with_bands(
    design: AbstractDesign, at: Sequence[float] | None, samples: int, seed: int
) -> Prediction:
    """A prediction whose bands are computed when asked for; to first order without samples."""
    require_samples(samples, seed)
    bands = partial(propagate, design.with_open_errors(), samples=samples, seed=seed)
    return replace(predict_design(design, at), propagate=bands)
