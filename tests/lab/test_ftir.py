from dataclasses import replace

import numpy as np
import pytest
from scipy.fft import dct
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.core.errors import Doubt
from lightflyer.lab.ftir.means import planck_weights, uncovered_power
from lightflyer.lab.ftir.reduction import BAND, DEFAULT_ACCURACY, reduce_ftir, to_dataset
from lightflyer.lab.readers.spectrum_data import MeasuredSpectrum

PER_CM = 100.0
C2 = 0.01438776877  # second radiation constant [m K], CODATA 2018


def spectrum(wavenumber, value, quantity="transmittance"):
    value = np.broadcast_to(value, wavenumber.shape).astype(float)
    return MeasuredSpectrum("synthetic", quantity, wavenumber, value)


@pytest.mark.parametrize(("filling", "window"), [(4, (1.0,)), (2, (0.54, 0.46))])
def test_the_noise_of_a_mean_includes_its_correlation(filling, window):
    """Noise made in the interferogram, boxcar or Happ-Genzel; how band means scatter by it."""
    points, top, count = 3950, 7899.0, 40
    path = np.arange(points) / points
    shape = sum(part * np.cos(j * np.pi * path) for j, part in enumerate(window))
    wavenumber = np.linspace(0.0, top, points * filling + 1)
    kept = (wavenumber > 400.0) & (wavenumber < 4000.0)
    means, spreads = [], []
    for seed in range(count):
        signal = np.zeros(points * filling + 1)
        signal[:points] = shape * np.random.default_rng(seed).normal(size=points)
        noise = 0.002 * dct(signal, type=1)[kept] / np.sqrt(2.0 * points)
        mean = reduce_ftir([spectrum(wavenumber[kept] * PER_CM, 0.8 + noise)], accuracy=0.0)
        means.append(mean.transmittance.band.value)
        spreads.append(mean.transmittance.band.uncertainty)
    error = 3.0 / np.sqrt(2.0 * count)  # three standard ones of a standard deviation
    assert np.mean(spreads) == pytest.approx(np.std(means), rel=error)


def planck_per_wavenumber(wavenumber, temperature):
    return wavenumber**3 / np.expm1(C2 * wavenumber / temperature)


GRIDS = [
    np.linspace(400.0, 4000.0, 1801) * PER_CM,
    np.sort(np.random.default_rng(5).uniform(400.0, 4000.0, 40)) * PER_CM,
    np.array([400.0, 900.0, 4000.0]) * PER_CM,
]


@pytest.mark.parametrize("temperature", [200.0, 300.0, 441.0, 1000.0])
@pytest.mark.parametrize("wavenumber", GRIDS)
def test_planck_weights_against_quadrature(wavenumber, temperature):
    top = bottom = 0.0
    chosen = wavenumber if len(wavenumber) < 100 else wavenumber[::40]
    line = 0.5 + 0.4 * np.sin(chosen / 3e4)
    weights = planck_weights(chosen, temperature)
    for left, right, low, high in zip(chosen[:-1], chosen[1:], line[:-1], line[1:], strict=True):
        slope = (high - low) / (right - left)
        top += quad(
            lambda nu, a=low, b=slope, x=left: (a + b * (nu - x))
            * planck_per_wavenumber(nu, temperature), left, right, epsabs=0, epsrel=1e-12,
        )[0]  # fmt: skip
        bottom += quad(planck_per_wavenumber, left, right, (temperature,),
                       epsabs=0, epsrel=1e-12)[0]  # fmt: skip
    assert weights @ line == pytest.approx(top / bottom, rel=1e-8)
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)


def test_uncovered_power_against_quadrature():
    low, high, temperature = 400.0 * PER_CM, 4000.0 * PER_CM, 300.0
    inside = quad(planck_per_wavenumber, low, high, (temperature,), epsrel=1e-12)[0]
    whole = np.pi**4 / 15.0 * (temperature / C2) ** 4
    assert uncovered_power((low, high), temperature) == pytest.approx(1 - inside / whole, rel=1e-8)


def test_band_mean_of_a_ramp_is_its_middle():
    wavenumber = np.linspace(400.0, 4000.0, 333) * PER_CM  # no point on the band's ends
    result = reduce_ftir([spectrum(wavenumber, wavenumber / 5e5)], temperatures=[300.0])
    assert result.transmittance.band.value == pytest.approx(900.0 * PER_CM / 5e5, rel=1e-12)


