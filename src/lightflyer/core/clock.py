"""Dates and the seconds that places count: since 2000-01-01 12:00 UTC."""

import datetime
import re
from typing import Any

import numpy as np

from lightflyer.core.errors import ParameterError

EPOCH = datetime.datetime(2000, 1, 1, 12, tzinfo=datetime.UTC)
"""Instant from which the time of a place is counted."""

_EPOCH = np.datetime64("2000-01-01T12:00:00", "ns")
_NANOSECONDS = 1e9
_DAY = re.compile(r"\d{4}-\d\d-\d\d")


def require_hour(instant: Any) -> Any:
    """Raise :class:`ParameterError` for a day without an hour, which is no instant; else it."""
    if _DAY.fullmatch(str(instant).strip()):
        raise ParameterError(f"{instant} is a day; add the hour, as in {instant}T12:00Z")
    return instant


def seconds_of(instant: Any) -> Any:
    """Seconds since the epoch [s]; leap seconds are not counted."""
    require_hour(instant)
    if isinstance(instant, str):
        try:
            instant = datetime.datetime.fromisoformat(instant)
        except ValueError:
            raise ParameterError(
                f'time = "{instant}" is not a date; write it such as 2026-06-21T12:00:00Z'
            ) from None
    if isinstance(instant, datetime.datetime):
        if instant.tzinfo is None:
            instant = instant.replace(tzinfo=datetime.UTC)
        return (instant - EPOCH).total_seconds()
    if isinstance(instant, np.datetime64):
        return float((instant.astype("datetime64[ns]") - _EPOCH).astype(float) / _NANOSECONDS)
    return instant


def dates_of(seconds: Any) -> np.ndarray:
    """Dates of seconds since the epoch; UTC; not a time where the number is not finite."""
    seconds = np.asarray(seconds, float)
    known = np.isfinite(seconds)
    offsets = np.round(np.where(known, seconds, 0.0) * _NANOSECONDS).astype("timedelta64[ns]")
    dates = _EPOCH + offsets
    return np.where(known, dates, np.datetime64("NaT", "ns"))


def date_text(seconds: float) -> str:
    """Date in words for tables; ``seconds``: since the epoch."""
    instant = EPOCH + datetime.timedelta(seconds=float(seconds))
    return f"{instant:%Y-%m-%d %H:%M} UTC"
