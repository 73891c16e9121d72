"""Studies: which designs, and what is asked of them."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError
from lightflyer.design.design import AbstractDesign, Field, digest
from lightflyer.design.outputs import Output, check_outputs, outputs_of
from lightflyer.files.toml_file import place_of, read_file
from lightflyer.study.axes import SAMPLE, Distribution, StudyAxis, draw_samples, read_entry
from lightflyer.study.sections import STUDY_FILE, SamplingSection, StudyFile

_LISTED = 6  # values of a number that are shown one by one


@dataclass(frozen=True)
class StudySource:
    """Where a study was read from, for messages and for the record."""

    path: Path
    text: str

    def place(self, keys: Sequence[str]) -> str:
        """File, line and name of a key, for the beginning of a message."""
        parts = [part for key in keys for part in key.split(".")]
        shown = ".".join(f'"{key}"' if "." in key else key for key in keys)
        return f"{place_of(parts, self.text, self.path)}: {shown}"


@contextmanager
def errors_at(source: StudySource | None, *keys: str) -> Iterator[None]:
    """Let errors inside begin with the key that they are about, and its place."""
    try:
        yield
    except ConfigurationError as error:
        text = str(error)
        named = text.startswith((f"{keys[-1]} ", f"{keys[-1]}:"))
        rest = text.removeprefix(keys[-1]) if named else f": {text}"
        raise ConfigurationError((source.place(keys) if source else keys[-1]) + rest) from None


def read_study_file(path: str | Path) -> tuple[StudyFile, AbstractDesign, StudySource]:
    """Read a study file and the flyer file that it names; ``path``: A TOML file."""
    path = Path(path)
    study, text = read_file(StudyFile, path, STUDY_FILE)
    flyer = path.parent / study.flyer
    if not flyer.is_file():
        raise ConfigurationError(
            f'{place_of(["flyer"], text, path)}: flyer = "{study.flyer}" does not exist; name a '
            "flyer file relative to the study file"
        )
    return study, as_design(flyer), StudySource(path, text)


@dataclass(frozen=True, eq=False)
class Dimension:
    """A dimension of a study."""

    name: str  # Dotted name of its field, or :data:`~lightflyer.study.axes.SAMPLE`
    values: dict[str, np.ndarray]  # shape (n,); values of each field along it, by dotted name

    @property
    def size(self) -> int:
        """Number of points."""
        return len(next(iter(self.values.values())))


@dataclass(frozen=True, eq=False)
class Study:
    """Designs to be computed: every combination of the values along its dimensions."""

    design: AbstractDesign
    dimensions: tuple[Dimension, ...]
    fixed: dict[str, float]  # Numbers that have one value, by dotted name
    outputs: tuple[str, ...]  # Names of the outputs
    text: str = ""  # Text of the study file, for the record

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each dimension."""
        return tuple(dimension.size for dimension in self.dimensions)

    @property
    def size(self) -> int:
        """Number of designs."""
        size = 1
        for length in self.shape:
            size *= length  # exact, however many: NumPy's product would overflow
        return size

    @property
    def fields(self) -> dict[str, Field]:
        """All numbers that have values, by dotted name, in the order of the dimensions."""
        varied = [name for dimension in self.dimensions for name in dimension.values]
        return {name: self.design.field(name) for name in (*varied, *self.fixed)}

    @property
    def known_outputs(self) -> dict[str, Output]:
        """The study's outputs by name."""
        known = outputs_of(self.design.setup)
        return {name: known[name] for name in self.outputs}

    def places(self, designs: Any) -> tuple[Any, ...]:
        """Places along each dimension of designs, which are numbered in row-major order."""
        arrays = designs.__array_namespace__()
        return tuple(arrays.unravel_index(designs, self.shape)) if self.shape else ()

    def values_at(self, designs: Any) -> dict[str, Any]:
        """Varied numbers of some designs, shape (n,); ``designs`` (n,)."""
        asarray = designs.__array_namespace__().asarray
        return {
            name: asarray(table)[place]
            for dimension, place in zip(self.dimensions, self.places(designs), strict=True)
            for name, table in dimension.values.items()
        }

    def description(self) -> dict[str, str]:
        """What decides the results, in words that can be compared and shown."""
        described, fields = {"variables": ", ".join(self.outputs)}, self.fields
        for dimension in self.dimensions:
            for name, values in dimension.values.items():
                described[name] = _describe(values, fields[name])
        for name, value in self.fixed.items():
            described[name] = f"{value:.9g} {fields[name].quantity.unit}".rstrip()
        return described | self.design.description()


