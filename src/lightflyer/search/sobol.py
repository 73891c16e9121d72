r"""Which uncertain input costs most: Sobol indices, elasticities, one input at a time.

The variance of an output :math:`q` over its independent inputs splits into the share of each
alone, :math:`S_i = \mathrm{Var}[\mathrm E(q\,|\,x_i)]/\mathrm{Var}[q]`, and in total with all its
interactions, :math:`T_i = 1 - \mathrm{Var}[\mathrm E(q\,|\,x_{\sim i})]/\mathrm{Var}[q]`
([Sobol2001]_, [Saltelli2010]_). What has the largest share is worth measuring better: halving its
standard uncertainty takes away three quarters of its own share.

Indices need independent inputs. Two whose errors are correlated vary together and count as one,
which is independent of all others: :math:`x_i` is then a pair.
"""

import contextlib
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.config.sections import FlyerFile
from lightflyer.flight.fields import field
from lightflyer.flight.outputs import check_outputs
from lightflyer.foundation.errors import ConfigurationError, MissingExtraError
from lightflyer.search.problem import stated_distributions
from lightflyer.sweeps.axes import SAMPLE, Axis, Distribution, read_entry
from lightflyer.sweeps.evaluation import Evaluator
from lightflyer.sweeps.sections import SensitivitySection
from lightflyer.sweeps.study import Dimension, Source, Study, located, read_study
from lightflyer.uncertainty.correlation import correlate, correlated_groups

_ENDS = (0.025, 0.975)
_STEP = 1e-4  # of an input's 95 % range, for elasticities
_ERRORS_OF_MODELS = ("force.force_error", "force.heat_error")  # which nobody can measure
_LARGEST_INTERVAL = 0.2  # of a share, beyond which shares are not ranked
_LEFT_BY_HALVING = 0.25  # of a variance, when a standard deviation is halved


@dataclass(frozen=True)
class Inquiry:
    """What a sensitivity asks.

    Attributes
    ----------
    configuration : FlyerFile
    outputs : tuple of str
    fixed : dict of str to float
        Fields that have one value, by dotted name.
    inputs : tuple of Distribution
    points : int
        Base samples; there are (inputs + 2) times as many designs.
    seed : int
    """

    configuration: FlyerFile
    outputs: tuple[str, ...]
    fixed: dict[str, float]
    inputs: tuple[Distribution, ...]
    points: int
    seed: int

    @property
    def names(self) -> tuple[str, ...]:
        """Of the inputs, dotted."""
        return tuple(part.field.name for part in self.inputs)

    @property
    def tac_correlation(self) -> float:
        """Of the errors of the faces' accommodation coefficients."""
        return self.configuration.film.tac_correlation.value

    @property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """Names of the inputs, those with correlated errors together."""
        return correlated_groups(self.names, self.tac_correlation)


@dataclass(frozen=True)
class Indices:
    """What the uncertainty of each input does to an output.

    Attributes
    ----------
    output : str
    groups : tuple of tuple of str
        Names of the inputs, dotted; those with correlated errors together, g in all.
    nominal, mean, spread : float
        The output at the inputs' medians, its mean and its standard deviation, in SI units.
    first, total : array, shape (g,)
        Sobol indices.
    first_interval, total_interval : array, shape (g,)
        Half widths of their 95 % intervals.
    low, high : array, shape (g,)
        Output with one input at its 2.5 % and its 97.5 % quantile, the others at their medians.
        Where two vary together, the output's own quantiles.
    elasticity : dict of str to float
        Relative change of the output over that of an input, by the input's name; not a number for
        an input whose median is zero.
    """

    output: str
    groups: tuple[tuple[str, ...], ...]
    nominal: float
    mean: float
    spread: float
    first: np.ndarray
    total: np.ndarray
    first_interval: np.ndarray
    total_interval: np.ndarray
    low: np.ndarray
    high: np.ndarray
    elasticity: dict[str, float]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the groups."""
        return tuple(" and ".join(group) for group in self.groups)

    @property
    def ranked(self) -> bool:
        """Whether the shares are known well enough to say which is the largest."""
        return bool(np.max(self.first_interval) < _LARGEST_INTERVAL)

    @property
    def next(self) -> str | None:
        """The input whose better measurement would help most; None if none can be measured."""
        row = self._row_of_next
        return None if row is None else self.names[row]

    @property
    def _row_of_next(self) -> int | None:
        measurable = [
            row
            for row, group in enumerate(self.groups)
            if not any(name in _ERRORS_OF_MODELS for name in group)
        ]
        return max(measurable, key=lambda row: float(self.first[row]), default=None)

    @property
    def spread_after_halving(self) -> float:
        """Standard deviation of the output if that input's were halved."""
        row = self._row_of_next
        share = 0.0 if row is None else float(np.clip(self.first[row], 0.0, 1.0))
        return self.spread * float(np.sqrt(1.0 - (1.0 - _LEFT_BY_HALVING) * share))

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
        }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def read_inquiry(path: str | Path) -> Inquiry:
    """Read the ``[sensitivity]`` of a study file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Inquiry

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key and what is allowed.
    """
    study, configuration, source = read_study(path)
    if study.sensitivity is None:
        raise ConfigurationError(
            f'{path}: needs a section [sensitivity] with outputs = "payload", and its place: '
            '[sensitivity.at] with altitude = "70 km"'
        )
    return make_inquiry(configuration, study.sensitivity, source)


