"""What a mission says of a film that gets too hot on its way."""

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.mission.report.dataset import ELAPSED
from lightflyer.mission.report.summary import heat_of_film, summarise


def dataset(temperature, **attributes):
    elapsed = 600.0 * np.arange(len(temperature))
    columns = {"temperature": temperature, "altitude": 70e3 + elapsed}
    variables = {name: (ELAPSED, np.asarray(column, float)) for name, column in columns.items()}
    return xr.Dataset(variables, {ELAPSED: elapsed}, attributes)


@pytest.mark.parametrize(
    ("temperature", "hours", "begin"),
    [
        ([400, 500, 450], 0.0, None),
        ([500, 540, 500, 500], 600.0 / 3600.0, 300.0),
        ([530, 510, 510, 530, 530], (300.0 + 300.0 + 600.0) / 3600.0, 0.0),
        ([500, 560, 560, np.nan], 1000.0 / 3600.0, 200.0),
    ],
)
def test_hours_in_which_a_film_is_too_hot(temperature, hours, begin):
    assert heat_of_film(dataset(temperature)) is None
    found = heat_of_film(dataset(temperature, highest_temperature_k=520.0))
    assert found["too_hot_h"] == pytest.approx(hours)
    assert found["hottest_k"] == np.nanmax(temperature)
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
    assert found["hottest_k"] == float(flown.temperature.max()) > 480.0
    assert f"too hot   from {found['too_hot_from_h']:.2f} h after the release" in text
    assert "still flying at the end of its time, if its film survived" in text
    assert "the flyer reaches" not in text
