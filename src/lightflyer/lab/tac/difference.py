r"""Difference of the accommodation coefficients of two faces, measured on one bench.

The force on a flyer goes with :math:`d = \alpha_\mathrm{top} - \alpha_\mathrm{bottom}`. An error of
the gauge or the plateau moves both coefficients by nearly the same factor, so that of it only
:math:`d` times that factor remains. Runs of both faces are fitted together, each with coefficient,
area ratio and offset of its own, and with one set of the errors that all runs have in common.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Fraction, Length
from lightflyer.files.result_text import Parts, PrintedResult, warning_lines
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, weighted_mean
from lightflyer.lab.tac.accuracy import TacAccuracy
from lightflyer.lab.tac.data import TacRun
from lightflyer.lab.tac.fit import TacFit, fit_together
from lightflyer.lab.tac.heat_law import KINETIC_LAW, AbstractHeatLaw
from lightflyer.lab.tac.preparation import LU2023_HEATER_DIAMETER, Bench
from lightflyer.lab.tac.record import mean_tac, summary, warnings_of, with_spread
from lightflyer.program.arguments import reads_units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FACES = ("top", "bottom")
_DIGITS = 3  # of a correlation, as it is written into flyer files
_LEAST_MISSING = 1e-6  # of a correlation to one

ONE_RUN = (
    "one run of a face does not show what a sample mounted anew changes, and no interval contains "
    "it; two runs of each face or more do"
)


@dataclass(frozen=True, repr=False)
class TacDifference(PrintedResult):
    """Accommodation coefficients of two faces, and their difference."""

    top: tuple[TacFit, ...]  #: Runs of the top face
    bottom: tuple[TacFit, ...]  #: Runs of the bottom face
    tac_top: Estimate  #: Mean over the runs
    tac_bottom: Estimate  #: Mean over the runs
    difference: Estimate  #: Coefficient of the top less that of the bottom
    warnings: tuple[str, ...]  #: What a reader of the result must know

    @property
    def fits(self) -> tuple[TacFit, ...]:
        """Runs of both faces, those of the top first."""
        return self.top + self.bottom

    @property
    def tac_correlation(self) -> float:
        """Correlation of the errors of both coefficients [1].

        With their standard uncertainties it gives that of the difference.
        """
        top, bottom, apart = (
            one.uncertainty or 0.0 for one in (self.tac_top, self.tac_bottom, self.difference)
        )
        if not top * bottom:
            return 0.0
        return min(max((top**2 + bottom**2 - apart**2) / (2.0 * top * bottom), -1.0), 1.0)

    @property
    def unshared(self) -> float:
        """Standard uncertainty that the difference had if nothing were shared [1]."""
        return math.hypot(self.tac_top.uncertainty or 0.0, self.tac_bottom.uncertainty or 0.0)

    def text_parts(self) -> Parts:
        from lightflyer.lab.tac.text import difference_parts

        yield from difference_parts(self)
        yield from warning_lines(self.warnings)

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the runs of both faces with their fits, and what is known of both coefficients."""
        from lightflyer.lab.tac.figures import plot_difference

        return plot_difference(self, ax)

    def film_values(self) -> dict[tuple[str, str], Estimate]:
        """What a flyer file's film has of it, by section and key."""
        related = self.tac_correlation
        # digits of what is missing to one: the difference's uncertainty goes with that
        missing = max(1.0 - abs(related), _LEAST_MISSING)
        rounded = round(related, _DIGITS - 1 - math.floor(math.log10(missing)))
        return {
            ("film", "tac_top"): self.tac_top,
            ("film", "tac_bottom"): self.tac_bottom,
            ("film", "tac_correlation"): Estimate(rounded, (rounded, rounded)),
        }

    def summary(self) -> dict[str, Any]:
        """Both coefficients, their difference and every run as a JSON object."""
        return {
            "difference": self.difference.to_json(),
            "tac_top": self.tac_top.to_json(),
            "tac_bottom": self.tac_bottom.to_json(),
            "standard_uncertainty": {
                "difference": self.difference.uncertainty,
                "difference_if_nothing_were_shared": self.unshared,
                "tac_top": self.tac_top.uncertainty,
                "tac_bottom": self.tac_bottom.uncertainty,
            },
            "tac_correlation": self.tac_correlation,
            "faces": {"top": summary(self.top), "bottom": summary(self.bottom)},
            "warnings": list(self.warnings),
        }


