"""Whether designs that a search finds are within the range of their force model and film."""

from collections.abc import Mapping, Sequence

from lightflyer.design.diagnostics import TOO_HOT, diagnose_design, diagnose_designs
from lightflyer.search.problem import Problem


def diagnose_solution(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """What a reader must know of a design, with uncertain numbers at their means."""
    return diagnose_design(problem.design, _values(problem, design))


def range_passed(problem: Problem, designs: Sequence[Mapping[str, float]]) -> list[tuple[str, ...]]:
    """Diagnostics of designs that others of the search might not have; of heat the search knows."""
    several = [_values(problem, design) for design in designs]
    found = []
    for values, said in zip(several, diagnose_designs(problem.design, several), strict=True):
        # what is said of data that end holds for every thickness: no other design would avoid it
        own = problem.design.warnings_for(values)
        found.append(
            tuple(text for text in said if text not in own and not text.startswith(TOO_HOT))
        )
    return found


def _values(problem: Problem, design: Mapping[str, float]) -> dict[str, float]:
    return problem.means() | problem.fixed | dict(design)
