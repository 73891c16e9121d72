"""Whether designs that a search finds are within the range of their force model and film."""

from collections.abc import Mapping

from lightflyer.core.errors import LightflyerError
from lightflyer.design.diagnostics import diagnose_design
from lightflyer.search.problem import Problem


def diagnose_solution(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """What a reader must know of a design, with uncertain numbers at their means."""
    return diagnose_design(problem.design, _values(problem, design))


def _values(problem: Problem, design: Mapping[str, float]) -> dict[str, float]:
    return problem.means() | problem.fixed | dict(design)


def require_within_range(
    problem: Problem, found: tuple[str, ...], values: Mapping[str, float], design: str
) -> None:
    """Raise where a design is outside of a range, unless the problem allows it."""
    # What the film itself is warned of, such as optical data that end, refuses no design.
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
