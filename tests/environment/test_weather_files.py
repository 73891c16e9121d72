"""Weather files in the layouts of those who make them, beside an independent interpolation."""

from functools import cache

import jax
import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import RegularGridInterpolator

import lightflyer as lf
from lightflyer.core.clock import seconds_of
from lightflyer.environment import GriddedWind, Place
from lightflyer.environment.wind import store
from lightflyer.environment.wind.heights import GAS_CONSTANT, altitude_of

START = np.datetime64("2026-06-21T00:00", "ns")
BEGIN = (START - np.datetime64("2000-01-01T12:00", "ns")) / np.timedelta64(1, "s")
TIMES = START + np.arange(4) * np.timedelta64(6, "h")
HPA = np.array([1000.0, 500, 200, 100, 50, 20, 10, 5, 3, 2, 1])
NORTH, EAST = np.arange(-90.0, 90.1, 5.0), np.arange(0.0, 360.0, 5.0)
GRAVITY = 9.80665
DIMS = ("time", "pressure", "latitude", "longitude")
AXES = (np.arange(4.0), -np.log(100.0 * HPA), NORTH, EAST)


def truth(time, log_level, north, east):
    """Winds [m/s], temperature [K] and geopotential [m²/s²] of an air that is warm in the north."""
    turned, level = np.radians(east), log_level + np.log(1e5)
    tropics = np.cos(np.radians(north)) ** 2
    temperature = 245.0 + 20.0 * np.sin(np.radians(north)) + 0.0 * (time + level + turned)
    u = tropics * (10.0 + 8.0 * level + 5.0 * np.cos(turned) + time)
    v = tropics * (6.0 * np.sin(turned) + level)
    omega = -0.1 * np.exp(-level) * (1.0 + 0.0 * temperature)
    return u, v, omega, temperature, GAS_CONSTANT * temperature * level + 1000.0


@cache
def _canonical():
    fields = truth(*np.meshgrid(*AXES, indexing="ij"))
    names = ("u", "v", "w", "t", "z")
    units = ("m s**-1", "m s**-1", "Pa s**-1", "K", "m**2 s**-2")
    return xr.Dataset(
        {name: (DIMS, field, {"units": unit})
         for name, field, unit in zip(names, fields, units, strict=True)},
        coords={"time": TIMES, "pressure": ("pressure", HPA, {"units": "hPa"}),
                "latitude": NORTH, "longitude": EAST},
    )  # fmt: skip


def canonical():
    return _canonical().copy(deep=True)


def coarse(step=6):
    return canonical().isel(latitude=slice(None, None, step), longitude=slice(None, None, step))


def as_height(data):
    return (data.z / GRAVITY).assign_attrs(units="m")


def era5(data):
    """Of the present Climate Data Store: north first, two versions, each with its own times."""
    data = data.rename(time="valid_time", pressure="pressure_level").isel(
        latitude=slice(None, None, -1)
    )
    early, late = data.copy(deep=True), data.copy(deep=True)
    early[{"valid_time": slice(2, None)}] = early.isel(valid_time=slice(2, None)) * np.nan
    late[{"valid_time": slice(None, 2)}] = late.isel(valid_time=slice(None, 2)) * np.nan
    both = xr.concat([early, late], "expver").assign_coords(expver=[1, 5])
    return both.expand_dims(number=[0])


def gfs(data):
    """Of THREDDS: names in full, times and levels that are numbered, geopotential metres."""
    names = {"u": "u-component_of_wind_isobaric", "v": "v-component_of_wind_isobaric",
             "t": "Temperature_isobaric", "w": "Vertical_velocity_pressure_isobaric"}  # fmt: skip
    data = data.assign(Geopotential_height_isobaric=as_height(data).assign_attrs(units="gpm"))
    data["w"].attrs["units"] = "Pa/s"
    levels = data.assign_coords(pressure=("pressure", 100.0 * HPA, {"units": "Pa"}))
    levels = levels.isel(pressure=slice(None, None, -1)).drop_vars("z").rename(names)
    return levels.rename(time="time1", pressure="isobaric3", latitude="lat", longitude="lon")


