"""Options and words that the commands of levitation points share."""

import math

from lightflyer.cli.lab._shared import quantity


def accuracy(option: str, text: str | None) -> float | None:
    """An instrument's accuracy such as "5 %", None where none is given.

    Parameters
    ----------
    option : str
        Name of the option, for messages.
    text : str or None

    Returns
    -------
    float or None
    """
    return None if text is None else quantity(option, text, "").value


def interval_text(low: float, high: float) -> str:
    """An interval in words where an end is open.

    Parameters
    ----------
    low, high : float

    Returns
    -------
    str
    """
    if math.isinf(high):
        return f"above {low:.4g}" if low > 0.0 else "unknown"
    return f"{low:.4g} to {high:.4g}" if low > 0.0 else f"below {high:.4g}"
