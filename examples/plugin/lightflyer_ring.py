from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

import lightflyer as lf
from lightflyer.environment import AbstractAtmosphere, Attitude, Planet, PlanetSection
from lightflyer.force.laws.faces import accommodated_force, free_molecular_conductance


class Ring(lf.AbstractFlyer):
    nodes: ClassVar = ("film",)  # one temperature
    film: lf.FilmProperties
    outer: lf.quantity.Length  # radii [m]
    inner: lf.quantity.Length
    payload: lf.quantity.Mass = 0.0
    attitude: Attitude | None = None

    @staticmethod
    def contradiction(outer, inner):
        yield inner >= outer, "inner must be smaller than outer"

    @property
    def area(self):  # of one face [m²]
        return np.pi * (self.outer**2 - self.inner**2)

    @property
    def own_mass(self):  # [kg]
        return self.area * self.film.areal_density

    def describe(self):
        return f"ring of {200 * float(self.outer):g} cm"

    @property
    def disk(self):  # absorbs and radiates as much
        radius = (self.outer**2 - self.inner**2) ** 0.5
        return lf.Disk(self.film, radius, attitude=self.attitude)

    def beam_areas(self, state):  # [m²]
        return self.disk.beam_areas(state)

    def heat_gains(self, state):  # [W]
        return self.disk.heat_gains(state)

    def heat_losses(self, state, unknowns):  # [W]
        return self.disk.heat_losses(state, unknowns)


class RingSection(lf.flyer.FlyerSection, of=Ring):
    shape: Literal["ring"]
    default_model: ClassVar = "thin-gas"


THIN = lf.Validity("the Knudsen number", 10.0, np.inf, "thin-gas leaves collisions out")


class ThinGas(lf.AbstractForceModel):
    flyers: ClassVar = (Ring,)

    def heat_loss(self, flyer, state, unknowns):  # to the gas [W]
        (excess,) = unknowns
        gas, temperature = state.gas, state.temperature
        conductance = free_molecular_conductance(
            2.0 * flyer.area,
            flyer.film.tac_mean,
            state.pressure,
            gas.mean_speed(temperature),
            gas.heat_capacity_ratio_at(temperature * (1.0 + 0.5 * excess)),
        )
        return (conductance * excess,)

    def force(self, flyer, state, unknowns):  # towards the top [N]
        (excess,) = unknowns
        tacs = flyer.film.tac_top, flyer.film.tac_bottom
        return accommodated_force(flyer.area, *tacs, state.pressure, excess)

    def ranges(self, flyer, state, temperature):  # outside, predictions say so
        knudsen = lf.gas.knudsen_number(state.pressure, state.temperature, flyer.outer, state.gas)
        yield THIN, knudsen


class ThinGasSection(lf.force.ForceSection, of=ThinGas):
    model: Literal["thin-gas"]


TITAN = Planet(
    "Titan",
    radius=2_574.7e3,
    rotation_rate=4.5607e-6,
    gravity=1.352,
    irradiance=14.8,
    albedo=0.265,
    infrared=2.83,
    highest_searched=500e3,
)


class Haze(AbstractAtmosphere):
    """170 K everywhere, 10 Pa at 300 km."""

    altitude_range: ClassVar = (100e3, 600e3)

    def temperature(self, altitude, place=None):
        return 170.0 + 0.0 * altitude

    def pressure(self, altitude, place=None):
        scale_height = 296.8 * 170.0 / TITAN.gravity_at(300e3)
        nearer = (TITAN.radius + 300e3) / (TITAN.radius + altitude)
        return 10.0 * lf.xp.exp(-(altitude - 300e3) * nearer / scale_height)

    def molar_mass_ratio(self, altitude, place=None):
        return 1.0


class TitanSection(PlanetSection):
    kind: Literal["titan"]
    planet: ClassVar = TITAN
    default_gas: ClassVar = "nitrogen"

    def build_atmosphere(self):
        return Haze()


class Krypton(lf.gas.AbstractReferenceGas):
    name: ClassVar = "krypton"
    molecules: ClassVar = "monatomic"
    transport: ClassVar = lf.gas.LemmonJacobsen(
        83.798, 0.3655, 178.9, 209.48, of_viscosity=0.3721, terms=()
    )
    correlations: ClassVar = lf.gas.Correlations(
        transport.viscosity,
        transport.conductivity,
        lf.gas.IdealHeatCapacity((2.5,)),  # of atoms
        ends=(120.0, 1500.0),
    )
    specific_gas_constant: float = lf.gas.GAS_CONSTANT / 83.798
    heat_capacity_ratio: float = 5.0 / 3.0


lf.gas.GASES["krypton"] = Krypton()


lf.film.MEDIA["soot"] = lf.film.tabulated_material(
    "soot", [0.2e-6, 50e-6], n=[1.57, 1.57], k=[0.56, 0.56], density=1800.0
)


def is_ours(source):
    return source.content.startswith(b"OUR LAMP")


def read_ours(source):
    table = np.loadtxt(source.text.splitlines()[1:])
    metadata = lf.lab.SpectrumMetadata("our lamp")
    return [lf.lab.RawSpectrum(table[:, 0], table[:, 1], "nm", "%T", metadata)]


lf.lab.SPECTRUM_FORMATS.append(lf.lab.Format("our lamp", is_ours, read_ours))


def weigh(file: Path):
    """Print the mass of the flyer in a file."""
    setup = lf.read_flyer_file(file).build()
    print(f"{setup.flyer.describe()}: {1e6 * float(setup.flyer.mass):.3f} mg")
