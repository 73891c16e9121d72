import numpy as np
import pytest
from uncertainties import ufloat

import lightflyer as lf
from lightflyer.foundation.units import Measured
from lightflyer.lab.thermal_image import parse_regions, read_thermal_image, region_temperatures
from lightflyer.lab.thermography import (
    LIGHT,
    THERMAL,
    Readings,
    given_readings,
    read_readings,
    reduce_readings,
)

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
    found = reduce_readings(given_readings(TEMPERATURES, THERMAL)).first_order
    for one, other in zip(found.values(), expected, strict=True):
        assert one.value == pytest.approx(other.nominal_value, rel=1e-12)
        assert one.uncertainty == pytest.approx(other.std_dev, rel=1e-9)
        assert one.interval[1] - one.value == pytest.approx(1.959964 * other.std_dev, rel=1e-6)


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
    scatter = reduce_readings(Readings(THERMAL, values, np.zeros(4))).emissivity
    few = reduce_readings(Readings(THERMAL, values[:, :10], np.zeros(4))).emissivity
    assert scatter.uncertainty == pytest.approx(few.uncertainty / np.sqrt(5.0), rel=0.5)
    common = reduce_readings(Readings(THERMAL, values, np.full(4, 0.5))).emissivity
    single = reduce_readings(Readings(THERMAL, values.mean(axis=1)[:, None], np.full(4, 0.5)))
    assert common.uncertainty == pytest.approx(single.emissivity.uncertainty, rel=0.02)


def test_scatter_intervals_cover(rng):
    truth = np.array([[423.15], [323.15], [403.15], [295.15]])
    exact = reduce_readings(Readings(THERMAL, truth, np.zeros(4)), draws=1000).emissivity.value
    inside, count = 0, 200
    for _ in range(count):
        values = truth + 0.2 * rng.normal(size=(4, 6))
        low, high = reduce_readings(
            Readings(THERMAL, values, np.zeros(4)), draws=1000
        ).emissivity.interval
        inside += low <= exact <= high
    assert 0.92 <= inside / count <= 0.98


def test_light_meter_by_the_same_code(tmp_path):
    path = tmp_path / "meter.csv"
    path.write_text("incident,reflected,transmitted,dark\n1010,160,110,10\n", encoding="utf-8")
    readings, _ = read_readings(path, LIGHT)
    found = reduce_readings(readings).summary()
    assert found["reflectance"]["value"] == pytest.approx(0.15)
    assert found["transmittance"]["value"] == pytest.approx(0.10)
    assert found["absorptivity"]["value"] == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("hotplate [K],lower [K],upper [K]\n400,300,350\n", "ambient_temperature is missing"),
        ("hotplate [K],lower [K],upper [K],ambient [K]\n290,300,350,295\n", ":2: hotplate_temp"),
        ("hotplate [K],lower [K],upper [K],ambient [K]\n-4,300,350,295\n", ":2: hotplate_temp"),
        ("hotplate,lower [K],upper [K],ambient [K]\n400,300,350,295\n", ":1: column hotplate"),
        ("hotplate [K],lower [°C],upper [K],ambient [K]\n400,-300,350,295\n", "is not positive"),
    ],
)
def test_one_clear_line_for_each_mistake(tmp_path, text, says):
    path = tmp_path / "raw.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(lf.ConfigurationError) as error:
        read_readings(path, THERMAL)
    assert says in str(error.value)
    assert str(error.value).startswith(str(path))


def test_regions_of_an_image():
    image = np.full((60, 80), 295.0)
    image[10:20, 30:40] = 400.0
    regions = parse_regions("hotplate=10:20,30:40; ambient=0:5,0:80")
    found = region_temperatures(image, regions, "a.jpg")
    assert found["hotplate_temperature"].value == 400.0
    assert found["ambient_temperature"].value == 295.0
    with pytest.raises(lf.ConfigurationError, match=r"a\.jpg: region hotplate extends beyond"):
        region_temperatures(image[:15], regions, "a.jpg")
    for text in ("hotplate", "hotplate=1:1,2:3", "hotplate=1:2"):
        with pytest.raises(lf.ConfigurationError, match="--regions"):
            parse_regions(text)


@pytest.mark.parametrize("content", [b"", b"\xff\xd8\xff\xe0" + b"\x00" * 40, b"text"])
def test_a_picture_is_no_thermal_image(tmp_path, content):
    path = tmp_path / "a.jpg"
    path.write_bytes(content)
    with pytest.raises(lf.ConfigurationError, match=r"a\.jpg: is not a radiometric FLIR image"):
        read_thermal_image(path)