def make_inquiry(
    configuration: FlyerFile, section: SensitivitySection, source: Source | None = None
) -> Inquiry:
    """Look up what a sensitivity names and check it.

    Parameters
    ----------
    configuration : FlyerFile
    section : SensitivitySection
    source : Source, optional
        Names file and line in errors.

    Returns
    -------
    Inquiry

    Raises
    ------
    ConfigurationError
        Naming the key and what is wrong with it.
    """
    fixed: dict[str, float] = {}
    for name, entry in section.at.items():
        found = _read(configuration, name, entry, ["sensitivity", "at", name], source)
        if not (isinstance(found, Axis) and found.single):
            message = ' is not one value, such as "70 km"'
            raise located(source, ["sensitivity", "at", name], message)
        fixed[name] = float(found.values[0])
    inputs: Sequence[Distribution] = []
    for name, entry in section.inputs.items():
        found = _read(configuration, name, entry, ["sensitivity", "inputs", name], source)
        if isinstance(found, Axis):
            message = ' is not uncertain; write "0.80 ± 0.01" or { distribution = ... }'
            raise located(source, ["sensitivity", "inputs", name], message)
        inputs = [*inputs, found]
    inputs = inputs or stated_distributions(configuration, list(fixed))
    if not inputs:
        message = ": nothing is uncertain; write ± in the flyer file or [sensitivity.inputs]"
        raise located(source, ["sensitivity"], message)
    try:
        check_outputs(section.outputs, configuration, list(fixed))
    except ConfigurationError as error:
        raise located(source, ["sensitivity", "outputs"], f": {error}") from None
    return Inquiry(
        configuration, section.outputs, fixed, tuple(inputs), section.points, section.seed
    )


def _read(
    configuration: FlyerFile, name: str, entry: Any, keys: list[str], source: Source | None
) -> Axis | Distribution:
    try:
        known = field(configuration, name)
    except ConfigurationError as error:
        raise located(source, keys, str(error).removeprefix(name)) from None
    try:
        return read_entry(entry, known)
    except ConfigurationError as error:
        raise located(source, keys, f": {error}") from None