def test_noise_is_found_and_repeats_average(rng):
    wavenumber = GRIDS[0]
    clean = 0.8 + 0.05 * np.cos(wavenumber / 4e4)
    noisy = [spectrum(wavenumber, clean + 0.01 * rng.normal(size=1801)) for _ in range(6)]
    one, many = (reduce_ftir(noisy[:count], accuracy=0.0) for count in (1, 6))
    points = 401  # in the band
    assert one.transmittance.band.uncertainty == pytest.approx(0.01 / np.sqrt(points), rel=0.3)
    expected = reduce_ftir([spectrum(wavenumber, clean)]).transmittance.band.value
    low, high = many.transmittance.band.interval
    assert low < expected < high
    accurate = reduce_ftir(noisy[:1], accuracy=0.005).transmittance.band
    assert accurate.uncertainty == pytest.approx(
        np.hypot(0.005, one.transmittance.band.uncertainty)
    )


def test_few_repeats_have_students_factor():
    """Two means that differ by d have an interval of d/2 times 12.7 to each side."""
    pair = [spectrum(GRIDS[0], value) for value in (0.50, 0.52)]
    band = reduce_ftir(pair, accuracy=0.0).transmittance.band
    assert band.interval == pytest.approx((0.51 - 0.1271, 0.51 + 0.1271), abs=1e-4)
    # what a flyer file gets has the same interval
    assert band.uncertainty == pytest.approx(0.1271 / 1.96, rel=1e-3)


def test_an_instrument_has_an_accuracy():
    result = reduce_ftir([spectrum(GRIDS[0], 0.8)])
    assert result.accuracy == DEFAULT_ACCURACY == 0.01
    assert result.transmittance.band.uncertainty == pytest.approx(0.01)
    assert "± 1 % of full scale is assumed" in result.warnings[-1]
    stated = reduce_ftir([spectrum(GRIDS[0], 0.8)], accuracy=0.003)
    assert stated.transmittance.band.uncertainty == pytest.approx(0.003)
    assert not any("assumed" in text for text in stated.warnings)
    none = reduce_ftir([spectrum(GRIDS[0], 0.8)], accuracy=0.0)
    assert "leave out the spectrometer's accuracy" in none.warnings[-1]


def test_the_bound_is_a_bound():
    result = reduce_ftir([spectrum(GRIDS[0], 0.8)], accuracy=0.01)
    assert result.emissivity is None
    assert result.at_most == pytest.approx(0.2 + 1.645 * 0.01, abs=1e-5)
    document = result.summary()
    assert "emissivity" not in document
    assert document["emissivity_upper_bound"]["at_most_95"] == result.at_most
    outside = result.uncovered[300.0]
    assert outside == pytest.approx(0.166, abs=1e-3)
    low, high = result.total_bounds()[300.0]
    assert low == 0.0
    assert high == pytest.approx(outside + (1.0 - outside) * result.at_most, rel=1e-9)
    mirror = spectrum(GRIDS[0], 0.1, "reflectance")
    low, high = reduce_ftir([spectrum(GRIDS[0], 0.8)], [mirror], accuracy=0.0).total_bounds()[300.0]
    assert (low, high) == pytest.approx(((1 - outside) * 0.1, outside + (1 - outside) * 0.1))


@pytest.mark.parametrize(
    ("transmittance", "reflectance", "accuracy", "says"),
    [
        (1.0099, None, 0.001, "transmittance over the band is 1.01 (1.008 to 1.012), above 1"),
        (-0.05, None, 0.01, "transmittance over the band is -0.05 (-0.0696 to -0.0304), below 0"),
        (0.5, 1.1, 0.01, "reflectance over the band is 1.1 "),
        (0.8, 0.46, 0.01, "emissivity over the band is -0.26 (-0.2877 to -0.2323), below 0"),
    ],
)
def test_impossible_shares_are_refused(transmittance, reflectance, accuracy, says):
    mirrors = [] if reflectance is None else [spectrum(GRIDS[0], reflectance, "reflectance")]
    with pytest.raises(lf.ParameterError) as error:
        reduce_ftir([spectrum(GRIDS[0], transmittance)], mirrors, accuracy=accuracy)
    assert says in str(error.value)
    assert "check" in str(error.value)


def test_shares_near_their_ends_are_cut_and_say_so():
    result = reduce_ftir([spectrum(GRIDS[0], 1.0099)], accuracy=0.01, temperatures=[300.0])
    assert (result.transmittance.band.value, result.upper_bound.value) == (1.0, 0.0)
    assert result.upper_bound.interval == pytest.approx((0.0, 0.0097), abs=1e-4)
    assert result.planck_emissivity[300.0].interval[0] == 0.0
    said = [text for text in result.warnings if "within its uncertainty of 1; 1 is given" in text]
    assert [text.split(" came")[0] for text in said] == ["transmittance over the band",
                                                         "transmittance at 300 K"]  # fmt: skip
    mirror = spectrum(GRIDS[0], 0.19, "reflectance")
    close = reduce_ftir([spectrum(GRIDS[0], 0.8)], [mirror], accuracy=0.01)
    assert close.emissivity.value == pytest.approx(0.01)
    assert close.emissivity.interval[0] == 0.0
    assert "the interval of the emissivity over the band is cut at 0" in close.warnings
    assert to_dataset(close).attrs["warnings"] == "; ".join(close.warnings)
    assert close.summary()["warnings"] == list(close.warnings)


