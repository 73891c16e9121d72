"""Whether designs that a search finds are within the range of their force model and film."""

from collections.abc import Mapping

from lightflyer.core.errors import LightflyerError
from lightflyer.design.cautions import cautions_of_design
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
    return cautions_of_design(problem.design, _values(problem, design))


def _values(problem: Problem, design: Mapping[str, float]) -> dict[str, float]:
    return problem.means() | problem.fixed | dict(design)


def require_within_range(
    problem: Problem, found: tuple[str, ...], values: Mapping[str, float], design: str
) -> None:
    """Raise where a design is outside of a range, unless the problem allows it.

    What the film itself is warned of, such as optical data that end, refuses no design.

    Parameters
    ----------
    problem : Problem
    found : tuple of str
        From :func:`cautions_about`.
    values : dict of str to float
        The free numbers, in the units of the design.
    design : str
        The design in words.

    Raises
    ------
    LightflyerError
    """
    if problem.beyond_range:
        return
    # what is said of data that end holds for every thickness: no other search would avoid it
    own = problem.design.warnings_for(_values(problem, values))
    beyond = [text for text in found if text not in own]
    if beyond:
        raise LightflyerError(
            f"the best design found ({design}) is not to be relied on: {'; '.join(beyond)}; narrow "
            "the bounds, take another force model, add a constraint, or accept it with "
            "beyond_range = true"
        )
