"""Many designs at once: a compiled function of the varied numbers, applied piece by piece."""

import itertools
import threading
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import jax
import numpy as np

from lightflyer.config.sections import FlyerFile
from lightflyer.film.properties import FilmProperties
from lightflyer.flight.fields import film_of, shape_film
from lightflyer.flight.outputs import OUTPUTS, evaluate
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.precision import float64, jit_with_options
from lightflyer.sweeps.study import Study

PIECE = 16_384
"""Designs evaluated at once: they fit the processor's cache, and one thread."""

PIECE_OVER_ALTITUDE = 128
"""The same where each design is searched over altitude, at some hundred altitudes at a time."""

MOST_FILMS = 5_000
"""Different films of layers in one study: each takes a fraction of a second to compute."""

_COMPILATION: dict[str, Any] = {
    "xla_backend_optimization_level": 3,
    "xla_cpu_use_fusion_emitters": True,
}
"""XLA's own defaults, whatever its flags say: the last bits of a result must not depend on the
process that computes it. Less optimised, XLA joins products and sums into one rounding or not
according to which operations it compiles together, and that depends on the number of its threads.
"""

Table = dict[str, np.ndarray]


class Evaluator:
    """Computes the outputs of any of a study's designs.

    Designs are numbered in row-major order of the study's dimensions. The result of a design
    does not depend on which others are computed with it. Can be pickled; it is compiled where it
    runs, once for all studies of a flyer file with the same outputs.

    Parameters
    ----------
    study : Study
    on_film : callable, optional
        Called with the number of films done and their total, where films of layers have to be
        computed.
    """

    def __init__(self, study: Study, on_film: Callable[[int, int], None] | None = None):
        self.study = study
        searched = any(OUTPUTS[name].over_altitude for name in study.variables)
        self.piece = PIECE_OVER_ALTITUDE if searched else PIECE
        self._films, self._film_strides = _films(study, on_film)

    def __call__(self, start: int, stop: int) -> tuple[Table, int]:
        """Outputs of the designs from ``start`` up to ``stop``.

        Parameters
        ----------
        start, stop : int

        Returns
        -------
        outputs : dict of str to array, shape (stop - start,)
            NaN where there is no such number, or where it has not converged.
        failures : int
            Number of designs that have not converged.
        """
        results = {name: np.empty(stop - start) for name in self.study.variables}
        failures = 0
        for first in range(start, stop, self.piece):
            last = min(first + self.piece, stop)
            outputs, converged = self._piece(np.arange(first, first + self.piece))
            part, inside = slice(first - start, last - start), slice(0, last - first)
            failed = ~converged[inside]
            failures += int(np.count_nonzero(failed))
            for name, column in outputs.items():
                values = column[inside]
                results[name][part] = np.where(np.isfinite(values) & ~failed, values, np.nan)
        return results, failures

    def _piece(self, designs: np.ndarray) -> tuple[Table, np.ndarray]:
        """Outputs of exactly one piece of designs; what lies beyond the last repeats it."""
        study = self.study
        kernel = _kernel(study.configuration, study.variables, tuple(study.fixed.items()))
        return kernel(*self.inputs(np.minimum(designs, study.size - 1)))

    def inputs(self, designs: np.ndarray) -> tuple[Table, FilmProperties | None]:
        """Varied numbers, and films, of some designs.

        Parameters
        ----------
        designs : int array, shape (n,)

        Returns
        -------
        values : dict of str to array, shape (n,)
            By dotted name.
        films : FilmProperties or None
            Arrays of leading shape (n,), where films have layers that are varied.
        """
        places = np.unravel_index(designs, self.study.shape) if self.study.shape else ()
        values = {
            name: table[place]
            for dimension, place in zip(self.study.dimensions, places, strict=True)
            for name, table in dimension.values.items()
        }
        if not values:
            # a study of one design still needs something to map over
            name, value = next(iter(self.study.fixed.items()))
            values = {name: np.full(designs.shape, value)}
        if self._films is None:
            return values, None
        number = np.zeros(designs.shape, int)
        for place, stride in zip(places, self._film_strides, strict=True):
            number += stride * place
        return values, jax.tree.map(lambda leaf: leaf[number], self._films)


class _Kernel:
    """Outputs of many designs of one flyer file; compiled once for all threads of a process."""

    def __init__(
        self, configuration: FlyerFile, variables: tuple[str, ...], fixed: dict[str, float]
    ):
        self._compiled = jit_with_options(
            jax.vmap(lambda values, film: evaluate(configuration, variables, fixed | values, film)),
            _COMPILATION,
        )
        self._ready: set[Any] = set()
        self._lock = threading.Lock()

    def __call__(self, values: Table, films: FilmProperties | None) -> tuple[Table, np.ndarray]:
        shapes = {name: column.shape for name, column in values.items()}
        kind = tuple(shapes.items()), films is None
        if kind not in self._ready:
            with self._lock:  # or every thread would compile
                if kind not in self._ready:
                    found = self._run(values, films)
                    self._ready.add(kind)
                    return found
        return self._run(values, films)

    def _run(self, values: Table, films: FilmProperties | None) -> tuple[Table, np.ndarray]:
        with float64():
            outputs, converged = self._compiled(values, films)
            return {name: np.asarray(column) for name, column in outputs.items()}, np.asarray(
                converged
            )


@lru_cache(maxsize=16)
def _kernel(
    configuration: FlyerFile, variables: tuple[str, ...], fixed: tuple[tuple[str, float], ...]
) -> _Kernel:
    return _Kernel(configuration, variables, dict(fixed))


def _films(
    study: Study, on_film: Callable[[int, int], None] | None
) -> tuple[FilmProperties | None, list[int]]:
    """All different films of a study, stacked, and the strides of their numbers."""
    changing = [
        shape_film(study.configuration, list(dimension.values)) for dimension in study.dimensions
    ]
    fixed = {name: study.fixed[name] for name in shape_film(study.configuration, list(study.fixed))}
    if not any(changing) and not fixed:
        return None, []
    lengths = [
        dimension.size if names else 1
        for dimension, names in zip(study.dimensions, changing, strict=True)
    ]
    total = int(np.prod(lengths))
    if total > MOST_FILMS:
        raise ConfigurationError(
            f"the study has {total} different films of layers, and each takes a fraction of a "
            f"second to compute: at most {MOST_FILMS}"
        )
    films = []
    for places in itertools.product(*map(range, lengths)):
        values = fixed | {
            name: float(dimension.values[name][place])
            for dimension, names, place in zip(study.dimensions, changing, places, strict=True)
            for name in names
        }
        films.append(film_of(study.configuration, values))
        if on_film:
            on_film(len(films), total)
    stacked = jax.tree.map(lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves]), *films)
    strides = [
        int(np.prod(lengths[number + 1 :])) if length > 1 else 0
        for number, length in enumerate(lengths)
    ]
    return stacked, strides
