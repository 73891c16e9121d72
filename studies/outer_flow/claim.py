"""A sandwich of 10 cm at 25 km with a gap of 2 µm: what it carries."""

import math

import numpy as np
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.force.laws.outer_flow import CREEPING, through_flow_force
from lightflyer.force.membranes.sandwich import rarefaction
from lightflyer.gas import mean_free_path

ALTITUDE = 25e3  # [m]
RADIUS, GAP, CLAIMED = 0.05, 2e-6, 285e-6  # [m], [m], [kg]: Schafer et al. 2022
OPEN_FRACTION = 0.5  # "about half of the layers' surfaces": Schafer et al. 2022
MILLIGRAM = 1e-6  # [kg]
SAMPLES, SEED = 4000, 1
PERCENTILES = (2.5, 50.0, 97.5)

# What is not published, with the range it is taken from.
GUESSED = {
    "open_fraction": (0.4, 0.6),
    "absorptance": (0.5, 0.95),  # of the lower film, sunlight
    "top_transmittance": (0.8, 0.95),
    "top_emittance": (0.3, 0.95),  # "infrared-emissive"
    "bottom_emittance": (0.03, 0.3),  # "infrared-transmissive"
    "tac": (0.8, 1.0),
    "log_support_fraction": (-5.0, -3.0),
}


class Surroundings:
    """Air at the altitude of the claim, and the disk in it."""

    def __init__(self):
        self.state = lf.Earth().state(ALTITUDE)
        gas = self.state.gas
        self.pressure, self.temperature, self.gravity = (
            float(value)
            for value in (self.state.pressure, self.state.temperature, self.state.gravity)
        )
        self.density = float(gas.density(self.pressure, self.temperature))
        self.viscosity = float(gas.viscosity(self.temperature))
        self.speed = math.sqrt(2.0 * gas.specific_gas_constant * self.temperature)
        self.area = math.pi * RADIUS**2
        self.rarefaction = float(rarefaction(RADIUS, self.pressure, self.temperature, gas))
        self.mean_free_path = float(mean_free_path(self.pressure, self.temperature, gas))

    def effusion(self, difference):
        """Fastest flow that a temperature difference drives: through holes without walls [m/s].

        Free molecules stream from either side at p/√(2πRT) per area; holes are everywhere.
        """
        return self.speed * difference / (4.0 * math.sqrt(math.pi) * self.temperature)

    def transmitting_disk(self, difference, open_fraction):
        """Flow through the disk of the published simulations, in dense gas [m/s].

        Each molecule passes it with a probability of ``open_fraction`` or leaves as warm as the
        face it came to.
        """
        return self.effusion(difference) * open_fraction / (1.0 + open_fraction)

    def slab(self, difference, open_fraction):
        """Force if the gas could not flow around the disk, as in an endless sheet [N]."""
        relative = difference / self.temperature
        return 0.25 * self.pressure * self.area * (1.0 - open_fraction) * relative

    def flow(self, velocity):
        """Force of the flow through the disk [N]."""
        return np.asarray(through_flow_force(RADIUS, velocity, self.density, self.viscosity))

    def reynolds(self, velocity):
        """Reynolds number of a velocity."""
        return self.density * RADIUS * velocity / self.viscosity


def mass(force, gravity):
    """What a force carries [mg]."""
    return force / gravity / MILLIGRAM


def sandwiches(guesses):
    """The device, once for each guess."""
    top = lf.FilmProperties(
        3e-4, 0.02, guesses["top_emittance"], guesses["top_emittance"], guesses["tac"],
        guesses["tac"], transmittance=guesses["top_transmittance"],
    )  # fmt: skip
    bottom = lf.FilmProperties(
        3.7e-4, guesses["absorptance"], guesses["bottom_emittance"], guesses["bottom_emittance"],
        guesses["tac"], guesses["tac"], infrared_transmittance=0.7,
    )  # fmt: skip
    return lf.Sandwich(
        top, bottom, RADIUS, GAP, guesses["open_fraction"], 0.5 * GAP,
        10.0 ** guesses["log_support_fraction"], 1.8,
    )  # fmt: skip


def available_difference(around, flyer):
    """Difference of the membranes in sunlight [K], and the force of the simulations [N].

    The simulations end at a hundredth of the rarefaction, and are extrapolated.
    """
    found = lf.equilibrium(flyer, around.state, lf.Schafer2025())
    top, bottom = (np.asarray(found.temperature_of(node)) for node in ("top", "bottom"))
    return bottom - top, np.asarray(lf.Schafer2025().force(flyer, around.state, found.unknowns))


