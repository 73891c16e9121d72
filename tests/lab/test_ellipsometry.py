"""Ψ and Δ: the stack by tmm, in the conventions of instruments, and fits of them."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.config.update import require_no_doubt
from lightflyer.core.errors import Doubt
from lightflyer.film.optics.transfer_matrix import Structure, ellipsometric_angles
from lightflyer.lab.optics.data import FilmSpectrum, read_sample
from lightflyer.lab.optics.fit import fit_optics
from lightflyer.lab.optics.model import FilmProblem, FilmSolution, OpticalModel
from lightflyer.lab.optics.search import search
from lightflyer.numerics.residuals import correlation_length

tmm = pytest.importorskip("tmm")

A, B = 1.45, 0.0035  # of the oxide, Cauchy [1, µm²]
SILICON = 3.858 + 0.018j  # at 632.8 nm
THICKNESS, SILICA = 120e-9, (1.50, 0.004)


def angles_by_tmm(index, thickness, below, incidence, wavelength):
    """Ψ and Δ [rad]; tmm measures Δ from 180° in the other direction."""
    found = tmm.ellips([1, *index, below], [np.inf, *thickness, np.inf], incidence, wavelength)
    return found["psi"], np.pi - found["Delta"]


@pytest.mark.parametrize("incidence", [0.3, 1.1, 1.35])
def test_as_another_package_computes_them(incidence):
    index, thickness, below = [2.1 + 0.3j, 1.5 + 0.001j], [30e-9, 500e-9], 1.52 + 0.0j
    n, k = (np.array([getattr(one, part) for one in index])[:, None] for part in ("real", "imag"))
    structure = Structure(1.0, (below.real, below.imag))
    found = ellipsometric_angles(
        n, k, np.array(thickness)[:, None], np.array([500e-9]), incidence, structure
    )
    psi, delta = angles_by_tmm(index, thickness, below, incidence, 500e-9)
    own = np.cos(2 * psi), np.sin(2 * psi) * np.cos(delta), np.sin(2 * psi) * np.sin(delta)
    assert np.ravel(found) == pytest.approx(own, abs=1e-12)


def test_oxide_on_silicon_lowers_delta_from_180_degrees():
    """What every ellipsometer shows at 70°: some 2.9° for each of the first nanometres."""
    shown = []
    for thickness in (1e-12, 1e-9, 2e-9):
        n, c, s = ellipsometric_angles(
            np.array([[1.46]]), np.array([[0.0]]), np.array([[thickness]]), np.array([632.8e-9]),
            np.radians(70.0), Structure(1.0, (SILICON.real, SILICON.imag)),
        )  # fmt: skip
        shown.append((np.degrees(0.5 * np.arccos(n)), np.degrees(np.arctan2(s, c))))
    psi, delta = np.array(shown)[..., 0].T
    assert psi[0] == pytest.approx(10.4, abs=0.05)
    assert delta[0] == pytest.approx(179.2, abs=0.05)
    assert np.diff(delta) == pytest.approx([-2.9, -2.9], abs=0.1)


def whole(delta):
    return delta % 360.0


def folded(delta):
    return np.degrees(np.arccos(np.cos(np.radians(delta))))


def turned(delta):
    return -delta % 360.0


HEADER = "wavelength [nm],psi [deg],delta [deg],aoi [deg]"


def write(folder, sample, film, below, thickness, angles, wavelengths, noise=lambda: 0.0,
          shown=whole, header=HEADER):  # fmt: skip
    """A sample file, and Ψ and Δ by tmm; ``shown``: what the instrument makes of Δ [deg]."""
    lines = [header]
    for angle, wavelength in itertools.product(angles, wavelengths):
        index, base = film(1e-3 * wavelength), below(1e-3 * wavelength)
        pair = angles_by_tmm([index], [thickness], base, np.radians(angle), 1e-9 * wavelength)
        psi, delta = np.degrees(pair) + noise()
        lines.append(f"{wavelength},{psi:.5f},{shown(delta):.5f},{angle}")
    (folder / "psi-delta.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "sample.toml").write_text(sample, encoding="utf-8")


def write_sample(folder, rng, noise=0.05, header=HEADER):
    """A polymer's film on glass, with noise of Ψ and Δ [deg]."""
    write(
        folder, SAMPLE, lambda um: A + 0.25 + B / um**2, lambda um: SILICA[0] + SILICA[1] / um**2,
        THICKNESS, (60.0, 70.0), np.arange(400.0, 900.0, 10.0), lambda: noise * rng.normal(size=2),
        header=header,
    )  # fmt: skip


