import jax
import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.environment import GriddedWind, Place

NOON = np.datetime64("2000-01-01T12:00", "ns")
LEVELS = np.array([40e3, 50e3, 60e3, 80e3])
TIMES = NOON + np.arange(5) * np.timedelta64(6, "h")


def tumbling(latitude, longitude, axis_longitude=0.3):
    """East and north of a solid rotation about an axis in the equator, which crosses the poles."""
    east = -np.sin(latitude) * np.cos(longitude - axis_longitude)
    return east, np.sin(longitude - axis_longitude)


def dataset(step=5.0, latitude=None, longitude=None, axis_longitude=0.3, speed=60.0):
    latitude = np.arange(-90.0, 90.1, step) if latitude is None else latitude
    longitude = np.arange(0.0, 360.0, step) if longitude is None else longitude
    time, height, north, east = np.meshgrid(
        np.arange(5.0), LEVELS / 1e4, np.radians(latitude), np.radians(longitude), indexing="ij"
    )
    u, v = tumbling(north, east, axis_longitude)
    growth = speed * (1.0 + 0.1 * time) * height
    names = ("time", "altitude", "latitude", "longitude")
    metres_per_second = {"units": "m s-1"}
    return xr.Dataset(
        {
            "u": (names, growth * u, metres_per_second),
            "v": (names, growth * v, metres_per_second),
            "w": (names, 0.1 * height, metres_per_second),
        },
        coords={
            "time": TIMES,
            "altitude": ("altitude", LEVELS / 1e3, {"units": "km"}),
            "latitude": latitude,
            "longitude": ("longitude", longitude, {"units": "degrees_east"}),
        },
    )


@pytest.fixture(scope="module")
def wind():
    return GriddedWind(dataset())


PLACES = np.radians([[10.0, 20.0], [-77.3, 359.9], [90.0, 0.0], [90.0, 120.0], [-90.0, -170.0]]).T
ODD = np.radians([[41.7, 180.0], [41.7, -180.0], [88.9, -33.0], [-89.99, 12.0], [0.1, 540.2]]).T


@pytest.mark.parametrize("places", [PLACES, ODD], ids=["nodes and poles", "between"])
def test_a_wind_over_the_poles_and_the_date_line(wind, places):
    hours = 7.5
    found = wind.velocity(55e3, Place(*places, hours * 3600.0))
    growth = 60.0 * (1.0 + 0.1 * hours / 6.0) * 5.5
    east, north = tumbling(*places)
    # cubics over 5° leave 1.3e-5 of a wave around the planet
    np.testing.assert_allclose(found.east, growth * east, atol=3e-5 * growth)
    np.testing.assert_allclose(found.north, growth * north, atol=3e-5 * growth)
    np.testing.assert_allclose(found.up, 0.55, rtol=1e-12)


def test_derivative_is_continuous_across_nodes(wind):
    def east(longitude):
        return wind.velocity(50e3, Place(0.8, longitude, 6.0 * 3600.0)).east

    with lf.float64():
        around = np.radians(45.0) + np.array([-1e-9, 1e-9])
        slopes = jax.vmap(jax.grad(east))(around)
        exact = 300.0 * 1.1 * np.sin(0.8) * np.sin(around - 0.3)
    np.testing.assert_allclose(slopes, exact, rtol=2e-3)
    np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-6)


def test_order_names_and_units_of_the_dataset_do_not_matter(wind):
    data = dataset().isel(latitude=slice(None, None, -1), altitude=slice(None, None, -1))
    data = data.assign_coords(longitude=(data.longitude + 180.0) % 360.0 - 180.0)
    data = data.rename(latitude="lat", longitude="lon", altitude="height", time="valid_time")
    data["lon"].attrs["units"] = "degrees"
    data["u"] = (100.0 * data.u).assign_attrs(units="cm/s")
    place = Place(*ODD, 9e3)
    np.testing.assert_allclose(
        GriddedWind(data.transpose("lon", "lat", "valid_time", "height")).velocity(61e3, place),
        wind.velocity(61e3, place),
        rtol=1e-10,
        atol=1e-9,
    )


