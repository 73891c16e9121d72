"""What a mission says of a film that gets too hot on its way."""

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.mission.report.events import Event, Events, add_events
from lightflyer.mission.report.summary import heat_of_film, summarise


@pytest.mark.parametrize(
    ("passes", "hours", "begin"),
    [
        ([], 0.0, None),
        ([(Event.TOO_HOT, 300.0), (Event.COOL_AGAIN, 900.0)], 600.0 / 3600.0, 300.0),
        ([(Event.TOO_HOT, 0.0), (Event.COOL_AGAIN, 60.0), (Event.TOO_HOT, 1740.0)],
         120.0 / 3600.0, 0.0),
    ],
)  # fmt: skip
def test_hours_in_which_a_film_is_too_hot(passes, hours, begin):
    listed = [*passes, (Event.HOTTEST, 1799.0)]
    kinds, elapsed = (np.array(part) for part in zip(*listed, strict=True))
    flight = xr.Dataset({"end_elapsed": 1800.0})
    add_events(flight, Events(kinds, elapsed, 70e3 + elapsed, 500.0 + 0.0 * elapsed))
    assert heat_of_film(flight) is None
    flight.attrs["highest_temperature_k"] = 490.0
    found = heat_of_film(flight)
    assert found["too_hot_h"] == pytest.approx(hours)
    assert found["hottest_k"] == 500.0
    if begin is None:
        assert found["too_hot_from_h"] is found["too_hot_from_altitude_km"] is None
    else:
        assert found["too_hot_from_h"] * 3600.0 == pytest.approx(begin)
        assert found["too_hot_from_altitude_km"] * 1e3 == pytest.approx(70e3 + begin)


def test_a_flight_says_when_its_film_is_too_hot():
    film = lf.FilmProperties(
        1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9, highest_temperature=480.0
    )
    flown = lf.fly(
        lf.Disk(film, radius=0.0025),
        lf.Earth(),
        lf.FreeMolecular(),
        duration="3 h",
        release=lf.Release("75 km", latitude=10.0, longitude=0.0, time="2026-06-21T11:00Z"),
    )
    found = summarise(flown)["film"]
    text = lf.mission.describe(flown)
    assert found["bears_k"] == 480.0
    assert found["hottest_k"] >= float(flown.temperature.max()) > 480.0
    assert f"too hot   from {found['too_hot_from_h']:.2f} h after the release" in text
    assert "still flying at the end of its time, if its film survived" in text
    assert "the flyer reaches" not in text
