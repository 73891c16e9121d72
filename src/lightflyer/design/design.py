"""A design: a setup whose numbers have names, so that studies can vary them.

Sweeps, optimisation, sensitivities and uncertainty know nothing else. A flyer file is one way to
make a design; three objects are another, whose numbers are named by their place in them, such as
``"flyer.film.tac_top"``.
"""

import abc
import difflib
import hashlib
import inspect
import pickle
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields as dataclass_fields
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Protocol, cast

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, call
from lightflyer.array.records import Module
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import dumps
from lightflyer.core.quantity import (
    Correlation,
    Quantity,
    quantities_of,
    quantity_of,
    require_possible,
    shapes_in,
)
from lightflyer.core.units import Measured, dataset_unit
from lightflyer.design.setup import Setup
from lightflyer.numerics.correlation import correlation_matrix

_CORRELATION = quantity_of(Correlation) or Quantity()
_ROUNDING = 1e-12  # of an eigenvalue of a correlation matrix, whose diagonal is one
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")  # in the text of a function, another in each process


class Field(NamedTuple):
    """A number that describes a design."""

    #: Dotted, such as ``"film.emittance"``, or the coordinate's name, such as ``"altitude"``
    name: str
    quantity: Quantity  #: Its unit and range

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of a coordinate that holds its values."""
        words = self.name.replace(".", " ").replace("_", " ")
        return {"units": dataset_unit(self.quantity.unit), "long_name": words}


class Surrogate(Protocol):
    """What :meth:`AbstractDesign.precompute` computes, to a few thousandths, and traceable."""

    tables: Any  # Whatever it needs that is the same for all values

    def knows(self, name: str) -> bool:
        """Whether a costly number may have other values."""

    def __call__(self, values: Mapping[str, Numeric], tables: Any) -> Any:
        """The same pytree as from :meth:`AbstractDesign.precompute`, for one design."""


class AbstractStacks(abc.ABC):
    """Stacks of layers that a film of a design may be."""

    # Any of them; where each thickness lies between its bounds is one of its numbers
    design: "AbstractDesign"
    shares: tuple[str, ...]  # Names of these numbers, for the stack with the most layers
    sequences: tuple[tuple[int, ...], ...]  # Numbers of the materials of each stack, top to bottom
    notes: tuple[str, ...]  # What a reader of results must know, one line each

    @abc.abstractmethod
    def labels(self, sequence: Sequence[int]) -> tuple[str, ...]:
        """Names of the materials of a stack."""

    @abc.abstractmethod
    def tables(self, sequence: Sequence[int]) -> Any:
        """Tables of :meth:`AbstractDesign.surrogate` of :attr:`design` for a stack."""

    @abc.abstractmethod
    def limit(self, sequence: Sequence[int]) -> float:
        """Temperature that a stack withstands [K]; infinite where it is not known."""

    @abc.abstractmethod
    def exact(self, sequence: Sequence[int], values: Mapping[str, float]) -> Any:
        """:meth:`AbstractDesign.precompute` of :attr:`design` for a stack."""

    @abc.abstractmethod
    def thicknesses(self, sequence: Sequence[int], shares: np.ndarray) -> np.ndarray:
        """Thickness of each layer of a stack, from where it lies between its bounds [m]."""

    @abc.abstractmethod
    def choose(self, sequence: Sequence[int]) -> tuple["AbstractDesign", dict[str, Any]]:
        """The design with a stack, and bounds of its thicknesses by name."""


class AbstractDesign(abc.ABC):
    """A setup that can be built anew with other numbers."""

    text: str = ""
    """Name of the file or object that the design was read from, for the record."""

    @abc.abstractmethod
    def build(self, values: Mapping[str, Numeric] | None = None, prepared: Any = None) -> Setup:
        """The setup with some numbers replaced.

        ``values`` by the name of the field, in its unit: they broadcast, may be traced and are not
        checked; a coordinate has no effect. ``prepared`` is from :meth:`precompute`.
        """

    @cached_property
    @abc.abstractmethod
    def quantities(self) -> dict[str, Quantity]:
        """Unit and range of each number that may be varied, by name, without the coordinate."""

    @abc.abstractmethod
    def number(self, name: str) -> float | None:
        """Value of a number, None for an optional one that is not given."""

    @property
    @abc.abstractmethod
    def uncertainties(self) -> dict[str, float]:
        """Standard uncertainties that are stated, by name, in the units of the values."""

    @property
    @abc.abstractmethod
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of the errors of two numbers, by their names."""

    @abc.abstractmethod
    def description(self) -> dict[str, str]:
        """Everything that decides results, in words that can be compared and shown."""

    def needs_recompute(self, names: list[str]) -> list[str]:
        """Those of some numbers whose change takes more than arithmetic; see :meth:`precompute`."""
        del names
        return []

    def precompute(self, values: Mapping[str, float], *, coarse: bool = False) -> Any:
        """Whatever :meth:`build` needs for other values of costly numbers: arrays in a pytree."""
        del values, coarse  # which is for differences of two of them: 1 % off, and quicker

    def surrogate(self, names: Sequence[str]) -> "Surrogate":
        """A quick stand-in of :meth:`precompute` over costly numbers; raises if there is none."""
        raise ConfigurationError(f"{', '.join(names)}: there is no quick way to compute the rest")

    def stacks(self, asked: Any, folder: Path | None = None) -> "AbstractStacks":
        """The stacks of layers that a film of the design may be; raises where there are none.

        ``asked`` has ``film``, ``materials`` and ``most_layers``; ``folder`` is the study file's.
        """
        del asked, folder
        raise ConfigurationError("needs a flyer file whose film has layers")

    def data_bounds(self) -> dict[str, tuple[Any, Any]]:
        """What missing data leave open, by a name: :meth:`precompute` at both bounds."""
        return {}

    def with_open_errors(self) -> "AbstractDesign":
        """The design with the errors of its force model that nobody has stated."""
        return self

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of any result of the design must know, one line each."""
        return ()

    def warnings_for(self, values: Mapping[str, float]) -> tuple[str, ...]:
        """The same for a design with other numbers, by their names."""
        del values
        return self.warnings

    @property
    def sampling_warnings(self) -> tuple[str, ...]:
        """The same for results over samples of the numbers that have a ±."""
        left_out = (
            f"{name} is not sampled: it has its nominal value" for name in self.data_bounds()
        )
        return (*self.warnings, *left_out)

    def why_not_varied(self, name: str) -> str | None:
        """Reason why a number of the design cannot be varied, None where there is none."""
        del name
        return None

    def label(self, name: str) -> str:
        """What a number belongs to, where its name does not tell; such as a layer's material."""
        del name
        return ""

    def conflict(self, names: list[str]) -> tuple[str, str] | None:
        """Two of some numbers that cannot be given at once, None where there are none."""
        del names
        return None

    @property
    def setup(self) -> Setup:
        """The setup with its own numbers."""
        # no cached_property: in Python 3.11 all threads wait while it makes any design's
        kept = vars(self)
        if "_setup" not in kept:
            kept["_setup"] = self.build()
        return cast(Setup, kept["_setup"])

    @property
    def coordinate_name(self) -> str:
        """Name of the coordinate of the surroundings, such as ``"altitude"``."""
        return self.setup.environment.coordinate.name

    @cached_property
    def fields(self) -> dict[str, Field]:
        """All numbers that may be varied, and the coordinate of the surroundings, by name."""
        coordinate = self.setup.environment.coordinate
        quantities = {**self.quantities, coordinate.name: coordinate.quantity}
        return {name: Field(name, quantity) for name, quantity in quantities.items()}

    def field(self, name: str) -> Field:
        """A number by its name; raises where there is none, or where it cannot be varied."""
        known = self.fields
        if name in known:
            return known[name]
        reason = self.why_not_varied(name)
        if reason is not None:
            raise ConfigurationError(f"{name} cannot be varied: it {reason}")
        last = name.rpartition(".")[2]
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
        near = near or [full for full in known if full.rpartition(".")[2] == last]
        hint = f'did you mean "{near[0]}"?' if near else f"choose from {', '.join(known)}"
        raise ConfigurationError(f"{name} is not a number of the design; {hint}")


