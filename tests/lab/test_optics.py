"""Numbers of a film from its spectra: truths the fit does not know, other codes, bad files."""

import json
from dataclasses import replace

import numpy as np
import pytest
import tmm

import lightflyer as lf
from lightflyer.config.reader import read_design, read_film_file
from lightflyer.film.media.dispersion import Cauchy, Formula
from lightflyer.film.optics.stack import thickness_uncertainty
from lightflyer.lab.optics.data import FilmSpectrum, FreeNumber, OpticsSample, read_sample
from lightflyer.lab.optics.fit import fit_optics, to_dataset
from lightflyer.lab.optics.model import FilmProblem, OpticalModel
from lightflyer.lab.optics.search import intervals, search
from lightflyer.lab.readers.interpretation import MeasuredSpectrum
from lightflyer.lab.synthetic.spectra import TRUTH, optics_files
from lightflyer.numerics.residuals import correlation_length

TRUE = np.array([TRUTH["germanium"], TRUTH["porosity"], TRUTH["mylar"]])


def written(folder, seed=0, change=("", "")):
    for name, text in optics_files(seed).items():
        (folder / name).write_text(text.replace(*change) if name.endswith("toml") else text)
    return folder / "sample.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("optics")


@pytest.fixture(scope="module")
def sample(folder):
    return read_sample(written(folder))


@pytest.fixture(scope="module")
def model(sample):
    return OpticalModel(sample)


def test_derivatives_are_those_of_differences(sample, model):
    problem = FilmProblem.of(sample, model)
    rng = np.random.default_rng(0)
    vector = np.concatenate([[0.3, 0.4, 0.45], rng.normal(size=6)])
    exact = problem.jacobian(vector)
    for number in range(vector.size):
        step = np.zeros(vector.size)
        step[number] = 1e-5
        slope = (problem.residuals(vector + step) - problem.residuals(vector - step)) / 2e-5
        np.testing.assert_allclose(slope, exact[:, number], atol=1e-6 * np.abs(exact).max())


@pytest.fixture(scope="module")
def widths(sample, model):
    """Widths of the intervals of what is free."""
    _, ends = intervals(search(FilmProblem.of(sample, model), starts=1))
    return np.diff([model.values(np.array(end)) for end in zip(*ends, strict=True)], axis=0)[0]


def test_intervals_are_no_wider_than_the_errors_need(widths):
    assert np.all(widths < 0.1 * TRUE)


def test_correlation_length_of_known_noise():
    rng = np.random.default_rng(3)
    white = rng.normal(size=20_000)
    assert correlation_length(white)[0] == pytest.approx(1.0, abs=0.15)
    smoothed = np.convolve(white, np.ones(10), mode="valid")
    assert correlation_length(smoothed)[0] == pytest.approx(10.0, rel=0.2)
    ripple = np.sin(np.linspace(0.0, 40.0, 500))
    assert correlation_length(ripple)[0] > 10.0


SILICON = 3.5
ENDLESS = lf.film.tabulated_material("Si", [1e-7, 1e-5], [SILICON, SILICON], [0.0, 0.0])


def cauchy_sample(thickness, noise=0.0, seed=0, bounds=(100e-9, 2000e-9)):
    """Reflectance of a Cauchy layer on an endless substrate, s polarised at 30°, by tmm."""
    wavelength = np.linspace(450e-9, 900e-9, 91)
    n = 1.6 + 0.01e-12 / wavelength**2
    share = np.array([
        tmm.coh_tmm("s", [1.0, index, SILICON], [np.inf, thickness, np.inf], np.deg2rad(30.0),
                    one)["R"]
        for index, one in zip(n, wavelength, strict=True)
    ])  # fmt: skip
    share = share + noise * np.random.default_rng(seed).normal(size=share.size)
    spectrum = MeasuredSpectrum("tmm", "reflectance", 1.0 / wavelength[::-1], share[::-1])

    def build(values):
        layer = Formula("layer", cauchy=Cauchy(values["a"], values["b"]))
        return lf.film.Film((lf.film.Layer(layer, values["thickness"]),), below=ENDLESS)

    free = (
        FreeNumber("thickness", 0.9 * thickness, *bounds, "m"),
        FreeNumber("a", 1.5, 1.3, 2.0),
        FreeNumber("b", 0.005e-12, 0.0, 0.05e-12, "m^2"),
    )
    measured = FilmSpectrum(spectrum, np.deg2rad(30.0), "s", "top", 0.002, 0.0005)
    return OpticsSample(build, free, (measured,))


@pytest.fixture(scope="module")
def cauchy():
    return fit_optics(cauchy_sample(400e-9, 0.001, bounds=(100e-9, 900e-9)), starts=4)


def test_layer_on_a_substrate_computed_by_tmm(cauchy):
    for name, truth in (("thickness", 400e-9), ("a", 1.6), ("b", 0.01e-12)):
        found = cauchy.numbers[name]
        low, high = found.interval
        assert low <= truth <= high
        assert found.uncertainty == pytest.approx(0.5 * (high - low) / 1.96, rel=1e-4)
    assert cauchy.numbers["thickness"].value == pytest.approx(400e-9, rel=0.01)
    assert cauchy.numbers["a"].value == pytest.approx(1.6, abs=0.02)
    assert not cauchy.predictions  # a film on a substrate is no flyer