def _describe(values: np.ndarray, field: Field) -> str:
    few = len(values) <= _LISTED
    shown = ", ".join(f"{value:.6g}" for value in (values if few else values[[0, -1]]))
    ends = f"{shown if few else shown.replace(', ', ' to ')} {field.quantity.unit}".rstrip()
    return f"{len(values)} values, {ends} ({digest(values)})"


def read_entries(
    design: AbstractDesign,
    entries: Mapping[str, object],
    outputs: Sequence[str],
    source: StudySource | None = None,
) -> dict[str, Any]:
    """Read and check what a study varies: axes, distributions, or labelled arrays, by name."""
    if not entries:
        raise ConfigurationError("over names no number to vary")
    require_compatible(design, list(entries), source, "sweep")
    found = {}
    for name, entry in entries.items():
        with errors_at(source, "sweep", name):
            field = design.field(name)
            found[name] = entry if hasattr(entry, "dims") else read_entry(entry, field)
    with errors_at(source, "outputs", *(("variables",) if source else ())):
        check_outputs(outputs, design.setup, list(entries))
    return found


def make_study(
    design: AbstractDesign,
    entries: Mapping[str, object],
    outputs: Sequence[str],
    sampling: SamplingSection | None = None,
    source: StudySource | None = None,
) -> Study:
    """Look up what a study names, check it, and draw its samples."""
    found = read_entries(design, entries, outputs, source)
    return assemble_study(design, found, outputs, sampling, source)


def assemble_study(
    design: AbstractDesign,
    entries: Mapping[str, StudyAxis | Distribution],
    outputs: Sequence[str],
    sampling: SamplingSection | None = None,
    source: StudySource | None = None,
) -> Study:
    """Study of entries that are read."""
    found, how = list(entries.values()), sampling or SamplingSection()
    dimensions = [
        Dimension(axis.field.name, {axis.field.name: axis.values})
        for axis in found
        if isinstance(axis, StudyAxis) and not axis.single
    ]
    distributions = [part for part in found if isinstance(part, Distribution)]
    if distributions:
        with errors_at(source, "sampling"):
            correlations = design.correlations
            drawn = draw_samples(distributions, how.points, how.method, how.seed, correlations)
        dimensions.append(Dimension(SAMPLE, drawn))
    return Study(
        design=design,
        dimensions=tuple(dimensions),
        fixed={
            axis.field.name: float(axis.values[0])
            for axis in found
            if isinstance(axis, StudyAxis) and axis.single
        },
        outputs=tuple(dict.fromkeys(outputs)),
        text=source.text if source else "",
    )


def require_compatible(
    design: AbstractDesign, names: list[str], source: StudySource | None, *sections: str
) -> None:
    """Raise where two numbers cannot be given at once."""
    conflict = design.conflict(names)
    if conflict is not None:
        first, second = conflict
        with errors_at(source, *sections, first):
            raise ConfigurationError(f"{first} cannot vary together with {second}, which sets it")


def read_study(path: str | Path) -> Study:
    """Read the ``[sweep]`` of a study file; ``path``: A TOML file."""
    study, design, source = read_study_file(path)
    if not study.sweep:
        raise ConfigurationError(
            f"{path}: needs a section [sweep] with a line such as "
            '"flyer.diameter" = { from = "1 cm", to = "5 cm", points = 9 }'
        )
    if study.outputs is None:
        raise ConfigurationError(
            f'{path}: needs a section [outputs] with variables = ["relative_payload", ...]'
        )
    return make_study(design, study.sweep, study.outputs.variables, study.sampling, source)
