import numpy as np
import pytest
from scipy import optimize, stats
from uncertainties import ufloat

import lightflyer as lf
from lightflyer.core.units import Measured
from lightflyer.lab import Scene, flat_band
from lightflyer.lab.thermography.data import (
    LIGHT,
    THERMAL,
    Readings,
    given_readings,
    read_readings,
    standard_uncertainties,
)
from lightflyer.lab.thermography.reduction import reduce_readings
from lightflyer.lab.thermography.thermal_image import (
    parse_regions,
    region_temperatures,
    region_warnings,
)

from .test_camera import radiance

FEW = 1000  # draws, where the test is of the first order
TOTAL = Scene(camera=None)
BAND = (7.5e-6, 14e-6)
CAMERA = Scene(flat_band(*BAND))
HOT, COLD = 423.15, 295.15


def seen(temperature):
    """Radiance in the band."""
    return radiance(temperature, *BAND)


def apparent(reflectance, transmittance, plate=1.0, warmth=0.0):
    """What a camera shows of a film over a hotplate, shape (4, 1) [K]."""
    emissivity = 1.0 - reflectance - transmittance
    source = plate * seen(HOT) + (1.0 - plate) * seen(COLD)
    own = emissivity * seen(COLD + warmth)
    radiances = (
        source,
        reflectance * source + transmittance * seen(COLD) + own,
        transmittance * source + reflectance * seen(COLD) + own,
        seen(COLD),
    )
    return np.array([[optimize.brentq(lambda t, one=one: seen(t) - one, 200.0, 600.0)]
                     for one in radiances])  # fmt: skip


TEMPERATURES = {
    "hotplate_temperature": Measured(423.15, 0.5),
    "lower_temperature": Measured(323.15, 0.7),
    "upper_temperature": Measured(403.15, 0.6),
    "ambient_temperature": Measured(295.15, 0.3),
}


def test_first_order_equals_an_independent_propagation():
    hot, low, up, cold = (ufloat(*one) for one in TEMPERATURES.values())
    reflectance = (low**4 - cold**4) / (hot**4 - cold**4)
    transmittance = (up**4 - cold**4) / (hot**4 - cold**4)
    expected = (reflectance, transmittance, 1 - transmittance - reflectance)
    found = reduce_readings(given_readings(TEMPERATURES, THERMAL, scene=TOTAL)).first_order
    for one, other in zip(found.values(), expected, strict=True):
        assert one.value == pytest.approx(other.nominal_value, rel=1e-12)
        assert one.uncertainty == pytest.approx(other.std_dev, rel=1e-9)
        assert one.interval[1] - one.value == pytest.approx(1.959964 * other.std_dev, rel=1e-6)


def test_a_camera_is_not_the_fourth_power():
    """Measured on main: 0.115 in place of 0.080."""
    values = apparent(0.12, 0.80)
    found = reduce_readings(Readings(THERMAL, values, np.zeros(4), CAMERA), draws=FEW)
    np.testing.assert_allclose(
        [one.value for one in found.first_order.values()], (0.12, 0.80, 0.08), atol=1e-9
    )
    assert found.meaning == "within 7.5 to 14 µm, near normal"
    assert found.summary()["band_um"] == pytest.approx([7.5, 14.0])
    biased = reduce_readings(Readings(THERMAL, values, np.zeros(4), TOTAL))
    assert biased.emissivity.value == pytest.approx(0.1147, abs=1e-4)
    assert "emissivity of 0.080, the bias is +0.035" in biased.warnings[1]
    assert "T⁴ is no camera" in biased.summary()["warnings"][1]
    assumed = reduce_readings(Readings(THERMAL, values, np.zeros(4)))
    assert assumed.emissivity.value == pytest.approx(0.08)
    assert "with 8 to 14 µm the emissivity is 0.074" in assumed.warnings[1]


def test_a_grey_hotplate_and_a_warm_film():
    values = apparent(0.1, 0.4, plate=0.9, warmth=20.0)
    cold = reduce_readings(Readings(THERMAL, values, np.full(4, 0.1), CAMERA), draws=FEW)
    assert cold.emissivity.value < 0.45
    assert "the film is taken to be as cold" in cold.warnings[0]
    apparent_plate = Scene(CAMERA.camera, film_temperature=Measured(COLD + 20.0))
    found = reduce_readings(Readings(THERMAL, values, np.zeros(4), apparent_plate), draws=FEW)
    assert not found.warnings[1:]
    np.testing.assert_allclose(
        [one.value for one in found.first_order.values()], (0.1, 0.4, 0.5), atol=1e-9
    )
    values[0] = HOT  # by a thermometer
    own = Scene(CAMERA.camera, Measured(0.9), Measured(COLD + 20.0))
    found = reduce_readings(Readings(THERMAL, values, np.zeros(4), own), draws=FEW)
    np.testing.assert_allclose(
        [one.value for one in found.first_order.values()], (0.1, 0.4, 0.5), atol=1e-9
    )