SAMPLE = """\
free = [
  {number = "layers.0.thickness", lowest = "50 nm", highest = "200 nm"},
  {number = "layers.0.dispersion.cauchy.a", lowest = 1.5, highest = 2.0},
]

[[ellipsometry]]
file = "psi-delta.csv"
accuracy = "0.05 %"

[film]
layers = [
  {dispersion = {cauchy = {a = 1.6, b = "0.0035 um^2"}}, thickness = "100 nm"},
]
substrate = {dispersion = {cauchy = {a = 1.5, b = "0.004 um^2"}}}
"""


def test_thickness_and_index_of_a_film(tmp_path, rng):
    write_sample(tmp_path, rng)
    sample = read_sample(tmp_path / "sample.toml")
    assert [one.label for one in sample.spectra[:2]] == [
        "N at 60°, psi-delta.csv", "C at 60°, psi-delta.csv"
    ]  # fmt: skip
    fit = fit_optics(sample, starts=4)
    thickness, index = fit.numbers.values()
    assert thickness.interval[0] < THICKNESS < thickness.interval[1]
    assert thickness.value == pytest.approx(THICKNESS, rel=3e-3)
    assert index.interval[0] < A + 0.25 < index.interval[1]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (('file = "psi-delta.csv"', 'file = "psi-delta.csv"\nincidence = "70 deg"'), "leave inc"),
        (('[[ellipsometry]]\nfile = "psi-delta.csv"\naccuracy = "0.05 %"\n', ""), "nothing meas"),
        (('"psi-delta.csv"', '"none.csv"'), "there is no such file"),
        (('accuracy = "0.05 %"', "accurcy = 1"), 'did you mean "?accuracy'),
    ],
)
def test_mistakes(tmp_path, rng, change, says):
    write_sample(tmp_path, rng)
    text = SAMPLE.replace(*change)
    assert text != SAMPLE
    (tmp_path / "sample.toml").write_text(text, encoding="utf-8")
    with pytest.raises(lf.ConfigurationError, match=says):
        read_sample(tmp_path / "sample.toml")


def test_an_incidence_must_be_known(tmp_path, rng):
    write_sample(tmp_path, rng, header="wavelength [nm],psi [deg],delta [deg],other")
    with pytest.raises(lf.ConfigurationError, match='write incidence = "70 deg"'):
        read_sample(tmp_path / "sample.toml")


@pytest.mark.parametrize("noise", [(0.05, 0.0), (0.0, 0.05), (0.05, 0.05)])
def test_errors_of_psi_and_delta_add_up_over_their_ordinates(tmp_path, rng, noise):
    """To first order: variance of the thickness by N, C and S together over that by each alone."""
    write_sample(tmp_path, rng, np.array(noise))
    path = tmp_path / "sample.toml"  # whose index is right, and no number to be fitted
    lines = SAMPLE.replace("a = 1.6,", f"a = {A + 0.25},").splitlines(keepends=True)
    path.write_text("".join(lines[:2] + lines[3:]).replace("0.05 %", "0.0001 %"), encoding="utf-8")
    fit = search(FilmProblem.of(read_sample(path)), starts=1)
    problem, best = fit.problem, fit.best
    jacobian = problem.jacobian(best.vector)
    moves = np.linalg.solve(jacobian.T @ jacobian, jacobian.T)[0, :300].reshape(2, 3, 50)
    found = problem.common_errors(best).reshape(2, 3)
    spread = np.reshape(problem.spread, (2, 3, 1))
    readings = np.reshape([one.spectrum.value for one in problem.spectra], (2, 3, 50))
    for angle, (n, c, s) in enumerate(readings):
        sine = np.hypot(c, s)  # of 2 Ψ
        by_psi, by_delta = (-2.0 * sine, 2.0 * n * c / sine, 2.0 * n * s / sine), (0.0 * n, -s, c)
        slopes = np.multiply(noise, np.transpose([by_psi, by_delta]))  # (points, ordinates, errors)
        moved = (moves[angle] / spread[angle]).T[..., None] * slopes
        expected = max(1.0, np.sum(np.sum(moved, axis=1) ** 2) / np.sum(moved**2))
        assert found[angle] == pytest.approx(expected, rel=0.15)
    residuals = [
        one.spectrum.value - reading
        for one, reading in zip(problem.spectra, problem.readings(best), strict=True)
    ]
    alike = found.ravel() * [correlation_length(one)[0] for one in residuals]
    counted = [one.independent for one in fit.scatter]
    np.testing.assert_allclose(counted, np.maximum(50.0 / alike, 2.0), rtol=0.01)


def test_the_order_of_spectra_does_not_matter_to_errors_in_common(tmp_path, rng):
    write_sample(tmp_path, rng)
    sample = read_sample(tmp_path / "sample.toml")
    turned = replace(sample, spectra=sample.spectra[::-1])
    position = np.full(len(sample.free), 0.4)
    found = [
        FilmProblem.of(one).common_errors(
            FilmSolution(position, np.zeros((len(one.spectra), 2)), 0)
        )
        for one in (sample, turned)
    ]
    assert np.max(found[0]) > 1.0
    np.testing.assert_allclose(found[0], found[1][::-1], rtol=1e-9)


