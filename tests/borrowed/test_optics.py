"""Public reports of thin-film optics and ellipsometry: closed formulas are the right values.

Tests of `film` have the cases of https://github.com/MLResearchAtOSRAM/tmm_fast/issues/11,
https://github.com/kc-ml2/meent/pull/98, https://github.com/bahremsd/tmmax/issues/19,
https://github.com/bahremsd/tmmax/issues/45,
https://github.com/kitchenknif/PyTMM/issues/1 and https://github.com/franko/regress-pro/issues/5,
`lab/test_ellipsometry.py` that of https://github.com/edmundsj/rcwa/issues/20.
"""

from types import SimpleNamespace

import numpy as np
import pytest
import tmm

from lightflyer.core.errors import Doubt
from lightflyer.film.media.compound import bruggeman
from lightflyer.lab.optics.data import read_sample
from lightflyer.lab.optics.fit import fit_optics

ELLIPSOMETRY = '[[ellipsometry]]\nfile = "psi-delta.csv"\n{more}\n'


def film(folder, body, angles=None, more="", free="layers.0.thickness"):
    """A sample file with the film; Ψ and Δ of anything where only the film is of interest."""
    rows = angles or [(500, 60, 30, 100), (600, 60, 30, 100)]
    lines = ["wavelength [nm],incidence [deg],psi [deg],delta [deg]"]
    lines += [",".join(f"{one:.6f}" for one in row) for row in rows]
    (folder / "psi-delta.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    text = f'free = [{{number = "{free}"}}]\n{ELLIPSOMETRY.format(more=more)}[film]\n{body}\n'
    (folder / "sample.toml").write_text(text, encoding="utf-8")
    return read_sample(folder / "sample.toml")


def optics(folder, body, wavelength, incidence=0.0):
    """Reflectance and transmittance for s and p, shape (2, ...)."""
    sample = film(folder, body)
    built = sample.build({one.name: one.start for one in sample.free})
    found = built.optics(np.atleast_1d(wavelength), incidence)
    return SimpleNamespace(r=np.asarray(found.reflectance), t=np.asarray(found.transmittance))


def table(folder, name, index, ends=(0.2e-6, 200e-6)):
    rows = [f"{1e6 * one},{index.real},{index.imag}" for one in np.geomspace(*ends, 20)]
    path = folder / f"{name}.csv"
    path.write_text("wavelength [um],n,k\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return f'material = "{path}", density = "2 g/cm^3"'


@pytest.mark.parametrize(("angle", "r", "t"), [(0, 0.04299, 0.26233), (60, 0.09199, 0.17976)])
def test_a_thick_slab_absorbs(tmp_path, angle, r, t):
    """https://github.com/sbyrnes321/tmm/issues/4: 1 mm of n = 1.5 + 1e-4i, incoherent, at 1 µm."""
    slab = table(tmp_path, "slab", 1.5 + 1e-4j)
    body = (
        f'layers = [{{material = "{tmp_path}/air.csv", density = "2 g/cm^3", '
        f'thickness = "100 nm"}}]\nsubstrate = {{{slab}, thickness = "1 mm"}}'
    )
    table(tmp_path, "air", 1.0 + 0j)
    found = optics(tmp_path, body, 1e-6, np.radians(angle))
    assert found.r.mean() == pytest.approx(r, abs=2e-5)
    assert found.t.mean() == pytest.approx(t, abs=2e-5)


@pytest.mark.parametrize(
    "parts",
    [
        (1.5 + 0j, 0.13 + 4.0j),  # a metal in glass
        (1.0 + 0j, 4.3 + 0.6j),
        (0.2 + 3.4j, 1.33 + 0j),
    ],
)
@pytest.mark.parametrize("share", [0.1, 0.33, 0.5, 0.9])
def test_a_mixture_has_the_root_that_absorbs(parts, share):
    """https://github.com/PyEllips/pyElli/pull/173: of two roots the wrong one, which gives light.

    https://github.com/manoharan-lab/structural-color/pull/76: complex indices.
    """
    index = np.array(parts)
    n, k = bruggeman(index.real, index.imag, [1.0 - share, share])
    mixed, each = (n + 1j * k) ** 2, index**2
    shares = np.array([1.0 - share, share])
    away = np.sum(shares * (each - mixed) / (each + 2.0 * mixed))
    assert abs(away) < 1e-10
    assert n > 0.0
    assert k >= 0.0
    # between the parts for any shape of grains: Wiener's bounds turn round the origin
    turn = np.angle(each).min(), np.angle(each).max()
    assert turn[0] - 1e-9 <= np.angle(mixed) <= turn[1] + 1e-9


def angles_of(thickness, wavelengths, incidence):
    """Ψ and Δ [deg] of a layer on a substrate; tmm counts Δ from 180° in the other direction."""
    found = [
        tmm.ellips([1.0, 1.47, 3.9], [np.inf, thickness, np.inf], np.radians(incidence), wavelength)
        for wavelength in wavelengths
    ]
    return np.degrees([(one["psi"], np.pi - one["Delta"]) for one in found])


WAVELENGTHS = np.arange(400.0, 801.0, 20.0)  # [nm]
BODY = """\
substrate = {dispersion = {cauchy = {a = 3.9}}}
layers = [{dispersion = {cauchy = {a = 1.47}}, thickness = "90 nm"}]
"""


@pytest.mark.parametrize(
    ("least", "more"),
    [
        (0.0, ""),  # https://github.com/refnx/refellips/pull/99: 2° and 358° are 4° apart
        (-180.0, ""),  # https://github.com/PyEllips/pyElli/issues/98
        (-90.0, ""),  # https://github.com/PyEllips/pyElli/issues/198: from -90 to 270°
        (None, 'delta = "folded"'),  # https://github.com/PyEllips/pyElli/issues/123: 0 to 180°
    ],
)
def test_a_range_of_delta_does_not_matter(tmp_path, least, more):
    psi, delta = angles_of(100e-9, 1e-9 * WAVELENGTHS, 55.0).T
    shown = np.abs(delta) if least is None else (delta - least) % 360.0 + least
    rows = list(zip(WAVELENGTHS, np.full(WAVELENGTHS.size, 55.0), psi, shown, strict=True))
    found = fit_optics(film(tmp_path, BODY, rows, more), starts=1)
    assert found.numbers["layers.0.thickness"].value == pytest.approx(100e-9, rel=1e-5)
    assert not [one for one in found.warnings if isinstance(one, Doubt)]
