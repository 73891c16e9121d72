"""One comparison of an interval with the truth."""

from typing import NamedTuple


class Trial(NamedTuple):
    """An interval that the package printed for a synthetic case, and the truth of that case.

    Attributes
    ----------
    quantity : str
        What was estimated, in the words of the command's table; the condition after a comma where
        a command is tried under several.
    truth : float
    low, high : float
        Ends of the interval, in the unit of the truth.
    """

    quantity: str
    truth: float
    low: float
    high: float

    @property
    def covered(self) -> bool:
        """Whether the truth lies within the interval."""
        return self.low <= self.truth <= self.high
