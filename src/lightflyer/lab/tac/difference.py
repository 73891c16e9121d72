r"""Difference of the accommodation coefficients of two faces, measured on one bench.

The force on a flyer goes with :math:`d = \alpha_\mathrm{top} - \alpha_\mathrm{bottom}`. An error of
the gauge or the plateau moves both coefficients by nearly the same factor, so that of it only
:math:`d` times that factor remains. Runs of both faces are fitted together, each with coefficient,
area ratio and offset of its own, and with one set of the errors that all runs have in common.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Fraction, Length
from lightflyer.core.units import Measured
from lightflyer.files.result_text import Parts, table_of
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, student_factor
from lightflyer.lab.result import LabResult, Reported, Series, Shown, variables
from lightflyer.lab.tac.data import TacAccuracy, TacRun
from lightflyer.lab.tac.fit import TacFit, TacRuns, fit_together, with_spread
from lightflyer.lab.tac.preparation import (
    LU2023_HEATER_DIAMETER,
    MOST_TAC,
    POSSIBLE_TAC,
    Bench,
    cut,
)
from lightflyer.lab.tac.problem import KINETIC_LAW, AbstractHeatLaw

if TYPE_CHECKING:
    import xarray as xr

FACES = ("top", "bottom")
_APART = np.array([1.0, -1.0])  # of the coefficients, in their difference
_DIGITS = 3  # of a correlation, as it is written into flyer files
_LEAST_MISSING = 1e-6  # of a correlation to one

ONE_RUN = (
    "one run of each face does not show what a sample mounted anew changes, and no interval "
    "contains it; runs of samples mounted several times do"
)

_FACES_TABLE = ("", "value", "95 % interval", "standard uncertainty")


@dataclass(frozen=True, repr=False)
class TacDifference(LabResult):
    """Accommodation coefficients of two faces, and their difference."""

    top: tuple[TacFit, ...]  #: Runs of the top face
    bottom: tuple[TacFit, ...]  #: Runs of the bottom face
    #: Coefficient of the top less that of the bottom
    difference: Annotated[Estimate, Shown("TAC α, top less bottom")]
    tac_top: Annotated[Estimate, Shown("TAC α, top")]  #: Mean over the runs
    tac_bottom: Annotated[Estimate, Shown("TAC α, bottom")]  #: Mean over the runs
    #: Correlation of the errors of both coefficients [1], by which their standard uncertainties
    #: give that of the difference
    tac_correlation: Reported[float]
    warnings: tuple[str, ...]  #: What a reader of the result must know
    #: Coefficient of the heater's other face; None where the surface measured is on both
    other_face: Measured | None = None

    _drawing = "tac.figures:both_faces"
    _height = 4.2

    @property
    def fits(self) -> tuple[TacFit, ...]:
        """Runs of both faces, those of the top first."""
        return self.top + self.bottom

    @property
    def unshared(self) -> float:
        """Standard uncertainty that the difference had if nothing were shared [1]."""
        return math.hypot(self.tac_top.uncertainty or 0.0, self.tac_bottom.uncertainty or 0.0)

    @property
    def headline(self) -> str:
        """The difference."""
        return f"TAC α, top less bottom {self.difference}"

    def parts(self) -> Parts:
        """Difference of two faces, their coefficients, and the runs of each."""
        rows = [
            (name, f"{one.value:.4g}", one.interval_text(), f"{one.uncertainty:.2g}")
            for name, one in self.labelled().items()
        ]
        yield table_of(_FACES_TABLE, rows, left=(0, 2))
        yield (
            f"the errors of both have a correlation of {self.tac_correlation:.4g}; if they shared "
            f"nothing, the difference would be uncertain by {self.unshared:.2g}"
        )
        if self.other_face is not None:
            yield (
                "α of each run below is the mean of that of the sample and that of the heater's "
                f"other face, {self.other_face.value:g}"
            )
        for name, fits in (("top", self.top), ("bottom", self.bottom)):
            yield f"{name} face"
            for fit in fits:
                yield from fit.fit_parts()
        yield from self.fits[0].errors_parts()

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
            **self.reported(),
            "standard_uncertainty": {
                "difference": self.difference.uncertainty,
                "difference_if_nothing_were_shared": self.unshared,
                "tac_top": self.tac_top.uncertainty,
                "tac_bottom": self.tac_bottom.uncertainty,
            },
            "other_face": None if self.other_face is None else self.other_face._asdict(),
            "faces": {
                name: {fit.run.source: fit.summary() for fit in fits}
                for name, fits in zip(FACES, (self.top, self.bottom), strict=True)
            },
            "warnings": list(self.warnings),
        }

    def to_dataset(self, warnings: Sequence[str]) -> "xr.Dataset":
        """Rows of all runs, with the coefficients of both faces and their covariance."""
        record = TacRuns(self.fits).to_dataset(warnings)
        names = np.array(["top"] * len(self.top) + ["bottom"] * len(self.bottom))
        pair = self.tac_top, self.tac_bottom
        spread = np.array([one.uncertainty or 0.0 for one in pair])
        related = np.array([[1.0, self.tac_correlation], [self.tac_correlation, 1.0]])
        return record.assign(
            face_of_row=("row", names[record["run"].values], {"long_name": "face of the sample"}),
            **variables("face", [Series("tac", np.array([one.value for one in pair]), "", "TAC")]),
            **variables(("face", "other_face"), [
                Series("tac_covariance", np.outer(spread, spread) * related, "",
                       "covariance of the errors of both TACs"),
            ]),
            **variables((), [
                Series("tac_difference", self.difference.value, "",
                       "TAC of the top less of the bottom"),
                Series("tac_difference_uncertainty", self.difference.uncertainty, "",
                       "its standard uncertainty"),
            ]),
        ).assign_coords(face=["top", "bottom"], other_face=["top", "bottom"])  # fmt: skip

    def tables(self) -> dict[str, str]:
        """Fitted rows of each run, and coefficients with their difference, as CSV by file name."""
        lines = [f"# correlation of the errors of both TACs: {self.tac_correlation:.6g}"]
        lines.append("quantity,value,lower 95 %,upper 95 %,standard uncertainty")
        for name in ("tac_top", "tac_bottom", "difference"):
            one: Estimate = getattr(self, name)
            numbers = one.value, *one.interval, one.uncertainty or 0.0
            lines.append(",".join([name, *(f"{number:.8g}" for number in numbers)]))
        return TacRuns(self.fits).tables() | {"tac-difference.csv": "\n".join(lines) + "\n"}


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
    other_face: Measured | None = None,
) -> TacDifference:
    r"""Fit runs of two faces together, and find the difference of their coefficients.

    Parameters
    ----------
    top, bottom : TacRun or sequence of TacRun
        Runs of the surface of either face, all with one heater, gauge and chamber.
    diameter, tolerance, emissivity, law, gas, accuracy
        As of :func:`~lightflyer.lab.fit_tac`, of all runs.
    other_face : Measured, optional
        Coefficient of the heater's other face with its standard uncertainty, where the sample
        covers one face only [1]; by default the surface measured is on both.

    Returns
    -------
    TacDifference

    Raises
    ------
    ParameterError
        If a face has no run, or an argument is impossible.
    ConfigurationError, ConvergenceError
        As of :func:`~lightflyer.lab.fit_tac`.

    Notes
    -----
    Least squares over the rows of all runs. Each run has three parameters of its own, and the
    errors that all rows have in common are unknowns that the runs share, each with a normal prior
    of its accuracy. So the gauge's zero must not drift between runs. Scatter, and a quarter of the
    law's error of shape, are those of each run and do not cancel.

    Runs :math:`i` of a face are averaged by :math:`w_i=1/u_i^2` of their scatter. Where runs of a
    face differ by more than that, :math:`Q=\sum w_i(\alpha_i-\bar\alpha)^2` over both faces with
    :math:`\nu` degrees of freedom widens all :math:`u_i` by Student's factor times
    :math:`\sqrt{Q/\nu}` over 1.96: two mountings of a sample then differ by more than rows do.

    A heater that the sample covers on one face loses heat by the mean of its faces'
    coefficients, :math:`\alpha=(\alpha_\mathrm{sample}+\alpha_\mathrm{other})/2`. The other face
    drops out of the difference, which is twice that of the runs.

    References
    ----------
    [Lu2023]_ supplement, Eqs. (3)-(14).
    """
    faces = [[one] if isinstance(one, TacRun) else [*one] for one in (top, bottom)]
    for name, runs in zip(FACES, faces, strict=True):
        if not runs:
            raise ParameterError(f"{name} has no run; give one or more of each face")
    if other_face is not None:
        require_range("other_face", other_face.value, 0.0, POSSIBLE_TAC)
    bench = Bench(diameter, tolerance, emissivity, law, gas, accuracy or TacAccuracy())
    fits, covariance = fit_together([*faces[0], *faces[1]], bench)
    of_top, of_bottom = tuple(fits[: len(faces[0])]), tuple(fits[len(faces[0]) :])
    means, joint = _means(of_top, of_bottom, covariance)
    if other_face is not None:  # the means are those of sample and heater
        means = 2.0 * means - other_face.value
        joint = 4.0 * joint + (other_face.uncertainty or 0.0) ** 2
        for name, value in zip(FACES, means, strict=True):
            if not 0.0 < value <= MOST_TAC:
                raise ConfigurationError(
                    f"the {name} face would have a coefficient of {value:.3g}, which is "
                    f"impossible, beside {other_face.value:g} of the heater's other face; does the "
                    "sample cover one face only?"
                )
    found = []
    for side, mean, variance in zip((of_top, of_bottom), means, np.diag(joint), strict=True):
        one = Estimate.covering(float(mean), NORMAL_FACTOR * math.sqrt(variance))
        if len(side) == 1 and other_face is None:  # has its profile interval
            one = Estimate(one.value, side[0].tac.interval, "", math.sqrt(variance))
        else:
            one = cut({"tac": one})[0]["tac"]
        found.append(one)
    tac_top, tac_bottom = found
    apart = float(np.sqrt(_APART @ joint @ _APART))
    spreads = (tac_top.uncertainty or 0.0) * (tac_bottom.uncertainty or 0.0)
    alone = [ONE_RUN] if len(fits) == len(faces) else []
    return TacDifference(
        top=of_top, bottom=of_bottom, tac_top=tac_top, tac_bottom=tac_bottom,
        difference=Estimate.covering(float(_APART @ means), NORMAL_FACTOR * apart),
        tac_correlation=float(joint[0, 1] / spreads) if spreads else 0.0,
        warnings=(*TacRuns(fits).warnings, *alone), other_face=other_face,
    )  # fmt: skip


def _means(
    top: Sequence[TacFit], bottom: Sequence[TacFit], covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean coefficients of both faces, shape (2,), and their covariance, shape (2, 2).

    ``covariance``: total one of all runs' coefficients, shape (n, n).
    """
    fits = [*top, *bottom]
    values = np.array([fit.tac.value for fit in fits])
    by_rows = [with_spread(fit.statistical["tac"]) for fit in fits]
    # uncertainties that carry Student's interval of the rows' scatter on
    half = 0.5 * np.array([np.ptp(one.interval) for one in by_rows])
    spreads = np.maximum(half / NORMAL_FACTOR, [one.uncertainty or 0.0 for one in by_rows])
    face = np.repeat(np.eye(2), [len(top), len(bottom)], axis=1)
    precision = face / spreads**2
    weights = precision / precision.sum(axis=1, keepdims=True)
    means = weights @ values
    freedom = len(fits) - len(FACES)
    wider = 1.0
    if freedom:
        scatter = float(np.sum(((values - means @ face) / spreads) ** 2)) / freedom
        wider = max((student_factor(freedom) / NORMAL_FACTOR) ** 2 * scatter, 1.0)
    rows = np.diag([one.uncertainty or 0.0 for one in by_rows]) ** 2
    shared = weights @ (covariance - rows) @ weights.T
    return means, np.diag(wider / precision.sum(axis=1)) + shared
