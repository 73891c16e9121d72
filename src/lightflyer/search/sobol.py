r"""Which uncertain input matters most: Sobol indices, elasticities, one input at a time.

The variance of an output :math:`q` over its independent inputs splits into the share of each
alone, :math:`S_i = \mathrm{Var}[\mathrm E(q\,|\,x_i)]/\mathrm{Var}[q]`, and in total with all its
interactions, :math:`T_i = 1 - \mathrm{Var}[\mathrm E(q\,|\,x_{\sim i})]/\mathrm{Var}[q]`
([Sobol2001]_, [Saltelli2010]_). The input with the largest share is worth measuring better: halving
its standard uncertainty removes three quarters of its own share.

Indices need independent inputs. Those whose errors are correlated vary together and count as one
input, which is independent of all others: :math:`x_i` is then a group.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.compute.evaluation import Evaluator
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.extras import extra
from lightflyer.core.progress import Counted
from lightflyer.core.quantity import StandardErrors, quantity_of
from lightflyer.core.units import file_unit
from lightflyer.design.design import AbstractDesign
from lightflyer.design.diagnostics import diagnose_design
from lightflyer.design.outputs import check_outputs, outputs_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.files.result_text import Parts, PrintedResult
from lightflyer.force.base import AbstractForceModel
from lightflyer.search.sobol_estimates import (
    REPLICATES,
    MeasuredDifference,
    indices_with_intervals,
    measured_differences,
)
from lightflyer.study.axes import SAMPLE, Distribution, StudyAxis, read_entry, stated_distributions
from lightflyer.study.sections import SensitivitySection, from_arguments
from lightflyer.study.study import (
    Dimension,
    Study,
    StudySource,
    errors_at,
    read_study_file,
    require_compatible,
)
from lightflyer.uncertainty.inputs import correlate, correlated_groups

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_ENDS = (0.025, 0.975)
_STEP = 1e-4  # of an input's 95 % range, for elasticities
_OWN_ERROR = quantity_of(StandardErrors)  # of a model, which cannot be measured
_LARGEST_INTERVAL = 0.2  # of a share, beyond which shares are not ranked
_OF_SHARING = ".sharing_error"
_LEFT_BY_HALVING = 0.25  # of a variance, when a standard deviation is halved


@dataclass(frozen=True)
class SensitivityStudy(ShortRepr):
    """Which outputs, where, and which inputs are uncertain."""

    design: AbstractDesign
    outputs: tuple[str, ...]
    fixed: dict[str, float]  #: Numbers that have one value, by dotted name
    inputs: tuple[Distribution, ...]
    points: int  #: Number of base samples; there are (inputs + 2) times as many designs
    seed: int

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted names of the inputs."""
        return tuple(part.field.name for part in self.inputs)

    @property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """Names of the inputs, those with correlated errors together."""
        return correlated_groups(self.names, self.design.correlations)

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlations of the errors of two inputs, where they are not zero."""
        return {
            pair: value
            for pair, value in self.design.correlations.items()
            if value and set(pair) <= set(self.names)
        }


@dataclass(frozen=True, repr=False)
class Indices(PrintedResult):
    """Effect of the uncertainty of each input on an output."""

    output: str
    attributes: dict[str, str]  #: Unit and long name of the output, as in datasets
    #: Dotted names of the inputs, those with correlated errors together, g groups in all
    groups: tuple[tuple[str, ...], ...]
    #: Whether measurements can reduce the uncertainty: not where it is a model's own error
    measurable: tuple[bool, ...]
    nominal: float  #: Output at the inputs' medians, its mean and its standard deviation
    mean: float  #: Output at the inputs' medians, its mean and its standard deviation
    spread: float  #: Output at the inputs' medians, its mean and its standard deviation
    first: np.ndarray  #: shape (g,); sobol indices
    total: np.ndarray  #: shape (g,); sobol indices
    first_interval: np.ndarray  #: shape (g,); half widths of their 95 % intervals
    total_interval: np.ndarray  #: shape (g,); half widths of their 95 % intervals
    #: shape (g,); output with one input at its 2.5 % and its 97.5 % quantile, the others at their
    #: medians; quantiles of the output where several inputs vary together
    low: np.ndarray
    #: shape (g,); output with one input at its 2.5 % and its 97.5 % quantile, the others at their
    #: medians; quantiles of the output where several inputs vary together
    high: np.ndarray
    #: Relative change of the output over that of an input, by the input's name; not a number for an
    #: input whose median is zero
    elasticity: dict[str, float]
    warnings: tuple[str, ...]  #: What a reader must know, one line each
    #: Worth of measuring the difference of a film's two accommodation coefficients
    differences: tuple[MeasuredDifference, ...] = ()
    #: Factor from the output's SI unit, and the unit that its values are shown in
    shown: tuple[float, str] = (1.0, "")

    def plot(self) -> "Figure":
        """Draw the effect of each input, and the shares of the variance."""
        from lightflyer.search.text import tornado_figure

        return tornado_figure(self)

    @property
    def unit(self) -> str:
        """Unit of the output as in a flyer file, empty for a pure number."""
        return file_unit(self.attributes["units"])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the groups."""
        return tuple(" and ".join(group) for group in self.groups)

    @property
    def ranked(self) -> bool:
        """Whether the shares are known well enough to say which is the largest."""
        return bool(np.max(self.first_interval) < _LARGEST_INTERVAL)

    @property
    def next(self) -> str | None:
        """Input whose better measurement would help most; None if none can be measured."""
        row = self._row_of_next
        return None if row is None else self.names[row]

    @property
    def _row_of_next(self) -> int | None:
        rows = np.flatnonzero(self.measurable).tolist()
        return max(rows, key=lambda row: float(self.first[row]), default=None)

    @property
    def spread_after_halving(self) -> float:
        """Standard deviation of the output if that input's were halved."""
        row = self._row_of_next
        share = 0.0 if row is None else float(np.clip(self.first[row], 0.0, 1.0))
        return self.spread * float(np.sqrt(1.0 - (1.0 - _LEFT_BY_HALVING) * share))

    @property
    def with_known_force(self) -> tuple[float, float] | None:
        """Share of the variance that a measured force removes, and the spread that it leaves."""
        # a pair of TACs leaves open how the faces share it, and so the force
        rows = [row for row, name in enumerate(self.names) if name.endswith(_OF_SHARING)]
        if not rows:
            return None
        share = float(np.clip(self.first[rows[0]], 0.0, 1.0))
        return share, self.spread * float(np.sqrt(1.0 - share))

    @property
    def dataset(self) -> "xr.Dataset":
        """Shares and ranges over the dimension ``input``."""
        import xarray as xr

        share = {"units": "1", "long_name": "share of the variance (Sobol index)"}
        shares = ("first", "first_interval", "total", "total_interval")
        attributes = dict.fromkeys(shares, share) | dict.fromkeys(("low", "high"), self.attributes)
        return xr.Dataset(
            {name: ("input", getattr(self, name), words) for name, words in attributes.items()},
            {"input": ("input", list(self.names))},
            {"title": f"lightflyer sensitivity of {self.output}"},
        )

    def text_parts(self) -> Parts:
        from lightflyer.search.text import indices_parts

        return indices_parts(self)

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        columns = {
            "first": self.first,
            "first_interval_95": self.first_interval,
            "total": self.total,
            "total_interval_95": self.total_interval,
            "low": self.low,
            "high": self.high,
        }
        return {
            "nominal": self.nominal,
            "mean": self.mean,
            "standard_deviation": self.spread,
            "inputs": {
                name: {key: _finite(column[row]) for key, column in columns.items()}
                for row, name in enumerate(self.names)
            },
            "elasticities": {name: _finite(value) for name, value in self.elasticity.items()},
            "measure_next": self.next,
            "standard_deviation_after_halving": self.spread_after_halving,
            "standard_deviation_with_known_force": (self.with_known_force or (0.0, None))[1],
            "measured_differences": [one.summary(self.spread) for one in self.differences],
            "warnings": list(self.warnings),
        }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def read_sensitivity_study(path: str | Path) -> SensitivityStudy:
    """Read the ``[sensitivity]`` of a study file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    SensitivityStudy

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key and what is allowed.
    """
    study, design, source = read_study_file(path)
    if study.sensitivity is None:
        raise ConfigurationError(
            f'{path}: needs a section [sensitivity] with outputs = "payload", and '
            '[sensitivity.at] with altitude = "70 km"'
        )
    return make_sensitivity_study(design, study.sensitivity, source)