def test_every_input_is_propagated():
    """Derivatives against differences of whole reductions."""
    values = apparent(0.1, 0.4, plate=0.9, warmth=20.0)
    steps = {"readings": 0.01, "emissivity": 1e-4, "film": 0.01}

    def emissivity(values, plate, film):
        scene = Scene(CAMERA.camera, Measured(plate), Measured(film))
        readings = Readings(THERMAL, values, np.zeros(4), scene)
        return reduce_readings(readings, draws=1000).emissivity.value

    spread = np.array([0.5, 0.7, 0.6, 0.3])
    scene = Scene(CAMERA.camera, Measured(0.9, 0.02), Measured(315.0, 4.0))
    found = reduce_readings(Readings(THERMAL, values, spread, scene)).emissivity.uncertainty
    parts = []
    for number, own in enumerate(spread):
        shift = np.zeros((4, 1))
        shift[number] = steps["readings"]
        ends = [emissivity(values + sign * shift, 0.9, 315.0) for sign in (1.0, -1.0)]
        parts.append(own * (ends[0] - ends[1]) / (2.0 * steps["readings"]))
    ends = [emissivity(values, 0.9 + sign * 1e-4, 315.0) for sign in (1.0, -1.0)]
    parts.append(0.02 * (ends[0] - ends[1]) / 2e-4)
    ends = [emissivity(values, 0.9, 315.0 + sign * 0.01) for sign in (1.0, -1.0)]
    parts.append(4.0 * (ends[0] - ends[1]) / 0.02)
    assert found == pytest.approx(np.linalg.norm(parts), rel=1e-5)


def test_errors_that_a_camera_makes_in_all_readings_cancel():
    radiances = [1.05 * seen(float(one)) + 3.0 for one in apparent(0.12, 0.80)[:, 0]]
    shown = [optimize.brentq(lambda t, one=one: seen(t) - one, 200.0, 600.0) for one in radiances]
    found = reduce_readings(Readings(THERMAL, np.array(shown)[:, None], np.zeros(4), CAMERA))
    assert found.emissivity.value == pytest.approx(0.08, abs=1e-9)


def test_monte_carlo_agrees_where_it_should():
    found = reduce_readings(given_readings(TEMPERATURES, THERMAL))
    for name, one in found.first_order.items():
        other = found.monte_carlo[name]
        assert other.uncertainty == pytest.approx(one.uncertainty, rel=0.02)
        assert other.value == pytest.approx(one.value, abs=0.05 * one.uncertainty)
        np.testing.assert_allclose(other.interval, one.interval, atol=0.1 * one.uncertainty)


@pytest.mark.parametrize(
    ("lower", "upper", "expected"),
    [(295.15, 423.15, (0, 1, 0)), (423.15, 295.15, (1, 0, 0)), (295.15, 295.15, (0, 0, 1))],
)
def test_limits(lower, upper, expected):
    """A window, a mirror and a black body."""
    values = np.array([[423.15], [lower], [upper], [295.15]])
    found = reduce_readings(Readings(THERMAL, values, np.zeros(4)))
    np.testing.assert_allclose([one.value for one in found.first_order.values()], expected,
                               atol=1e-12)  # fmt: skip


def test_rows_average_but_a_common_error_does_not(rng):
    values = np.array([[423.15], [323.15], [403.15], [295.15]]) + 0.2 * rng.normal(size=(4, 50))

    def spread(values, of_each):
        readings = Readings(THERMAL, values, np.full(4, of_each))
        return reduce_readings(readings, draws=FEW).emissivity.uncertainty

    assert spread(values, 0.0) == pytest.approx(spread(values[:, :10], 0.0) / 5**0.5, rel=0.5)
    single = spread(values.mean(axis=1)[:, None], 0.5)
    assert spread(values, 0.5) == pytest.approx(single, rel=0.02)


