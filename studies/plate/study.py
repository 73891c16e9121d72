"""Lift of a nanocardboard plate over pressure, and what of it is the channels' pump.

    python studies/plate/study.py

Writes docs/images/plate.png and results.json.
"""

import json
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"

OBSERVED = (10.0, 200.0)  # Pa, Cortes et al. (2020)
GAS, TEMPERATURE, GRAVITY, LIGHT = lf.gas.AIR, 293.0, 9.81, 1e4
SHOWN = (1.0, 10.0, 30.0, 100.0, 200.0, 1e3, 1e4, 1e5)
MODEL = lf.ChannelPump()


def plate(absorptance=0.9, height=50e-6, emittance=0.1):
    """The published geometry; what is not published is an argument, or clear and black."""
    top = lf.FilmProperties(1.5e-4, 1e-3, emittance, emittance, 1.0, 1.0, transmittance=0.999)
    bottom = lf.FilmProperties(1.5e-4, absorptance, emittance, emittance, 1.0, 1.0)
    return lf.Plate(
        top, bottom, 4e-3, 50e-6, 500e-6, 50e-6, height, 50e-9, 1.8, areal_density=4.1e-4
    )


def state(pressure):
    """In the chamber, under the lamp."""
    radiation = lf.environment.Radiation(LIGHT)
    return lf.environment.EnvironmentState(pressure, TEMPERATURE, GRAVITY, GAS, radiation)


def over_pressure(flyer, pressure):
    """Lift over weight, the share of the pump in it, and the temperatures."""
    here = state(pressure)
    found = lf.equilibrium(flyer, here, MODEL)
    weight = lf.statics.weight(flyer, here)
    own = MODEL.own_results(flyer, here, found.unknowns)
    top, bottom = (np.asarray(found.temperature_of(node)) for node in flyer.nodes)
    return {
        "lift_over_weight": lf.lift(flyer, here, MODEL) / weight,
        "pump_over_weight": np.asarray(own["pressure_difference"]) * float(flyer.area) / weight,
        "temperature_difference": bottom - top,
        "temperature": bottom,
        "flow_velocity": np.asarray(own["flow_velocity"]),
    }


def simple_temperature_difference(pressure):
    """An estimate by hand: half of the light goes up, each face loses the whole disk's 8κaΔT.

    (1 - φ) of a light that an open slot without ends passes, properties of the gas at its own
    temperature and no rarefaction outside.
    """
    with lf.float64():
        path = np.asarray(lf.gas.mean_free_path(pressure, TEMPERATURE, GAS))
        conductivity = float(GAS.conductivity(TEMPERATURE))
    between = conductivity / (50e-6 + 2.0 * 1.64 * path) + 1.8 * 1e-3 / 50e-6
    outside = 18.5
    return 0.9 * 0.5 * LIGHT / (2.0 * between + outside)


def draw():
    """Lift over weight beside the observed range."""
    pressure = np.geomspace(1.0, 1e5, 101)
    figure = plot.new_figure(width=6.4, height=4.4)
    (axes,) = figure.axes
    axes.axvspan(*OBSERVED, color="0.9")
    axes.text(45.0, 2e-3, "levitation\nobserved", ha="center")
    for label, where, colour, flyer in (
        ("absorptance 0.9, height 100 µm", (1.2, 45.0), palette.GREEN, plate(height=100e-6)),
        ("0.9, 50 µm", (4.5, 9.5), palette.BLUE, plate()),
        ("0.3, 50 µm", (450.0, 0.06), palette.VERMILION, plate(0.3)),
    ):
        found = over_pressure(flyer, pressure)
        axes.plot(pressure, found["lift_over_weight"], color=colour)
        axes.plot(pressure, found["pump_over_weight"], "--", color=colour)
        axes.text(*where, label, color=colour)
    axes.text(1.2, 0.02, "dashed: the\nchannels' pump\nalone", color="0.3")
    axes.axhline(1.0, color="0.3", lw=0.8)
    axes.set(
        xscale="log",
        yscale="log",
        xlim=(1.0, 1e5),
        ylim=(1e-3, 100.0),
        xlabel="pressure [Pa]",
        ylabel="lift over weight",
    )
    axes.grid(alpha=0.3)
    plot.save(figure, [IMAGES / "plate.png"])


def main():
    """Write the figure and the numbers."""
    draw()
    pressure = np.array(SHOWN)
    rows = {
        name: [float(f"{value:.4g}") for value in np.atleast_1d(values)]
        for name, values in over_pressure(plate(), pressure).items()
    }
    by_hand = simple_temperature_difference(pressure)
    rows["temperature_difference_by_hand"] = [float(f"{value:.4g}") for value in by_hand]
    results = {"pressure": list(SHOWN), **rows}
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
