"""Whether designs that a search finds are within the range of their force model and film."""

from collections.abc import Mapping

from lightflyer.design.diagnostics import TOO_HOT, diagnose_design
from lightflyer.search.problem import Problem


def diagnose_solution(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """What a reader must know of a design, with uncertain numbers at their means."""
    return diagnose_design(problem.design, _values(problem, design))


def range_passed(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """Diagnostics that another design of the search might not have; of heat the search knows."""
    # what is said of data that end holds for every thickness: no other design would avoid it
    own = problem.design.warnings_for(_values(problem, design))
    return tuple(
        text
        for text in diagnose_solution(problem, design)
        if text not in own and not text.startswith(TOO_HOT)
    )


def _values(problem: Problem, design: Mapping[str, float]) -> dict[str, float]:
    return problem.means() | problem.fixed | dict(design)