@pytest.mark.parametrize("count", [2, 3])
def test_intervals_of_repeats_have_students_factor(count, rng):
    """Without it two repeats held the truth in 70 % of cases, three in 81 %."""
    values = apparent(0.2, 0.6) + 0.02 * rng.normal(size=(4, count))

    def found(some):
        return reduce_readings(Readings(THERMAL, some, np.zeros(4), CAMERA), draws=1000)

    each = [found(values[:, [one]]).emissivity.value for one in range(count)]
    both = found(values).emissivity, found(values).monte_carlo["emissivity"]
    half = stats.t.ppf(0.975, count - 1) * np.std(each, ddof=1) / np.sqrt(count)
    for one, rel in zip(both, (1e-9, 0.15), strict=True):  # the latter of a thousand draws
        assert 0.5 * np.ptp(one.interval) == pytest.approx(half, rel=rel)
    # what a flyer file gets has the same interval
    assert both[0].uncertainty == pytest.approx(half / 1.959964, rel=1e-6)


def test_instruments_have_an_accuracy():
    """Limits of 2 K or 2 % for a camera, of 2 % for a light meter, evenly distributed."""
    silent = {name: Measured(one.value) for name, one in TEMPERATURES.items()}
    readings = given_readings(silent, THERMAL)
    np.testing.assert_allclose(readings.uncertainties, np.array([3.0, 2.0, 2.6, 2.0]) / np.sqrt(3))
    stated = silent | {"lower_temperature": Measured(323.15, 0.0)}
    found = given_readings(stated, THERMAL, accuracy=0.5).uncertainties
    np.testing.assert_array_equal(found, [0.5, 0.0, 0.5, 0.5])
    values = np.array([1000.0, 200.0, 100.0, 0.0])
    np.testing.assert_allclose(standard_uncertainties(LIGHT, values), 0.02 / np.sqrt(3) * values)
    np.testing.assert_allclose(standard_uncertainties(LIGHT, values, 0.01), 0.01 * values)
    with pytest.raises(lf.ParameterError, match="accuracy = -1"):
        standard_uncertainties(THERMAL, values, -1.0)


def test_a_light_meters_linearity_does_not_average_out():
    light = np.array([1800.0, 270.0, 180.0, 0.0])
    one = light[:, None] * np.ones(200)
    spread = standard_uncertainties(LIGHT, light)
    found = reduce_readings(Readings(LIGHT, one, spread)).emissivity
    relative = 0.02 / np.sqrt(3.0)
    # d(1 - r - t): 0.25 of the incident's error, 0.15 and 0.10 of the others'
    assert found.uncertainty == pytest.approx(relative * np.sqrt(0.25**2 + 0.15**2 + 0.1**2))
    louder = reduce_readings(Readings(LIGHT, 3.0 * one, 3.0 * spread)).emissivity
    assert louder.value == pytest.approx(found.value)
    assert louder.uncertainty == pytest.approx(found.uncertainty)


def test_light_meter_by_the_same_code(write):
    path = write("incident,reflected,transmitted,dark\n1010,160,110,10\n", "meter.csv")
    readings, _ = read_readings(path, LIGHT)
    found = reduce_readings(readings).summary()
    assert found["warnings"] == [
        "no accuracy of the light meter is stated; limits of 2 % of the reading are assumed"
    ]
    assert not reduce_readings(read_readings(path, LIGHT, accuracy=0.01)[0]).warnings
    assert found["standard_uncertainties"]["incident"]["value"] == pytest.approx(11.66, rel=1e-3)
    assert found["reflectance"]["value"] == pytest.approx(0.15)
    assert found["transmittance"]["value"] == pytest.approx(0.10)
    assert found["absorptivity"]["value"] == pytest.approx(0.75)


def given(lower, upper, **options):
    """Readings before a hotplate of 150 °C, ambient 22 °C."""
    names = dict(zip(THERMAL.readings, (HOT, lower, upper, COLD), strict=True))
    measured = {name: Measured(one) for name, one in names.items()}
    return given_readings(measured, THERMAL, scene=CAMERA, **options)


def test_impossible_properties_are_an_error_or_cut_and_named():
    with pytest.raises(lf.ConfigurationError, match=r"emissivity -0\.1\d* \(.*is impossible"):
        reduce_readings(given(335.0, 415.0, accuracy=0.5))
    near = reduce_readings(given(*apparent(0.2, 0.81)[1:3, 0]))
    assert near.emissivity.value == 0.0
    assert near.emissivity.interval[0] == near.monte_carlo["emissivity"].interval[0] == 0.0
    assert 0.0 < near.emissivity.interval[1] < 0.1
    assert "emissivity -0.01 is beyond its bound" in near.warnings[0]
    close = reduce_readings(given(*apparent(0.2, 0.78)[1:3, 0]))
    assert close.emissivity.value == pytest.approx(0.02)
    assert close.emissivity.interval[0] == 0.0
    assert "is cut at its bound" in close.warnings[0]


