import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.lab.ftir import BAND, planck_weights, reduce_ftir, uncovered_power
from lightflyer.lab.spectrum_data import MeasuredSpectrum, read_spectrum

PER_CM = 100.0
C2 = 0.01438776877  # second radiation constant [m K], CODATA 2018


def spectrum(wavenumber, value, quantity="transmittance"):
    value = np.broadcast_to(value, wavenumber.shape).astype(float)
    return MeasuredSpectrum("synthetic", quantity, wavenumber, value)


def planck_per_wavenumber(wavenumber, temperature):
    return wavenumber**3 / np.expm1(C2 * wavenumber / temperature)


GRIDS = [
    np.linspace(400.0, 4000.0, 1801) * PER_CM,
    np.sort(np.random.default_rng(5).uniform(400.0, 4000.0, 40)) * PER_CM,
    np.array([400.0, 900.0, 4000.0]) * PER_CM,
]


@pytest.mark.parametrize("wavenumber", GRIDS)
def test_a_flat_spectrum_gives_its_own_value(wavenumber):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lf.ParameterWarning)
        result = reduce_ftir([spectrum(wavenumber, 0.8371)])
    assert result.transmittance.band.value == pytest.approx(0.8371, abs=1e-12)
    for one in result.transmittance.planck.values():
        assert one.value == pytest.approx(0.8371, abs=1e-12)
    assert result.upper_bound.value == pytest.approx(0.1629, abs=1e-12)


@pytest.mark.parametrize("temperature", [200.0, 300.0, 441.0, 1000.0])
@pytest.mark.parametrize("wavenumber", GRIDS)
def test_planck_weights_against_quadrature(wavenumber, temperature):
    value = 0.5 + 0.4 * np.sin(wavenumber / 3e4)
    weights = planck_weights(wavenumber, temperature)
    top = bottom = 0.0
    chosen = wavenumber if len(wavenumber) < 100 else wavenumber[::40]
    line = np.interp(chosen, wavenumber, value)
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
    result = reduce_ftir([spectrum(wavenumber, wavenumber / 5e5)])
    assert result.transmittance.band.value == pytest.approx(900.0 * PER_CM / 5e5, rel=1e-12)


def test_noise_is_found_and_repeats_average(rng):
    wavenumber = GRIDS[0]
    clean = 0.8 + 0.05 * np.cos(wavenumber / 4e4)
    noisy = [spectrum(wavenumber, clean + 0.01 * rng.normal(size=1801)) for _ in range(6)]
    one, many = reduce_ftir(noisy[:1]), reduce_ftir(noisy)
    points = 401  # in the band
    assert one.transmittance.band.uncertainty == pytest.approx(0.01 / np.sqrt(points), rel=0.15)
    expected = reduce_ftir([spectrum(wavenumber, clean)]).transmittance.band.value
    low, high = many.transmittance.band.interval
    assert low < expected < high
    accurate = reduce_ftir(noisy[:1], accuracy=0.005).transmittance.band
    assert accurate.uncertainty == pytest.approx(
        np.hypot(0.005, one.transmittance.band.uncertainty)
    )


def test_reflectance_turns_the_bound_into_an_emissivity():
    mirror = spectrum(GRIDS[0], 0.1, "reflectance")
    result = reduce_ftir([spectrum(GRIDS[0], 0.7)], [mirror])
    assert result.emissivity.value == pytest.approx(0.2)
    assert result.upper_bound.value == pytest.approx(0.3)
    with pytest.raises(lf.ParameterError, match="shows reflectance, not transmittance"):
        reduce_ftir([mirror])


def test_what_is_not_covered_is_said():
    short = np.linspace(700.0, 4000.0, 100) * PER_CM
    with pytest.warns(lf.ParameterWarning, match="do not cover 25.0% of the band"):
        result = reduce_ftir([spectrum(short, 0.5)])
    assert result.uncovered_band == pytest.approx(0.25)
    assert result.summary()["uncovered_fraction"]["300"]["value"] > 0.3
    with pytest.raises(lf.ParameterError, match="has no data in the band from 500 to 1300"):
        reduce_ftir([spectrum(np.linspace(2000.0, 4000.0, 9) * PER_CM, 0.5)])
    assert BAND == (50000.0, 130000.0)


# The same seven ordinates in every form of JCAMP-DX, coded by hand after the rules of the standard:
# R. S. McDonald, P. A. Wilks, Appl. Spectrosc. 42, 151 (1988).
FORMS = {
    "fix": "400 1000 2000 2001 2002 2003 2003 2003",
    "packed": "400+1000+2000+2001+2002+2003+2003+2003",
    "squeezed": "400A000B000B001B002B003B003B003",
    "difference": "400A000J000JJJ%%",
    "duplicate": "400A000J000JU%T",
}
HEADER = """\
##TITLE=ordinates of the standard's example
##JCAMP-DX=4.24
##DATA TYPE=INFRARED SPECTRUM
##XUNITS=1/CM
##YUNITS={yunits}
##XFACTOR=1.0
##YFACTOR=0.0001
##FIRSTX=400
##LASTX=406
##NPOINTS=7
##XYDATA=(X++(Y..Y))
"""