def test_orders_of_interference_are_other_minima(cauchy):
    """Wrong fringe orders are minima too; these spectra exclude them, and the result has them."""
    assert len(cauchy.rivals) >= 1
    assert all(one.excluded for one in cauchy.rivals)
    assert not any("fits as well" in text for text in cauchy.warnings)


def test_index_of_the_layer_has_a_band_that_contains_the_truth(cauchy):
    (layer,) = cauchy.indices
    truth = 1.6 + 0.01e-12 / layer.wavelength**2
    assert np.all((layer.n_band[0] <= truth) & (truth <= layer.n_band[1]))
    assert np.all(layer.k == 0.0)


def test_numbers_that_spectra_cannot_tell_apart_are_named(folder):
    """Two transparent layers of one index: only the sum of their thicknesses counts."""
    wavelength = np.linspace(0.5e-6, 1e-6, 60)
    glass = lf.film.tabulated_material("glass", [1e-7, 1e-5], [1.5, 1.5], [0.0, 0.0])

    def build(values):
        layers = tuple(lf.film.Layer(glass, values[name]) for name in ("one", "two"))
        return lf.film.Film(layers, below=ENDLESS)

    share = build({"one": 200e-9, "two": 300e-9}).optics(wavelength).transmittance[0]
    share = share + 1e-3 * np.random.default_rng(1).normal(size=60)
    spectrum = MeasuredSpectrum("glass", "transmittance", 1.0 / wavelength[::-1], share[::-1])
    free = tuple(FreeNumber(name, 250e-9, 200e-9, 320e-9, "m") for name in ("one", "two"))
    found = fit_optics(OpticsSample(build, free, (FilmSpectrum(spectrum),)), starts=1)
    said = "\n".join(found.warnings)
    assert "hardly told apart: their errors have a correlation of -1.000" in said
    assert "one is not determined" in said or "ends at its" in said
    assert "no accuracy is stated of glass: 1 % of the scale" in said


def test_what_was_stated_counts_and_contradictions_are_said(folder, model):
    path = written(folder, 0, ('"500 nm"}', '"500 ± 1 nm"}'))
    found = fit_optics(read_sample(path), starts=1, model=model)
    said = "\n".join(found.warnings)
    assert "layers.1.thickness = 510" in said
    assert "contradicts what was stated, 500 nm ± 1 nm" in said


def test_misfit_is_said_and_widens_intervals(sample, model, widths):
    """A ripple that no film of the model has."""
    one = sample.spectra[0]
    ripple = 0.02 * np.sin(np.linspace(0.0, 9.0, one.spectrum.value.size))
    odd = replace(one, spectrum=replace(one.spectrum, value=one.spectrum.value + ripple))
    changed = replace(sample, spectra=(odd, *sample.spectra[1:]))
    found = fit_optics(changed, starts=1, model=model)
    assert any("differ from the model" in text for text in found.warnings)
    assert found.spectra[0].scatter.independent < 15
    assert np.diff(found.numbers["layers.0.porosity"].interval)[0] > 1.2 * widths[1]


@pytest.fixture(scope="module")
def command(folder):
    """What the command wrote and printed."""
    from lightflyer.cli import main

    written(folder)
    flyer = folder / "flyer.toml"
    flyer.write_text(
        '[flyer]\ndiameter = "2 cm"\n[film]\nlayers = [  # mine\n'
        '  {material = "Ge", thickness = "20 nm", porosity = 0.1, tac = 0.9},  # germanium\n'
        '  {material = "PET", thickness = "500 nm"},\n]\n',
        encoding="utf-8",
    )
    with pytest.raises(SystemExit) as ended:
        main(["lab", "optics", str(folder / "sample.toml"), "--out", str(folder / "out"),
              "--starts", "1", "--format", "svg", "--update", str(flyer)])  # fmt: skip
    assert not ended.value.code
    return folder


def test_command_writes_everything(command):
    out = command / "out"
    names = {path.name for path in out.iterdir()}
    assert {"optics.json", "optics.nc", "optics.svg", "optics-constants.svg",
            "optics-spectrum-3.csv", "optics-constants-1.csv"} <= names  # fmt: skip
    document = json.loads((out / "optics.json").read_text(encoding="utf-8"))
    for name, truth in zip(document["numbers"], TRUE, strict=True):
        low, high = document["numbers"][name]["interval_95"]
        assert low <= truth <= high
    table = lf.film.material_from_csv(out / "optics-constants-1.csv")
    porous = lf.film.porous(lf.film.material("Ge"), 0.35)
    np.testing.assert_allclose(table.index(1e-6), porous.index(1e-6), rtol=0.03)