def test_both_ends_of_the_circle_given(wind):
    closed = GriddedWind(dataset(longitude=np.arange(-180.0, 180.1, 5.0)))
    place = Place(*ODD, 9e3)
    expected = wind.velocity(61e3, place)
    np.testing.assert_allclose(closed.velocity(61e3, place), expected, rtol=1e-10, atol=1e-9)


def test_rows_that_stop_before_the_pole_are_joined_across_it():
    gaussian = GriddedWind(dataset(latitude=np.arange(-87.5, 87.6, 5.0)))
    places = np.radians([[90.0, 40.0], [89.0, 100.0], [-88.0, -70.0]]).T
    east, north, _ = gaussian.velocity(40e3, Place(*places, 0.0))
    np.testing.assert_allclose([east, north], np.multiply(240.0, tumbling(*places)), atol=0.02)


def test_pressure_levels_are_found_by_the_atmosphere(wind):
    atmosphere = lf.environment.US1976()
    data = dataset()
    pressure = ("altitude", atmosphere.pressure(LEVELS) / 100.0, {"units": "hPa"})
    data = data.assign_coords(altitude=pressure).rename(altitude="pressure")
    with pytest.raises(lf.ConfigurationError, match="pressure levels need an atmosphere"):
        GriddedWind(data)
    by_pressure = GriddedWind(data, atmosphere)
    place = Place(0.7, 0.2, 0.0)
    at_levels = by_pressure.velocity(LEVELS, place)
    np.testing.assert_allclose(at_levels, wind.velocity(LEVELS, place), rtol=1e-9)
    assert "287.1 Pa to 1.052 Pa" in by_pressure.describe()[0]
    with pytest.raises(lf.ParameterError, match=r"end at 1\.052 Pa"):
        by_pressure.velocity(81e3, place)


def test_a_mean_over_longitude_that_does_not_change():
    data = dataset().isel(time=0, longitude=0, drop=True).drop_vars("w")
    data["u"], data["v"] = 0.0 * data.u + 40.0, 0.0 * data.v
    data["u"] = data.u * np.cos(np.radians(data.latitude))
    for name in ("u", "v"):
        data[name].attrs["units"] = "m/s"
    zonal = GriddedWind(data)
    assert zonal.describe() == ("wind: data, constant in time, 40 km to 80 km, nothing upwards",)
    latitude = np.array([-1.2, 0.0, 0.73, 1.5])
    found = zonal.velocity(50e3, Place(latitude, 1.234, 1e9))
    np.testing.assert_allclose(found.east, 40.0 * np.cos(latitude), atol=0.005)
    np.testing.assert_allclose(found.north, 0.0, atol=0.005)


def test_a_wind_upwards_alone(wind):
    rising = GriddedWind(dataset().drop_vars(["u", "v"]))
    place = Place(*ODD, 9e3)
    east, north, up = rising.velocity(61e3, place)
    assert not np.any(east)
    assert not np.any(north)
    np.testing.assert_allclose(up, wind.velocity(61e3, place).up, rtol=1e-12)


def test_the_wind_says_where_its_data_end():
    here = dataset(latitude=np.arange(30.0, 61.0, 5.0), longitude=np.arange(-30.0, 31.0, 5.0))
    wind = GriddedWind(here)
    inside = Place(0.8, 0.0, 3600.0)
    assert min(wind.margins(50e3, inside).values()) > 0.0
    for altitude, place, said in (
        (50e3, inside._replace(time=86401.0), "time after .* end at 2000-01-02 12:00 UTC"),
        (50e3, inside._replace(time=-1.0), "time before .* begin at 2000-01-01 12:00 UTC"),
        (39.9e3, inside, "altitude below .* begin at 40 km"),
        (80.1e3, inside, "altitude above .* end at 80 km"),
        (50e3, inside._replace(latitude=0.5), "latitude south of .* begin at 30°"),
        (50e3, inside._replace(longitude=3.0), "longitude east of .* end at 30°"),
    ):
        with pytest.raises(lf.ParameterError, match=said):
            wind.velocity(altitude, place)
    with lf.float64():
        later = jax.jit(lambda time: wind.velocity(50e3, inside._replace(time=time)).east)
        assert np.isfinite(later(86400.0))
        assert np.isnan(later(86401.0))