def merra2(data):
    """In capitals, from -180°, without values below mountains."""
    data = data.assign_coords(longitude=(data.longitude + 180.0) % 360.0 - 180.0)
    data = data.sortby("longitude").assign(H=as_height(data)).drop_vars("z")
    for name in data.data_vars:
        values = data[name].values.copy()
        values[:, 0, 20, 10:30] = np.nan
        data[name] = data[name].copy(data=values)
    names = {"u": "U", "v": "V", "w": "OMEGA", "t": "T"}
    return data.rename(names | {"pressure": "lev", "latitude": "lat", "longitude": "lon"})


def icon(data):
    """As cfgrib gives a forecast: one run, its steps, and the times at which they hold."""
    data = data.rename(time="step", pressure="isobaricInhPa", z="fi").drop_vars("step")
    steps = (TIMES - START).astype("timedelta64[ns]")
    return data.assign_coords(
        step=steps, time=START, valid_time=("step", TIMES), heightAboveGround=10.0
    )


def wrf(data):
    """Of ``auxhist`` on pressure levels, its map that of latitudes and longitudes."""
    dims = ("Time", "num_press_levels_stag", "south_north", "west_east")
    fields = {"u": "U_PL", "v": "V_PL", "t": "T_PL"}
    found = {ours: (dims, data[name].values, data[name].attrs) for name, ours in fields.items()}
    found["GHT_PL"] = (dims, as_height(data).values, {"units": "m"})
    found["P_PL"] = (dims[:2], np.tile(100.0 * HPA, (4, 1)), {"units": "Pa"})
    north, east = np.meshgrid(NORTH, EAST, indexing="ij")
    for name, grid in (("XLAT", north), ("XLONG", east)):
        found[name] = ((dims[0], *dims[2:]), np.tile(grid, (4, 1, 1)))
    return xr.Dataset(found, coords={"XTIME": ("Time", TIMES)})


PLACES = np.radians([[42.0, 13.0], [-33.3, -71.4], [68.0, 181.0], [1.0, 359.0]])
HEIGHTS = np.array([21e3, 30e3, 36e3, 42e3])
MOMENTS = np.array([1.3, 0.4, 2.6, 2.0])


def grads(data):
    """Of NOMADS: names as GrADS has them, units in long names, days since the year one."""
    names = {"u": "ugrdprs", "v": "vgrdprs", "t": "tmpprs", "w": "vvelprs", "h": "hgtprs"}
    units = {"u": "m/s", "v": "m/s", "t": "k", "w": "pa/s", "h": "gpm"}
    data = data.assign(h=as_height(data)).drop_vars("z")
    for name, unit in units.items():
        data[name].attrs = {"long_name": f"** (1000 975 950.. 1) {name} [{unit}] "}
    days = 739789.0 + np.arange(4) / 4.0
    data = data.assign_coords(
        time=("time", days, {"units": "days since 1-1-1 00:00:0.0"}),
        pressure=("pressure", HPA, {"units": "millibar", "long_name": "altitude"}),
    )
    return data.rename(names).rename(pressure="lev", latitude="lat", longitude="lon")


@cache
def independent(index):
    """Winds and air by SciPy, linear in pressure's logarithm, at the level of the height wanted."""
    north, east = np.degrees(PLACES[index])
    table = [np.concatenate([field, field[..., :1]], axis=3)
             for field in truth(*np.meshgrid(*AXES, indexing="ij"))]  # fmt: skip
    levels = np.linspace(AXES[1][0], AXES[1][-1], 20_001)
    at = np.stack(np.broadcast_arrays(MOMENTS[index], levels, north, east % 360.0), axis=-1)
    axes = (*AXES[:3], np.append(EAST, 360.0))
    table[2] *= -GAS_CONSTANT * table[3] / (np.exp(-AXES[1])[:, None, None] * GRAVITY)
    *air, geopotential = (RegularGridInterpolator(axes, field)(at) for field in table)
    height = altitude_of(geopotential, PLACES[index, 0])
    return [np.interp(HEIGHTS[index], height, part) for part in (*air, np.exp(-levels))]


