"""Very many tiny linear systems at once, one in every array element."""

from collections.abc import Sequence
from typing import TypeAlias

from lightflyer.array.namespace import Array, xp

Vector: TypeAlias = Sequence[Array]
Matrix: TypeAlias = Sequence[Vector]


def solve_linear(matrix: Matrix, vector: Vector) -> tuple[Array, ...]:
    """Solve linear systems, element by element; ``matrix``: rows of the matrices."""
    # The solution is written out in array operations, which XLA fuses with what stands around them:
    # a call to LAPACK for every small matrix would take longer than all else together.
    #
    # Cramer's rule for two unknowns, which loses no accuracy there and is half the work; else
    # Gaussian elimination with partial pivoting. Differentiable where the matrix is regular.
    return _by_cramer(matrix, vector) if len(vector) == 2 else _by_elimination(matrix, vector)


def _by_cramer(matrix: Matrix, vector: Vector) -> tuple[Array, ...]:
    (a, b), (c, d) = matrix
    first, second = vector
    inverse = 1.0 / (a * d - b * c)
    return (first * d - b * second) * inverse, (a * second - first * c) * inverse


def _by_elimination(matrix: Matrix, vector: Vector) -> tuple[Array, ...]:
    rows = [[*row, right] for row, right in zip(matrix, vector, strict=True)]
    for pivot in range(len(rows)):
        for below in range(pivot + 1, len(rows)):
            _exchange_if_larger(rows, pivot, below)
        for below in range(pivot + 1, len(rows)):
            share = rows[below][pivot] / rows[pivot][pivot]
            rows[below] = [
                entry - share * above for entry, above in zip(rows[below], rows[pivot], strict=True)
            ]
    return _substitute_back(rows)


def _exchange_if_larger(rows: list[list[Array]], pivot: int, below: int) -> None:
    larger = xp.abs(rows[below][pivot]) > xp.abs(rows[pivot][pivot])
    pairs = list(zip(rows[pivot], rows[below], strict=True))
    rows[pivot] = [xp.where(larger, lower, upper) for upper, lower in pairs]
    rows[below] = [xp.where(larger, upper, lower) for upper, lower in pairs]


def _substitute_back(rows: list[list[Array]]) -> tuple[Array, ...]:
    solution: list[Array] = []
    for index, (*coefficients, right) in reversed(list(enumerate(rows))):
        for coefficient, known in zip(reversed(coefficients), solution, strict=False):
            right = right - coefficient * known
        solution.append(right / coefficients[index])
    return tuple(reversed(solution))
