"""The uncertain numbers of a flyer file, and what they move."""

from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from lightflyer.config.sections import FlyerFile, Setup, quantity_of
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.units import Measured
from lightflyer.uncertainty.correlation import FACES

_STEP = 1e-3  # relative; setups are linear in their inputs, so any step is exact
_MOST_DRAWS = 1000

NOT_PROPAGATED = frozenset(
    {
        "altitude_min",
        "altitude_max",
        "pressure_min",
        "pressure_max",
        "latitude",
        "longitude",
        "f107",
        "f107a",
        "ap",
        "tac_correlation",
    }
)
"""Fields that say where to search, what an atmosphere's table is built from, or how the errors
of others are correlated."""

_LAYERS = "film.layers"  # thickness and density of layers: kept with the data, not propagated


@dataclass(frozen=True)
class Inputs:
    """The uncertain numbers of a flyer file.

    Attributes
    ----------
    names : list of str
        Dotted, as ``"film.tac_top"``.
    values, spreads : array, shape (k,)
        In the units of the configuration: SI, angles in degrees.
    correlation : array, shape (k, k)
    ranges : array, shape (k, 2)
        Possible values.
    setup : tuple of flyer, environment and model
    slopes : list of such tuples, length k
        Derivative of the setup's numbers in each input.
    """

    names: list[str]
    values: np.ndarray
    spreads: np.ndarray
    correlation: np.ndarray
    ranges: np.ndarray
    setup: Any
    slopes: list[Any]

    @property
    def covariance(self) -> np.ndarray:
        """Of the inputs, shape (k, k)."""
        return self.correlation * np.outer(self.spreads, self.spreads)

    @property
    def tac_correlation(self) -> float | None:
        """Of the errors of the faces' TACs, or None where not both are uncertain."""
        if not set(FACES) <= set(self.names):
            return None
        first, second = (self.names.index(face) for face in FACES)
        return float(self.correlation[first, second])


def uncertain_inputs(configuration: FlyerFile) -> Inputs | None:
    """The uncertain numbers of a flyer file that a prediction depends on.

    Parameters
    ----------
    configuration : FlyerFile

    Returns
    -------
    Inputs or None
        None where nothing that can be propagated has a ±.
    """
    stated = {
        name: spread
        for name, spread in configuration.uncertainties().items()
        if spread > 0.0
        and name.rpartition(".")[2] not in NOT_PROPAGATED
        and not name.startswith(_LAYERS)
    }
    if not stated:
        return None
    names = list(stated)
    fields = [_field(configuration, name) for name in names]
    correlation = np.eye(len(names))
    if set(FACES) <= set(names):
        first, second = (names.index(face) for face in FACES)
        shared = configuration.film.tac_correlation.value
        correlation[first, second] = correlation[second, first] = shared
    base = _parts(configuration.build())
    return Inputs(
        names=names,
        values=np.array([value for value, _, _ in fields]),
        spreads=np.array(list(stated.values())),
        correlation=correlation,
        ranges=np.array([[lowest, highest] for _, lowest, highest in fields]),
        setup=base,
        slopes=[
            _slope(configuration, base, name, value, stated[name])
            for name, (value, _, _) in zip(names, fields, strict=True)
        ],
    )


def _field(configuration: FlyerFile, name: str) -> tuple[float, float, float]:
    """Value and range of a field."""
    section, _, key = name.rpartition(".")
    part = getattr(configuration, section)
    quantity = quantity_of(type(part), key)
    return getattr(part, key).value, quantity.lowest, quantity.highest


def _parts(setup: Setup) -> Any:
    return jax.tree.map(
        lambda leaf: np.asarray(leaf, float), (setup.flyer, setup.environment, setup.model)
    )


def _slope(configuration: FlyerFile, base: Any, name: str, value: float, spread: float) -> Any:
    """Derivative of the setup's numbers in one input."""
    section, _, key = name.rpartition(".")
    # towards zero, which no upper limit forbids; from zero upwards
    step = -_STEP * value if value else _STEP * spread
    moved = getattr(configuration, section).model_copy(update={key: Measured(value + step)})
    setup = _parts(configuration.model_copy(update={section: moved}).build())
    return jax.tree.map(lambda there, here: (there - here) / step, setup, base)


def draw(inputs: Inputs, samples: int, seed: int) -> np.ndarray:
    """Draw inputs from a normal distribution, redrawing the impossible.

    Parameters
    ----------
    inputs : Inputs
    samples, seed : int

    Returns
    -------
    array, shape (samples, k)

    Raises
    ------
    ParameterError
        If nearly every draw is impossible.
    """
    generator = np.random.default_rng(seed)
    drawn = np.empty((0, inputs.values.size))
    for _ in range(_MOST_DRAWS):
        more = generator.multivariate_normal(inputs.values, inputs.covariance, samples)
        inside = (more > inputs.ranges[:, 0]) & (more < inputs.ranges[:, 1])
        drawn = np.concatenate([drawn, more[np.all(inside, axis=1)]])
        if len(drawn) >= samples:
            return drawn[:samples]
    raise ParameterError(
        f"the uncertainties of {', '.join(inputs.names)} make nearly every sample impossible"
    )