def make_sensitivity_study(
    design: AbstractDesign, section: SensitivitySection, source: StudySource | None = None
) -> SensitivityStudy:
    """Look up what a sensitivity study names and check it."""
    fixed: dict[str, float] = {}
    for name, entry in section.at.items():
        with errors_at(source, "sensitivity", "at", name):
            found = read_entry(entry, design.field(name))
            if not (isinstance(found, StudyAxis) and found.single):
                raise ConfigurationError('is not one value, such as "70 km"')
        fixed[name] = float(found.values[0])
    inputs: list[Distribution] = []
    for name, entry in section.inputs.items():
        with errors_at(source, "sensitivity", "inputs", name):
            found = read_entry(entry, design.field(name))
            if isinstance(found, StudyAxis):
                raise ConfigurationError(
                    'is not uncertain; write "0.80 ± 0.01" or { distribution = ... }'
                )
        inputs.append(found)
    require_compatible(design, [*fixed, *section.inputs], source, "sensitivity", "inputs")
    inputs = inputs or stated_distributions(design, fixed)
    with errors_at(source, "sensitivity"):
        if not inputs:
            raise ConfigurationError(
                "no number is uncertain; state uncertainties in the flyer file or in inputs"
            )
    with errors_at(source, "sensitivity", "outputs"):
        check_outputs(section.outputs, design.setup, list(fixed))
    return SensitivityStudy(
        design, section.outputs, fixed, tuple(inputs), section.points, section.seed
    )


