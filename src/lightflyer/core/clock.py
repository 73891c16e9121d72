"""Dates and the seconds that places count: since 2000-01-01 12:00 UTC."""

import datetime
import warnings
from numbers import Real
from typing import Any

import numpy as np

from lightflyer.array.namespace import is_tracer
from lightflyer.core.checks import is_concrete, is_labelled
from lightflyer.core.errors import ParameterError, ParameterWarning

EPOCH = datetime.datetime(2000, 1, 1, 12, tzinfo=datetime.UTC)
"""Instant from which the time of a place is counted."""

_EPOCH = np.datetime64("2000-01-01T12:00:00", "ns")
_NANOSECONDS = 1e9
_YEAR = 365.25 * 86400.0  # [s]
_LIKE_UNIX_TIME = 978_307_200.0  # since 2000, of the year 2031; as a Unix time, of 2001
_WITHOUT_HOUR = ("Y", "M", "W", "D")  # units of NumPy's dates
_NO_DATE = "is not a date; write it such as 2026-06-21T12:00:00Z"


def require_hour(instant: Any) -> Any:
    """The date; raises :class:`ParameterError` for a day without an hour, and for a number."""
    day = f"{instant} is a day; add the hour, as in {instant}T12:00Z"
    # of a number of seconds nobody knows since when
    for reads, said in ((datetime.date.fromisoformat, day), (float, f"{instant} {_NO_DATE}")):
        try:
            reads(str(instant).strip())
        except ValueError:
            continue
        raise ParameterError(said)
    return instant


def seconds_of(instant: Any) -> Any:
    """Seconds since the epoch [s] of a date or of many; leap seconds are not counted.

    Dates are texts, those of Python, NumPy, pandas or xarray, and lists of them; without a zone
    they are UTC. Numbers are seconds already. Shapes stay, and names of dimensions.
    """
    if is_tracer(instant) or isinstance(instant, Real):
        return _require_numbers(instant)
    if isinstance(instant, str | datetime.date):
        require_hour(instant)
        if isinstance(instant, str):
            try:
                instant = datetime.datetime.fromisoformat(instant)
            except ValueError:
                raise ParameterError(f'time = "{instant}" {_NO_DATE}') from None
        _require_known(instant, instant != instant)  # as NaT alone is
        assert isinstance(instant, datetime.datetime)  # a day without an hour was refused
        if instant.tzinfo is None:
            instant = instant.replace(tzinfo=datetime.UTC)
        return float((instant - EPOCH).total_seconds())
    if is_labelled(instant) and instant.dtype.kind not in "iuf":
        return instant.copy(data=seconds_of(instant.to_numpy())).drop_attrs()
    array = np.asarray(instant)
    if array.dtype.kind == "M":
        if np.datetime_data(array.dtype)[0] in _WITHOUT_HOUR:
            raise ParameterError(f"{array.flat[0]} is a day; give dates with an hour")
        _require_known(array, np.isnat(array))
        whole = array.astype("datetime64[s]")  # of which there are enough for any year
        epoch = _EPOCH.astype(whole.dtype)
        second = np.timedelta64(1, "s")
        return ((whole - epoch) / second + (array - whole) / second)[()]
    if array.dtype.kind in "OU" and array.ndim:
        each = [seconds_of(one) for one in array.ravel().tolist()]
        return np.reshape(np.array(each, float), array.shape)
    if array.dtype.kind not in "iuf":
        raise ParameterError(f"time = {instant!s:.60} {_NO_DATE}")
    return _require_numbers(array if isinstance(instant, list | tuple) else instant)


def _require_numbers(seconds: Any) -> Any:
    if isinstance(seconds, bool | np.timedelta64):
        raise ParameterError(f"time = {seconds} {_NO_DATE}")
    if is_concrete(seconds):
        _require_known(seconds, np.isnan(np.asarray(seconds)))
        latest = np.max(seconds, initial=0.0)
        if latest > _LIKE_UNIX_TIME:
            warnings.warn(
                f"time = {latest:.10g} s is in the year {2000.0 + latest / _YEAR:.0f}: numbers are "
                "seconds since 2000-01-01 12:00 UTC; of a Unix time give "
                "datetime.fromtimestamp(time, UTC)",
                ParameterWarning,
                stacklevel=4,
            )
    return seconds


def _require_known(instant: Any, unknown: Any) -> None:
    if np.any(unknown):
        bad = np.asarray(instant)[unknown].flat[0] if np.ndim(unknown) else instant
        raise ParameterError(f"time = {bad} {_NO_DATE}")


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