@pytest.mark.parametrize("layout", [era5, gfs, merra2, icon, wrf, grads])
def test_a_file_as_it_is_downloaded(tmp_path, layout):
    path = tmp_path / "weather.nc"
    layout(canonical()).to_netcdf(path, engine="h5netcdf")
    wind = GriddedWind.from_file(path)
    told = "geopotential" if layout in (era5, icon) else "heights"
    assert f"altitudes of its levels by the {told} of the data" in wind.describe()[0]
    for index, (height, moment) in enumerate(zip(HEIGHTS, MOMENTS, strict=True)):
        place = Place(*PLACES[index], BEGIN + moment * 21600.0)
        found, state = wind.velocity(height, place), lf.Earth(wind=wind).state(height, place)
        east, north, up, temperature, pressure = independent(index)
        assert state.temperature == pytest.approx(temperature, rel=2e-4)
        assert state.pressure == pytest.approx(pressure, rel=1e-3)
        np.testing.assert_allclose([found.east, found.north], [east, north], atol=0.1)
        if layout is not wrf:
            assert found.up == pytest.approx(up, rel=1e-3)


def test_levels_lie_by_the_temperature_where_there_is_no_geopotential():
    data = coarse(2)
    wind, sure = (GriddedWind(one) for one in (data.drop_vars("z"), data))
    assert "by the temperature of the data" in wind.describe()[0]
    where = Place(0.7, 0.2, 835_300_000.0)
    there = [one.velocity(30e3, where).east for one in (wind, sure)]
    assert there[0] == pytest.approx(there[1], abs=0.1)
    alone = data.drop_vars(["z", "t", "w"])
    assert "by the atmosphere" in GriddedWind(alone, lf.environment.US1976()).describe()[0]


def by_temperature(data):
    return data.drop_vars("z")


@pytest.mark.parametrize("layout", [era5, merra2, by_temperature])
def test_what_is_read_of_a_large_file_is_what_it_has(tmp_path, monkeypatch, layout):
    """Over both poles and the date line, place after place and all at once."""
    path = tmp_path / "weather.nc"
    layout(canonical().isel(pressure=slice(3, None))).to_netcdf(path, engine="h5netcdf")
    whole = GriddedWind.from_file(path)
    monkeypatch.setattr(store, "KEPT", 10_000)
    wind, fresh = (GriddedWind.from_file(path) for _ in range(2))
    assert wind.store is not None
    assert wind.describe() == whole.describe()
    assert wind.reach.ends == whole.reach.ends
    generator, low = np.random.default_rng(0), whole.reach.ends[1][0]
    latitude = np.radians([-90.0, -84.0, -50.1, -1.0, 20.0, 50.0, 83.0, 88.0, 89.9, 90.0])
    longitude = np.array([0.1, 3.1, 3.2, -3.1, 6.27, 0.01, -1.0, 4.0, 5.0, 12.0])
    place = Place(latitude, longitude, BEGIN + 64800.0 * generator.uniform(0.0, 1.0, 10))
    altitude = generator.uniform(low, 42e3, 10)
    for row in (4, 5, 9, 0):
        where = altitude[row], Place(*(part[row] for part in place))
        np.testing.assert_allclose(fresh.velocity(*where), whole.velocity(*where), atol=1e-12)
    found = wind.velocity(altitude, place)
    np.testing.assert_allclose(found, whole.velocity(altitude, place), atol=1e-12)
    with pytest.raises(lf.ParameterError, match="not under JAX"):
        jax.grad(lambda height: wind.velocity(height, Place(0.7, 0.2, BEGIN)).east)(30e3)
    with pytest.raises(lf.ParameterError, match=r'altitude above .*; beyond = "gradient"'):
        wind.velocity(60e3, Place(0.7, 0.2, BEGIN))


def test_a_large_file_of_a_region_is_read_whatever_its_longitudes_are_called(tmp_path, monkeypatch):
    path = tmp_path / "weather.nc"
    region = canonical().sel(latitude=slice(20.0, 60.0), longitude=slice(180.0, 300.0))
    region.to_netcdf(path, engine="h5netcdf")
    whole = GriddedWind.from_file(path)
    monkeypatch.setattr(store, "KEPT", 3000)
    wind = GriddedWind.from_file(path)
    longitude = np.radians([-179.0, 181.0, 240.0, -120.0, -61.0, 299.9])
    place = Place(np.radians([20.1, 59.9, 40.0, 40.0, 21.0, 58.0]), longitude, 835_300_000.0)
    found = wind.velocity(30e3, place)
    np.testing.assert_allclose(found, whole.velocity(30e3, place), atol=1e-12)
    with pytest.raises(lf.ParameterError, match="longitude east of"):
        wind.velocity(30e3, Place(0.7, 0.0, 835_300_000.0))