def sensitivity(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    outputs: str | Sequence[str] | None = None,
    at: Mapping[str, Any] | None = None,
    inputs: Mapping[str, Any] | None = None,
    points: int | None = None,
    seed: int | None = None,
) -> list[Indices]:
    """Sobol indices and elasticities of outputs in uncertain inputs.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path, AbstractDesign or SensitivityStudy
        What is uncertain; or all of the study, from :func:`read_sensitivity_study`.
    environment, model : optional
        Where ``what`` is a flyer.
    outputs : str or sequence of str, optional
        Names of outputs, by default ``"payload"``.
    at : dict of str to object, optional
        Values of numbers, such as ``{"altitude": "72 km"}``.
    inputs : dict of str to object, optional
        Distributions of the uncertain numbers by name, such as ``"0.80 ± 0.01"``; by default the
        uncertainties of the design.
    points : int, optional
        Number of base samples, by default 1024; there are (inputs + 2) times as many designs.
    seed : int, optional
        Default 0.

    Returns
    -------
    list of Indices
        One for each output.

    Raises
    ------
    ConfigurationError
        If a number or an output does not exist, or an output has no value for some samples.
    MissingExtraError
        If SALib is not installed.

    Notes
    -----
    Inputs are independent, but for those whose errors the design states to be correlated: these
    vary together and share one index.

    References
    ----------
    [Sobol2001]_, [Saltelli2010]_; computed by SALib, [Iwanaga2022]_.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> (found,) = lf.sensitivity(
    ...     lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023(),
    ...     outputs="own_mass", inputs={"flyer.radius": "1.0 ± 0.1 cm"}, points=64,
    ... )
    >>> print(f"{found.elasticity['flyer.radius']:.4f}")
    2.0000
    """
    if isinstance(what, SensitivityStudy):
        if any(
            part is not None for part in (environment, model, outputs, at, inputs, points, seed)
        ):
            raise ParameterError("a SensitivityStudy already states all that is asked")
        return _indices(what)
    section = from_arguments(
        SensitivitySection, outputs=outputs, at=at, inputs=inputs, points=points, seed=seed
    )
    return _indices(make_sensitivity_study(as_design(what, environment, model), section))


