"""How published flyers hold their shape, and up to which size each kind does.

Writes ``flyers.json`` and docs/images/structure.png; two minutes.
"""

import dataclasses
import json
import math
from functools import partial
from pathlib import Path

import jax.numpy as jnp
import numpy as np
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.film.media.mechanics import NUMBERS, mechanics_of
from lightflyer.flyer.shape import Core, core_of_posts, shape_of_film, shape_of_sandwich
from lightflyer.structure import (
    Lamina,
    Laminate,
    Ligaments,
    free_plate_frequency,
    laminate_stiffness,
    ligament_shear_stiffness,
    perforated_share,
    sandwich_stiffness,
)

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"
ROOM, GRAVITY = 293.15, 9.8
SAMPLES, SEED = 400, 0
DENSITY = {"Al2O3": 3000.0, "PET": 1390.0, "Ge": 5323.0, "Cr": 7150.0}
WARMER = 10.0  # [K] of the lower film of a sandwich, about that of levitation
FLAT = 0.2  # height of the edge over the radius up to which 4 % to 8 % of the lift are lost
DIAMETERS = np.geomspace(1e-3, 1.0, 61)
BULK, ALUMINA_POISSON = 1.4e11, 0.24

FILMS = {  # layers, top to bottom, by name and thickness [m]
    "mylar": (("PET", 5e-7),),
    "germanium disk": (("Al2O3", 5e-8), ("Ge", 2e-8), ("PET", 5e-7), ("Ge", 2e-8)),
    "face": (("Al2O3", 1e-7),),
    "absorbing face": (("Al2O3", 1e-7), ("Cr", 1e-8)),
    "thin face": (("Al2O3", 5e-8),),
}


def draw(samples):
    """Mechanical numbers of each material, one error for all its layers; shape (samples, 1)."""
    generator, found = np.random.default_rng(SEED), {}
    for name in DENSITY:
        for number, value in mechanics_of(name).items():
            error = generator.standard_normal((samples, 1)) if samples else 0.0
            least = -np.inf if number in ("stress", "expansion") else 0.1 * value.value
            found[name, number] = np.maximum(value.value + value.uncertainty * error, least)
    return found


def laminate(name, numbers):
    """A film as a structure."""
    return Laminate([
        Lamina(thickness, **{key: numbers[material, key] for key in NUMBERS
                             if (material, key) in numbers})
        for material, thickness in FILMS[name]
    ])  # fmt: skip


def areal_density(name):
    """Of a film [kg/m²]."""
    return sum(DENSITY[material] * thickness for material, thickness in FILMS[name])


def film_kind(name, payload):
    """Areal density and shape of a disk; ``payload``: over the disk's own mass."""
    density = areal_density(name)

    def shape(numbers, radius):
        load = payload * math.pi * radius**2 * density * GRAVITY
        return shape_of_film(laminate(name, numbers), radius, ROOM, load)

    return density, shape


def double_kind(names, posts, gap, open_fraction, core_density, walls, payload):
    """Areal density and shape of a sandwich or plate; ``payload``: over its own mass."""
    density = (1.0 - open_fraction) * sum(map(areal_density, names)) + core_density

    def shape(numbers, radius):
        films = [laminate(name, numbers) for name in names]
        core = walls
        if walls is None:
            core = core_of_posts(
                dataclasses.replace(posts, modulus=numbers["Al2O3", "modulus"]), films, gap,
                open_fraction,
            )  # fmt: skip
        area = math.pi * radius**2
        load = payload * area * density * GRAVITY
        pressure = (1.0 + payload) * density * GRAVITY
        heats = ROOM, ROOM + WARMER
        return shape_of_sandwich(films, heats, core, gap, open_fraction, radius, load, pressure)

    return density, shape


POSTS = Ligaments(1e-4, 1e-5, 1e-7)  # the template's guess
GAP, OPEN = 1.25e-4, 0.5
# the nanocardboard of Cortes et al. (2020): rectangles of 50 µm by 500 µm, 50 µm apart, 50 µm high
WALL_SHARE, PLATE_HEIGHT, PLATE_OPEN = 2 * 5.5e-4 * 5e-8 / (1e-4 * 5.5e-4), 5e-5, 0.4545
SHEAR = 0.5 * WALL_SHARE * BULK / (2 * (1 + ALUMINA_POISSON)) * PLATE_HEIGHT
KINDS_AT = {
    "mylar, 0.5 µm": partial(film_kind, "mylar"),
    "germanium disk, empty": partial(film_kind, "germanium disk"),
    "sandwich on posts": partial(
        double_kind, ("face", "absorbing face"), POSTS, GAP, OPEN,
        3000.0 * float(POSTS.fraction) * GAP, None,
    ),
    "nanocardboard": partial(
        double_kind, ("thin face", "thin face"), None, PLATE_HEIGHT, PLATE_OPEN,
        3000.0 * WALL_SHARE * PLATE_HEIGHT, Core(SHEAR, 2.5e-5, 5.5e-4),
    ),
}  # fmt: skip
"""Each kind by its payload over its own mass."""

KINDS = {kind: make(0.0 if "empty" in kind else 1.0) for kind, make in KINDS_AT.items()}
BUILT = {"mylar, 0.5 µm": 0.04, "germanium disk, empty": 0.02, "sandwich on posts": 0.01,
         "nanocardboard": 0.008}  # fmt: skip
"""Diameters of flyers [m] of Lu et al. (2023), Schafer et al. (2025) and Cortes et al. (2020)."""


def rises(kind, numbers, diameter):
    """Height of the edge over the radius."""
    radius = jnp.asarray(0.5 * diameter)
    return np.asarray(KINDS[kind][1](numbers, radius).deflection / radius)