def test_little_of_a_large_file_is_in_memory(tmp_path, monkeypatch):
    path = tmp_path / "weather.nc"
    canonical().to_netcdf(path, engine="h5netcdf")
    largest = []
    monkeypatch.setattr(store, "KEPT", 3000)
    load = store.load_parts

    def watched(*given):
        found = load(*given)
        largest.append(max(field.size for field in found.data_vars.values()))
        return found

    monkeypatch.setattr(store, "load_parts", watched)
    wind = GriddedWind.from_file(path)
    wind.velocity(30e3, Place(0.7, 0.2, 835_300_000.0))
    assert max(largest) < canonical().u.size / 40


def test_polar_rows_of_a_large_file_that_are_no_wind_at_some_times(tmp_path, monkeypatch):
    """Read time by time: all tables have the same rows, whatever stands at the poles."""
    data = canonical().isel(pressure=slice(3, 8))
    data.u[:] = -12.0 * np.sin(np.radians(data.longitude))  # 12 m/s across the pole
    data.v[:] = -12.0 * np.cos(np.radians(data.longitude)) * np.sin(np.radians(data.latitude))
    data.u[:, :, [0, -1]], data.v[:, :, [0, -1]] = 12.0, 0.0
    data.u[1], data.v[1] = 0.0, 0.0  # a calm
    data.to_netcdf(tmp_path / "weather.nc", engine="h5netcdf")
    whole = GriddedWind.from_file(tmp_path / "weather.nc")
    monkeypatch.setattr(store, "KEPT", 3000)
    wind = GriddedWind.from_file(tmp_path / "weather.nc")
    place = Place(np.radians([90.0, 89.0, 87.5]), np.full(3, 0.4), BEGIN + 12.0 * 3600.0)
    found = wind.velocity(30e3, place)
    np.testing.assert_allclose(found, whole.velocity(30e3, place), atol=1e-12)
    north = -np.cos(0.4) * np.sin(place.latitude)
    np.testing.assert_allclose(found.east, -12.0 * np.sin(0.4), rtol=1e-4)
    np.testing.assert_allclose(found.north, 12.0 * north, rtol=1e-4)


def test_several_files_are_one(tmp_path, monkeypatch):
    data = coarse(2)
    for number in range(4):
        path = tmp_path / f"day-{number}.nc"
        data.isel(time=[number]).to_netcdf(path, engine="h5netcdf")
    where = Place(0.7, 0.2, 835_300_000.0)
    found = GriddedWind.from_file(tmp_path / "day-*.nc").velocity(30e3, where)
    np.testing.assert_allclose(found, GriddedWind(data).velocity(30e3, where), rtol=1e-12)
    monkeypatch.setattr(store, "KEPT", 10_000)
    parts = GriddedWind.from_file(tmp_path / "day-*.nc").velocity(30e3, where)
    np.testing.assert_allclose(parts, found, atol=1e-12)
    other = data.isel(time=[3], latitude=slice(1, None))
    other.to_netcdf(tmp_path / "day-3.nc", engine="h5netcdf")
    with pytest.raises(
        lf.ConfigurationError, match="do not share one grid: their latitudes or longitudes"
    ):
        GriddedWind.from_file(tmp_path / "day-*.nc")
    with pytest.raises(lf.ConfigurationError, match="no file has such a name"):
        GriddedWind.from_file(tmp_path / "week-*.nc")


