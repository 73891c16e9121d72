r"""
Limits, and a force of your own
===============================

You want to know whether the model is right, or to try your own. This notebook checks an energy
balance and a limit that has a closed form, replaces the force, and takes derivatives through the
solution.
"""

import jax
import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

film = lf.FilmProperties(
    areal_density=1e-3,
    absorptance=0.75,
    emittance_top=0.08,
    emittance_bottom=0.08,
    tac_top=0.8,
    tac_bottom=0.9,
)
disk = lf.Disk(film, radius=0.01)
light = lf.environment.Radiation(1361.0)

# %%
# Energy
# ------
# Take the gas away, and what the disk absorbs is what it radiates. Its surroundings are black at
# the temperature of the gas, :math:`T_c`, so that
#
# .. math:: \varepsilon_\mathrm{vis} I = (\varepsilon_t + \varepsilon_b)\,\sigma\,(T^4 - T_c^4)

thin = lf.Chamber(temperature=293.0, radiation=light).state(1e-9)
temperature = lf.equilibrium(disk, thin, lf.FreeMolecular()).temperature
expected = (293.0**4 + 0.75 * 1361.0 / (0.16 * 5.670374419e-8)) ** 0.25
print(f"{float(temperature):.3f} K, closed form {expected:.3f} K")
assert abs(temperature / expected - 1.0) < 1e-5

# %%
# The free-molecular limit
# ------------------------
# Molecules that meet the disk and never each other push with :math:`\tfrac12 p A\,(\alpha_b -
# \alpha_t)(\sqrt{T_h/T_c} - 1)` if the walls are Maxwell's. The kinetic model tends to that.

knudsen = np.geomspace(0.05, 100.0, 100)
pressure = lf.gas.mean_free_path(1.0, 293.0, lf.gas.AIR) / (2.0 * disk.radius * knudsen)
states = lf.Chamber(temperature=293.0, radiation=light).state(pressure)
excess = np.full_like(knudsen, 0.5)  # (T_h - T_c)/T_c
free = 0.5 * pressure * disk.area * 0.1 * (np.sqrt(1.5) - 1.0)
ratio = lf.Kinetic(wall="maxwell").force(disk, states, (excess,)) / free
print(f"{ratio[-1]:.4f} at Kn = 100")
assert abs(ratio[-1] - 1.0) < 0.01

# %%
# Collisions take a share that in thin gas falls nearly as 1/Kn: :math:`(1-\hat F)\,\mathrm{Kn}`
# stays between 0.11 and 0.18 from Kn = 0.2 to 100. The model's table ends at Kn = 30; from there it
# goes on exactly as 1/Kn, hence the kink.

fig, ax = plt.subplots()
ax.plot(knudsen, (1.0 - ratio) * knudsen)
ax.set(xscale="log", xlabel="Knudsen number", ylabel="(1 - force ratio) × Kn")
ax.grid(alpha=0.25)

# %%
# A force of your own
# -------------------
# The simplest law of that kind is :math:`\hat F = 1/(1 + c/\mathrm{Kn})`. A force model is a
# class with two methods; all else, bands of altitude, payloads, derivatives, takes it as it takes
# the package's own.


class FirstCollisions(lf.AbstractForceModel):
    """Free molecules, of whose push collisions take a share."""

    flyers = (lf.Disk,)
    collisions: float = 0.25

    @lf.entry_point
    def heat_loss(self, flyer, state, unknowns):
        return lf.FreeMolecular().heat_loss(flyer, state, unknowns)

    @lf.entry_point
    def force(self, flyer, state, unknowns):
        free = lf.FreeMolecular().force(flyer, state, unknowns)
        return free / (1.0 + self.collisions / self.knudsen(flyer, state))

    @staticmethod
    def knudsen(flyer, state):
        return lf.gas.mean_free_path(state.pressure, state.temperature, state.gas) / (
            2.0 * flyer.radius
        )


for model in (FirstCollisions(), lf.Kinetic(), lf.Lu2023()):
    band = lf.levitation_band(disk, lf.Earth(), model)
    print(f"{type(model).__name__:16} {band.lower / 1e3:.1f} km to {band.upper / 1e3:.1f} km")

# %%
# Derivatives through the solution
# --------------------------------
# The irradiance that levitates the disk is the root of a heat balance and a force balance. Its
# derivative is exact: it comes from the implicit function theorem, not from the steps of the
# solver.

state = lf.Earth().state("80 km")


def needed(collisions):
    return lf.levitate(disk, state, FirstCollisions(collisions)).irradiance


with lf.float64():
    slope = float(jax.grad(needed)(0.25))
quotient = (float(needed(0.2501)) - float(needed(0.2499))) / 2e-4
print(f"{slope:.4f} W/m², difference quotient {quotient:.4f} W/m²")
assert abs(slope / quotient - 1.0) < 1e-6

# %%
# Next: the equations (:doc:`/model`), the solver of the kinetic equation (:doc:`/kinetic`), and a
# flyer of your own (:doc:`/extending`).
