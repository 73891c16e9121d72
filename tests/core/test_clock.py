from datetime import UTC, datetime

import pytest

from lightflyer.core.clock import date_text, seconds_of


def test_seconds_count_from_noon_of_2000():
    between = datetime(2026, 6, 21, 3, tzinfo=UTC) - datetime(2000, 1, 1, 12, tzinfo=UTC)
    assert seconds_of("2026-06-21T03:00:00Z") == pytest.approx(between.total_seconds(), rel=1e-15)
    assert seconds_of("2000-01-01T13:00:00+01:00") == 0.0


def test_dates_in_words():
    assert date_text(86400.0) == "2000-01-02 12:00 UTC"