def write_grib(path, entries):
    """Write messages as a forecast has them: (time, short name, level [Pa], field) each."""
    eccodes = pytest.importorskip("eccodes")
    grid = {"Ni": EAST.size, "Nj": NORTH.size, "bitsPerValue": 24, "dataDate": 20260621}
    grid |= {"latitudeOfFirstGridPointInDegrees": 90.0, "latitudeOfLastGridPointInDegrees": -90.0,
             "longitudeOfFirstGridPointInDegrees": 0.0, "longitudeOfLastGridPointInDegrees": 355.0,
             "iDirectionIncrementInDegrees": 5.0, "jDirectionIncrementInDegrees": 5.0}  # fmt: skip
    with path.open("wb") as file:
        for time, name, pascals, field in entries:
            message = eccodes.codes_grib_new_from_samples("regular_ll_pl_grib2")
            unit = "isobaricInhPa" if pascals >= 100 else "isobaricInPa"
            keys = {"typeOfLevel": unit, "level": pascals // (100 if pascals >= 100 else 1)}
            if name == "2t":
                keys = {"typeOfLevel": "heightAboveGround", "level": 2}
            keys = grid | {"dataTime": 0, "step": 6 * time, "shortName": name} | keys
            for key, value in keys.items():
                eccodes.codes_set(message, key, value)
            eccodes.codes_set_values(message, field[::-1].ravel())
            eccodes.codes_write(message, file)
            eccodes.codes_release(message)


@pytest.mark.parametrize("kept", [store.KEPT, 50_000])
def test_a_forecast_in_grib(tmp_path, monkeypatch, kept):
    """A file for each time, levels in hPa and in Pa, and much that is not asked for."""
    pytest.importorskip("cfgrib")
    levels = [100000, 50000, 10000, 3000, 1000, 300, 100, 40, 10, 4]
    grid = np.meshgrid(NORTH, EAST, indexing="ij")
    for time in range(4):
        entries = [(time, "2t", 0, 0.0 * grid[0] + 288.0)]
        for level in levels:
            *fields, geopotential = truth(float(time), -np.log(level), *grid)
            named = zip(("u", "v", "w", "t", "gh"), [*fields, geopotential / GRAVITY], strict=True)
            entries += [(time, name, level, field) for name, field in named
                        if name != "w" or level >= 100]  # fmt: skip
        write_grib(tmp_path / f"gfs.f{6 * time:03d}.grib2", entries)
    monkeypatch.setattr(store, "KEPT", kept)
    wind = GriddedWind.from_file(tmp_path / "gfs.*")
    assert (wind.store is not None) == (kept == 50_000)
    GriddedWind.from_file(tmp_path / "gfs.*")  # beside the files that cfgrib has written
    for (north, east), moment, height in zip(
        PLACES, MOMENTS, [21e3, 35e3, 50e3, 65e3], strict=True
    ):
        at = moment, np.linspace(-np.log(1e5), -np.log(4.0), 20_001), *np.degrees([north, east])
        u, v, _, temperature, geopotential = truth(at[0], at[1], at[2], at[3] % 360.0)
        where = Place(north, east, BEGIN + moment * 21600.0)
        expected = [np.interp(height, altitude_of(geopotential, north), part)
                    for part in (u, v, temperature + 0.0 * u)]  # fmt: skip
        state = lf.Earth(wind=wind).state(height, where)
        found = state.wind.east, state.wind.north, state.temperature
        np.testing.assert_allclose(found, expected, atol=0.1)
    write_grib(tmp_path / "surface.grib2", [(0, "2t", 0, 0.0 * grid[0] + 288.0)])
    with pytest.raises(lf.LightflyerError, match="has no u and v on pressure levels"):
        GriddedWind.from_file(tmp_path / "surface.grib2")


def test_files_that_are_not_usable_get_one_line(tmp_path):
    (tmp_path / "era5.grib").write_bytes(b"GRIB")
    try:
        import cfgrib  # noqa: F401
    except ImportError:
        reason = "GRIB needs cfgrib: pip install"
    else:
        reason = "cannot be read as GRIB"
    with pytest.raises(lf.LightflyerError, match=rf"era5.grib: {reason}"):
        GriddedWind.from_file(tmp_path / "era5.grib")
    bent = wrf(canonical())
    bent["XLAT"] = bent.XLAT + 0.1 * bent.west_east
    with pytest.raises(
        lf.ConfigurationError, match="do not form a grid of latitudes and longitudes"
    ):
        GriddedWind(bent)


WRONG_UNITS = {  # variable, what is done to it, unit that it then has, unit that is meant
    "geopotential over g": ("z", 1 / GRAVITY, "m**2 s**-2", "m"),
    "heights that are geopotentials": ("h", GRAVITY, "m", "m**2/s**2"),
    "heights in kilometres": ("h", 1e-3, "m", "km"),
    "heights in feet": ("h", 1 / 0.3048, "m", "ft"),
    "hectopascals": ("pressure", 1.0, "Pa", "hPa"),
}


@pytest.mark.parametrize("case", WRONG_UNITS)
@pytest.mark.parametrize("is_warm", [True, False])
def test_heights_that_contradict_pressures(case, is_warm):
    """And what the message says to write is right: pressure and wind are those of a right file."""
    name, factor, unit, meant = WRONG_UNITS[case]
    data = coarse()
    right = GriddedWind(data.copy(deep=True))
    if not is_warm:
        data = data.drop_vars(["t", "w"])
    if name == "h":
        data = data.assign(h=as_height(data)).drop_vars("z")
    data = data.assign({name: (data[name] * factor).assign_attrs(units=unit)})
    with pytest.raises(lf.ConfigurationError, match="where the standard atmosphere has") as caught:
        GriddedWind(data)
    advice = f'set dataset["{name}"].attrs["units"] = "{meant}"'
    assert str(caught.value).endswith(advice)
    exec(advice.removeprefix("set "), {"dataset": data})
    place = Place(0.5, 0.3, float(seconds_of(START)) + 9e3)
    np.testing.assert_allclose(
        GriddedWind(data).velocity(3e4, place)[:2], right.velocity(3e4, place)[:2], rtol=1e-9
    )


def test_temperatures_that_are_in_celsius():
    data = coarse()
    data["t"] = (data.t - 273.15).assign_attrs(units="K")
    with pytest.raises(lf.ConfigurationError, match=r't falls to -48.* in °C, set dataset\["t"\]'):
        GriddedWind(data)


def with_times(path, unit, *numbers, calendar="standard"):
    data = coarse()
    data = data.isel(time=slice(len(numbers)))
    data = data.assign_coords(time=("time", [*numbers], {"units": unit, "calendar": calendar}))
    data.to_netcdf(path, engine="h5netcdf")
    return GriddedWind.from_file(path)


@pytest.mark.parametrize("calendar", ["noleap", "360_day", "julian"])
def test_calendars_without_true_dates(tmp_path, monkeypatch, calendar):
    monkeypatch.chdir(tmp_path)
    said = rf"m\.nc: .*calendar {calendar}.*: pip install cftime, then "
    with pytest.raises(lf.ConfigurationError, match=said) as caught:
        with_times("m.nc", "days since 2026-06-21", 0.0, 1.0, calendar=calendar)
    pytest.importorskip("cftime")
    exec(str(caught.value).split("then ")[1], {"xarray": xr})
    assert "2026-06-21 00:00 UTC to 2026-06-22" in GriddedWind.from_file("dates.nc").describe()[0]
    with pytest.raises(lf.ConfigurationError, match=f"calendar {calendar}"):
        GriddedWind(xr.open_dataset("m.nc"))


@pytest.mark.parametrize(
    ("unit", "calendar", "first"),
    [  # cftime.num2date(739789, "days since 1-1-1", calendar) is 2026-06-21, and 2 days less
        ("days since 1-1-1 00:00:0.0", "standard", 739789.0),
        ("hours since 1-1-1", "gregorian", 24 * 739789.0),
        ("days since 0001-01-01", "proleptic_gregorian", 739787.0),
    ],
)
def test_days_since_the_year_one(tmp_path, unit, calendar, first):
    wind = with_times(tmp_path / "old.nc", unit, first, first + 1.0, calendar=calendar)
    assert wind.describe()[0].startswith("wind: data, 2026-06-21 00:00 UTC to 2026-06-2")


def test_a_time_that_no_library_reads_is_not_a_damaged_file(tmp_path):
    with pytest.raises(
        lf.ConfigurationError, match=r"n\.nc: its times cannot be read: .*fortnights"
    ):
        with_times(tmp_path / "n.nc", "fortnights since 2026-06-21", 0.0, 1.0)


def test_another_wind_takes_over_smoothly_beyond_the_data():
    data = GriddedWind(coarse())
    other = lf.environment.UniformWind(east=-60.0)
    both = lf.environment.WindBeyondData(data, other)
    top = data.reach.ends[1][1]
    here = Place(0.7, 0.2, 835_300_000.0)
    heights = top + np.array([-10e3, -2e3, -1e3, 0.0, 1.0, 30e3])
    east = np.array([both.velocity(height, here).east for height in heights])
    inner = np.array([data.velocity(height, here).east for height in heights[:3]])
    expected = [*inner[:2], 0.5 * (inner[2] - 60.0), -60.0, -60.0, -60.0]
    np.testing.assert_allclose(east, expected, atol=1e-9)
    with lf.float64():
        slope = jax.grad(lambda height: both.velocity(height, here).east)
        assert [float(slope(top + above)) for above in (0.0, 1e3)] == [0.0, 0.0]
        step = [both.velocity(top - 1e3 + way, here).east for way in (-1.0, 1.0)]
        assert float(slope(top - 1e3)) == pytest.approx(np.diff(step)[0] / 2.0, rel=1e-5)
    later = here._replace(time=here.time + 1e7)
    assert both.velocity(30e3, later).east == -60.0
    assert both.describe()[-1] == "wind beyond the data: -60 m/s east, everywhere"


def test_the_other_wind_need_not_reach_where_the_data_do():
    atmosphere = lf.environment.GlobalNRLMSIS(f107=150.0, ap=4.0)
    gradient = lf.environment.GradientWind(atmosphere)
    both = lf.environment.WindBeyondData(GriddedWind(coarse()), gradient)
    equator = Place(0.0, 0.2, 835_300_000.0)
    assert np.isfinite(both.velocity(30e3, equator).east)
    with pytest.raises(lf.ParameterError, match="within 15° of the equator"):
        both.velocity(70e3, equator)
    north = equator._replace(latitude=0.8)
    np.testing.assert_allclose(both.velocity(70e3, north), gradient.velocity(70e3, north))


def test_air_of_the_data_goes_over_into_the_atmosphere():
    """Smoothly, above in hydrostatic balance, and beside the data back to the atmosphere's own."""
    data = GriddedWind(canonical().sel(latitude=slice(20.0, 60.0), longitude=slice(0.0, 60.0)))
    wind = lf.environment.WindBeyondData(data, lf.environment.UniformWind(-10.0))
    place = Place(*np.radians([42.0, 13.0]), BEGIN + 3e4)
    with_data, without = lf.Earth(wind=wind), lf.Earth()
    heights = np.arange(20e3, 70e3, 10.0)
    air = with_data.state(heights, place)
    warm = 245.0 + 20.0 * np.sin(np.radians(42.0))
    top = data.reach.ends[1][1]
    inside, above = heights < top - 2e3, heights > top
    np.testing.assert_allclose(air.temperature[inside], warm, rtol=1e-6)
    standard = without.state(heights)
    np.testing.assert_allclose(air.temperature[above], standard.temperature[above], rtol=1e-12)
    slope = np.gradient(np.log(air.pressure), heights)
    expected = -air.gravity / (air.gas.specific_gas_constant * air.temperature)
    np.testing.assert_allclose(slope[5:-5], expected[5:-5], rtol=5e-3)
    beside = Place(np.radians(42.0), np.radians(-5.0), BEGIN + 3e4)
    assert with_data.state(30e3, beside).pressure == pytest.approx(without.state(30e3).pressure)


def test_a_flyer_may_keep_its_atmosphere(tmp_path):
    path = tmp_path / "weather.nc"
    coarse().to_netcdf(path, engine="h5netcdf")
    place = Place(np.pi / 3.0, 0.0, BEGIN)
    for air, temperature in ((True, 245.0 + 20.0 * np.sin(np.pi / 3.0)), (False, None)):
        environment = lf.Earth(wind=GriddedWind.from_file(path, air=air))
        expected = temperature or lf.Earth().state(30e3).temperature
        assert environment.state(30e3, place).temperature == pytest.approx(expected, rel=1e-6)
        assert any("air: temperature" in text for text in environment.wind.describe()) == air
