"""A film from its spectra in words."""

from typing import TYPE_CHECKING

from lightflyer.core.text import correlation_text
from lightflyer.files.result_text import Parts, listed, table_of
from lightflyer.lab.estimate import Estimate, estimate_table
from lightflyer.lab.optics.diagnostics import display_unit

if TYPE_CHECKING:
    from lightflyer.lab.optics.fit import OpticsFit

_PERCENT = 100.0
_HEADINGS = ("spectrum", "scatter\n[%]", "points", "indepen-\ndent", "scale's\nerror [%]",
             "zero's\nerror [%]")  # fmt: skip
_DIGITS = 5


def finding_parts(result: "OpticsFit") -> Parts:
    """Fitted numbers in a sentence."""
    yield listed(f"{name} {in_display_unit(one)}" for name, one in result.numbers.items())


def fit_parts(result: "OpticsFit") -> Parts:
    """Fitted numbers, what the fitted film does, and the errors of the instruments."""
    numbers = [(name, in_display_unit(one)) for name, one in result.numbers.items()]
    yield estimate_table(numbers, "fitted", _DIGITS)
    if result.predictions:
        yield estimate_table(result.predictions.items(), "of the fitted film", _DIGITS)
    yield table_of(
        _HEADINGS,
        (
            (
                one.measured.label, f"{_PERCENT * one.scatter.deviation:.2f}",
                f"{len(one.reading)}", f"{one.scatter.independent:.0f}",
                f"{_PERCENT * one.scale_error:+.2f}", f"{_PERCENT * one.zero_error:+.2f}",
            )
            for one in result.spectra
        ),
    )  # fmt: skip

    yield correlation_text(list(result.numbers), result.correlation)


def in_display_unit(one: Estimate) -> Estimate:
    """The estimate in the unit that people write such numbers of films in."""
    scale, unit = display_unit(one.unit)
    low, high = one.interval
    return Estimate(one.value / scale, (low / scale, high / scale), unit)
