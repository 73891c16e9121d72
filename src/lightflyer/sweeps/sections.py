"""The sections of a study file, before their names are looked up in the flyer file."""

from typing import Annotated, Any, Literal

import pydantic

from lightflyer.config.reader import FileKind
from lightflyer.foundation.quantity import Section

_Count = Annotated[int, pydantic.Field(strict=True, ge=1)]
_Seed = Annotated[int, pydantic.Field(strict=True, ge=0)]


def _listed(value: Any) -> tuple[str, ...]:
    """One name, or several, as several."""
    names = (value,) if isinstance(value, str) else value
    if isinstance(names, list | tuple) and all(isinstance(name, str) for name in names):
        return tuple(names)
    raise ValueError('is not the name of an output, such as "payload", or a list of such names')


_Names = Annotated[tuple[str, ...], pydantic.BeforeValidator(_listed)]
_Entries = Annotated[dict[str, Any], pydantic.Field(default_factory=dict)]


class OutputsSection(Section):
    """``[outputs]``: what a sweep computes."""

    variables: list[str]


class SamplingSection(Section):
    """``[sampling]``: how the distributions of a study are drawn."""

    method: Literal["sobol", "latin-hypercube", "random"] = "sobol"
    points: _Count = 1024
    seed: _Seed = 0


class UncertaintySection(Section):
    """``[optimise.uncertainty]``: which number stands for an output that is uncertain."""

    of: Literal["mean", "quantile"] = "mean"
    quantile: Annotated[float, pydantic.Field(gt=0.0, lt=1.0)] = 0.05


class OptimiseSection(Section):
    """``[optimise]``: what is wanted, over which fields, and within which limits."""

    maximise: _Names = ()
    minimise: _Names = ()
    over: _Entries
    constraints: _Entries
    uncertainty: UncertaintySection | None = None
    starts: _Count = 8
    seed: _Seed = 0


class SensitivitySection(Section):
    """``[sensitivity]``: which output, where, and what is uncertain about it."""

    outputs: _Names = ("payload",)
    at: _Entries
    inputs: _Entries
    points: _Count = 1024
    seed: _Seed = 0


class StudyFile(Section):
    """A study file."""

    flyer: str
    sweep: _Entries
    outputs: OutputsSection | None = None
    sampling: SamplingSection = SamplingSection()
    optimise: OptimiseSection | None = None
    sensitivity: SensitivitySection | None = None


_SECTIONS: dict[str, type[pydantic.BaseModel]] = {
    "": StudyFile,
    "outputs": OutputsSection,
    "sampling": SamplingSection,
    "optimise": OptimiseSection,
    "optimise.uncertainty": UncertaintySection,
    "sensitivity": SensitivitySection,
}

STUDY_FILE = FileKind(
    "a study file",
    lambda section, _: list(_SECTIONS[section].model_fields),
    'it needs flyer = "flyer.toml" and a section [sweep]',
)
"""How messages speak of a study file."""