def _indices(study: SensitivityStudy) -> list[Indices]:
    sampling = extra("SALib.sample.sobol", "a sensitivity study", "optimise")
    # the unit cube of the inputs' shares, as SALib describes it
    names, sets, ends = [*study.names], study.groups, np.array(_ENDS)
    groups = [str(row) for name in names for row, group in enumerate(sets) if name in group]
    if len(sets) == 1:
        # SALib takes one group for none, so there is another, which nothing depends on
        names, groups = [*names, "nothing"], [*groups, "nothing"]
    bounds = [[0.0, 1.0]] * len(names)
    space = {"num_vars": len(names), "names": names, "groups": groups, "bounds": bounds}
    power = 2 ** int(np.ceil(np.log2(study.points)))
    seeds = np.random.default_rng(study.seed).integers(2**31, size=min(REPLICATES, power))
    each = power // seeds.size
    shares = np.concatenate(
        [sampling.sample(space, each, calc_second_order=False, seed=int(seed)) for seed in seeds]
    )
    # Blocks of designs: the samples; all inputs at their medians; each group alone, at the ends of
    # an input's range or over samples of a pair; each input a small step down; each a step up.
    count = len(study.inputs)
    sampled = shares[:, :count]
    blocks = [sampled, np.full((1, count), 0.5)]
    for group in sets:
        columns = [study.names.index(name) for name in group]
        alone = sampled[:: len(shares) // power] if len(group) > 1 else ends[:, None]
        block = np.full((len(alone), count), 0.5)
        block[:, columns] = alone[:, columns] if len(group) > 1 else alone
        blocks.append(block)
    drawn = correlate(np.concatenate(blocks), study.names, study.design.correlations)
    designs, medians, steps = {}, np.zeros(count), np.zeros(count)
    for column, part in enumerate(study.inputs):
        low, medians[column], high = part.quantile(np.array([_ENDS[0], 0.5, _ENDS[1]]))
        steps[column] = _STEP * float(high - low)
        near = np.full(2 * count, medians[column])
        near[column] -= steps[column]
        near[count + column] += steps[column]
        designs[part.field.name] = np.concatenate([part.quantile(drawn[:, column]), near])
    whole = Study(study.design, (Dimension(SAMPLE, designs),), study.fixed, study.outputs)
    evaluate = Evaluator(whole)
    evaluate.counted = Counted("computing designs", whole.size, "designs")
    table, _ = evaluate(0, whole.size)
    said, nominals = study.design.sampling_warnings, dict(zip(study.names, medians, strict=True))
    if study.design.coordinate_name in study.fixed | nominals:
        more = diagnose_design(study.design, study.fixed | nominals)
        said = tuple(dict.fromkeys((*said, *more)))
    places, found = np.cumsum([*map(len, blocks), count]), []
    for output in study.outputs:
        values, middle, *each, down, up = np.split(table[output], places)
        if np.isnan(values).any():
            raise ConfigurationError(
                f"{output}: {100.0 * np.mean(np.isnan(values)):.3g} % of the samples have none; "
                "choose an output that every design has, such as lift_over_weight"
            )
        nominal = float(middle[0])
        (first, total), half = indices_with_intervals(values, len(set(groups)), len(sets))
        low, high = np.transpose(
            [
                part if len(group) == 1 else np.quantile(part, _ENDS)
                for group, part in zip(sets, each, strict=True)
            ]
        )
        slopes = (up - down) / (2.0 * steps)
        elasticity = np.where(medians == 0.0, np.nan, slopes * medians / nominal)
        known = outputs_of(study.design.setup)[output]
        inputs = {name: column[: len(values)] for name, column in designs.items()}
        found.append(Indices(
            output=output,
            attributes=known.attributes,
            groups=sets,
            measurable=tuple(
                all(study.design.field(name).quantity != _OWN_ERROR for name in group)
                for group in sets
            ),
            nominal=nominal,
            mean=float(values.mean()),
            spread=float(values.std()),
            first=first,
            total=total,
            first_interval=half[0],
            total_interval=half[1],
            low=low,
            high=high,
            elasticity=dict(zip(study.names, elasticity.tolist(), strict=True)),
            warnings=said,
            differences=measured_differences(values, inputs, study.seed),
            shown=known.display_unit_for([nominal, *low, *high]),
        ))  # fmt: skip
    return found
