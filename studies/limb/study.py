r"""How high the edge of the Earth's shadow is: sunlight along rays that graze the atmosphere.

A ray of tangent height H is dimmed by molecules, ozone and clouds and bent by the air. With the
share T(H) that passes, a flyer sees T over the apparent depression of the ray. The opaque edge
that lets through as much light in all, while the sun sets, is at the depression

.. math:: \int T\,d\delta_\mathrm{apparent}

Bending needs no more: it moves light to later and spreads it by as much. From that depression
follows the height of the limb of ``lightflyer.environment.Limb``.

- Molecules: Rayleigh's optical depth of Bodhaine and others (1999), density of US 1976.
- Ozone: absorption coefficients of the SPECTRL2 model (Bird & Riordan 1984) as pvlib has them; 300
  Dobson units around 22 km. Below 0.3 µm, where 1 % of the light is, all is lost.
- Clouds: an opaque deck up to some height. Dust and smoke are left out.

Run as ``python studies/limb/study.py``; writes docs/images/daylight.png.
"""

from pathlib import Path

import numpy as np
from pvlib.spectrum.spectrl2 import _SPECTRL2_COEFFS as SPECTRL2
from scipy.optimize import brentq
from scipy.special import erf

import lightflyer as lf
from lightflyer.environment import EARTH_LIMB, Daylight, Place
from lightflyer.environment.horizon import horizon_depression, visible_share
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.film.optics.spectra import am0

IMAGES = Path(__file__).parents[2] / "docs" / "images"
RADIUS = 6_371e3
SEA_LEVEL_REFRACTIVITY = 2.77e-4  # of dry air at 15 °C and 0.55 µm, Ciddor (1996)
SCALE_HEIGHT = 8434.5  # RT/g at sea level: the height of a homogeneous atmosphere [m]
DOBSON, OZONE_PEAK, OZONE_WIDTH = 0.3, 22e3, 7e3  # column [cm], shape [m]
HEIGHTS = np.arange(0.0, 100e3, 250.0)
DECKS = (0.0, 8e3, 12e3, 16e3)
SUN = np.radians(0.267)


def profiles():
    """Density of air over that at sea level, and ozone per metre [cm/m], over HEIGHTS."""
    earth = lf.Earth().atmosphere
    density = earth.pressure(HEIGHTS) / earth.temperature(HEIGHTS) * earth.molar_mass_ratio(HEIGHTS)
    ozone = np.exp(-(((HEIGHTS - OZONE_PEAK) / OZONE_WIDTH) ** 2))
    return density / density[0], ozone * DOBSON / np.trapezoid(ozone, HEIGHTS)


def along_ray(height, profile):
    """Integral of a profile along the straight ray of a tangent height."""
    path = np.concatenate([[0.0], np.geomspace(100.0, 1.2e6, 2000)])
    heights = np.hypot(RADIUS + height, path) - RADIUS
    return 2.0 * np.trapezoid(np.interp(heights, HEIGHTS, profile, right=0.0), path)


def rayleigh(wavelength):
    """Optical depth of the atmosphere from the zenith at a wavelength [µm]."""
    above = 1.0455996 - 341.29061 * wavelength**-2 - 0.90230850 * wavelength**2
    below = 1.0 + 0.0027059889 * wavelength**-2 - 85.968563 * wavelength**2
    return 0.0021520 * above / below


def transmission(with_ozone=True):
    """Share of the sun's energy that passes along the rays of HEIGHTS, without clouds."""
    spectrum = am0()
    wavelength, weight = spectrum.wavelength, np.gradient(spectrum.wavelength) * spectrum.irradiance
    wavelength = wavelength * (1e6 if wavelength.max() < 1.0 else 1.0)
    kept = wavelength > 0.3
    air, ozone = profiles()
    absorbs = np.interp(
        wavelength[kept], SPECTRL2["wavelength"] / 1e3, SPECTRL2["ozone_absorption"]
    )
    passes = []
    for height in HEIGHTS:
        depth = rayleigh(wavelength[kept]) * along_ray(height, air) / SCALE_HEIGHT
        if with_ozone:
            depth = depth + absorbs * along_ray(height, ozone)
        passes.append(np.sum(weight[kept] * np.exp(-depth)) / np.sum(weight))
    return np.array(passes)


def apparent_depression(altitude):
    """Heights from the flyer down, the depression at which it sees their rays, and the true one."""
    heights = np.append(HEIGHTS[altitude > HEIGHTS], altitude)[::-1]
    refractivity = SEA_LEVEL_REFRACTIVITY * np.interp(heights, HEIGHTS, profiles()[0])
    nearest = (RADIUS + heights) * (1.0 + refractivity)
    seen = np.arccos(np.minimum(nearest / (RADIUS + altitude), 1.0))
    scale = EARTH_LIMB.scale_height
    passed = 1.0 + erf(np.sqrt((altitude - heights) / scale))
    return (
        heights,
        seen,
        seen + 0.5 * refractivity * np.sqrt(2.0 * np.pi * nearest / scale) * passed,
    )


