"""The paper's two coefficients that come closest to another force model."""

from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.core.errors import ParameterError
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.lu2023 import REPORTED, Lu2023, Reading


class SimpleForm(NamedTuple):
    """The interpolation of Lu et al. with coefficients fitted to another model."""

    model: Lu2023
    deviation: float  #: Root mean square of the logarithm of its force over the other model's [1]
    largest: float  #: Largest absolute value of that logarithm [1]


def fit_simple_form(
    model: AbstractForceModel,
    flyer: Disk,
    state: EnvironmentState,
    excess: Numeric,
    reading: Reading = REPORTED,
) -> SimpleForm:
    """Fit the coefficients of Lu et al. to the force of another model.

    Parameters
    ----------
    model : AbstractForceModel
        The model to imitate.
    flyer : Disk
    state : EnvironmentState
        Surroundings in which the forces shall agree: arrays, at least two points.
    excess : array, shape (...)
        Relative temperature excess there [1].
    reading : Reading
        Default :data:`lightflyer.force.REPORTED`.

    Returns
    -------
    SimpleForm
        Least squares in the logarithm of the force.

    Raises
    ------
    ParameterError
        If there are fewer than two forces, or one is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> state = lf.Chamber().state(np.geomspace(0.1, 100.0, 20))
    >>> same = lf.force.fit_simple_form(lf.Lu2023(0.7, 2.0), lf.Disk(film, 0.01), state, 0.5)
    >>> print(f"{same.model.c_fm:.6f} {same.model.c_cont:.6f}")
    0.700000 2.000000
    """
    # 1/F is linear in 1/C_fm and 1/C_cont; only the weights, those of the logarithm, are not
    from scipy.optimize import least_squares

    unknowns = (excess,)
    wanted = np.ravel(model.force(flyer, state, unknowns))
    if wanted.size < 2 or not np.all(wanted > 0.0):
        raise ParameterError("the forces to imitate must be positive, and at least two")
    huge = 1e30  # takes the other limit out
    thin = np.ravel(Lu2023(1.0, huge, reading).force(flyer, state, unknowns))
    dense = np.ravel(Lu2023(huge, 1.0, reading).force(flyer, state, unknowns))

    def misfit(logarithms: np.ndarray) -> np.ndarray:
        c_fm, c_cont = np.exp(logarithms)
        return -np.log(wanted / (c_fm * thin) + wanted / (c_cont * dense))

    found = least_squares(misfit, np.zeros(2), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    c_fm, c_cont = map(float, np.exp(found.x))
    return SimpleForm(
        model=Lu2023(c_fm, c_cont, reading),
        deviation=float(np.sqrt(np.mean(found.fun**2))),
        largest=float(np.max(np.abs(found.fun))),
    )
