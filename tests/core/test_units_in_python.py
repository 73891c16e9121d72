"""What constructors and functions make of texts, quantities, lists and of what is no number."""

import jax
import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.core.checks import require_range

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
OTHER_REGISTRY = pint.UnitRegistry()


ONE = OTHER_REGISTRY.Quantity(1, "cm")
SEVERAL = [
    [0.01, 0.02],
    (0.01, 0.02),
    np.array([0.01, 0.02]),
    xr.DataArray([0.01, 0.02], dims="radius"),
    OTHER_REGISTRY.Quantity([1, 2], "cm"),
]


@pytest.mark.parametrize(
    "radius", [0.01, "1 cm", "10 mm", ONE, np.float64(0.01), np.asarray(0.01), *SEVERAL]
)
def test_a_number_in_any_writing_is_the_same_disk(radius):
    expected = np.pi * 1e-3 * np.array([0.01, 0.02])[: np.size(radius)] ** 2
    found = lf.Disk(FILM, radius).own_mass
    np.testing.assert_allclose(found, expected if np.ndim(found) else expected[0], rtol=1e-12)


def test_every_record_reads_units():
    film = lf.FilmProperties("1 g/m^2", "75 %", 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    assert film.areal_density == pytest.approx(1e-3)
    assert film.absorptance == pytest.approx(0.75)
    assert lf.Chamber(temperature="20 degC").temperature == pytest.approx(293.15)
    assert lf.Chamber().state("30 mTorr").pressure == pytest.approx(3.99967, rel=1e-5)
    assert np.shape(lf.Earth().state([70e3, 72e3]).pressure) == (2,)
    assert lf.Disk(FILM, "1 cm", payload="0.1 mg").payload == pytest.approx(1e-7)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("2 kg", r'radius = "2 kg": unit "kg" is of the wrong kind; give one that converts to m'),
        ("2", r'radius = "2" has no unit; write "2 cm"'),
        ("wide", r'radius = "wide" is not a number with a unit, such as "1 m"'),
        ("2 ± 1 cm", r"radius = 0.02: an object takes no ±; give uncertainties to a flyer file"),
        (lf.Measured(0.02, 0.01), r"radius = 0.02: an object takes no ±"),
        (OTHER_REGISTRY.Quantity(2, "kg"), r"radius = 2 kg does not convert to m"),
        (None, r'radius must be a number or an array of numbers \[m\], or a text such as "1 m"'),
        (True, "radius must be a number"),
        (1j, "radius must be a number"),
        ({}, "radius must be a number"),
        (
            pd.DataFrame({"radius": [0.01, 0.02]}),
            "radius is a table of pandas; give one of its columns",
        ),
        ([0.01, "x"], r'radius = "x" is not a number with a unit'),
        ([[0.01], [0.01, 0.02]], "radius must be a number"),
        ("-2 cm", "radius = -0.02 is not positive"),
        (np.nan, "radius = nan is not positive"),
    ],
)
def test_what_is_no_length_is_one_clear_line(value, message):
    with pytest.raises(lf.ParameterError, match=message) as caught:
        lf.Disk(FILM, value)
    assert "\n" not in str(caught.value)


def test_what_is_of_the_wrong_class_is_one_clear_line():
    disk, state = lf.Disk(FILM, 0.01), lf.Earth().state(72e3)
    for function in (lf.payload, lf.lift, lf.levitate, lf.equilibrium, lf.statics.force_vector):
        with pytest.raises(lf.ParameterError, match="state must be of class EnvironmentState"):
            function(disk, 72e3, lf.Lu2023())
        with pytest.raises(lf.ParameterError, match="model must be of class AbstractForceModel"):
            function(disk, state, "kinetic")


def test_functions_take_lists_and_refuse_units():
    paths = lf.gas.mean_free_path([1.0, 2.0], 300.0, lf.gas.AIR)
    assert paths[0] == pytest.approx(2.0 * paths[1])
    assert lf.gas.mean_free_path("1 Pa", 300.0, lf.gas.AIR) == paths[0]
    hours = xr.DataArray([1.0, 2.0], dims="t", attrs={"units": "hour"})
    position = lf.environment.EarthSun().position
    for time in ("1 hour", ["1 hour"], OTHER_REGISTRY.Quantity(1, "hour"), hours):
        with pytest.raises(lf.ParameterError, match="in SI units"):
            position(time)


