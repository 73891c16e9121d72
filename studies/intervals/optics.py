"""``lab optics``: thicknesses and an index from spectra, and from Ψ and Δ, that tmm computes.

Germanium on mylar is seen in transmittance and in reflectance at 8°, with errors of scale and zero
of each spectrum drawn from their accuracies. A clear film on glass is seen by an ellipsometer, with
errors of N, C and S in common to all points. Noise is white: of Ψ and Δ, which the ordinates share,
or of each ordinate by itself.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import tmm
from trial import Trial

import lightflyer as lf
from lightflyer.film.media.dispersion import Cauchy, Formula
from lightflyer.lab.optics.data import FilmSpectrum, FreeNumber, OpticsSample
from lightflyer.lab.optics.fit import fit_optics
from lightflyer.lab.optics.model import OpticalModel
from lightflyer.lab.readers.interpretation import MeasuredSpectrum

COMMAND = "lab optics"

SCALE, ZERO, NOISE = 0.01, 0.001, 0.003
WAVELENGTH = np.linspace(0.45e-6, 1.6e-6, 116)[::-1]  # wavenumbers rise
TILT = np.radians(8.0)
GLASS, SLOPE = (1.50, 0.004e-12), 0.0035e-12  # Cauchy's numbers [1], [m²]
ANGLE, ACCURACY, DEGREE = np.radians(65.0), 0.002, np.radians(0.05)
NOISY = 0.002  # of N, C and S
VISIBLE = np.linspace(0.4e-6, 0.9e-6, 51)[::-1]


def film_of(values):
    """Germanium on mylar."""
    layers = ("Ge", values["germanium"]), ("PET", values["mylar"])
    return lf.film.Film(
        tuple(lf.film.Layer(media()[name], thickness) for name, thickness in layers)
    )


@cache
def media():
    """The package's media, whose n and k are the truth's too."""
    return {name: lf.film.material(name) for name in ("Ge", "PET")}


def clear_film_of(values):
    """A clear film on glass."""
    layer = Formula("layer", cauchy=Cauchy(values["a"], SLOPE))
    below = Formula("glass", cauchy=Cauchy(*GLASS))
    return lf.film.Film((lf.film.Layer(layer, values["thickness"]),), below=below)


def two_spectra(rng):
    """Transmittance and reflectance as they are read, and the truth."""
    truth = {"germanium": rng.uniform(15e-9, 40e-9), "mylar": rng.uniform(480e-9, 560e-9)}
    index = [np.ravel(n + 1j * k) for n, k in (media()[m].index(WAVELENGTH) for m in ("Ge", "PET"))]
    thickness = [np.inf, truth["germanium"], truth["mylar"], np.inf]
    spectra = []
    for quantity, key, tilt in (("transmittance", "T", 0.0), ("reflectance", "R", TILT)):
        share = [
            np.mean([
                tmm.coh_tmm(one, [1.0, *layers, 1.0], thickness, tilt, wavelength)[key]
                for one in "sp"
            ])
            for *layers, wavelength in zip(*index, WAVELENGTH, strict=True)
        ]  # fmt: skip
        read = np.array(share) * (1.0 + SCALE * rng.normal()) + ZERO * rng.normal()
        read += NOISE * rng.normal(size=read.size)
        measured = MeasuredSpectrum(quantity, quantity, 1.0 / WAVELENGTH, read)
        spectra.append(FilmSpectrum(measured, tilt, "none", "top", SCALE, ZERO))
    free = (
        FreeNumber("germanium", 27e-9, 5e-9, 80e-9, "m"),
        FreeNumber("mylar", 520e-9, 400e-9, 700e-9, "m"),
    )
    return OpticsSample(film_of, free, tuple(spectra)), truth


def clear_film(rng):
    """The truth of a clear film, with its Ψ and Δ [rad]."""
    truth = {"thickness": rng.uniform(80e-9, 200e-9), "a": rng.uniform(1.6, 1.75)}
    found = []
    for wavelength in VISIBLE:
        layer, glass = truth["a"] + SLOPE / wavelength**2, GLASS[0] + GLASS[1] / wavelength**2
        stack = [1.0, layer, glass], [np.inf, truth["thickness"], np.inf]
        ratio = [tmm.coh_tmm(one, *stack, ANGLE, wavelength)["r"] for one in "sp"]
        seen = -tmm.ellips(*stack, ANGLE, wavelength)["Delta"] + np.pi
        found.append((np.arctan(np.abs(ratio[1] / ratio[0])), seen))
    return truth, *np.transpose(found)


def ordinates_of(psi, delta):
    """N, C and S, shape (3, n)."""
    sine = np.sin(2.0 * psi)
    return np.stack([np.cos(2.0 * psi), sine * np.cos(delta), sine * np.sin(delta)])


def sample_of(rng, ordinates):
    """The sample as it is read, with errors in common to all points of an ordinate."""
    spectra = tuple(
        FilmSpectrum(
            MeasuredSpectrum(name, name, 1.0 / VISIBLE, value + ACCURACY * rng.normal()),
            ANGLE, "none", "top", 0.0, ACCURACY,
        )
        for name, value in zip("NCS", ordinates, strict=False)
    )  # fmt: skip
    free = FreeNumber("thickness", 140e-9, 50e-9, 260e-9, "m"), FreeNumber("a", 1.68, 1.52, 1.9)
    return OpticsSample(clear_film_of, free, spectra)


def angles(rng):
    """N, C and S with noise of Ψ and Δ, and the truth."""
    truth, *seen = clear_film(rng)
    return sample_of(rng, ordinates_of(*seen + DEGREE * rng.normal(size=(2, VISIBLE.size)))), truth


def folded_angles(rng):
    """N and C alone, of an ellipsometer that does not see the sign of Δ, and the truth."""
    sample, truth = angles(rng)
    return replace(sample, spectra=sample.spectra[:2]), truth


def compensator(rng):
    """Ψ and Δ of N, C and S that have noise each by itself, and the truth."""
    truth, *seen = clear_film(rng)
    n, c, s = ordinates_of(*seen) + NOISY * rng.normal(size=(3, VISIBLE.size))
    read = 0.5 * np.arctan2(np.hypot(c, s), n), np.arctan2(s, c)
    return sample_of(rng, ordinates_of(*read)), truth


def analyser(rng):
    """N and C that have noise each by itself, as of a rotating analyser, and the truth."""
    truth, *seen = clear_film(rng)
    read = ordinates_of(*seen)[:2] + NOISY * rng.normal(size=(2, VISIBLE.size))
    return sample_of(rng, read), truth


CONDITIONS = {
    "T and R of germanium on mylar": two_spectra,
    "Ψ and Δ of a clear film": angles,
    "Ψ and folded Δ of a clear film": folded_angles,
    "noise of N, C and S of a clear film": compensator,
    "noise of N and C of a clear film": analyser,
}


@cache
def model(name):
    """The compiled film of a condition, the same for all trials."""
    return OpticalModel(CONDITIONS[name](np.random.default_rng(0))[0])


def trials(seed):
    """Intervals of every free number under each condition."""
    found = []
    for number, (name, make) in enumerate(CONDITIONS.items()):
        sample, truth = make(np.random.default_rng([seed, number]))
        fit = fit_optics(sample, starts=6, seed=seed, model=model(name))
        found += [
            Trial(f"{free}, {name}", truth[free], *one.interval)
            for free, one in fit.numbers.items()
        ]
    return found
