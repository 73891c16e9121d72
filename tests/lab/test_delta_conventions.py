"""Δ as instruments show it: whole, folded into 0 to 180°, or of the other sign; films by tmm."""

import numpy as np
import pytest

from lightflyer.config.update import require_no_doubt
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.lab.optics.data import read_sample
from lightflyer.lab.optics.fit import fit_optics

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


def write(folder, shown, delta="full"):
    """Write Ψ and Δ of the film at 55°; ``shown``: what the instrument makes of Δ [deg]."""
    rows = ["wavelength [nm],incidence [deg],psi [deg],delta [deg]"]
    for wavelength in WAVELENGTHS:
        index = FILM[0] + FILM[1] / (1e-3 * wavelength) ** 2
        pair = tmm.ellips(
            [1, index, BELOW], [np.inf, THICKNESS, np.inf], np.radians(55.0), 1e-9 * wavelength
        )
        psi, angle = pair["psi"], np.pi - pair["Delta"]
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
    """Eleven points: their residuals are as rough as noise, whatever the film.

    https://github.com/PyEllips/pyElli/issues/123, as a file that does not say that it is folded.
    """
    found = fit_optics(write(tmp_path, shown), starts=2)
    doubts = [one for one in found.warnings if isinstance(one, Doubt)]
    if remedy is None:
        assert not doubts
    else:
        assert f'delta = "{remedy}"' in doubts[0]
        with pytest.raises(ConfigurationError, match="--insist writes it all the same"):
            require_no_doubt(tmp_path / "flyer.toml", found.warnings, insist=False)
        found = fit_optics(write(tmp_path, shown, remedy), starts=2)
        assert not [one for one in found.warnings if isinstance(one, Doubt)]
    estimate = found.numbers["layers.0.thickness"]
    assert estimate.value == pytest.approx(THICKNESS, rel=2e-3)


def test_residuals_far_above_the_accuracy_are_in_doubt_whatever_their_number(tmp_path):
    """A film of another index, where no convention of Δ helps."""
    write(tmp_path, whole)
    text = SAMPLE.format(delta="full").replace("a = 1.47", "a = 2.4")
    (tmp_path / "sample.toml").write_text(text, encoding="utf-8")
    sample = read_sample(tmp_path / "sample.toml")
    found = fit_optics(sample, starts=2)
    doubts = [one for one in found.warnings if isinstance(one, Doubt)]
    assert doubts
    assert all("where an accuracy of" in one and "delta =" not in one for one in doubts)


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