def test_suspicious_spectra_are_named():
    def said(values, mirror=None, grid=GRIDS[0]):
        group = [] if mirror is None else [spectrum(grid, mirror, "reflectance")]
        result = reduce_ftir([spectrum(grid, values)], group, accuracy=0.005)
        return "\n".join(result.warnings)

    nu = GRIDS[0] / PER_CM
    negative = np.where(nu > 3000.0, -0.05, 0.6)
    assert "27.8 % of its points lie below 0 or above 1" in said(negative)
    too_bright = np.where(nu > 3000.0, 0.98, 0.6)
    assert "add up to more than 1 at 27.8 % of the wavenumbers (to 1.18)" in said(too_bright, 0.2)
    missing = GRIDS[0][(nu < 800.0) | (nu > 1000.0)]
    assert "has no points between 798 and 1002 cm^-1" in said(0.8, grid=missing)
    assert "has 40 points, too few" in said(0.8, grid=GRIDS[1])
    assert said(0.8).count("\n") == 0  # only what lies outside the wavenumbers


def test_reflectance_turns_the_bound_into_an_emissivity():
    mirror = spectrum(GRIDS[0], 0.1, "reflectance")
    result = reduce_ftir([spectrum(GRIDS[0], 0.7)], [mirror])
    assert result.emissivity.value == pytest.approx(0.2)
    assert result.upper_bound.value == pytest.approx(0.3)
    assert result.emissivity_spectrum()[1] == pytest.approx(0.2, abs=1e-12)
    with pytest.raises(lf.ParameterError, match="shows reflectance, not transmittance"):
        reduce_ftir([mirror])


def test_what_is_not_covered_is_said():
    short = np.linspace(700.0, 4000.0, 100) * PER_CM
    result = reduce_ftir([spectrum(short, 0.5)])
    said = "\n".join(result.warnings)
    assert "25.0 % of the band from 500 to 1300 cm^-1 has no data" in said
    assert "of a black body's power at 300 to 500 K lies outside the measured wavenumbers" in said
    assert result.uncovered_band == pytest.approx(0.25)
    assert result.summary()["uncovered_fraction"]["300"]["value"] > 0.3
    with pytest.raises(lf.ParameterError, match="has no data in the band from 500 to 1300"):
        reduce_ftir([spectrum(np.linspace(2000.0, 4000.0, 9) * PER_CM, 0.5)])
    assert BAND == (50000.0, 130000.0)


def test_half_a_band_is_not_named_as_the_whole():
    """Transmittance over all of it, reflectance from 900 cm^-1 on."""
    whole = spectrum(np.linspace(450.0, 1400.0, 400) * PER_CM, 0.8)
    half = replace(
        spectrum(np.linspace(900.0, 1400.0, 300) * PER_CM, 0.05, "reflectance"), source="r.csv"
    )
    found = reduce_ftir([whole], [half])
    assert found.covered == pytest.approx((900.0 * PER_CM, 1300.0 * PER_CM))
    (doubt,) = (one for one in found.warnings if isinstance(one, Doubt))
    assert "50.0 % of the band" in doubt
    assert "r.csv, reflectance from 900 to 1400 cm^-1" in doubt
    assert "synthetic" not in doubt
    assert "over 900 to 1300 cm⁻¹, 50 % of the band" in next(iter(found.finding()))
    assert not [one for one in reduce_ftir([whole], [replace(whole, quantity="reflectance",
                value=0.2 - 0.1 * whole.value)]).warnings if isinstance(one, Doubt)]  # fmt: skip


def test_repeats_of_another_film_and_a_hole_in_the_band_are_doubts():
    at = np.linspace(450.0, 1400.0, 400) * PER_CM
    repeats = [spectrum(at, value) for value in (0.8, 0.6)]
    assert any("repeats of transmittance" in one for one in reduce_ftir(repeats).warnings
               if isinstance(one, Doubt))  # fmt: skip
    with_hole = at[(at < 700.0 * PER_CM) | (at > 1000.0 * PER_CM)]
    assert any("has no points between" in one for one in reduce_ftir([spectrum(with_hole, 0.8)])
               .warnings if isinstance(one, Doubt))  # fmt: skip