class WarmAir:
    """Air that rises around the warm device, by the study's solutions of Boussinesq's equations.

    Between their Grashof numbers, and not far beyond, they go as powers.
    """

    def __init__(self, around, solutions):
        self.around = around
        self.logs = np.log([float(number) for number in solutions])
        self.solutions = solutions

    def _at(self, name, grashof):
        values = np.log([one[name] for one in self.solutions.values()])
        return np.exp(np.interp(np.log(grashof), self.logs, values))

    def properties(self, warmth):
        """Density, conductivity, rise velocity U and Grashof number half-way to the film."""
        around, gas = self.around, self.around.state.gas
        mean = around.temperature + 0.5 * warmth
        density = np.asarray(gas.density(around.pressure, mean))
        rise = np.sqrt(around.gravity * RADIUS * warmth / mean)
        reynolds = density * RADIUS * rise / np.asarray(gas.viscosity(mean))
        return density, np.asarray(gas.conductivity(mean)), rise, reynolds**2

    def heat(self, warmth):
        """Heat that the device gives to the air [W]."""
        _, conductivity, _, grashof = self.properties(warmth)
        return self._at("heat_over_kappa_a_dT", grashof) * conductivity * RADIUS * warmth

    def lift(self, warmth):
        """Lift of the air that the device warms [N]."""
        density, _, rise, grashof = self.properties(warmth)
        scale = density * rise**2 * self.around.area
        return self._at("force_over_rho_U2_area", grashof) * scale

    def pumped(self, warmth, velocity):
        """What a flow through the device adds to that, to first order [N]."""
        density, _, rise, grashof = self.properties(warmth)
        scale = density * rise * velocity * self.around.area
        return self._at("added_over_rho_U_u_area", grashof) * scale

    def warmth(self, flyer):
        """How much warmer than the air the device is [K], both membranes alike."""
        state = self.around.state
        light = sum(flyer.beam_areas(state)) * state.radiation.irradiance
        gained = np.asarray(light + sum(flyer.heat_gains(state)))
        low, high = np.full(SAMPLES, 1.0), np.full(SAMPLES, 300.0)
        for _ in range(40):  # bisection
            middle = 0.5 * (low + high)
            excess = middle / self.around.temperature
            lost = np.asarray(sum(flyer.heat_losses(state, (excess, excess)))) + self.heat(middle)
            low, high = np.where(lost < gained, middle, low), np.where(lost < gained, high, middle)
        return middle


def sample():
    """Guesses, drawn evenly from their ranges."""
    rng = np.random.default_rng(SEED)
    return {name: rng.uniform(*ends, SAMPLES) for name, ends in GUESSED.items()}


def interval(values, digits=3):
    """Median with the ends of the 95 % interval."""
    low, middle, high = np.percentile(values, PERCENTILES)
    return {
        name: float(f"{value:.{digits}g}")
        for name, value in (("median", middle), ("low", low), ("high", high))
    }


def needed_difference(around, velocity):
    """Temperature difference at which the flow carries what is claimed [K]."""
    weight = CLAIMED * around.gravity
    return brentq(lambda difference: around.flow(velocity(difference)) - weight, 1e-3, 1e4)


def summary(warm_solutions):
    """All numbers of the claim."""
    with lf.float64():
        around = Surroundings()
        return {
            **_place(around),
            **_per_kelvin(around),
            **_in_sunlight(around, WarmAir(around, warm_solutions)),
        }


def _place(around):
    return {
        "pressure_pa": round(around.pressure, 1),
        "gas_temperature_k": round(around.temperature, 2),
        "mean_free_path_um": round(around.mean_free_path * 1e6, 3),
        "rarefaction": round(around.rarefaction),
        "claimed_mg": round(CLAIMED / MILLIGRAM, 1),
    }


def _per_kelvin(around):
    """At a difference of one kelvin, and the difference at which the claimed mass is carried."""
    velocities = {
        "flow": lambda difference: around.transmitting_disk(difference, OPEN_FRACTION),
        "flow, effusion": around.effusion,
    }
    slab = around.slab(1.0, OPEN_FRACTION)
    creeping = CREEPING * around.viscosity * RADIUS * velocities["flow"](1.0)
    forces = {"slab": slab, "flow, creeping": creeping}
    forces |= {name: around.flow(velocity(1.0)) for name, velocity in velocities.items()}
    needed = {"slab": CLAIMED * around.gravity / slab}
    needed |= {name: needed_difference(around, one) for name, one in velocities.items()}
    return {
        "velocity_per_kelvin_m_s": {name: _short(one(1.0)) for name, one in velocities.items()},
        "reynolds_per_kelvin": {
            name: _short(around.reynolds(one(1.0))) for name, one in velocities.items()
        },
        "mass_at_one_kelvin_mg": {
            name: _short(mass(force, around.gravity)) for name, force in forces.items()
        },
        "needed_difference_k": {name: _short(value) for name, value in needed.items()},
    }


def _in_sunlight(around, air):
    """What the available light sustains, with the guessed inputs' 95 % intervals."""
    guesses = sample()
    flyer = sandwiches(guesses)
    difference, simulated = available_difference(around, flyer)
    warmth = air.warmth(flyer)
    pumped = around.transmitting_disk(difference, guesses["open_fraction"])
    forces = {
        "by_slab_mg": around.slab(difference, guesses["open_fraction"]),
        "by_schafer2025_mg": simulated,
        "by_flow_mg": around.flow(pumped),
        "by_flow_effusion_mg": around.flow(around.effusion(difference)),
        "by_warm_air_mg": air.lift(warmth),
        "by_flow_in_warm_air_mg": air.pumped(warmth, pumped),
        "by_flow_effusion_in_warm_air_mg": air.pumped(warmth, around.effusion(difference)),
    }
    together = air.lift(warmth) + air.pumped(warmth, pumped)
    needed = (CLAIMED + np.asarray(flyer.own_mass)) * around.gravity
    return {
        "available_difference_k": interval(difference),
        "warmer_than_the_gas_k": interval(warmth),
        "grashof": interval(air.properties(warmth)[3]),
        **{name: interval(mass(force, around.gravity)) for name, force in forces.items()},
        "over_needed": interval(together / needed),
        "films_mg": interval(np.asarray(flyer.own_mass) / MILLIGRAM),
    }


def _short(value):
    return float(f"{value:.4g}")