def test_a_row_far_from_the_others_is_named(tmp_path, rng):
    values = apparent(0.12, 0.80) + 0.1 * rng.normal(size=(4, 8))
    values[1, 4] += 40.0
    names = ",".join(f"{name} [K]" for name in THERMAL.readings)
    lines = [",".join(f"{one:.3f}" for one in row) for row in values.T]
    (tmp_path / "a.csv").write_text("\n".join([names, *lines]) + "\n", encoding="utf-8")
    readings, _ = read_readings(tmp_path / "a.csv", THERMAL, scene=CAMERA)
    found = reduce_readings(readings)
    assert "a.csv:6: far from the other rows" in found.warnings[0]
    assert found.summary()["warnings"] == list(found.warnings)


@pytest.mark.parametrize(
    ("scene", "says"),
    [({"hotplate_emissivity": Measured(0.0)}, "hotplate_emissivity = 0"),
     ({"hotplate_emissivity": Measured(1.1)}, "hotplate_emissivity = 1.1"),
     ({"film_temperature": Measured(20.0)}, "film_temperature .* = 20")],
)  # fmt: skip
def test_impossible_scenes_are_refused(scene, says):
    with pytest.raises(lf.ParameterError, match=says):
        Scene(**scene)


def test_a_film_as_warm_as_the_hotplate_is_refused():
    scene = Scene(CAMERA.camera, film_temperature=Measured(415.0, 5.0))
    with pytest.raises(lf.ConfigurationError, match="too close to the hotplate"):
        reduce_readings(Readings(THERMAL, apparent(0.12, 0.8), np.zeros(4), scene))


def test_regions_of_an_image():
    image = np.full((60, 80), 295.0)
    image[10:20, 30:40] = 400.0
    regions = parse_regions("hotplate=10:20,30:40; ambient=0:5,0:80")
    found = region_temperatures(image, regions, "a.jpg")
    assert found["hotplate_temperature"].value == 400.0
    assert found["ambient_temperature"].value == 295.0
    with pytest.raises(lf.ConfigurationError, match=r"a\.jpg: region hotplate extends beyond"):
        region_temperatures(image[:15], regions, "a.jpg")
    assert any(
        "100% of its pixels are at 400 K" in said for said in region_warnings(image, regions)
    )


def test_a_region_that_is_not_uniform(rng):
    image = 295.0 + 0.1 * rng.normal(size=(60, 80))
    image[10:20, 30:40] = np.linspace(380.0, 400.0, 10)
    regions = parse_regions("hotplate=10:20,30:40; ambient=0:5,0:80")
    said = region_warnings(image, regions)
    assert len(said) == 1
    assert said[0].startswith("region hotplate is not uniform: its pixels scatter by 6.4 K")
    found = region_temperatures(image, regions, "a.jpg")
    # the film sees some part of it, not its mean
    assert found["hotplate_temperature"].uncertainty == pytest.approx(6.4, rel=0.01)


def test_units_of_a_light_meter_are_of_one_kind(write):
    path = write("incident [W],reflected [mW],transmitted [V]\n1.7,271,1\n", "meter.csv")
    with pytest.raises(lf.ConfigurationError, match="units of one kind"):
        read_readings(path, LIGHT)


@pytest.mark.parametrize(("ambient", "fits"), [(1.0, True), (3.0, False)])
def test_source_and_background_both_count_in_what_tells_them_apart(ambient, fits):
    """Five standard uncertainties of a difference: 5 √2 = 7.1 K, and 5 √10 = 15.8 K, of 10 K."""
    given = {
        "hotplate_temperature": Measured(305.0, 1.0), "lower_temperature": Measured(297.0, 0.1),
        "upper_temperature": Measured(302.0, 0.1), "ambient_temperature": Measured(295.0, ambient),
    }  # fmt: skip
    if fits:
        assert given_readings(given, THERMAL).uncertainties[3] == ambient
        return
    with pytest.raises(lf.ConfigurationError, match=r"less than 5 standard uncertainties, 15\.8 K"):
        given_readings(given, THERMAL)