def test_polarisations_of_reflected_light(tmp_path, rng):
    """By tmm; unpolarised light is half s and half p."""
    write_sample(tmp_path, rng)
    sample = read_sample(tmp_path / "sample.toml")
    measured = replace(sample.spectra[0].spectrum, quantity="reflectance")
    spectra = tuple(FilmSpectrum(measured, 1.0, kind) for kind in ("s", "p", "none"))
    model = OpticalModel(replace(sample, spectra=spectra))
    shares, _ = model.shares(model.positions(np.array([THICKNESS, A + 0.25])))
    wavelength = 1e6 * measured.wavelength[7]
    index = [1, A + 0.25 + B / wavelength**2, SILICA[0] + SILICA[1] / wavelength**2]
    s, p = (
        tmm.coh_tmm(kind, index, [np.inf, THICKNESS, np.inf], 1.0, 1e-6 * wavelength)["R"]
        for kind in "sp"
    )
    assert shares.reshape(3, -1)[:, 7].tolist() == pytest.approx([s, p, 0.5 * (s + p)], rel=1e-9)


OXIDE = """\
free = [ {{number = "layers.0.thickness", lowest = "20 nm", highest = "200 nm"}} ]

[[ellipsometry]]
file = "psi-delta.csv"
delta = "{delta}"

[film]
substrate = {{dispersion = {{cauchy = {{a = 3.9}}}}}}
layers = [ {{dispersion = {{cauchy = {{a = 1.47, b = "0.00495 um^2"}}}}, thickness = "90 nm"}} ]
"""


def oxide(folder, shown, delta="full"):
    """An oxide's film at 55°, on what silicon is in red light."""
    write(
        folder, OXIDE.format(delta=delta), lambda um: 1.47 + 0.00495 / um**2, lambda _: 3.9, 100e-9,
        (55.0,), np.arange(300.0, 801.0, 50.0), shown=shown,
    )  # fmt: skip
    return read_sample(folder / "sample.toml")


@pytest.mark.parametrize(
    ("shown", "remedy"), [(whole, None), (folded, "folded"), (turned, "reversed")]
)
def test_a_convention_of_delta_is_told_and_its_remedy_helps(tmp_path, shown, remedy):
    """Eleven points: their residuals are as rough as noise, whatever the film.

    https://github.com/PyEllips/pyElli/issues/123, as a file that does not say that it is folded.
    """
    found = fit_optics(oxide(tmp_path, shown), starts=2)
    doubts = [one for one in found.warnings if isinstance(one, Doubt)]
    if remedy is None:
        assert not doubts
    else:
        assert f'delta = "{remedy}"' in doubts[0]
        with pytest.raises(lf.ConfigurationError, match="--insist writes it all the same"):
            require_no_doubt(tmp_path / "flyer.toml", found.warnings, insist=False)
        found = fit_optics(oxide(tmp_path, shown, remedy), starts=2)
        assert not [one for one in found.warnings if isinstance(one, Doubt)]
    estimate = found.numbers["layers.0.thickness"]
    assert estimate.value == pytest.approx(100e-9, rel=2e-3)


def test_residuals_far_above_the_accuracy_are_in_doubt_whatever_their_number(tmp_path):
    """A film of another index, where no convention of Δ helps."""
    oxide(tmp_path, whole)
    text = OXIDE.format(delta="full").replace("a = 1.47", "a = 2.4")
    (tmp_path / "sample.toml").write_text(text, encoding="utf-8")
    sample = read_sample(tmp_path / "sample.toml")
    found = fit_optics(sample, starts=2)
    doubts = [one for one in found.warnings if isinstance(one, Doubt)]
    assert doubts
    assert all("where an accuracy of" in one and "delta =" not in one for one in doubts)


def test_angles_without_units_are_degrees_unless_they_look_like_radians(tmp_path):
    oxide(tmp_path, whole)
    path, numbers = tmp_path / "psi-delta.csv", read_sample(tmp_path / "sample.toml").spectra
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(" [deg]", ""), encoding="utf-8")
    for one, other in zip(read_sample(tmp_path / "sample.toml").spectra, numbers, strict=True):
        assert one.spectrum.value == pytest.approx(other.spectrum.value)
    rows = [line.split(",") for line in text.splitlines()[1:]]
    lines = [
        f"{a},{np.radians(float(b)):.6f},{np.radians(float(c)):.6f},{d}" for a, b, c, d in rows
    ]
    path.write_text("\n".join(["nm,Psi,Delta,aoi", *lines]) + "\n", encoding="utf-8")
    with pytest.raises(lf.ConfigurationError, match="looks like radians"):
        read_sample(tmp_path / "sample.toml")