def write(tmp_path, content, name="spectrum.jdx"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_every_form_of_jcamp(tmp_path, form):
    text = HEADER.format(yunits="TRANSMITTANCE") + form + "\n##END=\n"
    found = read_spectrum(write(tmp_path, text))
    np.testing.assert_allclose(found.wavenumber, np.arange(400.0, 407.0) * PER_CM)
    np.testing.assert_allclose(
        found.value, np.array([1000, 2000, 2001, 2002, 2003, 2003, 2003]) * 1e-4
    )


# As the NIST Chemistry WebBook writes its infrared spectra: absorbance, wavelength or wavenumber
# falling, comments after the label of the table.
NIST = """\
##TITLE=POLYMER
##JCAMP-DX=4.24
##DATA TYPE=INFRARED SPECTRUM
##ORIGIN=NIST style
$$ comment
##XUNITS=MICROMETERS
##YUNITS=ABSORBANCE
##XFACTOR=1.000000
##YFACTOR=0.001
##NPOINTS=3
##XYPOINTS=(XY..XY) $$ pairs
10.0, 301.0
12.5, 1000.0
20.0, 0.0
##END=
"""


def test_jcamp_of_absorbance_over_wavelength(tmp_path):
    found = read_spectrum(write(tmp_path, NIST))
    np.testing.assert_allclose(found.wavenumber, [5e4, 8e4, 1e5])
    np.testing.assert_allclose(found.value, [1.0, 0.1, 10.0**-0.301])


TABLES = {
    "per centimetre": "wavenumber [cm^-1],transmittance\n1000,0.8\n2000,0.9\n",
    "micrometres": "Wavelength (µm);Transmittance (%)\n10,0;80,0\n5,0;90,0\n",
    "spectrometer": "instrument X\ncm-1,%T\n2000,90\n1000,80\n",
    "absorbance": "wavelength [um] absorbance\n10 0.0969100130\n5 0.0457574906\n",
}


@pytest.mark.parametrize("text", TABLES.values(), ids=TABLES)
def test_tables(tmp_path, text):
    found = read_spectrum(write(tmp_path, text, "s.csv"))
    np.testing.assert_allclose(found.wavenumber, [1e5, 2e5])
    np.testing.assert_allclose(found.value, [0.8, 0.9])


def test_table_without_header(tmp_path):
    path = write(tmp_path, "1000 80\n2000 90\n", "s.txt")
    found = read_spectrum(path, columns="wavenumber [cm^-1], transmittance [%]")
    np.testing.assert_allclose(found.value, [0.8, 0.9])


GOOD = HEADER.format(yunits="TRANSMITTANCE") + FORMS["fix"] + "\n##END=\n"


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("s.jws", b"", "export JCAMP-DX"),
        ("s.jdx", b"", ":1: is not JCAMP-DX"),
        ("s.jdx", b"\x00\xff" * 50, ":1: is not JCAMP-DX"),
        ("s.jdx", GOOD.replace("##END=\n", ""), ":12: ends without ##END="),
        ("s.jdx", GOOD.replace(" 2003\n", "\n"), "is damaged"),
        ("s.jdx", GOOD.replace("NPOINTS=7", "NPOINTS=99999999999"), "is not a number of points"),
        ("s.jdx", GOOD.replace("NPOINTS=7", "NPOINTS=x"), "is not a number of points"),
        ("s.jdx", GOOD.replace("1/CM", "HERTZ"), '##XUNITS= "hertz" is not one of'),
        (
            "s.jdx",
            GOOD.replace("TRANSMITTANCE", "COUNTS"),
            '##YUNITS= "counts" is not TRANSMITTANCE',
        ),
        ("s.jdx", GOOD.replace("0.0001", "0.1"), "is it in %?"),
        ("s.jdx", HEADER.split("##XYDATA")[0] + "##END=\n", "contains no spectrum"),
        ("s.csv", "wavenumber [cm^-1],transmittance\n1000,80\n2000,90\n", ":2: transmittance = 80"),
        ("s.csv", "wavenumber [cm^-1],transmittance\n1000,0.8\n", "has 1 wavenumber"),
        ("s.csv", "wavenumber [cm^-1]\n1000\n", "needs one of the columns transmittance"),
        ("s.csv", "transmittance\n0.8\n", "needs a column wavenumber or wavelength"),
        ("s.csv", "wavenumber,transmittance\n1000,0.8\n", "wavenumber has no unit"),
    ],
)
def test_one_clear_line_for_each_mistake(tmp_path, name, content, says):
    path = write(tmp_path, content, name)
    with pytest.raises(lf.ConfigurationError) as error:
        read_spectrum(path)
    message = str(error.value)
    assert message.startswith(str(path))
    assert says in message
    assert "\n" not in message


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_no_jcamp_gives_a_traceback(tmp_path_factory, data):
    text = bytearray(GOOD if data.draw(st.booleans()) else NIST, "utf-8")
    for _ in range(data.draw(st.integers(0, 5))):
        at = data.draw(st.integers(0, len(text) - 1))
        text[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=4))
    path = tmp_path_factory.mktemp("fuzz") / "s.jdx"
    path.write_bytes(text)
    try:
        found = read_spectrum(path)
    except lf.ConfigurationError as error:
        said = str(error)
        assert said.startswith(str(path))
        assert "\n" not in said
        return
    assert np.isfinite(found.value).all()
    assert np.all(np.diff(found.wavenumber) > 0.0)