class ObjectDesign(AbstractDesign):
    """A design made of objects.

    Equal to any other of equal objects. Can be pickled, also where their classes are a script's.

    Parameters
    ----------
    setup : Setup
        Numbers that are scalars may be varied.
    uncertainties : dict of str to float, optional
        Standard uncertainties by name, such as ``{"flyer.film.tac_bottom": 0.03}``.
    correlations : dict of (str, str) to float, optional
        Correlation of the errors of two numbers.

    Raises
    ------
    ConfigurationError
        If a name is not that of a number, a number is an array, or an uncertainty or correlation
        is impossible.
    """

    def __init__(
        self,
        setup: Setup,
        uncertainties: Mapping[str, float] | None = None,
        correlations: Mapping[tuple[str, str], float] | None = None,
    ):
        self._base = setup
        several = {name: shape for name, shape in shapes_in(setup, labelled=True).items() if shape}
        for name, shape in several.items():
            raise ConfigurationError(
                f"{name} of shape {shape} describes several designs; lightflyer.sweep takes arrays"
            )
        stated = (uncertainties or {}).items()
        self._uncertainties = {name: self._spread(name, spread) for name, spread in stated}
        self._correlations = dict(correlations or {})
        for names, value in self._correlations.items():
            _CORRELATION.check(f"correlation of {' and '.join(names)}", value)
            for name in names:
                if not self._uncertainties.get(name):
                    raise ConfigurationError(f"a correlation of {name} has no effect without its ±")
        matrix = correlation_matrix([*self._uncertainties], self._correlations)
        if self._uncertainties and np.linalg.eigvalsh(matrix)[0] < -_ROUNDING:
            raise ConfigurationError("no joint distribution has the correlations stated")

    def __repr__(self) -> str:
        setup = self._base
        return f"ObjectDesign({setup.flyer.describe()}, {type(setup.model).__name__})"

    def _spread(self, name: str, given: Any) -> float:
        """A standard uncertainty by the rules of files, in the unit of the number."""
        if name not in self._numbers:
            self.field(name)
            raise ConfigurationError(f"{name} is where the flyer is, and has no ±")
        quantity, value = self._numbers[name]
        spread = Quantity(quantity.unit).number(f"uncertainty of {name}", given)
        if np.ndim(spread):
            raise ConfigurationError(f"{name}: the uncertainty must be one number")
        try:
            quantity.read(Measured(value, spread))
        except ConfigurationError as error:
            raise ConfigurationError(f"{name}: {error}") from None
        return float(spread)

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickle, (dumps((self._base, self._uncertainties, self._correlations)),)

    @cached_property
    def _identity(self) -> tuple[Any, ...]:
        leaves, structure = tree.flatten(self._base)
        stated = tuple(self._uncertainties.items()), tuple(self._correlations.items())
        return structure, digest(*leaves), *stated

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ObjectDesign) and other._identity == self._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @cached_property
    def _numbers(self) -> dict[str, tuple[Quantity, float]]:
        found = {}
        for prefix, part in _parts(self._base).items():
            for name, quantity, value in _numbers_in(part):
                found[f"{prefix}.{name}"] = (quantity, value)
        return found

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        return {name: quantity for name, (quantity, _) in self._numbers.items()}

    def number(self, name: str) -> float | None:
        return self._numbers[name][1] if name in self._numbers else None

    @property
    def uncertainties(self) -> dict[str, float]:
        return dict(self._uncertainties)

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        return dict(self._correlations)

    def with_open_errors(self) -> "ObjectDesign":
        names = self._base.model.open_errors
        model = replace(self._base.model, **dict.fromkeys(names, 0.0))
        stated = {f"force.{name}": 1.0 for name in names} | self._uncertainties
        return ObjectDesign(replace(self._base, model=model), stated, self._correlations)

    def build(self, values: Mapping[str, Numeric] | None = None, prepared: Any = None) -> Setup:  # noqa: ARG002
        moved = {name: value for name, value in (values or {}).items() if name in self._numbers}
        if not moved:
            return self._base
        setup: Setup = tree.replace_at(
            lambda setup: [_at(setup, name) for name in moved], self._base, list(moved.values())
        )
        if call.blanks:  # numbers that contradict each other become NaN, as those of a file
            require_possible(setup)
        return setup

    def description(self) -> dict[str, str]:
        base = self._base
        parts = _parts(base)
        kinds = {
            f"object: {name}": f"{type(part).__module__}.{type(part).__qualname__}"
            for name, part in parts.items()
        }
        numbers = {f"object: {name}": repr(value) for name, (_, value) in self._numbers.items()}
        structure = _ADDRESS.sub("", str(tree.structure(base)))
        described = kinds | numbers | _code(base) | {"search range": repr(base.search_range)}
        described["numbers of the objects and of their data"] = digest(*tree.leaves(base))
        described["structure of the objects"] = hashlib.sha256(structure.encode()).hexdigest()[:12]
        return described


