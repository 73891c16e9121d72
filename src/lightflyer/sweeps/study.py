"""Study files: which designs, and what is asked of them."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np

from lightflyer.config.reader import place_of, read_file, read_flyer_file
from lightflyer.config.sections import FlyerFile
from lightflyer.flight.fields import Field, field
from lightflyer.flight.outputs import check_outputs
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.sweeps.axes import SAMPLE, Axis, Distribution, draw, read_entry
from lightflyer.sweeps.sections import STUDY_FILE, SamplingSection, StudyFile

_LISTED = 6  # values of a field that are told one by one


@dataclass(frozen=True)
class Source:
    """Where a study was read from, for messages and for the record.

    Attributes
    ----------
    path : Path
    text : str
    flyer_text : str
    """

    path: Path
    text: str
    flyer_text: str

    def place(self, keys: Sequence[str]) -> str:
        """File, line and name of a key, for the beginning of a message.

        Parameters
        ----------
        keys : sequence of str
            Sections, outermost first, and the key, which may be dotted.

        Returns
        -------
        str
        """
        parts = [part for key in keys for part in key.split(".")]
        shown = ".".join(f'"{key}"' if "." in key else key for key in keys)
        return f"{place_of(parts, self.text, self.path)}: {shown}"


def read_study(path: str | Path) -> tuple[StudyFile, FlyerFile, Source]:
    """Read a study file and the flyer file that it names.

    Parameters
    ----------
    path : str or path
        Of a TOML file.

    Returns
    -------
    study : StudyFile
    configuration : FlyerFile
    source : Source

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key and what is allowed.
    """
    path = Path(path)
    study, text = read_file(StudyFile, path, STUDY_FILE)
    flyer = path.parent / study.flyer
    if not flyer.is_file():
        raise ConfigurationError(
            f'{place_of(["flyer"], text, path)}: flyer = "{study.flyer}" is no file beside the '
            "study"
        )
    configuration = read_flyer_file(flyer)
    return study, configuration, Source(path, text, flyer.read_text(encoding="utf-8-sig"))


@dataclass(frozen=True, eq=False)
class Dimension:
    """A dimension of a study.

    Attributes
    ----------
    name : str
        Dotted name of its field, or :data:`~lightflyer.sweeps.axes.SAMPLE`.
    values : dict of str to array, shape (n,)
        Values of each field along it, by dotted name.
    """

    name: str
    values: dict[str, np.ndarray]

    @property
    def size(self) -> int:
        """Number of points."""
        return len(next(iter(self.values.values())))


@dataclass(frozen=True, eq=False)
class Study:
    """Designs to be computed: every combination of the values along its dimensions.

    Attributes
    ----------
    configuration : FlyerFile
    dimensions : tuple of Dimension
    fixed : dict of str to float
        Fields that have one value, by dotted name.
    variables : tuple of str
        Names of the outputs.
    fields : dict of str to Field
        All that have values, by dotted name.
    text, flyer_text : str
        Of the files, for the record.
    """

    configuration: FlyerFile
    dimensions: tuple[Dimension, ...]
    fixed: dict[str, float]
    variables: tuple[str, ...]
    fields: dict[str, Field]
    text: str = ""
    flyer_text: str = ""

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

    def description(self) -> dict[str, str]:
        """What decides the results, in words that can be compared and shown.

        Returns
        -------
        dict of str to str
        """
        described = {"variables": ", ".join(self.variables)}
        for dimension in self.dimensions:
            for name, values in dimension.values.items():
                described[name] = _describe(values, self.fields[name])
        for name, value in self.fixed.items():
            described[name] = f"{value:.9g} {self.fields[name].quantity.unit}".rstrip()
        dumped = self.configuration.model_dump(mode="json")
        for section, content in dumped.items():
            for key, entry in content.items():
                if key != "layers" and entry is not None:
                    described[f"flyer file: {section}.{key}"] = json.dumps(entry)
            for number, layer in enumerate(content.get("layers") or ()):
                described[f"flyer file: {section}.layers.{number}"] = json.dumps(layer)
        # what the sections read from elsewhere: materials, spectra, atmospheres
        setup = jax.tree.leaves(tuple(self.configuration.build())[:3])
        described["numbers of the flyer file and of its data"] = _digest(*setup)
        return described


def _digest(*arrays: Any) -> str:
    total = hashlib.sha256()
    for array in arrays:
        total.update(np.ascontiguousarray(array, float).tobytes())
    return f"sha256 {total.hexdigest()[:12]}"


def _describe(values: np.ndarray, field: Field) -> str:
    few = len(values) <= _LISTED
    shown = ", ".join(f"{value:.6g}" for value in (values if few else values[[0, -1]]))
    ends = f"{shown if few else shown.replace(', ', ' to ')} {field.quantity.unit}".rstrip()
    return f"{len(values)} values, {ends} ({_digest(values)})"


def make_study(
    configuration: FlyerFile,
    entries: Mapping[str, Any],
    variables: Sequence[str],
    sampling: SamplingSection | None = None,
    source: Source | None = None,
) -> Study:
    """Look up what a study names, check it, and draw its samples.

    Parameters
    ----------
    configuration : FlyerFile
    entries : dict of str to object
        Values of each field by dotted name: see :func:`lightflyer.sweeps.axes.read_entry`.
    variables : sequence of str
        Names of outputs.
    sampling : SamplingSection, optional
    source : Source, optional
        Names file and line in errors.

    Returns
    -------
    Study

    Raises
    ------
    ConfigurationError
        Naming the field and what is wrong with it.
    """
    sampling = sampling or SamplingSection()
    found: list[Axis | Distribution] = []
    for name, entry in entries.items():
        try:
            known = field(configuration, name)
        except ConfigurationError as error:
            message = str(error).removeprefix(name)
            raise located(source, ["sweep", name], message) from None
        try:
            found.append(read_entry(entry, known))
        except ConfigurationError as error:
            raise located(source, ["sweep", name], f": {error}") from None
    _refuse_two_emittances(list(entries), source)
    try:
        check_outputs(variables, configuration, list(entries))
    except ConfigurationError as error:
        raise located(source, ["outputs", "variables"], f": {error}") from None
    return Study(
        configuration=configuration,
        dimensions=_dimensions(configuration, found, sampling, source),
        fixed={
            axis.field.name: float(axis.values[0])
            for axis in found
            if isinstance(axis, Axis) and axis.single
        },
        variables=tuple(dict.fromkeys(variables)),
        fields={part.field.name: part.field for part in found},
        text=source.text if source else "",
        flyer_text=source.flyer_text if source else "",
    )


def _dimensions(
    configuration: FlyerFile,
    found: Sequence[Axis | Distribution],
    sampling: SamplingSection,
    source: Source | None,
) -> tuple[Dimension, ...]:
    dimensions = [
        Dimension(axis.field.name, {axis.field.name: axis.values})
        for axis in found
        if isinstance(axis, Axis) and not axis.single
    ]
    distributions = [part for part in found if isinstance(part, Distribution)]
    if distributions:
        how = (sampling.method, sampling.seed, configuration.film.tac_correlation.value)
        try:
            drawn = draw(distributions, sampling.points, *how)
        except ConfigurationError as error:
            raise located(source, ["sampling"], f": {error}") from None
        dimensions.append(Dimension(SAMPLE, drawn))
    return tuple(dimensions)


def _refuse_two_emittances(names: Sequence[str], source: Source | None) -> None:
    if "film.emittance" in names:
        for face in ("film.emittance_top", "film.emittance_bottom"):
            if face in names:
                message = " stands beside film.emittance, which is that of both faces"
                raise located(source, ["sweep", face], message)


def located(source: Source | None, keys: Sequence[str], message: str) -> ConfigurationError:
    """An error, with the place of its key where the study was read from a file.

    Parameters
    ----------
    source : Source or None
    keys : sequence of str
        Sections, outermost first, and the key.
    message : str
        That continues the key's name, its separator first.

    Returns
    -------
    ConfigurationError
    """
    return ConfigurationError((source.place(keys) if source else keys[-1]) + message)


def sweep_study(path: str | Path) -> Study:
    """Read the ``[sweep]`` of a study file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Study

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key and what is allowed.
    """
    study, configuration, source = read_study(path)
    if not study.sweep:
        raise ConfigurationError(
            f"{path}: needs a section [sweep] with a line such as "
            '"flyer.diameter" = { from = "1 cm", to = "5 cm", points = 9 }'
        )
    if study.outputs is None:
        raise ConfigurationError(
            f'{path}: needs a section [outputs] with variables = ["relative_payload", ...]'
        )
    return make_study(configuration, study.sweep, study.outputs.variables, study.sampling, source)
