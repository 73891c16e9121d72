"""The sections of a study file, before their names are looked up in the design."""

from typing import Annotated, Any, Literal, TypeVar

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Duration
from lightflyer.files.section import Section
from lightflyer.files.toml_file import FileKind, format_error
from lightflyer.study.axes import METHODS, MOST_SAMPLES, SAMPLES

_Count = Annotated[int, pydantic.Field(strict=True, ge=1, le=MOST_SAMPLES)]
_Base = Annotated[int, pydantic.Field(strict=True, ge=1, le=2**18)]  # times the inputs, in memory
_Starts = Annotated[int, pydantic.Field(strict=True, ge=1, le=1000)]
_Seed = Annotated[int, pydantic.Field(strict=True, ge=0)]
_Method = Literal[tuple(METHODS)]  # type: ignore[valid-type]


def _as_names(value: Any) -> tuple[str, ...]:
    """One name, or several, as several."""
    names = (value,) if isinstance(value, str) else value
    if isinstance(names, list | tuple) and all(isinstance(name, str) for name in names):
        return tuple(names)
    raise ValueError('is not the name of an output, such as "payload", or a list of such names')


_Names = Annotated[tuple[str, ...], pydantic.BeforeValidator(_as_names)]
_Entries = Annotated[dict[str, Any], pydantic.Field(default_factory=dict)]


class OutputsSection(Section):
    """``[outputs]``: what a sweep computes."""

    variables: list[str]


class SamplingSection(Section):
    """``[sampling]``: how the distributions of a study are drawn."""

    method: _Method = "sobol"  # type: ignore[valid-type]
    points: _Count = SAMPLES
    seed: _Seed = 0


class UncertaintySection(Section):
    """``[optimise.uncertainty]``: which number stands for an output that is uncertain."""

    of: Literal["mean", "quantile"] = "mean"
    quantile: Annotated[float, pydantic.Field(gt=0.0, lt=1.0)] = 0.05


class StacksSection(Section):
    """``[optimise.stacks]``: which materials a film of layers may have, in any order."""

    materials: Annotated[list[dict[str, Any]], pydantic.Field(min_length=1)]
    most_layers: Annotated[int, pydantic.Field(strict=True, ge=1, le=8)] = 4
    film: str = "film"
    time_limit: Duration | None = None


class OptimiseSection(Section):
    """``[optimise]``: the objectives, the free numbers, and the limits."""

    maximise: _Names = ()
    minimise: _Names = ()
    over: _Entries
    constraints: _Entries
    uncertainty: UncertaintySection | None = None
    stacks: StacksSection | None = None
    beyond_range: Annotated[bool, pydantic.Field(strict=True)] = False
    starts: _Starts = 8
    seed: _Seed = 0


class SensitivitySection(Section):
    """``[sensitivity]``: which outputs, where, and which inputs are uncertain."""

    outputs: _Names = ("payload",)
    at: _Entries
    inputs: _Entries
    points: _Base = SAMPLES
    seed: _Seed = 0


class StudyFile(Section):
    """A study file."""

    flyer: str
    sweep: _Entries
    outputs: OutputsSection | None = None
    sampling: SamplingSection = SamplingSection()
    optimise: OptimiseSection | None = None
    sensitivity: SensitivitySection | None = None


_SECTIONS: dict[str, type[Section]] = {
    "": StudyFile,
    "outputs": OutputsSection,
    "sampling": SamplingSection,
    "optimise": OptimiseSection,
    "optimise.uncertainty": UncertaintySection,
    "optimise.stacks": StacksSection,
    "sensitivity": SensitivitySection,
}

STUDY_FILE = FileKind(
    "a study file",
    lambda section, _: list(_SECTIONS[section].model_fields),
    'it needs flyer = "flyer.toml" and a section [sweep]',
    lambda document: (
        ""
        if isinstance(document.get("flyer", 0), str | int)
        else 'a flyer file: a study file names one, flyer = "flyer.toml"'
    ),
)
"""How messages speak of a study file."""

_Kind = TypeVar("_Kind", bound=Section)


def from_arguments(kind: type[_Kind], **given: Any) -> _Kind:
    """A section from the arguments of a function; ``kind``: class of the section."""
    try:
        return kind.model_validate({k: value for k, value in given.items() if value is not None})
    except pydantic.ValidationError as error:
        lines = []
        for mistake in error.errors():
            name = ".".join(map(str, mistake["loc"]))
            if mistake["type"] == "extra_forbidden":
                known = _SECTIONS.get(f"optimise.{name.rpartition('.')[0]}", kind)
                choice = ", ".join(known.model_fields)
                lines.append(f"{name} is unknown; choose from {choice}")
            else:
                lines.append(format_error(mistake, name))
        raise ConfigurationError("\n".join(lines)) from None
