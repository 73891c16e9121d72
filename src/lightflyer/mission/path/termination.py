"""Why a mission ended."""

from lightflyer.numerics.rootfind import Reason


class TerminationReason(Reason):
    """Why a mission ended."""

    STILL_FLYING = 0, "is still aloft at the end of its time"
    LOWEST_ALTITUDE = 1, "reached the lowest altitude"
    HIGHEST_ALTITUDE = 2, "reached the highest altitude"
    NO_DATA = 3, "met a place or a time without data"
    STEP_LIMIT = 4, "reached the limit of steps"
    TOO_HOT = 5, "got hotter than its film bears"
    TORN = 6, "tore: a layer's tension passed its strength"
    INTERRUPTED = 7, "was interrupted"
