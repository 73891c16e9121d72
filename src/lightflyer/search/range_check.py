"""Whether designs that a search finds are within the range of their force model and film."""

from collections.abc import Mapping

import numpy as np

from lightflyer.flight.cautions import cautions_of_design
from lightflyer.foundation.errors import LightflyerError
from lightflyer.search.problem import Problem


def cautions_about(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """What a reader must know of a design, with uncertain numbers at their means.

    Parameters
    ----------
    problem : Problem
    design : dict of str to float
        The free numbers, in the units of the design.

    Returns
    -------
    tuple of str
        Where no coordinate is given, of the whole band in which the design flies.
    """
    means = {name: float(np.mean(column)) for name, column in problem.samples.items()}
    values = means | problem.fixed | dict(design)
    return cautions_of_design(problem.design, values)


def require_within_range(problem: Problem, found: tuple[str, ...], design: str) -> None:
    """Raise where a design is outside of a range, unless the problem allows it.

    What the flyer file itself is warned of, such as optical data that end, refuses no design.

    Parameters
    ----------
    problem : Problem
    found : tuple of str
        From :func:`cautions_about`.
    design : str
        The design in words.

    Raises
    ------
    LightflyerError
    """
    # what is said of the flyer file itself holds for every design: no other search would avoid it
    beyond = [text for text in found if text not in problem.design.warnings]
    if beyond and not problem.beyond_range:
        raise LightflyerError(
            f"the best design found ({design}) is not to be relied on: {'; '.join(beyond)}; narrow "
            "the bounds, take another force model, add a constraint, or accept it with "
            "beyond_range = true"
        )