def largest(kind, numbers):
    """Diameter up to which a kind stays flat [m], an end of those drawn where it is beyond."""
    ends = np.log(DIAMETERS[[0, -1]])

    def beyond(size):
        return float(np.ravel(rises(kind, numbers, np.exp(size)))[0]) - FLAT

    if beyond(ends[0]) > 0.0:
        return DIAMETERS[0]
    if beyond(ends[1]) < 0.0:
        return DIAMETERS[-1]
    return math.exp(brentq(beyond, *ends))


def borne(kind):
    """Acceleration over g at which a layer breaks, held in the middle; linear theory."""
    radius, many = jnp.asarray(0.5 * BUILT[kind]), 1e8  # loads beside which its own stress is none
    shape = KINDS_AT[kind](many)[1](draw(0), radius)
    return many / float(shape.stress_over_strength)


def frequency(kind):
    """Lowest frequency of the published size [Hz], free."""
    radius, numbers = 0.5 * BUILT[kind], draw(0)
    density = KINDS[kind][0]
    if kind in ("sandwich on posts", "nanocardboard"):
        names, gap, share = (
            (("face", "absorbing face"), GAP, perforated_share(OPEN))
            if kind == "sandwich on posts"
            else (("thin face", "thin face"), PLATE_HEIGHT, perforated_share(PLATE_OPEN))
        )
        top, bottom = (laminate_stiffness(laminate(name, numbers)) for name in names)
        whole = sandwich_stiffness(top, bottom, gap)
        stiffness, poisson = share * whole.plate, whole.poisson
    else:
        name = "mylar" if "mylar" in kind else "germanium disk"
        film = laminate_stiffness(laminate(name, numbers))
        stiffness, poisson = film.plate, film.poisson
    return float(free_plate_frequency(radius, density, stiffness, poisson))


def enhancements():
    """Bending stiffness over that of a solid plate of the same mass, of published panels."""
    found, numbers = {}, draw(0)
    for name, film, height, share, density in (
        ("Lin et al. (2018), 50 nm, 50 µm", "thin face", PLATE_HEIGHT,
         perforated_share(PLATE_OPEN), KINDS["nanocardboard"][0]),
        ("sandwich of the template", "face", GAP, perforated_share(OPEN),
         KINDS["sandwich on posts"][0]),
    ):  # fmt: skip
        one = laminate_stiffness(laminate(film, numbers))
        plate = float(share * sandwich_stiffness(one, one, height).plate)
        solid = BULK * (density / 3000.0) ** 3 / 12 / (1 - ALUMINA_POISSON**2)
        found[name] = {"stiffness [N m]": plate, "over a solid plate": plate / solid}
    return found


def main():
    """Compute everything and draw."""
    with lf.float64():
        nominal, drawn = draw(0), draw(SAMPLES)
        figure = plot.new_figure(width=6.6)
        (ax,) = figure.axes
        found = {}
        for number, kind in enumerate(KINDS):
            style = plot.series_style(number)
            band = np.percentile(rises(kind, drawn, DIAMETERS), (2.5, 97.5), axis=0)
            middle = rises(kind, nominal, DIAMETERS)
            ax.fill_between(1e2 * DIAMETERS, *band, color=style["color"], alpha=0.2, lw=0)
            ax.plot(1e2 * DIAMETERS, middle, color=style["color"], label=kind)
            built = BUILT[kind]
            there = np.ravel(rises(kind, nominal, built))[0]
            ax.plot(1e2 * built, there, **style, ms=8)
            shape = KINDS[kind][1](nominal, jnp.asarray(0.5 * built))
            limits = [
                largest(
                    kind,
                    {
                        key: value if np.ndim(value) == 0 else value[row, 0]
                        for key, value in drawn.items()
                    },
                )
                for row in range(SAMPLES)
            ]
            found[kind] = {
                "areal density [g/m²]": 1e3 * KINDS[kind][0],
                "built [cm]": 1e2 * built,
                "curvature [1/m]": float(shape.curvature),
                "edge over radius": float(there),
                "stress over strength": float(shape.stress_over_strength),
                "bears, held in the middle [g]": borne(kind),
                "gap closed": float(shape.gap_closed),
                "lowest frequency [Hz]": frequency(kind),
                "flat up to [cm]": 1e2 * largest(kind, nominal),
                "95 % band [cm]": [1e2 * float(end) for end in
                                   np.percentile(limits, (2.5, 97.5))],
            }  # fmt: skip
        posts = found["sandwich on posts"]
        faces = [laminate_stiffness(laminate(name, nominal)) for name in ("face", "face")]
        share = perforated_share(OPEN)
        soft = [type(face)(*(share * part for part in face[:-1]), face.neutral) for face in faces]
        posts["shear stiffness [N/m]"] = float(ligament_shear_stiffness(POSTS, GAP, *soft))
        found["nanocardboard"]["shear stiffness [N/m]"] = SHEAR
        found["stiffness"] = enhancements()
    ax.axhline(FLAT, color="black", lw=1, ls="--", label="5 % of the lift lost")
    ax.set(xscale="log", yscale="log", xlabel="diameter [cm]", ylim=(1e-4, 2.0),
           xlim=1e2 * DIAMETERS[[0, -1]], ylabel="height of the edge over the radius")  # fmt: skip
    plot.plain_decades(ax.xaxis)
    plot.plain_decades(ax.yaxis)
    plot.legend_below(ax)
    plot.save(figure, [IMAGES / "structure.png"])
    (HERE / "flyers.json").write_text(
        json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8"
    )


if __name__ == "__main__":
    main()
