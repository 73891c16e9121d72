"""Draw what spheres absorb, what lifts soot, and how an engineered disk rests.

    python studies/particles/figure.py

Writes docs/images/particles.png and prints the numbers of docs/particles.md.
"""

from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.film import material, mie, sphere_absorption, tabulated_material

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
DIAMETERS = np.geomspace(0.05e-6, 50e-6, 61)
SOOT_SIZES = (1e-6, 2e-6, 4e-6, 10e-6)
DISKS = ((0.05, 0.8), (0.1, 0.8), (0.1, 0.3))  # absorptance for sunlight, emittance
ALTITUDES = np.linspace(5e3, 105e3, 401)
INFRARED = 255.0  # Temperature of Earth as a black body [K]
FORCE = lf.force.KineticSphere()


def soot():
    """Soot by m = 1.95 − 0.79i at all wavelengths; compact."""
    ends = np.array([1e-7, 3e-3])
    return tabulated_material("soot", ends, np.full(2, 1.95), np.full(2, 0.79), density=1800.0)


def soot_sphere(diameter, **numbers):
    """A compact sphere of soot over Earth, held by gravity where its halves are unlike."""
    seen = sphere_absorption(soot(), 0.5 * diameter)
    return lf.Sphere(
        0.5 * diameter,
        seen.absorption_efficiency,
        seen.emittance,
        0.3,
        density=1800.0,
        asymmetry=seen.asymmetry,
        infrared_asymmetry=seen.infrared_asymmetry(INFRARED),
        **numbers,
    )


def unlike(diameter):
    """Soot whose halves have TACs of 0.85 and 0.95, its centre of mass a tenth of a radius low."""
    return soot_sphere(
        diameter, tac_top=0.85, tac_bottom=0.95, upright="gravity", mass_offset=0.05 * diameter
    )


def engineered(absorptance, emittance):
    """Disk of Keith (2010): 50 nm of 3000 kg/m³ and TACs 0.15 apart."""
    film = lf.FilmProperties(
        0.15e-3, absorptance, emittance, emittance, tac_top=0.8, tac_bottom=0.95
    )
    return lf.Disk(film, radius=5e-6)


def over_weight(flyer, altitudes, model):
    """Lift over weight, in the sun at the zenith."""
    state = lf.Earth().state(altitudes)
    return lf.lift(flyer, state, model) / (flyer.mass * state.gravity)


def crossings(altitudes, values, level=0.0):
    """Where a curve crosses a level."""
    above = values - level
    at = np.flatnonzero(above[:-1] * above[1:] < 0.0)
    share = above[at] / (above[at] - above[at + 1])
    return altitudes[at] + share * (altitudes[at + 1] - altitudes[at])


def draw_asymmetry(ax):
    """Asymmetry factor over size."""
    for medium, name, factor, colour in (
        (soot(), "soot", 1.0, palette.BLUE),
        (material("SiO2"), "glass, times 100", 100.0, palette.VERMILION),
    ):
        seen = sphere_absorption(medium, 0.5 * DIAMETERS)
        ax.semilogx(DIAMETERS * 1e6, factor * seen.asymmetry, color=colour)
        ax.text(0.06, 0.3 if factor == 1.0 else -0.12, name, color=colour)
    ax.axhline(0.0, color=palette.GREY, linewidth=0.8)
    ax.axhline(0.5, color=palette.GREY, linewidth=0.8, linestyle=":")
    ax.text(0.06, 0.51, "opaque", color=palette.GREY)
    plot.plain_decades(ax.xaxis)
    ax.set_xlabel("diameter [µm]")
    ax.set_ylabel("asymmetry factor J₁ in sunlight [1]")


def draw_soot(ax):
    """Lift of soot over altitude."""
    for diameter in SOOT_SIZES:
        lift = over_weight(unlike(diameter), ALTITUDES, FORCE)
        ax.plot(lift, ALTITUDES / 1e3, label=f"{diameter * 1e6:g} µm")
    ax.axvline(1.0, color=palette.GREY, linewidth=0.8)
    ax.set_xlabel("lift over weight [1]")
    ax.set_ylabel("altitude [km]")
    ax.set_xlim(-0.7, 2.0)
    ax.legend(title="soot, upright", loc="upper right")


def draw_disks(ax):
    """Lift of the engineered disk over altitude."""
    for absorptance, emittance in DISKS:
        found = over_weight(engineered(absorptance, emittance), ALTITUDES, lf.Kinetic())
        ax.plot(found, ALTITUDES / 1e3, label=f"{absorptance:g}, {emittance:g}")
    for level in (0.0, 1.0):
        ax.axvline(level, color=palette.GREY, linewidth=0.8)
    ax.set_xlabel("lift over weight [1]")
    ax.set_xlim(-16.0, 8.0)
    ax.legend(title="disk: absorbs, emits", loc="upper left")


def main():
    """Draw the figure and print the numbers."""
    figure = plot.new_figure(columns=3, width=5.0, height=4.0)
    draw_asymmetry(figure.axes[0])
    draw_soot(figure.axes[1])
    draw_disks(figure.axes[2])
    plot.save(figure, [IMAGES / "particles.png"])
    for diameter in SOOT_SIZES:
        lift = over_weight(unlike(diameter), ALTITUDES, FORCE)
        plain = over_weight(soot_sphere(diameter, tac_top=0.9), np.array([20e3, 50e3, 80e3]), FORCE)
        rests = np.round(crossings(ALTITUDES, lift, 1.0) / 1e3, 1)
        print(f"soot of {diameter * 1e6:g} µm: lift over weight up to {lift.max():.2f}", rests)
        print("  km has one; with halves alike at 20, 50, 80 km:", np.round(plain, 4))
    for absorptance, emittance in DISKS:
        disk = engineered(absorptance, emittance)
        lift = over_weight(disk, ALTITUDES, lf.Kinetic())
        turns, ones = (np.round(crossings(ALTITUDES, lift, at) / 1e3, 1) for at in (0.0, 1.0))
        print(f"disk {absorptance:g}, {emittance:g}: turns at {turns} km, lift is its weight at")
        print(f"  {ones} km; least {lift.min():.1f}, most {lift.max():.1f}")
    glass = mie(1.46 - 1e-7j, np.pi * 10e-6 / 532e-9)
    print("10 µm of glass at 532 nm:", glass)


if __name__ == "__main__":
    main()
