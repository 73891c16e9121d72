r"""Which one number brings a flight to a measured track: its mass, or a wind upwards.

The number minimises the mean square of the altitudes' residuals, of flights in the wind that the
track shows, so that they are where the track is. The residuals stay alike for some time, so
that :math:`n` of them are worth fewer that are independent,

.. math::
    n' = \min\left(\frac nm\,\frac{1 - \rho}{1 + \rho}, \frac{n}{1 + 2\sum_k \rho_k}\right)

for the residuals' autocorrelations :math:`\rho_k` up to where they first fall below zero. With
:math:`m`, where they first fall below one half, :math:`\rho = \rho_m + (1 + 4\rho_m)\,m/n` is
without the error of a short series [Kendall1954]_. The number's interval is Student's with
:math:`n' - 1` degrees of freedom.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.core.progress import asked_to_end, report
from lightflyer.mission.path.dynamics import follow
from lightflyer.mission.path.integration import Accuracy, Limits, Start
from lightflyer.mission.path.motion import Craft

TELLING = 6.0
"""Twice the logarithm of a ratio of likelihoods above which one explanation is preferred; strong
evidence on the scale of [KassRaftery1995]_."""

_TOLERANCE = 1e-7  # of the flights tried; metres at the end of days
_STEP = 3e-3  # of the number, for its derivative
_CLOSE = 1e-5  # of the number and of the mean square, relative: where the search ends
_EVEN = 4096  # moments, at most, of the autocorrelation
_UPPER = 0.975  # of a 95 % interval
_LEAST = 5.0  # rms below which residuals are those of receivers and of the integration [m]


class Explanation(NamedTuple):
    """One number, and what it leaves."""

    value: float
    low: float  # Ends of its 95 % interval
    high: float
    rms: float  # Root mean square of the residuals that are left [m]
    effect: np.ndarray  # By how much it changes the altitude at each fix [m]
    independent: float  # Number of independent residuals
    at_end: bool  # Whether it lies at an end of what was searched


class Question(NamedTuple):
    """Altitudes that a flight should have had."""

    craft: Craft  # In the wind of the track
    start: Start
    limits: Limits
    elapsed: np.ndarray  # shape (n,); of the fixes [s]
    altitude: np.ndarray  # shape (n,); measured [m]
    duration: float  # Of the flight [s]

    def flown(self, craft: Craft) -> np.ndarray:
        """Altitudes of a flight at the fixes [m]; after its end, that of its end."""
        accuracy = Accuracy.for_duration(self.duration, _TOLERANCE)
        _, way = follow(craft, self.start, self.limits, np.array([0.0, self.duration]), accuracy)
        return way(np.minimum(self.elapsed, way.times[-1]))[0]


class _Number(NamedTuple):
    """A number that is searched, as one near 1."""

    name: str
    scale: float  # Its unit over that of the searched number
    first: tuple[float, ...]  # Looks before the search
    ends: tuple[float, float]
    apply: Callable[[Craft, float], Craft]  # Craft for its value


def with_mass(craft: Craft, added: float) -> Craft:
    """A craft that weighs more by a mass [kg]."""
    # not by its constructor: a mass may be taken away from a flyer without payload
    payload = np.asarray(craft.setup.flyer.payload, float) + added
    return tree.replace_at(lambda one: one.setup.flyer.payload, craft, payload)


def with_vertical_wind(craft: Craft, upwards: float) -> Craft:
    """A craft in the wind of a track, stronger upwards by a speed [m/s]."""
    return tree.replace_at(lambda one: one.wind_error.upwards, craft, upwards)


def explain(question: Question, stated: np.ndarray) -> dict[str, Explanation] | None:
    """Mass [kg] and vertical wind [m/s] that explain a track best; None where interrupted.

    ``stated``: altitudes of the flight as it is stated [m], shape (n,).
    """
    numbers = (
        _Number(
            "mass",
            float(np.asarray(question.craft.setup.flyer.mass)),
            (0.8, 0.9, 1.1, 1.25),
            (0.05, 20.0),
            with_mass,
        ),
        _Number("vertical_wind", 1.0, (0.8, 0.95, 1.05, 1.2), (-9.0, 11.0), with_vertical_wind),
    )
    found: dict[str, Explanation] = {}
    for number in numbers:
        found[number.name] = _fit(question, number, stated)
        if asked_to_end():
            return None
    return found


def _fit(question: Question, number: _Number, stated: np.ndarray) -> Explanation:
    from scipy.optimize import least_squares

    weights = weights_of(question.elapsed)
    said = f"looking for the {number.name.replace('_', ' ')} that explains the track"
    tried: dict[float, np.ndarray] = {1.0: stated}

    def altitude(x: float) -> np.ndarray:
        if x not in tried:
            report(said, len(tried), None)
            value = (x - 1.0) * number.scale
            tried[x] = question.flown(number.apply(question.craft, value))
        return tried[x]

    def residuals(x: Any) -> np.ndarray:
        (one,) = x
        return np.sqrt(weights) * (question.altitude - altitude(float(one)))

    begin = min((1.0, *number.first), key=lambda x: float(np.sum(residuals([x]) ** 2)))
    best = least_squares(
        residuals, [begin], bounds=tuple([end] for end in number.ends), diff_step=_STEP,
        ftol=_CLOSE, xtol=_CLOSE, gtol=None,
    )  # fmt: skip
    (x,), left = best.x, question.altitude - altitude(float(best.x[0]))
    half, independent = interval_half_width(
        question.elapsed, left, best.jac[:, 0] / np.sqrt(weights), weights
    )
    value = (x - 1.0) * number.scale
    return Explanation(
        value, value - half * number.scale, value + half * number.scale,
        rms_of(left, weights), altitude(float(x)) - stated, independent,
        bool(best.active_mask.any()),
    )  # fmt: skip


def weights_of(times: np.ndarray) -> np.ndarray:
    """Shares of time for which fixes stand, shape (n,); a gap counts as its ends do."""
    apart = np.diff(times)
    apart = np.minimum(apart, 10.0 * np.median(apart))
    lasted = 0.5 * (np.append(apart, 0.0) + np.append(0.0, apart))
    return np.asarray(lasted / lasted.sum())


def rms_of(values: np.ndarray, weights: np.ndarray) -> float:
    """Root mean square of values that have weights."""
    return float(np.sqrt(np.sum(weights * values**2)))


def interval_half_width(
    times: np.ndarray, left: np.ndarray, slope: np.ndarray, weights: np.ndarray
) -> tuple[float, float]:
    """Half of the 95 % interval of a fitted number, and the number of independent residuals.

    ``left``: residuals of the fit (n,); ``slope``: change of the model per unit of the number (n,).
    """
    from scipy.special import stdtrit

    independent = independent_number(times, left)
    freedom = max(independent - 1.0, 1.0)
    strength = float(np.sum(weights * slope**2))
    if strength == 0.0:
        return np.inf, independent
    variance = rms_of(left, weights) ** 2 / (freedom * strength)
    return float(stdtrit(freedom, _UPPER) * np.sqrt(variance)), independent


def independent_number(times: np.ndarray, values: np.ndarray) -> float:
    """How many independent values a series is worth whose neighbours are alike; at least one."""
    count = min(_EVEN, times.size)
    series = np.interp(np.linspace(times[0], times[-1], count), times, values)
    series = series - series.mean()
    if not series.any():
        return float(count)
    spectrum = np.abs(np.fft.rfft(series, 2 * count)) ** 2
    correlation = np.fft.irfft(spectrum)[:count]
    correlation /= correlation[0]
    half, zero = (
        max(int(np.argmax(correlation < level)), 1) if (correlation < level).any() else count - 1
        for level in (0.5, 0.0)
    )
    of_all = 1.0 + 2.0 * float(correlation[1:zero].sum())
    alike = float(correlation[half])
    alike = min(max(alike + (1.0 + 4.0 * alike) * half / count, 0.0), 1.0 - 1.0 / count)
    return max(count / max((1.0 + alike) / (1.0 - alike) * half, of_all), 1.0)


def evidence(worse: float, better: float, independent: float) -> float:
    """Twice the logarithm of a ratio of likelihoods; of root mean squares [m]."""
    return 2.0 * independent * float(np.log(max(worse, _LEAST) / max(better, _LEAST)))


def alikeness(effects: Sequence[np.ndarray], weights: np.ndarray) -> float:
    """Correlation of two effects on a track, 1 where they cannot be told apart."""
    first, second = effects
    sizes = rms_of(first, weights) * rms_of(second, weights)
    return float(np.sum(weights * first * second) / sizes) if sizes > 0.0 else np.nan