@reads_units
def fit_tac_difference(
    top: TacRun | Sequence[TacRun],
    bottom: TacRun | Sequence[TacRun],
    *,
    diameter: Length = LU2023_HEATER_DIAMETER,
    tolerance: float = 1.0,
    emissivity: Fraction | None = None,
    law: AbstractHeatLaw = KINETIC_LAW,
    gas: AbstractGas = AIR,
    accuracy: TacAccuracy | None = None,
) -> TacDifference:
    r"""Fit runs of two faces together, and find the difference of their coefficients.

    Parameters
    ----------
    top, bottom : TacRun or sequence of TacRun
        Runs of the surface of either face, all with one heater, gauge and chamber.
    diameter, tolerance, emissivity, law, gas, accuracy
        As of :func:`~lightflyer.lab.fit_tac`, of all runs.

    Returns
    -------
    TacDifference

    Raises
    ------
    ParameterError
        If a face has no run, or an argument is impossible.
    ConfigurationError, ConvergenceError, MissingExtraError
        As of :func:`~lightflyer.lab.fit_tac`.

    Notes
    -----
    Least squares over the rows of all runs. Each run has three parameters of its own, and the
    errors that all rows have in common are unknowns that the runs share, each with a normal prior
    of its accuracy. So the gauge's zero must not drift between runs. Scatter, and an error of the
    law's shape, are those of each run and do not cancel. The variance between several runs of a
    face counts as in :func:`~lightflyer.lab.weighted_mean`.

    References
    ----------
    [Lu2023]_ supplement, Eqs. (3)-(14).
    """
    faces = [[one] if isinstance(one, TacRun) else [*one] for one in (top, bottom)]
    for name, runs in zip(FACES, faces, strict=True):
        if not runs:
            raise ParameterError(f"{name} has no run; give one or more of each face")
    bench = Bench(diameter, tolerance, emissivity, law, gas, accuracy or TacAccuracy())
    fits, covariance = fit_together([*faces[0], *faces[1]], bench)
    of_top, of_bottom = tuple(fits[: len(faces[0])]), tuple(fits[len(faces[0]) :])
    tac_top, tac_bottom = mean_tac(of_top), mean_tac(of_bottom)
    spread = _spread(of_top, of_bottom, covariance)
    alone = [ONE_RUN] if min(len(of_top), len(of_bottom)) == 1 else []
    return TacDifference(
        top=of_top,
        bottom=of_bottom,
        tac_top=tac_top,
        tac_bottom=tac_bottom,
        difference=Estimate.covering(tac_top.value - tac_bottom.value, NORMAL_FACTOR * spread),
        warnings=(*warnings_of(fits), *alone),
    )


def _spread(top: Sequence[TacFit], bottom: Sequence[TacFit], covariance: np.ndarray) -> float:
    """Standard uncertainty of the difference, that of the normal distribution with its interval.

    ``covariance``: total one of all runs' coefficients, shape (n, n).
    """
    fits = [*top, *bottom]
    scatter = np.array([fit.statistical["tac"].uncertainty for fit in fits], float)
    weights = np.repeat([1.0 / len(top), -1.0 / len(bottom)], [len(top), len(bottom)])
    shared = float(weights @ (covariance - np.diag(scatter**2)) @ weights)
    own = sum(_of_scatter(side) ** 2 for side in (top, bottom))
    return math.sqrt(own + max(shared, 0.0))


def _of_scatter(fits: Sequence[TacFit]) -> float:
    """Standard uncertainty of a face's mean by the scatter of rows and of runs [1]."""
    estimates = [with_spread(fit.statistical["tac"]) for fit in fits]
    if len(estimates) > 1:
        return weighted_mean(estimates).uncertainty or 0.0
    low, high = estimates[0].interval
    return 0.5 * (high - low) / NORMAL_FACTOR
