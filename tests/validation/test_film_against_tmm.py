"""The transfer matrix against the `tmm` package (S. Byrnes), an independent implementation."""

import warnings

import numpy as np
import tmm

from lightflyer.film import stack_optics

STACKS = 200
MOST_LAYERS = 8


def reference(polarisation, index, thickness, incidence, wavelength):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tmm thins what is opaque, and says so
        data = tmm.coh_tmm(
            polarisation,
            [1.0, *index, 1.0],
            [np.inf, *thickness, np.inf],
            incidence,
            wavelength,
        )
        return data["R"], data["T"], np.array(tmm.absorp_in_each_layer(data))[1:-1]


def test_two_hundred_random_stacks_from_both_sides(capsys):
    rng = np.random.default_rng(7)
    worst = 0.0
    for number in range(STACKS):
        layers = 1 + number % MOST_LAYERS
        n = rng.uniform(0.3, 5.0, layers)
        absorbing = rng.random(layers) < 0.5
        k = np.where(absorbing, 10.0 ** rng.uniform(-4.0, 1.0, layers), 0.0)
        d = 10.0 ** rng.uniform(-9.0, -5.5, layers)
        wavelength = 10.0 ** rng.uniform(-6.6, -4.6)
        incidence = np.radians(rng.uniform(0.0, 89.0))
        for side in (slice(None), slice(None, None, -1)):
            optics = stack_optics(n[side], k[side], d[side], wavelength, incidence)
            index = n[side] + 1j * k[side]
            for row, polarisation in enumerate("sp"):
                expected = reference(polarisation, index, d[side], incidence, wavelength)
                found = (
                    optics.reflectance[row],
                    optics.transmittance[row],
                    optics.layer_absorptance[:, row],
                )
                for ours, theirs in zip(found, expected, strict=True):
                    worst = max(worst, float(np.abs(ours - theirs).max()))
    assert worst < 1e-12
    capsys.readouterr()  # tmm prints
