"""
A plate that was seen to levitate
=================================

[Cortes2020]_ saw plates of nanocardboard levitate between 10 Pa and 200 Pa: two films of 50 nm
alumina, joined by channels. Nothing optical is published with them; absorptance, emittance and
height below are guesses, and :doc:`/other-claims` has the whole range of these. The lift is shown
over the weight.
"""

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

upper = lf.FilmProperties(0.15e-3, 0.01, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
lower = lf.FilmProperties(0.25e-3, 0.9, 0.1, 0.1, 0.8, 0.8)
plate = lf.Plate(
    upper,
    lower,
    radius="4 mm",
    channel_width="50 um",
    channel_length="500 um",
    spacing="50 um",
    height="50 um",
    wall_thickness="50 nm",
    wall_conductivity=1.8,
    wall_density=3000.0,
)
chamber = lf.Chamber(temperature=293.0, radiation=lf.environment.Radiation(10e3))
pressure = np.geomspace(1.0, 1000.0, 100)
lift = lf.lift(plate, chamber.state(pressure), lf.ChannelPump())

fig, ax = plt.subplots()
ax.axvspan(10.0, 200.0, color="C2", alpha=0.2, label="seen to levitate")
ax.plot(
    pressure,
    lift / lf.statics.weight(plate, chamber.state(pressure)),
    label="channel-pump, 10 kW/m²",
)
ax.axhline(1.0, color="grey", ls="--", label="weight")
ax.set(xscale="log", yscale="log", xlabel="pressure [Pa]", ylabel="lift over weight")
ax.legend()