def test_flyer_file_has_the_numbers_with_their_correlation(command):
    text = (command / "flyer.toml").read_text(encoding="utf-8")
    assert "# germanium" in text
    assert "fitted: lab optics, sample.toml" in text
    design = read_design(command / "flyer.toml")
    pair = ("film.layers.0.thickness", "film.layers.0.porosity")
    assert 0.85 < design.correlations[pair] < 0.99
    document = json.loads((command / "out" / "optics.json").read_text(encoding="utf-8"))
    fitted = document["predictions"]["absorptance, AM0"]
    section = read_film_file(command / "flyer.toml")
    spreads = [one or 0.0 for one in section.independent_spreads]
    spread = thickness_uncertainty(
        lambda one: (lf.film.absorptance(one).value, one.areal_density), section.film(), spreads,
        section.neighbours(),
    )  # fmt: skip
    # what lightflyer film makes of the file, by other differences
    assert 2 * 1.96 * spread[0] == pytest.approx(np.ptp(fitted["interval_95"]), rel=0.05)
    numbers = {name: value for name, _, value in section.numbers() if value is not None}
    names = list(document["numbers"])
    values, errors = np.array([numbers[name] for name in names], float).T
    slopes = np.array([5323.0 * (1.0 - values[1]), -5323.0 * values[0], 1390.0])
    covariance = np.array(document["correlation"]["matrix"]) * np.outer(errors, errors)
    assert spread[1] == pytest.approx(np.sqrt(slopes @ covariance @ slopes), rel=0.01)


def test_update_refuses_other_layers(command, write):
    from lightflyer.lab.optics.record import require_same_layers

    flyer = write(
        '[flyer]\ndiameter = "2 cm"\n[film]\nlayers = [{material = "PET", thickness = "1 um"}]\n'
        "tac_top = 0.9\ntac_bottom = 0.8\n",
        "flyer.toml",
    )
    with pytest.raises(lf.ConfigurationError, match=r"film\.layers\.0 is of PET, that of"):
        require_same_layers(flyer, read_sample(command / "sample.toml"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('porosity"}', 'porosty"}', r":\d+: free: layers.0.porosty is not a number that \[film\]"),
        ('lowest = "5 nm"', 'lowest = "50 nm"', "must be from lowest to highest"),
        ('lowest = "5 nm"', 'lowest = "5 kg"', "bound of layers.0.thickness: 5 kg"),
        ("8 deg", "95 deg", r"toml:17: spectra.1.incidence = .* must be between 0 and 90 deg"),
        ('collection = "sp', 'colection = "sp', 'toml:18: .* did you mean "collection"'),
        ("layers.0.porosity", "layers.0.thickness", "layers.0.thickness is named twice"),
        ("layers.0.porosity", "layers.0.tac", "is not a number that"),
        ("free = [", "fre = [", 'did you mean "free"'),
        ("[film]", "[flyer]\n[film]", "is a flyer file; a sample file has"),
        ("visible-reflectance", "visible-transmittance", r"has the same data as \S*visible-t"),
        ('incidence = "8 deg"', 'longest = "200 nm"', "no points between shortest and longest"),
        (
            "visible-reflectance.csv",
            "none.csv",
            r"toml:16: spectra.1.file = .*none.csv.*: there is no such",
        ),
    ],
)
def test_mistakes_in_sample_files_have_one_line(tmp_path, old, new, said):
    path = written(tmp_path, 0, (old, new))
    with pytest.raises(lf.ConfigurationError, match=said) as caught:
        read_sample(path)
    assert "\n" not in str(caught.value)


def test_damaged_sample_files_are_read_or_refused_in_lines(tmp_path):
    path = written(tmp_path)
    text, rng = path.read_text(encoding="utf-8"), np.random.default_rng(0)
    for _ in range(60):
        at, kind = int(rng.integers(len(text))), int(rng.integers(3))
        length = int(rng.integers(1, 12))
        cut = text[:at] + ("", "9", '"')[kind] + text[at + (0 if kind else length) :]
        path.write_text(cut, encoding="utf-8")
        try:
            found = read_sample(path)
        except lf.LightflyerError:
            continue  # in lines; anything else is a traceback
        assert all(one.lowest <= one.start <= one.highest for one in found.free)


def test_impossible_arguments_are_refused(sample):
    with pytest.raises(lf.ParameterError, match="starts = 0"):
        fit_optics(sample, starts=0)
    with pytest.raises(lf.ParameterError, match="needs free numbers"):
        fit_optics(replace(sample, free=()))
    with pytest.raises(lf.ParameterError, match="lowest must be below"):
        FreeNumber("x", 1.0, 2.0, 1.0)
    one = sample.spectra[0]
    few = replace(
        one, spectrum=replace(one.spectrum, wavenumber=one.spectrum.wavenumber[:2],
                              value=one.spectrum.value[:2])
    )  # fmt: skip
    with pytest.raises(lf.ParameterError, match="2 points are too few for 3"):
        fit_optics(replace(sample, spectra=(few,)))


def test_dataset_has_units(cauchy):
    found = to_dataset(cauchy)
    assert all("units" in found[name].attrs for name in found.variables)
    np.testing.assert_allclose(found["fitted_0"], found["measured_0"], atol=5e-3)