def effective_height(altitude, passes, deck):
    """Height of the opaque edge that lets through as much light in all [m]."""
    heights, seen, _ = apparent_depression(altitude)
    share = np.interp(heights, HEIGHTS, passes) * (heights >= deck)
    edge = np.trapezoid(share, seen)
    return brentq(
        lambda h: float(horizon_depression(EARTH_LIMB.at(h), altitude, RADIUS)) - edge, 1e3, 45e3
    )


def setting_sun(altitude, passes, deck, depression):
    """Share of sunlight at a flyer over the depression of the sun's centre, air and all."""
    heights, seen, true = apparent_depression(altitude)
    share = np.interp(heights, HEIGHTS, passes) * (heights >= deck) * np.gradient(seen, true)
    offset = np.linspace(-1.0, 1.0, 201)
    across = np.sqrt(1.0 - offset**2)  # chords of the sun's disk
    light = np.interp(depression[:, None] + SUN * offset, true, share, right=0.0)
    return np.sum(light * across, axis=1) / np.sum(across)


def draw_sunset(ax, passes):
    """Light at 75 km as the sun sets: through the air, and by the effective limb."""
    altitude = 75e3
    depression = np.radians(np.linspace(3.0, 9.5, 300))
    for deck, style, label, where in (
        (0.0, "-", "clear\nair", (8.75, 0.24)),
        (12e3, "--", "over clouds\nup to 12 km", (6.9, 0.2)),
    ):
        light = setting_sun(altitude, passes, deck, depression)
        (line,) = ax.plot(np.degrees(depression), light, style)
        ax.text(*where, label, color=line.get_color(), ha="right" if deck else "left")
    edge = horizon_depression(EARTH_LIMB, altitude, RADIUS)
    ax.plot(np.degrees(depression), visible_share(edge - depression, SUN), ":", color="black")
    ax.text(3.1, 0.9, f"as computed here:\nlimb at {EARTH_LIMB.height / 1e3:g} km", va="top")
    ax.set_xlabel("depression of the sun's centre [°]")
    ax.set_ylabel("sunlight at 75 km over that of the day [1]")


LABELLED = {  # where names of lines begin
    (0.0, "top"): (8.6, 1240.0),
    (60.0, "top"): (16.4, 850.0),
    (0.0, "bottom"): (8.2, 370.0),
    (60.0, "bottom"): (8.4, 30.0),
}


def draw_day(ax):
    """Light on the faces of a level flyer through a day."""
    sky = Daylight()
    for degrees, colour in ((0.0, palette.BLUE), (60.0, palette.VERMILION)):
        place = Place.at("2026-06-21T12:00Z", degrees, 0.0)
        hours = np.linspace(-12.0, 12.0, 1201)
        place = place._replace(time=place.time + 3600.0 * hours)
        radiation = sky.radiation(75e3, place)
        with lf.float64():
            light = radiation.on_faces()
        for face, style in (("top", "-"), ("bottom", "--")):
            values = radiation.irradiance * np.asarray(getattr(light, f"beam_{face}"))
            ax.plot(hours + 12.0, values, style, color=colour)
            ax.text(*LABELLED[degrees, face], f"{degrees:g}° N, {face} face", color=colour)
    ax.set_xlabel("UTC at longitude 0°, 21 June [h]")
    ax.set_ylabel("light on a level flyer at 75 km [W/m²]")
    ax.set_xlim(0.0, 24.0)
    ax.set_xticks(range(0, 25, 6))
    ax.set_ylim(None, 1350.0)


def main():
    """Print the heights of the effective limb and draw the figure."""
    passes = {ozone: transmission(ozone) for ozone in (True, False)}
    print("share that passes at 10, 20, 30, 40 km:",
          np.round(np.interp([1e4, 2e4, 3e4, 4e4], HEIGHTS, passes[True]), 2))  # fmt: skip
    for ozone, share in passes.items():
        for deck in DECKS:
            found = [effective_height(h, share, deck) / 1e3 for h in (50e3, 75e3, 90e3)]
            print(f"ozone {ozone!s:5}, clouds up to {deck / 1e3:4g} km: limb for flyers at "
                  f"50, 75, 90 km: {np.round(found, 1)} km")  # fmt: skip
    figure = plot.new_figure(columns=2, width=4.6, height=4.0)
    draw_sunset(figure.axes[0], passes[True])
    draw_day(figure.axes[1])
    plot.save(figure, [IMAGES / "daylight.png"])


if __name__ == "__main__":
    main()
