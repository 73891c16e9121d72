"""Light that was raised in steps until a sample lifted off.

The irradiance noted is the first one with levitation. The one that suffices lies anywhere between
it and the step before, so on average half a step lower.
"""

import math

import numpy as np

from lightflyer.core.errors import ParameterError

CENTRE = 0.5  # Distance of the middle of a step from its upper end, in steps

UNIFORM_SPREAD = 1.0 / math.sqrt(12.0)
"""Standard deviation of a number that may lie anywhere within a step, in steps."""

NOTICED = 0.01  # Step, over the least irradiance, from which :func:`found_step` looks for one

_OFF = 0.02  # distance from the nearest step up to which a value lies on it, in steps
_LEAST_VALUES = 3  # different values that show steps
_MOST_PARTS = 5  # of the least difference of two values that are tried as a step
_MOST_CHANCE = 1e-3  # probability that values without steps would lie so


def require_step(step: float, irradiance: np.ndarray, place: str = "") -> None:
    """Raise :class:`ParameterError` unless a step of the light is possible; ``irradiance`` (n,)."""
    start = f"{place}: " if place else ""
    if not 0.0 <= step < math.inf:
        raise ParameterError(f"{start}step = {step:g} W/m^2 is not zero or positive")
    if step >= np.min(irradiance):
        raise ParameterError(
            f"{start}step = {step:g} W/m^2 is not smaller than the least irradiance, "
            f"{np.min(irradiance):g} W/m^2"
        )


def found_step(irradiance: np.ndarray) -> float | None:
    """Step of the light that measured irradiances show, if any.

    Parameters
    ----------
    irradiance : array, shape (n,)
        [W/m²].

    Returns
    -------
    float or None
        The largest step on whose multiples all values lie [W/m²]; None where there is none of at
        least :data:`NOTICED` times the least irradiance, or where it may be chance.

    Examples
    --------
    >>> found_step(np.array([1000.0, 1200.0, 1800.0, 2600.0, 1000.0]))
    200.0
    """
    values = np.unique(irradiance)
    if values.size < _LEAST_VALUES:
        return None
    differences = np.diff(values)
    # the step is chosen by one difference; each other point could lie anywhere
    chance = _MOST_PARTS * (2.0 * _OFF) ** (np.size(irradiance) - 2)
    if chance > _MOST_CHANCE:
        return None
    for parts in range(1, _MOST_PARTS + 1):
        step = float(differences.min()) / parts
        if step < NOTICED * values[0]:
            return None
        counts = np.round(differences / step)
        off = np.abs(differences - counts * step)
        if np.all(off <= _OFF * step):
            return float(f"{differences.sum() / counts.sum():.6g}")
    return None
