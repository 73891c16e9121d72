"""A solar balloon over altitude, and what a wall that pumps adds to a light one.

    python studies/balloon/study.py

Writes docs/images/balloon.png and results.json.
"""

import json
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"

ALTITUDES = np.arange(10.0, 91.0, 1.0) * 1e3
SUN = {"zenith_angle": np.radians(30.0)}
KILOMETRE = 1e-3

# flight SHAB-15V of EarthSHAB, 22 August 2022, 17:35 to 18:18 UTC
FLOWN_RADIUS, FLOWN_FILM, FLOWN_LOAD = 2.9, 1.3, 1.7  # [m], [kg], [kg]
SHEET = 939.0 * 7.87e-6  # of the same simulation: polyethylene without charcoal and tape [kg/m²]
FLOWN_ALTITUDE, FLOWN_PRESSURE = 20.3e3, 5570.0
# its air: what is over New Mexico in August differs from the standard
INFRARED = {"mean of Earth": 240.0, "clear desert": 290.0, "high cloud": 150.0}
OPTICS = {"dark": (0.95, 0.95), "as the template": (0.90, 0.90), "grey": (0.85, 0.80)}


def solar_balloon(absorptance=0.9, emittance=0.9, density=None):
    """The balloon that was flown, with its film as far as it is known."""
    if density is None:
        density = FLOWN_FILM / (4.0 * np.pi * FLOWN_RADIUS**2)
    film = lf.FilmProperties(density, absorptance, emittance, emittance, 0.9, 0.9)
    return lf.Balloon(film, FLOWN_RADIUS, 0.3, payload=FLOWN_LOAD)


def pumping_balloon(diameter=10.0):
    """A sphere whose wall, two films of 0.5 g/m² in all, pumps air inward."""
    outer = lf.FilmProperties(5e-4, 0.1, 0.8, 0.1, 0.9, 0.9, transmittance=0.85)
    inner = lf.FilmProperties(5e-4, 0.9, 0.1, 0.1, 0.9, 0.9)
    return lf.HollowBody(
        outer, inner, diameter, 0.1 * diameter, 0.5, 5e-4, 1e-3, 5e-8, 1.8, "sphere"
    )


def shares(flyer, model):
    """Buoyancy, and force of the gas, over the weight at all altitudes."""
    state = lf.Earth(radiation=lf.environment.sunlight(**SUN)).state(ALTITUDES)
    unknowns = lf.equilibrium(flyer, state, model).unknowns
    weight = lf.statics.weight(flyer, state)
    with lf.float64():
        return (
            np.asarray(flyer.buoyancy(state, unknowns)) / weight,
            np.asarray(model.force(flyer, state, unknowns)) / weight,
        )


def ceiling(values):
    """Highest altitude at which the values reach one [km]."""
    last = np.flatnonzero(values >= 1.0)[-1]
    above = slice(last, last + 2)
    at = np.interp(0.0, -np.log(values[above]), ALTITUDES[above])
    return round(float(at) * KILOMETRE, 1)


def floating(flyer, infrared):
    """Altitude [km], pressure [Pa] and temperature [K] at which a balloon floats."""
    sun = lf.environment.sunlight(**SUN, infrared_below=infrared)
    earth, model = lf.Earth(radiation=sun), lf.BalloonConvection()
    top = lf.levitation_band(flyer, earth, model, (10e3, 30e3)).upper
    state = earth.state(top)
    return {
        "altitude_km": round(float(top) * KILOMETRE, 2),
        "pressure_pa": round(float(state.pressure)),
        "temperature_k": round(float(lf.equilibrium(flyer, state, model).temperature), 1),
    }


def floats():
    """Where the flown balloon floats, by what is not known of its film and the ground."""
    found = {
        f"{ground}, {name}": floating(solar_balloon(*optics), infrared)
        for ground, infrared in INFRARED.items()
        for name, optics in OPTICS.items()
    }
    sheet = solar_balloon(density=SHEET)
    return found | {"clear desert, sheet alone": floating(sheet, INFRARED["clear desert"])}


def draw(solar, pumping):
    """Lift over weight against altitude."""
    figure = plot.new_figure()
    (axes,) = figure.axes
    height = ALTITUDES * KILOMETRE
    buoyancy, pushed = pumping
    axes.plot(solar[0], height, color=palette.ORANGE)
    axes.plot([1.0], [FLOWN_ALTITUDE * KILOMETRE], "o", color=palette.MEASURED)
    axes.plot(buoyancy + pushed, height, color=palette.PURPLE)
    axes.plot(buoyancy, height, color=palette.PURPLE, ls="--")
    axes.plot(pushed, height, color=palette.PURPLE, ls=":")
    for label, where, colour in (
        ("solar balloon\n5.8 m, 3.0 kg", (0.012, 25.0), palette.ORANGE),
        ("such a one\nfloated here", (1.25, 19.0), palette.MEASURED),
        ("sphere of 10 m that pumps, 0.16 kg", (2.2, 47.0), palette.PURPLE),
        ("its warm air alone", (0.011, 62.0), palette.PURPLE),
        ("its jet and\nchannels alone", (0.125, 34.3), palette.PURPLE),
    ):
        axes.text(*where, label, color=colour)
    axes.axvline(1.0, color="0.6", lw=0.8)
    axes.set(
        xscale="log", xlim=(1e-2, 1e3), ylim=(10.0, 90.0),
        xlabel="lift over weight", ylabel="altitude [km]",
    )  # fmt: skip
    axes.grid(alpha=0.3)
    plot.save(figure, [IMAGES / "balloon.png"])


def main():
    """Compute, write and draw."""
    solar = shares(solar_balloon(), lf.BalloonConvection())
    buoyancy, pushed = pumping = shares(pumping_balloon(), lf.HollowPump())
    results = {
        "floats": floats(),
        "flown": {"altitude_km": FLOWN_ALTITUDE * KILOMETRE, "pressure_pa": FLOWN_PRESSURE},
        "sphere_of_10_m": {
            "ceiling_by_warm_air_km": ceiling(buoyancy),
            "ceiling_with_the_pump_km": ceiling(buoyancy + pushed),
            "strongest_push_over_weight": round(float(pushed.max()), 3),
            "at_km": round(float(ALTITUDES[np.argmax(pushed)]) * KILOMETRE, 1),
        },
    }
    text = json.dumps(results, indent=2) + "\n"
    (HERE / "results.json").write_text(text, encoding="utf-8")
    print(text)
    draw(solar, pumping)


if __name__ == "__main__":
    main()
