"""``sensitivity``: Sobol indices of the mass of a disk, a product whose variances are known."""

import numpy as np
from trial import Trial

import lightflyer as lf

COMMAND = "sensitivity"

DIAMETER, DENSITY = (0.02, 0.001), (1e-3, 1e-4)  # mean and standard deviation [m], [kg/m²]
FILM = {
    "areal_density": f"{DENSITY[0]} ± {DENSITY[1]} kg/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}
CONDITIONS = {"256 points": 256, "1024 points": 1024}


def truth():
    """First and total index of diameter and areal density.

    The mass is the product of independent factors, the square of a normal number and a normal one;
    moments of the normal distribution give the variances.
    """
    mean, spread = DIAMETER
    square = mean**2 + spread**2
    of_square = 4.0 * mean**2 * spread**2 + 2.0 * spread**4
    density, of_density = DENSITY[0], DENSITY[1] ** 2
    alone = {
        "flyer.diameter": of_square * density**2,
        "film.areal_density": of_density * square**2,
    }
    both = of_square * of_density
    whole = sum(alone.values()) + both
    return {name: (part / whole, (part + both) / whole) for name, part in alone.items()}


def trials(seed):
    """Indices with their intervals from samples of their own, by the number of samples."""
    file = lf.FlyerFile(
        flyer={"diameter": f"{DIAMETER[0]} ± {DIAMETER[1]} m"},
        film=FILM,
        force={"model": "lu2023", "force_error": 0},
    )
    found = []
    for words, points in CONDITIONS.items():
        (indices,) = lf.sensitivity(file, outputs="own_mass", points=points, seed=seed)
        for row, (name,) in enumerate(indices.groups):
            for kind, true in zip(("first", "total"), truth()[name], strict=True):
                value = getattr(indices, kind)[row]
                half = getattr(indices, f"{kind}_interval")[row]
                label = f"{kind} index of {name}, {words}"
                found.append(Trial(label, true, value - half, value + half))
    return found


if not np.isclose(sum(first for first, _ in truth().values()), 1.0, atol=0.02):
    raise AssertionError("nearly all variance is that of the factors alone")
