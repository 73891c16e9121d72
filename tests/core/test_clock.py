from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.errors import ParameterError


def test_seconds_count_from_noon_of_2000():
    between = datetime(2026, 6, 21, 3, tzinfo=UTC) - datetime(2000, 1, 1, 12, tzinfo=UTC)
    assert seconds_of("2026-06-21T03:00:00Z") == pytest.approx(between.total_seconds(), rel=1e-15)
    assert seconds_of("2000-01-01T13:00:00+01:00") == 0.0
    assert date_text(86400.0) == "2000-01-02 12:00 UTC"


TEXTS = ["2026-06-21T12:00", "2026-06-21T18:00", "2026-06-22T00:00"]
INDEX = pd.date_range("2026-06-21 12:00", periods=3, freq="6h")
EACH = [seconds_of(text) for text in TEXTS]


@pytest.mark.parametrize(
    "dates",
    [
        *(INDEX.as_unit(unit) for unit in ("s", "ms", "us", "ns")),
        *(INDEX.to_numpy().astype(f"datetime64[{unit}]") for unit in ("h", "m", "s", "ms", "ns")),
        INDEX.tz_localize("UTC"),
        INDEX.as_unit("us").tz_localize("UTC").tz_convert("Asia/Tokyo"),
        INDEX.tz_localize("UTC").tz_convert("Europe/Berlin"),
        pd.Series(INDEX),
        pd.Series(INDEX.tz_localize("UTC")),
        xr.DataArray(INDEX, dims="time"),
        TEXTS,
        np.array(TEXTS),
        list(INDEX),
        list(INDEX.to_pydatetime()),
        EACH,
    ],
    ids=lambda dates: f"{type(dates).__name__} {getattr(dates, 'dtype', '')}",
)
def test_arrays_of_dates_are_their_dates(dates):
    """https://github.com/pvlib/pvlib-python/issues/1932: counts of another unit than ns."""
    assert np.asarray(seconds_of(dates)) == pytest.approx(EACH, rel=1e-15)


def test_names_of_dimensions_stay():
    found = seconds_of(xr.DataArray(INDEX, dims="time"))
    assert found.dims == ("time",)


def test_fractions_of_a_second_stay():
    early = np.datetime64("2026-06-21T12:00:00.123456789", "ns")
    assert seconds_of(early) - EACH[0] == pytest.approx(0.123456789, abs=2e-7)
    far = np.array(["2700-01-01T12:00"], "datetime64[s]")  # beyond what nanoseconds reach
    assert seconds_of(far)[0] == seconds_of("2700-01-01T12:00")


@pytest.mark.parametrize(
    ("nothing", "said"),
    [
        (pd.NaT, "NaT is not a date"),
        (np.datetime64("NaT"), "NaT is"),
        (pd.to_datetime(["2026-06-21T12:00", None]), "NaT is not a date"),
        (float("nan"), "nan is not a date"),
        ([1.0, float("nan")], "nan is not a date"),
        (True, "True is not a date"),
        (None, "None is not a date"),
        ("noon", '"noon" is not a date'),
        (["2026-06-21T12:00", "noon"], '"noon" is not a date'),
        (np.timedelta64(3, "s"), "3 seconds is not a date"),
        ("2026-06-21", "is a day; add the hour"),
        ("20260621", "is a day; add the hour"),
        (np.datetime64("2026-06"), "is a day"),
        (np.arange("2026-06-21", "2026-06-23", dtype="datetime64[D]"), "2026-06-21 is a day"),
    ],
)
def test_what_is_no_date_is_refused(nothing, said):
    with pytest.raises(ParameterError, match=said):
        seconds_of(nothing)
