"""Δ as instruments show it: whole, folded into 0 to 180°, or of the other sign; films by tmm."""

from dataclasses import replace

import numpy as np
import pytest

from lightflyer.config.update import require_no_doubt
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.lab.optics.data import OpticsSample, read_sample
from lightflyer.lab.optics.fit import fit_optics
from lightflyer.lab.optics.model import OpticalModel

tmm = pytest.importorskip("tmm")

THICKNESS = 100e-9
FILM, BELOW = (1.47, 0.00495), 3.9  # Cauchy [1, µm²]; a constant index, as of silicon in red light

WAVELENGTHS = np.arange(300.0, 801.0, 50.0)  # [nm]

SAMPLE = """\
free = [ {{number = "layers.0.thickness", lowest = "20 nm", highest = "200 nm"}} ]

[[ellipsometry]]
file = "psi-delta.csv"
delta = "{delta}"

[film]
substrate = {{dispersion = {{cauchy = {{a = 3.9}}}}}}
layers = [ {{dispersion = {{cauchy = {{a = 1.47, b = "0.00495 um^2"}}}}, thickness = "90 nm"}} ]
"""


def write(folder, shown, delta="full", wavelengths=WAVELENGTHS, noise=None):
    """Write Ψ and Δ of the film at 55°; ``shown``: what the instrument makes of Δ [deg]."""
    rows = ["wavelength [nm],incidence [deg],psi [deg],delta [deg]"]
    for wavelength in wavelengths:
        index = FILM[0] + FILM[1] / (1e-3 * wavelength) ** 2
        pair = tmm.ellips(
            [1, index, BELOW], [np.inf, THICKNESS, np.inf], np.radians(55.0), 1e-9 * wavelength
        )
        psi, angle = pair["psi"], np.pi - pair["Delta"]
        if noise is not None:  # a rotating analyser measures N and C, a compensator S too
            found = np.array(
                [np.cos(2 * psi), *(np.sin(2 * psi) * np.array([np.cos(angle), np.sin(angle)]))]
            ) + 0.002 * noise.normal(size=3)
            if delta == "folded":
                found[2] = np.sqrt(max(1.0 - found[0] ** 2 - found[1] ** 2, 0.0))
            psi = 0.5 * np.arctan2(np.hypot(found[1], found[2]), found[0])
            angle = np.arctan2(found[2], found[1])
        angles = np.degrees([psi, angle])
        rows.append(f"{wavelength},55,{angles[0]:.5f},{shown(angles[1]):.5f}")
    (folder / "psi-delta.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "sample.toml").write_text(SAMPLE.format(delta=delta), encoding="utf-8")
    return read_sample(folder / "sample.toml")


def whole(delta):
    return delta % 360.0


def folded(delta):
    return np.degrees(np.arccos(np.cos(np.radians(delta))))


def turned(delta):
    return -delta % 360.0


@pytest.mark.parametrize(
    ("shown", "remedy"), [(whole, None), (folded, "folded"), (turned, "reversed")]
)
def test_a_convention_of_delta_is_told_and_its_remedy_helps(tmp_path, shown, remedy):
    """Eleven points: their residuals are as rough as noise, whatever the film."""
    found = fit_optics(write(tmp_path, shown))
    doubts = [one for one in found.warnings if isinstance(one, Doubt)]
    if remedy is None:
        assert not doubts
    else:
        assert f'delta = "{remedy}"' in doubts[0]
        with pytest.raises(ConfigurationError, match="--insist writes it all the same"):
            require_no_doubt(tmp_path / "flyer.toml", found.warnings, insist=False)
        found = fit_optics(write(tmp_path, shown, remedy))
        assert not [one for one in found.warnings if isinstance(one, Doubt)]
    estimate = found.numbers["layers.0.thickness"]
    assert estimate.value == pytest.approx(THICKNESS, rel=2e-3)


def test_residuals_far_above_the_accuracy_are_in_doubt_whatever_their_number(tmp_path):
    """A film of another index, where no convention of Δ helps."""
    sample = write(tmp_path, whole)
    text = SAMPLE.format(delta="full").replace("a = 1.47", "a = 2.4")
    (tmp_path / "sample.toml").write_text(text, encoding="utf-8")
    sample = read_sample(tmp_path / "sample.toml")
    doubts = [one for one in fit_optics(sample).warnings if isinstance(one, Doubt)]
    assert doubts
    assert all("where an accuracy of" in one and "delta =" not in one for one in doubts)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shown", "delta", "most"), [(whole, "full", 0.97), (folded, "folded", 0.995)]
)
def test_intervals_hold_the_truth(tmp_path, shown, delta, most):
    # Here the noise is of N, C and S, each by itself. The intervals of folded Δ allow for noise of
    # Ψ, which N and C share (96.5 % in studies/intervals), and so are too wide here: 99 %. Known
    # and open: the correlation should come from the residuals.
    rng = np.random.default_rng(5)
    trials, hits, model = 400, 0, None
    for _ in range(trials):
        sample: OpticsSample = write(tmp_path, shown, delta, np.arange(300.0, 801.0, 12.5), rng)
        # one instrument, whose scale and zero are right: the noise alone is at trial
        right = tuple(replace(one, zero_accuracy=0.0) for one in sample.spectra)
        sample = replace(sample, spectra=right)
        model = model or OpticalModel(sample)
        low, high = fit_optics(sample, starts=1, model=model).numbers["layers.0.thickness"].interval
        hits += low <= THICKNESS <= high
    assert 0.93 <= hits / trials <= most


def test_angles_without_units_are_degrees_unless_they_look_like_radians(tmp_path):
    write(tmp_path, whole)
    path, numbers = tmp_path / "psi-delta.csv", read_sample(tmp_path / "sample.toml").spectra
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(" [deg]", ""), encoding="utf-8")
    for one, other in zip(read_sample(tmp_path / "sample.toml").spectra, numbers, strict=True):
        assert one.spectrum.value == pytest.approx(other.spectrum.value)
    rows = [line.split(",") for line in text.splitlines()[1:]]
    lines = [
        f"{a},{b},{np.radians(float(c)):.6f},{np.radians(float(d)):.6f}" for a, b, c, d in rows
    ]
    path.write_text("\n".join(["nm,aoi,Psi,Delta", *lines]) + "\n", encoding="utf-8")
    with pytest.raises(ConfigurationError, match="looks like radians"):
        read_sample(tmp_path / "sample.toml")
