"""The 2-cm disk over Mars: what models, gas, light and weather make of its band.

Run as ``python studies/mars/study.py``; prints the numbers of docs/mars.md and writes
docs/images/mars.png.
"""

from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.environment import Dust, MarsAtmosphere, Radiation, air_of_mars, mars_sunlight
from lightflyer.environment.atmosphere.mars import SURFACE_PRESSURE_SPREAD, TEMPERATURE_SPREAD
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.lu2023 import PRINTED
from lightflyer.gas import FROZEN_CARBON_DIOXIDE

IMAGES = Path(__file__).parents[2] / "docs" / "images"
ALTITUDES = np.arange(35e3, 90.1e3, 500.0)
FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DISK = lf.Disk(FILM, radius=0.01)
SAMPLES, SEED = 400, 0

# Other published profiles: altitude [km], temperature [K], pressure [Pa].
# Mars-GRAM 2021 at 28° to 34° N, Ls 172°, morning: its sample output of the suite's version 1.5.
MARS_GRAM = ((40, 154.1, 7.586), (50, 138.0, 2.165), (60, 142.8, 0.6798), (70, 145.1, 0.2454),
             (80, 130.1, 0.05979))  # fmt: skip
# Mars Climate Database, mean over the planet and the year, as tabulated by Tudat.
CLIMATE_DATABASE = ((50.0, 161.05, 2.3477), (59.2484, 158.13, 0.78037), (70.2075, 153.95, 0.20744),
                    (79.7376, 147.64, 0.064634))  # fmt: skip


def row(name, environment, model):
    """Print a row of the table; lift over weight at ALTITUDES."""
    band = lf.levitation_band(DISK, environment, model)
    state = environment.state(ALTITUDES)
    ratio = lf.lift(DISK, state, model) / lf.statics.weight(DISK, state)
    best = int(np.argmax(ratio))
    print(f"| {name} | {band.lower / 1e3:.1f} to {band.upper / 1e3:.1f} | {ratio[best]:.2f} "
          f"at {ALTITUDES[best] / 1e3:.0f} |")  # fmt: skip
    return ratio


def spread():
    """Root mean square differences of other profiles from the reference one."""
    air = MarsAtmosphere()
    found = []
    for profile in (MARS_GRAM, CLIMATE_DATABASE):
        altitude, temperature, pressure = np.array(profile).T
        found += [(temperature - air.temperature(1e3 * altitude),
                   np.log(pressure / air.pressure(1e3 * altitude)))]  # fmt: skip
    kelvin, logarithm = (np.concatenate(part) for part in zip(*found, strict=True))
    print(f"other profiles, 40 to 80 km: {np.sqrt(np.mean(kelvin**2)):.1f} K, "
          f"{np.sqrt(np.mean(logarithm**2)):.2f} of ln p")  # fmt: skip
    for height in (40e3, 60e3, 80e3):
        warm = MarsAtmosphere(temperature_offset=TEMPERATURE_SPREAD).pressure(height)
        by_heat = np.log(warm / air.pressure(height))
        total = np.hypot(by_heat, SURFACE_PRESSURE_SPREAD / air.surface_pressure)
        print(f"stated ±, {height / 1e3:.0f} km: {total:.2f} of ln p")


def sampled(model):
    """95 % band of lift over weight from the ± of the air."""
    random = np.random.default_rng(SEED)
    air = MarsAtmosphere(
        surface_pressure=636.0 + SURFACE_PRESSURE_SPREAD * random.standard_normal((SAMPLES, 1)),
        temperature_offset=TEMPERATURE_SPREAD * random.standard_normal((SAMPLES, 1)),
    )
    state = lf.Mars(atmosphere=air).state(ALTITUDES)
    ratio = lf.lift(DISK, state, model) / lf.statics.weight(DISK, state)
    return np.percentile(ratio, (2.5, 97.5), axis=0)


def main():
    """Compute, print and draw."""
    spread()
    frozen = lf.Mars(gas=air_of_mars(FROZEN_CARBON_DIOXIDE))
    reported, kinetic = lf.Lu2023(), lf.Kinetic(polyatomic="scaled")
    curves = {
        "lu2023, reported": row("lu2023, reported", lf.Mars(), reported),
        "the same, frozen vibration": row("the same, gas co2-frozen", frozen, reported),
        "kinetic, scaled": row("kinetic, scaled", lf.Mars(), kinetic),
        "kinetic, frozen vibration": row("the same, gas co2-frozen", frozen, kinetic),
    }
    row("lu2023, printed", lf.Mars(), lf.Lu2023(reading=PRINTED))
    row("black surroundings at the gas temperature, 590 W/m², no dust",
        lf.Mars(radiation=Radiation(590.0, albedo=0.25), dust=None), reported)  # fmt: skip
    for name, season in (("aphelion", 71.0), ("perihelion", 251.0)):
        row(name, lf.Mars(radiation=mars_sunlight(season)), reported)
    row(
        "infrared from below 390 W/m²",
        lf.Mars(radiation=mars_sunlight(infrared_below=390.0)),
        reported,
    )
    row("dust storm, optical depth 3", lf.Mars(dust=Dust(3.0)), reported)
    for offset in (-TEMPERATURE_SPREAD, TEMPERATURE_SPREAD):
        row(
            f"air {offset:+.0f} K",
            lf.Mars(atmosphere=MarsAtmosphere(temperature_offset=offset)),
            reported,
        )
    draw(curves, sampled(reported))


def draw(curves, band):
    """The figure of the page."""
    figure, ax = plot.figure_for(None)
    places = (0.9, 39.0), (2.75, 59.0), (1.03, 77.0), (1.72, 66.0)
    for index, (name, ratio) in enumerate(curves.items()):
        colour = palette.PALETTE[index]
        ax.plot(ratio, ALTITUDES / 1e3, color=colour, ls=plot.LINES[index])
        band_too = "\n95 % band from the ± of the air" if index == 0 else ""
        ax.text(*places[index], name.replace("same, ", "same,\n") + band_too, color=colour)
    ax.fill_betweenx(ALTITUDES / 1e3, *band, color=palette.PALETTE[0], alpha=0.2, lw=0.0)
    ax.axvline(1.0, color=palette.GREY, lw=0.8)
    ax.set(xlabel="lift over weight", ylabel="altitude above the areoid [km]", xlim=(0.0, 3.8))
    plot.save(figure, [IMAGES / "mars.png"])


if __name__ == "__main__":
    main()
