"""Why a mission ended."""

import enum


class TerminationReason(enum.IntEnum):
    """Why a mission ended."""

    STILL_FLYING = 0
    LOWEST_ALTITUDE = 1
    HIGHEST_ALTITUDE = 2
    NO_DATA = 3
    STEP_LIMIT = 4

    def describe(self) -> str:
        """Phrase for tables and messages.

        Examples
        --------
        >>> TerminationReason.STILL_FLYING.describe()
        'is still flying at the end of its time'
        """
        return _REASONS[self]


_REASONS = {
    TerminationReason.STILL_FLYING: "is still flying at the end of its time",
    TerminationReason.LOWEST_ALTITUDE: "reached the lowest altitude",
    TerminationReason.HIGHEST_ALTITUDE: "reached the highest altitude",
    TerminationReason.NO_DATA: "met a place or a time without data",
    TerminationReason.STEP_LIMIT: "reached the limit of steps",
}