EARTH, LU = lf.Earth(), lf.Lu2023()
DISK, STATE = lf.Disk(FILM, 0.01), EARTH.state(72e3)
PLACE = lf.environment.Place.at("2026-06-21T12:00Z", 45.0, 10.0)
# What takes numbers: a function of one, values in SI, another unit, and its size by definition
TAKES_NUMBERS = {
    "mean free path": (lambda x: lf.gas.mean_free_path(x, 300.0, lf.gas.AIR), 10.0, "hPa", 100.0),
    "method of a gas": (lf.gas.CARBON_DIOXIDE.viscosity, 300.0, "mK", 1e-3),
    "Earth": (lambda x: EARTH.state(x).pressure, 70e3, "km", 1e3),
    "chamber": (lambda x: lf.Chamber().state(x).pressure, 10.0, "mbar", 100.0),
    "wind": (
        lambda x: lf.environment.UniformWind(x).velocity(70e3, PLACE).east, 5.0, "km/s", 1e3
    ),
    "gravity": (lf.environment.EARTH_PLANET.gravity_at, 70e3, "km", 1e3),
    "place": (
        lambda x: lf.environment.Place.at("2026-06-21T12:00Z", x, 10.0).latitude, 45.0, "rad",
        180.0 / np.pi,
    ),
    "light": (lambda x: lf.environment.Radiation(x).irradiance, 1361.0, "kW/m^2", 1e3),
    "constructor": (lambda x: lf.Disk(FILM, x).own_mass, 0.01, "cm", 0.01),
    "payload": (lambda x: lf.payload(lf.Disk(FILM, x), STATE, LU), 0.01, "cm", 0.01),
    "drag": (
        lambda x: lf.drag.disk_drag(x, 0.01, 5.2, 220.0, lf.gas.AIR), 1.0, "km/s", 1e3
    ),
    "radio": (lambda x: lf.budget.free_space_loss(x, 434e6), 30e3, "km", 1e3),
    "black body": (lambda x: lf.film.planck(x, 300.0), 1e-5, "um", 1e-6),
    "drift": (
        lambda x: lf.mission.steady_drift(DISK, EARTH, LU, altitude=x, tilt=0.3).speed, 70e3,
        "km", 1e3,
    ),
    "sweep": (
        lambda x: lf.sweep(DISK, EARTH, LU, over={"altitude": x}, outputs=["payload"]).payload,
        70e3, "km", 1e3,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", TAKES_NUMBERS.values(), ids=TAKES_NUMBERS)
def test_units_and_names_travel(case):
    function, value, unit, size = case
    numbers = np.array([value, 1.01 * value])
    expected = np.asarray(function(numbers))
    coordinates = {"where": [3, 4]}
    labelled = xr.DataArray(numbers / size, coordinates, ["where"], attrs={"units": unit})
    found = function(labelled)
    assert found.dims == ("where",)
    np.testing.assert_array_equal(found["where"], [3, 4])
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    for written in (
        pd.Series(numbers),
        numbers.tolist(),
        tuple(numbers.tolist()),
        OTHER_REGISTRY.Quantity(numbers / size, unit),
        [f"{number / size!r} {unit}" for number in numbers.tolist()],
    ):
        np.testing.assert_allclose(function(written), expected, rtol=1e-12)
    with pytest.raises(lf.LightflyerError, match="wrong kind; give one that converts to") as caught:
        function(labelled.assign_attrs(units="kg"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", ["m", "metre", "degree", "degrees_north", "W m-2", "1", "%"])
def test_units_are_read_as_datasets_write_them(kind):
    targets = {"W m-2": "W/m^2", "1": "", "%": "", "degree": "deg", "degrees_north": "deg"}
    number = lf.quantity.Quantity(targets.get(kind, "m")).number
    expected = 0.005 if kind == "%" else 0.5
    assert number("x", xr.DataArray(0.5, attrs={"units": kind})) == pytest.approx(expected)


def test_columns_of_pandas_go_out_as_columns():
    table = pd.DataFrame({"radius": [0.5, 1.0, 2.0], "km": [70.0, 74.0, 78.0]}, ["c", "a", "b"])
    some = table[table.radius < 1.5]
    disk, state = lf.Disk(FILM, 1e-2 * some.radius), EARTH.state(1e3 * some.km)
    found = lf.lift(disk, state, LU)
    assert type(found) is pd.Series
    assert [*found.index] == ["c", "a"]
    alone = lf.lift(lf.Disk(FILM, 0.01), EARTH.state(74e3), LU)
    assert found["a"] == pytest.approx(alone, rel=1e-12)
    assert type(lf.levitate(disk, state, LU).irradiance) is pd.Series
    assert type(lf.payload(disk, EARTH.state(72e3), LU)) is pd.Series
    table["lift"] = found  # by the index
    assert np.isnan(table.loc["b", "lift"])
    grid = EARTH.state(xr.DataArray([70e3, 72e3], dims="altitude"))
    assert type(lf.lift(lf.Disk(FILM, 0.01), grid, LU)) is xr.DataArray
    with pytest.raises(lf.ParameterError, match="columns of pandas have different indexes"):
        lf.lift(disk, EARTH.state(1e3 * table.km[::-1][:2]), LU)


def test_names_of_dimensions_make_a_grid():
    radii = xr.DataArray([1.0, 2.0, 3.0], dims="radius", attrs={"units": "cm"})
    altitudes = xr.DataArray([70.0, 72.0], dims="altitude", attrs={"units": "km"})
    found = lf.payload(lf.Disk(FILM, radii), EARTH.state(altitudes), LU)
    assert dict(found.sizes) == {"radius": 3, "altitude": 2}
    alone = lf.payload(lf.Disk(FILM, 0.03), EARTH.state(70e3), LU)
    assert found[2, 0] == pytest.approx(alone, rel=1e-12)
    shifted = altitudes.assign_coords(altitude=[1, 2])
    other = lf.Disk(FILM, xr.DataArray([0.01, 0.02], {"altitude": [2, 3]}, ["altitude"]))
    with pytest.raises(lf.ParameterError, match="do not fit together"):
        lf.payload(other, EARTH.state(shifted), LU)


def test_under_jit_what_is_impossible_is_nan():
    def payload(radius):
        return lf.payload(lf.Disk(FILM, radius), STATE, LU)

    found = jax.jit(jax.vmap(payload))(np.array([-0.01, 0.0, 0.01]))
    np.testing.assert_array_equal(np.isnan(found), [True, True, False])


@pytest.mark.parametrize(
    ("spreads", "correlation", "message"),
    [
        ((0.01, 0.01), 2.0, "= 2 is not between -1 and 1"),
        ((-0.01, 0.01), 0.0, "tac_top: the uncertainty must be zero or positive"),
        ((np.nan, 0.01), 0.0, "tac_top: the uncertainty must be zero or positive"),
        ((5.0, 0.01), 0.0, "tac_top: the uncertainty must be at most 1.3"),
        ((0.01, 0.0), 0.5, "of flyer.film.tac_bottom has no effect without its ±"),
        ((True, 0.01), 0.5, "uncertainty of flyer.film.tac_top must be a number"),
    ],
)
def test_a_design_of_objects_is_checked_as_files_are(spreads, correlation, message):
    faces = "flyer.film.tac_top", "flyer.film.tac_bottom"
    setup = lf.Setup(DISK, EARTH, LU)
    with pytest.raises(lf.LightflyerError, match=message):
        lf.design.ObjectDesign(setup, dict(zip(faces, spreads, strict=True)), {faces: correlation})


def test_correlations_of_a_design_of_objects_belong_together():
    top, bottom, light = names = [
        f"flyer.film.{name}" for name in ("tac_top", "tac_bottom", "absorptance")
    ]
    pairs = {(top, bottom): 0.9, (bottom, light): 0.9, (top, light): -0.9}
    setup = lf.Setup(DISK, EARTH, LU)
    with pytest.raises(lf.ConfigurationError, match="no joint distribution"):
        lf.design.ObjectDesign(setup, dict.fromkeys(names, 0.01), pairs)
    spreads = lf.design.ObjectDesign(setup, {"flyer.radius": "0.5 mm", top: "1 %"}).uncertainties
    assert spreads == pytest.approx({"flyer.radius": 5e-4, top: 0.01})


class Scalar(lf.Lu2023):
    def heat_loss(self, flyer, state, unknowns):
        return unknowns[0]


class Pair(lf.Lu2023):
    def force(self, flyer, state, unknowns):
        return 0.0, 0.0


RELEASE = lf.Release("75 km", 45.0, 10.0, "2026-06-21T12:00Z")
TWO_FILMS = lf.FilmProperties(1e-3, [0.7, 0.8], 0.1, 0.1, 0.8, 0.9)
MISFIT = r"of shape \(2,\) and .* of shape \(3,\) do not fit"


@pytest.mark.parametrize(
    ("function", "says"),
    [
        (lambda: lf.Disk("germanium", 0.01), "film must be of class FilmProperties, not the text"),
        (lambda: lf.Disk(FILM, 0.01, attitude=0.3), "attitude must be of class Attitude or None"),
        (lambda: lf.levitation_band(DISK, "earth", LU), "environment must be of class AbstractEnv"),
        (lambda: lf.lab.fit_tac(None), "run must be of class TacRun, not NoneType"),
        (lambda: lf.lab.levitation_curve("x"), "points must be of class LiftOffs, not str"),
        (lambda: lf.lab.roughness(np.ones((20, 20))), "source must be of class HeightMap"),
        (lambda: lf.lab.read_tac(5), "path must be a path, not int"),
        (lambda: lf.lab.read_spectrum(b"x.csv"), "path must be a path, not bytes"),
        (lambda: lf.calibration.Gauge("1.7"), "a gauge has one factor"),
        (lambda: lf.calibration.Gauge(1.0, np.ones(2)), "both shown and pressure or neither"),
        (lambda: lf.Disk(FILM, np.ma.masked_array([0.01, 0.02], [0, 1])), "radius = nan"),
        (lambda: lf.payload(DISK, STATE, Scalar()), r"heat_loss\(\) of \w+ must give a tuple"),
        (lambda: lf.payload(DISK, STATE, Pair()), r"force\(\) must give an array, not tuple"),
        (
            lambda: lf.fly(DISK, EARTH, LU, release=RELEASE, duration="1 min", attitude="level"),
            "attitude must be of class AbstractAttitudeRule",
        ),
        (
            lambda: require_range("span", "30 %", 0.1, 1.0),
            'span = "30 %" is a text; write a number',
        ),
        (lambda: lf.FilmProperties(1e-3, [0.7, 0.8], 0.1, 0.1, [0.8, 0.9, 1.0], 0.9), MISFIT),
        (lambda: lf.Disk(TWO_FILMS, [1e-2, 2e-2, 3e-2]), MISFIT),
        (
            lambda: lf.levitate(lf.Disk(FILM, [1e-2, 2e-2]), EARTH.state([7e4, 7.1e4, 7.2e4]), LU),
            MISFIT,
        ),
        (lambda: lf.gas.mean_free_path([1.0, 2.0], [200.0, 250.0, 300.0], lf.gas.AIR), MISFIT),
        (
            lambda: lf.predict(lf.Disk(FILM, [0.01, 0.02]), EARTH, LU),
            r"flyer.radius of shape \(2,\) .*sweep takes",
        ),
    ],
)
def test_what_does_not_belong_is_one_sentence(function, says):
    with pytest.raises((lf.ParameterError, lf.ConfigurationError), match=says):
        function()


@pytest.mark.parametrize(
    "wavelength",
    [
        ["500 nm", "0.6 um"],
        OTHER_REGISTRY.Quantity([500, 600], "nm"),
        xr.DataArray([500.0, 600.0], dims="wavelength", attrs={"units": "nm"}),
    ],
)
def test_a_film_reads_units(wavelength):
    film = lf.film.Film((lf.film.Layer(lf.film.material("Ge"), "20 nm"),))
    expected = film.optics(np.array([500e-9, 600e-9]), np.radians(60.0))
    found = film.optics(wavelength, "60 deg")
    np.testing.assert_allclose(found.reflectance, expected.reflectance, rtol=1e-12)
    with pytest.raises(lf.ParameterError, match="do not fit together"):
        film.optics(wavelength, np.array([0.1, 0.2, 0.3]))
    with pytest.raises(lf.ParameterError, match='side "left" is unknown'):
        film.optics(wavelength, side="left")


def test_a_difference_of_temperatures_has_no_zero():
    assert lf.lab.TacAccuracy(temperature="0.5 °C").temperature == 0.5
    assert lf.lab.TacAccuracy(temperature="0.9 °F").temperature == pytest.approx(0.5, rel=1e-12)
