"""Why a mission ended."""

import enum


class MissionEnd(enum.IntEnum):
    """Why a mission ended."""

    STILL_FLYING = 0
    LOWEST_ALTITUDE = 1
    HIGHEST_ALTITUDE = 2
    NO_DATA = 3
    STEP_LIMIT = 4

    def describe(self) -> str:
        """Phrase for tables and messages.

        Returns
        -------
        str

        Examples
        --------
        >>> MissionEnd.STILL_FLYING.describe()
        'is still flying at the end of its time'
        """
        return _REASONS[self]


_REASONS = {
    MissionEnd.STILL_FLYING: "is still flying at the end of its time",
    MissionEnd.LOWEST_ALTITUDE: "reached the lowest altitude",
    MissionEnd.HIGHEST_ALTITUDE: "reached the highest altitude",
    MissionEnd.NO_DATA: "met a place or a time without data",
    MissionEnd.STEP_LIMIT: "reached the limit of steps",
}
