"""Flights beside measured tracks; the tracks are made by SciPy and NumPy."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lightflyer as lf
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.progress import ask_to_end, ends_early
from lightflyer.files.result_text import as_text
from lightflyer.mission.areas import units_of
from lightflyer.mission.measured.explanation import (
    independent_number,
    interval_half_width,
    weights_of,
)
from lightflyer.mission.measured.geometry import apart
from lightflyer.mission.measured.summary import comparison_parts, summarise_comparison
from lightflyer.mission.measured.winds import WindOfTrack, wind_differences
from lightflyer.mission.path.dynamics import follow
from lightflyer.mission.path.integration import Accuracy, Limits
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.report.kml import write_kml
from lightflyer.mission.report.tables import write_csv

ROUND, RADIUS, AREAL_DENSITY = 6.371e6, 0.005, 1e-3
HOURS = 6.0
RELEASE = lf.Release(75e3, latitude=20.0, longitude=179.5, time="2026-06-21T12:00Z")
WIND, NOISE = (14.0, -4.0), 20.0  # eastward and northward [m/s]; of altitudes [m]
HEAVIER, UPWARDS = 0.08, 0.05  # share of the mass; [m/s]


@pytest.fixture(scope="module")
def measured(fall_speed):
    """A track of a disk that is heavier, or in air that rises, in a wind, with a receiver's noise;
    over the date line."""
    heights = np.linspace(30e3, 80e3, 501)

    def make(heavier=0.0, upwards=0.0, seed=1):
        speeds = [fall_speed(height, RADIUS, heavier) for height in heights]
        rng = np.random.default_rng(seed)
        elapsed = np.cumsum(rng.uniform(30.0, 90.0, 600))
        elapsed = elapsed[elapsed < HOURS * 3600.0]

        def rate(_, y):
            around = ROUND + y[0]
            return [
                upwards - np.interp(y[0], heights, speeds),
                WIND[1] / around,
                WIND[0] / (around * np.cos(y[1])),
            ]

        begin = [75e3, np.radians(20.0), np.radians(179.5)]
        way = solve_ivp(rate, (0.0, elapsed[-1]), begin, rtol=1e-9, atol=1e-9, t_eval=elapsed)
        noise = np.empty(elapsed.size)
        noise[0] = rng.normal()
        for number, apart_ in enumerate(np.diff(elapsed)):
            kept = np.exp(-apart_ / 600.0)
            noise[number + 1] = kept * noise[number] + np.sqrt(1.0 - kept**2) * rng.normal()
        longitude = (np.degrees(way.y[2]) + 180.0) % 360.0 - 180.0
        return lf.mission.MeasuredTrack.from_arrays(
            float(RELEASE.time) + elapsed, np.degrees(way.y[1]), longitude, way.y[0] + NOISE * noise
        )

    return make


@pytest.fixture(scope="module")
def compare(sky, closed_form_disk):
    still = replace(sky(0.0), air=np.zeros(3))

    def compared(track, **changes):
        return lf.mission.compare_track(
            track, closed_form_disk(2.0 * RADIUS, 0.85, 0.85), still, lf.Lu2023(),
            **{"release": RELEASE, "duration": f"{HOURS} h", "attitude": lf.mission.Level()}
            | changes,
        )  # fmt: skip

    return compared


@pytest.fixture(scope="module")
def explained(compare, measured):
    """Comparisons with tracks, each made once."""
    return cache(lambda heavier, upwards: compare(measured(heavier, upwards)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("heavier", "upwards", "name"), [(HEAVIER, 0.0, "mass"), (0.0, UPWARDS, "vertical_wind")]
)
def test_what_differs_is_found_within_its_interval(explained, heavier, upwards, name):
    compared = explained(heavier, upwards)
    truth = {
        "mass": heavier * np.pi * RADIUS**2 * AREAL_DENSITY,
        "vertical_wind": upwards,
    }[name]
    low, high = float(compared[f"{name}_low"]), float(compared[f"{name}_high"])
    assert low < truth < high
    assert high - low < 0.1 * truth
    assert float(compared[f"{name}_rms"]) == pytest.approx(NOISE, rel=0.3)
    found = summarise_comparison(compared)["explanations"]
    other = "vertical wind" if name == "mass" else "mass"
    assert (
        f"{name.replace('_', ' ')} explains the altitudes better than the {other}"
        in (found["verdict"])
    )
    assert found["rms_before_km"] > 10.0 * NOISE / 1e3


def test_what_has_no_effect_is_not_known(explained):
    compared = explained(HEAVIER, 0.0).assign(mass_low=-np.inf, mass_high=np.inf)
    found = summarise_comparison(compared)
    json.dumps(found, allow_nan=False)
    assert "-inf to +inf" in as_text(comparison_parts(found))


@pytest.mark.slow
def test_a_track_of_the_flight_itself_explains_nothing(compare, measured):
    compared = compare(replace(measured(), altitude=np.asarray(compare(
        measured(), explained=False).flown_altitude)))  # fmt: skip
    found = summarise_comparison(compared)
    assert found["residuals"]["altitude"]["largest_km"] == 0.0
    assert found["explanations"]["verdict"].startswith("neither is established")
    assert abs(found["explanations"]["mass"]["value"]) < 1e-3 * found["explanations"]["flyer_kg"]


@pytest.mark.slow
def test_the_wind_that_is_missing_is_found_at_any_time_and_altitude(compare, measured):
    compared = compare(measured(), explained=False)
    for part in ("period", "band"):
        np.testing.assert_allclose(compared[f"{part}_east"], WIND[0], rtol=1e-3)
        np.testing.assert_allclose(compared[f"{part}_north"], WIND[1], rtol=1e-3)
    elapsed = compared.measured_elapsed.values
    assert float(compared.period_duration.sum()) == pytest.approx(np.ptp(elapsed), rel=1e-9)
    np.testing.assert_allclose(
        compared.distance, np.hypot(*WIND) * elapsed * ROUND / (ROUND + 65e3), rtol=3e-3
    )
    np.testing.assert_allclose(compared.across_residual, 0.0, atol=0.02 * compared.distance.max())


@pytest.mark.slow
def test_the_wind_of_the_air_is_taken_off(measured, compare, sky, closed_form_disk):
    turning = replace(sky(0.0), air=np.array([0.0, 0.0, 30.0]))  # 30 m/s at the equator
    compared = lf.mission.compare_track(
        measured(), closed_form_disk(2.0 * RADIUS, 0.85, 0.85), turning, lf.Lu2023(),
        release=RELEASE, duration=f"{HOURS} h", attitude=lf.mission.Level(), explained=False,
    )  # fmt: skip
    latitude = np.radians(compared.measured_latitude.values.mean())
    assert float(compared.period_east.mean()) == pytest.approx(
        WIND[0] - 30.0 * np.cos(latitude), abs=0.02
    )
    np.testing.assert_allclose(compared.period_north, WIND[1], rtol=2e-3)


def test_a_flyer_s_own_way_through_the_air_is_no_wind(film):
    disk = lf.Disk(film, radius=2e-3, attitude=lf.environment.Attitude(0.3, 0.8))
    release = lf.Release("78 km", latitude=-60.0, longitude=0.0, time="2026-06-21T12:00Z")
    given = {"release": release, "duration": "2 h"}
    flown = lf.fly(disk, lf.Earth(), lf.FreeMolecular(), every=60.0, **given)
    names = ("time", "latitude", "longitude", "altitude")
    track = lf.mission.MeasuredTrack.from_arrays(*(flown[name].values for name in names))
    compared = lf.mission.compare_track(
        track, disk, lf.Earth(), lf.FreeMolecular(), explained=False, **given
    )
    gone = np.hypot(flown.eastward_speed, flown.northward_speed).min()
    assert gone > 0.3
    assert float(np.abs(compared.period_east).max()) < 0.01 * gone
    assert float(np.abs(compared.band_north).max()) < 0.01 * gone


def test_a_flight_in_the_wind_of_a_track_is_where_the_track_is(sky, closed_form_disk, measured):
    still = replace(sky(0.0), air=np.zeros(3))
    setup = lf.Setup(closed_form_disk(2.0 * RADIUS, 0.85, 0.85), still, lf.Lu2023())
    track, released = measured(), float(RELEASE.time)
    span = (track.time[0], track.time[-1])
    found, _ = wind_differences(track, Craft(setup, lf.mission.Level()), span, released)
    carried = Craft(setup, lf.mission.Level(), WindOfTrack.of(found))
    with lf.float64():
        start = RELEASE.start()
    times = np.array([0.0, HOURS * 3600.0])
    _, way = follow(carried, start, Limits(0.0, 100e3), times, Accuracy.for_duration(times[1]))
    _, flown = way(track.time - released)
    beside = apart(track, flown, ROUND)
    assert beside.distance.max() < 1e3
    assert np.hypot(*WIND) * times[1] > 300e3


def test_along_and_across_are_those_of_a_track_that_goes_north():
    latitude = np.linspace(10.0, 12.0, 50)
    track = lf.mission.MeasuredTrack.from_arrays(
        60.0 * np.arange(50), latitude, np.full(50, 7.0), np.full(50, 20e3)
    )
    found = apart(track, units_of(latitude - 0.02, np.full(50, 7.01)), ROUND)
    degree = ROUND * np.pi / 180.0
    np.testing.assert_allclose(found.along, 0.02 * degree, rtol=1e-3)
    east = 0.01 * degree * np.cos(np.radians(latitude))
    np.testing.assert_allclose(found.across, -east, rtol=1e-3)  # the flight is to the right
    np.testing.assert_allclose(found.distance, np.hypot(0.02 * degree, east), rtol=1e-3)


@pytest.mark.parametrize("correlation", [0.002, 0.05, 0.2])
def test_intervals_hold_the_truth_though_residuals_are_alike(correlation):
    rng, size, runs = np.random.default_rng(3), 300, 400
    times = np.linspace(0.0, 1.0, size)
    kept = np.exp(-1.0 / (size * correlation))
    noise = rng.normal(size=(size, runs))
    for row in range(1, size):
        noise[row] = kept * noise[row - 1] + np.sqrt(1.0 - kept**2) * noise[row]
    weights, inside = weights_of(times), 0
    for one in noise.T:
        value = np.sum(times * one) / np.sum(times**2)
        half, _ = interval_half_width(times, one - value * times, times, weights)
        inside += abs(value) < half
    assert 0.91 < inside / runs < 0.99


def test_waves_are_worth_about_as_many_numbers_as_their_correlation_says(rng):
    times, width = np.linspace(0.0, 1.0, 300), 0.02
    covariance = np.exp(-0.5 * ((times[:, None] - times) / width) ** 2) + 1e-9 * np.eye(300)
    waves = np.linalg.cholesky(covariance) @ rng.normal(size=(300, 100))
    found = np.median([independent_number(times, one) for one in waves.T])
    truth = 1.0 / (np.sqrt(2.0 * np.pi) * width)  # over the integral of the correlation
    assert 0.5 * truth < found < 1.1 * truth


def test_interval_is_that_of_scipy_where_residuals_are_independent(rng):
    from scipy.stats import linregress

    times = np.linspace(-1.0, 1.0, 2000)
    values = 3.0 * times + rng.normal(size=times.size)
    fitted = linregress(times, values)
    left = values - fitted.intercept - fitted.slope * times
    half, independent = interval_half_width(times, left, times, np.full(2000, 1.0 / 2000))
    assert independent > 1500
    assert half == pytest.approx(1.96 * fitted.stderr, rel=0.1)


def test_interrupted_flights_are_not_compared(compare, measured):
    with ends_early():
        ask_to_end()
        with pytest.raises(KeyboardInterrupt):
            compare(measured())


@pytest.mark.slow
def test_a_track_of_another_day_is_refused(compare, measured):
    track = measured()
    late = replace(track, time=track.time + 86_400.0)
    with pytest.raises(ConfigurationError, match=r"none of its fixes, of 2026-06-22.*the date"):
        compare(late)


def test_numbers_of_a_track_must_be_possible():
    good = (["2026-06-21T12:00Z", "2026-06-21T12:10Z"], [1.0, 2.0], [1.0, 2.0], [1e3, 2e3])
    for place, bad in ((1, [1.0, 100.0]), (3, [1e3, np.nan]), (2, [1.0, 2.0, 3.0])):
        given = list(good)
        given[place] = bad
        with pytest.raises(ParameterError):
            lf.mission.MeasuredTrack.from_arrays(*given)


ROWS = [(0, 45.0, 179.9, 18000.0), (600, 45.1, -179.9, 18250.5), (1200, 45.25, -179.6, 18100.0)]


def clock(seconds):
    return f"2026-06-21T12:{seconds // 60:02d}:{seconds % 60:02d}"


def gpx(points, head=""):
    body = "\n".join(points)
    return (
        f'<?xml version="1.0"?>\n{head}<gpx version="1.1" '
        f'xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>\n{body}\n</trkseg></trk></gpx>\n'
    )


def trkpt(seconds, latitude, longitude, altitude):
    return (
        f'<trkpt lat="{latitude}" lon="{longitude}"><ele>{altitude}</ele>'
        f"<time>{clock(seconds)}Z</time></trkpt>"
    )


def csv(header, row, rows=ROWS):
    return "\n".join([header, *(row(*one) for one in rows)]) + "\n"


GOOD = {
    "sondehub.csv": csv(
        "serial,datetime,lat,lon,alt,temp",
        lambda t, n, e, h: f"S1,{clock(t)}.000000Z,{n},{e},{h},-50",
    ),
    "aprs.csv": csv(
        "time,lasttime,lat,lng,speed,course,altitude,comment",
        lambda t, n, e, h: f'{clock(t).replace("T", " ")},x,{n},{e},4,262,{h}," 1.6V, 26C "',
    ),
    "german.csv": csv(
        "date;time;Latitude;Longitude;Altitude [km]",
        lambda t, n, e, h: f"{clock(t)[:10]};{clock(t)[11:]};{n};{e};{h / 1e3}".replace(".", ","),
    ),
    "feet.csv": csv(
        "time (UTC),lat,lon,alt_ft", lambda t, n, e, h: f"{clock(t)},{n},{e},{h / 0.3048}"
    ),
    "zone.csv": csv(
        "timestamp,lat,lon,height",
        lambda t, n, e, h: f"{clock(t).replace('T12', 'T14')}+02:00,{n},{e},{h}",
    ),
    "unix.csv": csv("time,lat,lon,alt", lambda t, n, e, h: f"{1782043200 + t},{n},{e},{h}"),
    "track.gpx": gpx([trkpt(*row) for row in ROWS]),
    "track.kml": '<kml xmlns="http://www.opengis.net/kml/2.2" '
    'xmlns:gx="http://www.google.com/kml/ext/2.2"><Placemark><gx:Track>'
    + "".join(f"<when>{clock(row[0])}Z</when>" for row in ROWS)
    + "".join(f"<gx:coord>{row[2]} {row[1]} {row[3]}</gx:coord>" for row in ROWS)
    + "</gx:Track></Placemark></kml>",
}  # fmt: skip


@pytest.mark.parametrize("name", GOOD)
def test_formats_give_the_same_track(tmp_path, name):
    (tmp_path / name).write_text(GOOD[name], encoding="utf-8")
    track = lf.mission.read_track(tmp_path / name)
    noon = (np.datetime64("2026-06-21T12:00") - np.datetime64("2000-01-01T12:00")) / np.timedelta64(
        1, "s"
    )
    found = np.stack([track.time - noon, track.latitude, track.longitude, track.altitude], axis=1)
    np.testing.assert_allclose(found, ROWS, rtol=1e-12)
    assert track.notes == ()


def test_our_own_files_are_read(tmp_path, disk):
    flown = lf.fly(
        disk, lf.Earth(), lf.FreeMolecular(), duration="2 h", every="10 min",
        release=lf.Release("75 km", latitude=45.0, longitude=10.0, time="2026-06-21T12:00Z"),
    )  # fmt: skip
    write_kml(flown, tmp_path / "mission.kml")
    write_csv(flown, tmp_path / "mission.csv")
    for name in ("mission.kml", "mission.csv"):
        track = lf.mission.read_track(tmp_path / name)
        np.testing.assert_allclose(track.altitude, flown.altitude, atol=0.06)
        np.testing.assert_allclose(track.latitude, flown.latitude, atol=1e-6)


def test_disorder_is_said(tmp_path):
    rows = [*ROWS[::-1], ROWS[1], (1200, 45.0, 0.0, 1e3), (2700, 45.0, 0.0, "x"),
            (2400, 45.0, -179.0, 17e3), (2460, 0.0, 0.0, 0.0)]  # fmt: skip
    text = csv("datetime,lat,lon,alt", lambda t, n, e, h: f"{clock(t)},{n},{e},{h}", rows)
    path = tmp_path / "track.csv"
    path.write_text(text, encoding="utf-8")
    track = lf.mission.read_track(path)
    np.testing.assert_array_equal(track.altitude, [18000.0, 18250.5, 18100.0, 17e3])
    left_out, order, repeated = track.notes
    assert left_out == '2 fixes left out: line 7: altitude: "x" is not a number'
    assert order == "not in the order of time (line 3 is the first): sorted"
    assert "2 of 6 times repeat another" in repeated
    assert "1 have another place (line 6 the first)" in repeated


def test_exchanged_coordinates_are_said(compare, measured):
    track = measured()
    other = lf.mission.MeasuredTrack.from_arrays(
        track.time, 0.5 * track.longitude, track.latitude, track.altitude
    )
    assert "latitude and longitude are exchanged" in compare(other, explained=False).attrs["notes"]


def test_gaps_are_said_and_no_wind_is_told_across_them(compare, measured):
    track, gap = measured(), slice(100, 300)
    parts = {name: np.delete(part, gap) for name, part in list(vars(track).items())[1:5]}
    parts["time"] = np.datetime64("2000-01-01T12:00:00") + (1e3 * parts["time"]).astype(
        "timedelta64[ms]"
    )
    holed = lf.mission.MeasuredTrack.from_arrays(**parts)
    lasted = track.time[300] - track.time[99]
    assert holed.notes[0].startswith(f"1 gap without a fix: {lasted / 3600.0:.2g} h after")
    whole, cut = (compare(one, explained=False) for one in (track, holed))
    left = float(cut.period_duration.sum())
    assert left == pytest.approx(float(whole.period_duration.sum()) - lasted, abs=620.0)  # 2 steps
    assert f"the wind is told for {left / 3600.0:.2f} h of" in cut.attrs["notes"]
    assert whole.attrs["notes"] == ""


BAD = {
    "empty.csv": ("", r"empty.csv: is empty"),
    "no-time.csv": ("lat,lon,alt\n1,2,3\n", r"no-time.csv: the column time is missing"),
    "no-alt.csv": ("time,lat,lon\n2026-06-21T12:00Z,1,2\n", r"no-alt.csv:1: the column altitude"),
    "hour.csv": ("time,lat,lon,alt\n12:00:00,1,2,3\n", r'hour.csv:2: time: "12:00:00" is not'),
    "day.csv": ("time,lat,lon,alt\n2026-06-21,1,2,3\n", r'day.csv:2: time: "2026-06-21" is not'),
    "range.csv": ("time,lat,lon,alt\n2026-06-21T12:00Z,100,2,3\n", r"range.csv:2: latitude = 100"),
    "unit.csv": ("time,lat,lon,alt [kg]\n2026-06-21T12:00Z,1,2,3\n", r"unit.csv:1: column alt"),
    "one.csv": (csv("time,lat,lon,alt", lambda t, *p: f"{clock(t)},{p[0]},{p[1]},{p[2]}", ROWS[:1]),
                r"one.csv: a track needs two fixes or more, has 1"),
    "same.csv": (csv("time,lat,lon,alt", lambda t, *p: f"{clock(0)},{p[0]},{p[1]},{p[2]}"),
                 r"same.csv: a track needs two fixes or more at different times"),
    "broken.gpx": ("<gpx>\n<trk></gpx>", r"broken.gpx:2: is no XML: mismatched tag"),
    "bomb.gpx": (gpx([trkpt(*ROWS[0])], '<!DOCTYPE gpx [<!ENTITY a "a"><!ENTITY b "&a;&a;">]>\n'),
                 r"bomb.gpx:2: has a DOCTYPE"),
    "route.gpx": (gpx([]), r"route.gpx: has no track \(<trkpt>\)"),
    "kind.gpx": ("<kml/>", r"kind.gpx:1: is no GPX file: its first element is <kml>"),
    "empty.gpx": ("", r"empty.gpx:1: is no XML: no element found"),
    "flat.gpx": (gpx(["<trkpt lat='1' lon='2'><time>2026-06-21T12:00Z</time></trkpt>"]),
                 r"flat.gpx:3: has no altitude"),
    "line.kml": ("<kml><Placemark>\n<LineString/></Placemark></kml>",
                 r"line.kml:2: <LineString> has no times"),
    "none.kml": ("<kml/>", r"none.kml: has no gx:Track"),
    "uneven.kml": ("<kml>\n<Track><when>2026-06-21T12:00Z</when></Track></kml>",
                   r"uneven.kml:2: gx:Track has 1 <when> and 0 <gx:coord>"),
    "ground.kml": ("<kml><Track><altitudeMode>relativeToGround</altitudeMode></Track></kml>",
                   r"ground.kml:1: altitudes above ground"),
    "packed.kmz": ("", r"packed.kmz: is a KMZ file"),
}  # fmt: skip


@pytest.mark.parametrize("name", [*BAD, "missing.gpx", "missing.csv"])
def test_bad_files_are_refused_in_one_line(tmp_path, name):
    text, said = BAD.get(name, (None, "cannot be read"))
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError, match=said) as error:
        lf.mission.read_track(tmp_path / name)
    assert "\n" not in str(error.value)