def _unpickle(content: bytes) -> ObjectDesign:
    return ObjectDesign(*pickle.loads(content))


def _code(part: Any) -> dict[str, str]:
    """Fingerprint of the source of each class among objects, but for the package's own."""
    found = {}
    for kind in type(part).__mro__:
        if issubclass(kind, Module) and kind.__module__.partition(".")[0] != "lightflyer":
            try:
                source = inspect.getsource(kind)
            except (OSError, TypeError):
                continue  # typed into an interpreter
            name = f"code of {kind.__module__}.{kind.__qualname__}"
            found[name] = f"sha256 {hashlib.sha256(source.encode()).hexdigest()[:12]}"
    for field in dataclass_fields(part):
        value = getattr(part, field.name)
        if isinstance(value, Module):
            found |= _code(value)
    return found


def _numbers_in(part: Any) -> Iterator[tuple[str, Quantity, float]]:
    """Dotted name, quantity and value of each scalar number inside a module."""
    known = quantities_of(part.__class__)
    for field in dataclass_fields(part):
        if field.metadata.get("static", False):
            continue
        value = getattr(part, field.name)
        if isinstance(value, Module):
            for name, quantity, number in _numbers_in(value):
                yield f"{field.name}.{name}", quantity, number
        elif _is_scalar(value):
            yield field.name, known.get(field.name, Quantity()), float(value)


def _is_scalar(value: Any) -> bool:
    if isinstance(value, bool) or value is None or isinstance(value, str | tuple | list | dict):
        return False
    array = np.asarray(value)
    return array.ndim == 0 and bool(np.issubdtype(array.dtype, np.number))


def _parts(setup: Setup) -> dict[str, Any]:
    """What a setup consists of, by the first word of its numbers' names."""
    parts = {
        "flyer": setup.flyer,
        "environment": setup.environment,
        "force": setup.model,
        "budget": setup.budget,
    }
    return {name: part for name, part in parts.items() if part is not None}


def _at(setup: Setup, name: str) -> Any:
    first, *rest = name.split(".")
    part: Any = setup.model if first == "force" else getattr(setup, first)
    for key in rest:
        part = getattr(part, key)
    return part


def digest(*arrays: Any) -> str:
    """Fingerprint of numbers, to tell whether two sets are the same."""
    total = hashlib.sha256()
    for array in arrays:
        total.update(np.ascontiguousarray(array, float).tobytes())
    return f"sha256 {total.hexdigest()[:12]}"
