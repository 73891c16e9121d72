"""The two readings of the paper, to all digits at which they are known.

The values were computed independently of this package, from the paper's equations with alpha
0.8/0.9, emittance 0.08, absorptance 0.75, 1.0 g/m2, C 0.4/3 and the paper's atmosphere, gas and
gravity.
"""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.environment.atmosphere.earth import _INVERSE_TEMPERATURE
from lightflyer.force import PRINTED, REPORTED

TOLERANCE = 1e-5
HEIGHTS = np.array([68e3, 72e3, 78e3])
COLD = [224.8909, 215.3859, 201.9077]
PRESSURE = [6.40953, 3.44597, 1.29009]
PRINTED_HOT = [349.0435, 311.5654, 358.6669]
PRINTED_IRRADIANCE = [866.459, 511.581, 570.523]
REPORTED_HOT = [355.0624, 323.6874, 452.0910]
REPORTED_IRRADIANCE = [1365.098, 811.018, 1341.540]
REPORTED_HOT_IN_SUNLIGHT = [354.6482, 382.9028, 454.3642]
REPORTED_LIFT = [0.995047, 1.589948, 1.005716]


@pytest.fixture
def state():
    return lf.lu2023_earth(1360.0).state(HEIGHTS)


def test_atmosphere(state):
    np.testing.assert_allclose(state.temperature, COLD, rtol=TOLERANCE)
    np.testing.assert_allclose(state.pressure, PRESSURE, rtol=TOLERANCE)


@pytest.mark.parametrize(
    ("reading", "hot", "irradiance"),
    [
        (PRINTED, PRINTED_HOT, PRINTED_IRRADIANCE),
        (REPORTED, REPORTED_HOT, REPORTED_IRRADIANCE),
    ],
    ids=["printed", "reported"],
)
def test_irradiance_and_temperature_to_levitate(disk, state, reading, hot, irradiance):
    result = lf.levitate(disk, state, lf.Lu2023(reading=reading))
    np.testing.assert_allclose(result.temperature, hot, rtol=TOLERANCE)
    np.testing.assert_allclose(result.irradiance, irradiance, rtol=TOLERANCE)


def test_temperature_and_lift_in_sunlight(disk, state):
    model = lf.Lu2023()
    hot = lf.equilibrium(disk, state, model).temperature
    np.testing.assert_allclose(hot, REPORTED_HOT_IN_SUNLIGHT, rtol=TOLERANCE)
    ratio = lf.lift(disk, state, model) / lf.statics.weight(disk, state)
    np.testing.assert_allclose(ratio, REPORTED_LIFT, rtol=TOLERANCE)


@pytest.mark.parametrize(
    ("reading", "incidence", "edges"),
    [
        (PRINTED, 0.0, (65.457, 82.861)),
        (REPORTED, 0.0, (68.022, 78.047)),
        (REPORTED, np.pi / 4, (70.28, 76.45)),
    ],
)
def test_altitude_bands(disk, reading, incidence, edges):
    earth = lf.lu2023_earth(1360.0, incidence)
    band = lf.levitation_band(disk, earth, lf.Lu2023(reading=reading))
    assert band.lower / 1e3 == pytest.approx(edges[0], abs=0.01)
    assert band.upper / 1e3 == pytest.approx(edges[1], abs=0.01)


@pytest.mark.parametrize(
    ("diameter", "payload_mg", "relative", "altitude_km"),
    [(0.005, 0.02091, 1.065, 65.9), (0.03, 0.268, 0.379, None)],
)
def test_best_payloads(film, diameter, payload_mg, relative, altitude_km):
    disk = lf.Disk(film, 0.5 * diameter)
    best = lf.predict(disk, lf.lu2023_earth(1360.0), lf.Lu2023()).summary()["best"]
    assert best["payload_mg"] == pytest.approx(payload_mg, rel=5e-3)
    assert best["relative_payload"] == pytest.approx(relative, rel=2e-3)
    if altitude_km is not None:
        assert best["altitude_km"] == pytest.approx(altitude_km, abs=0.06)


# Eq. (21) as printed: three digits of each coefficient, h in km, highest power first
PRINTED_COEFFICIENTS = [
    -4.59e-29, 4.02e-27, 1.49e-23, -7.94e-21, 2.02e-18, -3.15e-16, 3.27e-14, -2.33e-12,
    1.15e-10, -3.86e-9, 8.53e-8, -1.15e-6, 8.15e-6, -2.28e-5, 9.91e-5, 3.47e-3,
]  # fmt: skip


def test_coefficients_of_the_atmosphere_round_to_the_printed_ones():
    rounded = [float(f"{full:.2e}") for full in reversed(_INVERSE_TEMPERATURE)]
    assert rounded == PRINTED_COEFFICIENTS
    # three digits are not enough above 20 km
    inverse = np.polyval(PRINTED_COEFFICIENTS, [25.0, 70.0])
    np.testing.assert_allclose(1.0 / inverse, [170.0, 0.5], rtol=0.1)