def sensitivity_indices(inquiry: Inquiry) -> list[Indices]:
    """Sobol indices and elasticities of each output.

    Parameters
    ----------
    inquiry : Inquiry

    Returns
    -------
    list of Indices

    Raises
    ------
    ConfigurationError
        If an output has no value for some of the samples.
    MissingExtraError
        If SALib is not installed.

    Notes
    -----
    Inputs are independent, but for the two accommodation coefficients where the flyer file gives
    their errors a correlation: these two vary together and share one index.

    References
    ----------
    [Sobol2001]_, [Saltelli2010]_; computed by SALib, [Iwanaga2022]_.
    """
    try:
        from SALib.analyze import sobol as analysis
        from SALib.sample import sobol as sampling
    except ImportError:
        raise MissingExtraError(
            "Sobol indices need SALib: pip install 'lightflyer[optimise]'"
        ) from None
    space = _space(inquiry)
    power = 2 ** int(np.ceil(np.log2(inquiry.points)))
    shares = sampling.sample(space, power, calc_second_order=False, seed=inquiry.seed)
    sizes, designs = _designs(inquiry, shares, power)
    table = _evaluate(inquiry, designs)
    results = []
    for output in inquiry.outputs:
        values, middle, *alone, down, up = np.split(table[output], np.cumsum(sizes)[:-1])
        if np.isnan(values).any():
            raise ConfigurationError(
                f"{output}: {100.0 * np.mean(np.isnan(values)):.2g} % of the samples have none; "
                "choose an output that every design has, such as lift_over_weight"
            )
        with contextlib.redirect_stdout(io.StringIO()):
            # SALib takes a seed of 0 for none
            found = analysis.analyze(
                space,
                values,
                calc_second_order=False,
                seed=1 + inquiry.seed,
                print_to_console=False,
            )
        nominal, count = float(middle[0]), len(inquiry.groups)
        ends = [
            part if len(group) == 1 else np.quantile(part, _ENDS)
            for group, part in zip(inquiry.groups, alone, strict=True)
        ]
        low, high = np.transpose(ends)
        results.append(
            Indices(
                output=output,
                groups=inquiry.groups,
                nominal=nominal,
                mean=float(values.mean()),
                spread=float(values.std()),
                first=np.asarray(found["S1"])[:count],
                total=np.asarray(found["ST"])[:count],
                first_interval=np.asarray(found["S1_conf"])[:count],
                total_interval=np.asarray(found["ST_conf"])[:count],
                low=low,
                high=high,
                elasticity=_elasticities(inquiry, nominal, up - down),
            )
        )
    return results


def _space(inquiry: Inquiry) -> dict[str, Any]:
    """The unit cube of the inputs' shares, as SALib describes it."""
    names = [*inquiry.names]
    groups = [
        str(row) for name in names for row, group in enumerate(inquiry.groups) if name in group
    ]
    if len(inquiry.groups) == 1:
        # SALib takes one group for none, so there is another, which nothing depends on
        names, groups = [*names, "nothing"], [*groups, "nothing"]
    bounds = [[0.0, 1.0]] * len(names)
    return {"num_vars": len(names), "names": names, "groups": groups, "bounds": bounds}


def _designs(
    inquiry: Inquiry, shares: np.ndarray, base: int
) -> tuple[list[int], dict[str, np.ndarray]]:
    """Sizes of the blocks of designs, and the inputs of all of them.

    The blocks: the samples; all inputs at their medians; each group alone, at the ends of an
    input's range or over samples of a pair; each input a small step down; each a step up.
    """
    names, count = inquiry.names, len(inquiry.inputs)
    sampled = shares[:, :count]
    blocks = [sampled, np.full((1, count), 0.5)]
    for group in inquiry.groups:
        columns = [names.index(name) for name in group]
        alone = sampled[:: len(shares) // base] if len(group) > 1 else np.array(_ENDS)[:, None]
        block = np.full((len(alone), count), 0.5)
        block[:, columns] = alone[:, columns] if len(group) > 1 else alone
        blocks.append(block)
    drawn = correlate(np.concatenate(blocks), names, inquiry.tac_correlation)
    designs = {}
    for column, part in enumerate(inquiry.inputs):
        median, step = _median_and_step(part)
        near = np.full(2 * count, median)
        near[column] -= step
        near[count + column] += step
        designs[part.field.name] = np.concatenate([part.quantile(drawn[:, column]), near])
    return [*map(len, blocks), count, count], designs


def _median_and_step(part: Distribution) -> tuple[float, float]:
    low, median, high = part.quantile(np.array([_ENDS[0], 0.5, _ENDS[1]]))
    return float(median), _STEP * float(high - low)


def _elasticities(inquiry: Inquiry, nominal: float, change: np.ndarray) -> dict[str, float]:
    """Relative change of an output over that of each input, from a small step both ways."""
    medians, steps = np.array([_median_and_step(part) for part in inquiry.inputs]).T
    slopes = change / (2.0 * steps)
    relative = np.where(medians == 0.0, np.nan, slopes * medians / nominal)
    return dict(zip(inquiry.names, relative.tolist(), strict=True))


def _evaluate(inquiry: Inquiry, values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    study = Study(
        inquiry.configuration,
        (Dimension(SAMPLE, values),),
        inquiry.fixed,
        inquiry.outputs,
        {part.field.name: part.field for part in inquiry.inputs},
    )
    outputs, _ = Evaluator(study)(0, study.size)
    return outputs