def without_units(data):
    data["u"].attrs.clear()
    return data


def in_gap(data):
    data["v"][1, 2, 3, 4] = np.nan
    return data


def filled(data):
    data["v"][1, 2, 3, 4] = 9.96921e36  # what NetCDF has for a missing value
    return data


def with_units(data, name, unit):
    data[name].attrs["units"] = unit
    return data


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda data: data.rename(u="zonal"),
            "needs the variables u and v .*there are: zonal, v, w",
        ),
        (lambda data: with_units(data, "u", "kg"), 'units of u: "kg": unit "kg" is of the wrong'),
        (lambda data: with_units(data, "altitude", "hPa"), "units of altitude"),
        (lambda data: without_units(data).rename(u="ugrd"), "ugrd has no units; set dataset"),
        (
            lambda data: data.assign_coords(time=("time", np.arange(5), {"units": "h since 2026"})),
            r"time must be dates \(UTC\), not numbers; take xarray.decode_cf",
        ),
        (lambda data: with_units(data, "w", "Pa s-1"), "w is in Pa/s, a change of pressure"),
        (lambda data: with_units(data, "longitude", "radians"), "units of longitude"),
        (in_gap, "v has 1 missing values"),
        (filled, r"v reaches 9\.97e\+36 m/s, and no wind exceeds 1000 m/s"),
        (lambda data: data.expand_dims(member=2), "the dimension member, which is none of"),
        (lambda data: data.isel(altitude=0, drop=True), "one dimension altitude or pressure"),
        (lambda data: data.isel(latitude=0, drop=True), "no dimension latitude"),
        (lambda data: data.isel(longitude=[0]), "longitude needs two entries"),
        (lambda data: data.isel(altitude=[0]), "altitude needs two entries"),
        (lambda data: data.assign(v=data.v.isel(time=0, drop=True)), "v has other dimensions"),
        (lambda data: data.drop_vars("v"), "there are: u, w"),
        (lambda data: "winds", "there are: none"),
        (lambda data: data.assign_coords(time=np.arange(5)), "time must be dates"),
        (lambda data: data.isel(time=[0, 0, 1]), "time has missing or repeated entries"),
        (lambda data: data.assign_coords(latitude=3.0 * data.latitude), "between -90 and 90"),
        (lambda data: data.assign_coords(longitude=2.0 * data.longitude), "more than once round"),
    ],
)
def test_unusable_data_get_one_line(change, said):
    small = dataset(step=45.0)
    with pytest.raises(lf.ConfigurationError, match=said) as caught:
        GriddedWind(change(small))
    assert "\n" not in str(caught.value)


def test_files(tmp_path, wind):
    path = tmp_path / "winds.nc"
    dataset().to_netcdf(path, engine="h5netcdf")
    place = Place(*ODD, 9e3)
    again = GriddedWind.from_file(path).velocity(61e3, place)
    np.testing.assert_allclose(again, wind.velocity(61e3, place), rtol=1e-12)
    with pytest.raises(lf.ConfigurationError, match=r"gone\.nc: cannot be read as NetCDF"):
        GriddedWind.from_file(tmp_path / "gone.nc")
    (tmp_path / "text.nc").write_text("not NetCDF")
    with pytest.raises(lf.ConfigurationError, match=r"text\.nc: cannot be read as NetCDF"):
        GriddedWind.from_file(tmp_path / "text.nc")
