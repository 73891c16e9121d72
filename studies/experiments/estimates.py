"""How much everything else could matter for a germanium disk in the chamber: one number each."""

import math

import disks
import numpy as np
from measurements import middle, number, read

import lightflyer as lf
from lightflyer.core.constants import STANDARD_GRAVITY
from lightflyer.drag import disk_drag
from lightflyer.environment import Radiation
from lightflyer.environment.radiation import Attitude
from lightflyer.gas import AIR, knudsen_number, mean_free_path

WALL = 0.15  # from the disk, guessed [m]
PRESSURES = (1.5, 10.0, 30.0)  # where the least light suffices, and where 6-mm disks flew [Pa]
TILT = math.radians(10.0)
MYLAR_CONDUCTIVITY, MYLAR_THICKNESS = 0.15, 0.5e-6  # [W/(m K)], of PET films; [m]
LID_ABOVE_FLOOR, LID_COOLER = 0.2, 10.0  # both guessed [m], [K]
_PUSH_OF_HEAT = 0.8 / math.sqrt(math.pi)  # of a thin disk across a flow of heat, over q/√(2RT)
_STOKESLET = 16.0 / (6.0 * math.pi)  # mean axial velocity around a moving disk, over U r/R
_SOURCE = 2.0 / math.pi  # radius of the sphere that warms the gas far away as a disk does, over r
_NEARER = 0.0449  # [m]
_FARTHER = 0.0601  # [m]


def grashof_number(pressure, temperature, excess, length):
    """Buoyancy over viscosity, g (ΔT/T) L³/ν², in air.

    Parameters
    ----------
    pressure, temperature, excess, length : float
        [Pa], [K], [K], [m].

    Returns
    -------
    float
    """
    viscosity = float(AIR.viscosity(temperature) / AIR.density(pressure, temperature))
    return STANDARD_GRAVITY * excess / temperature * length**3 / viscosity**2


def updraft(pressure, temperature, excess, radius, wall):
    r"""Force of the slow circulation of warm gas on a disk in a vessel [N], at most.

    .. math:: F = \int \rho g \frac{\Delta T}{T}\, \hat u\, dV \approx
        \rho g\,\frac{\Delta T_h}{T_c}\;4\pi\,r_s\,\hat a\,\frac R4

    Parameters
    ----------
    pressure, temperature, excess, radius, wall : float
        [Pa], [K], of the disk over the gas [K], [m], [m].

    Notes
    -----
    By reciprocity: û is the axial velocity of gas around a disk that moves along its axis with unit
    velocity, in the mean over directions, :math:`\hat a/r` with :math:`\hat a = 16 r/6\pi`. Warm
    gas is that around a sphere of radius :math:`r_s = 2r/\pi`, whose conduction is the disk's.
    Both are taken to fall to zero at the wall, as 1 − x and (1 − x)². Without slip; slip and a
    finite Reynolds number make the force smaller.
    """
    density = float(AIR.density(pressure, temperature))
    source, moved = _SOURCE * radius, _STOKESLET * radius
    return density * STANDARD_GRAVITY * excess / temperature * math.pi * source * moved * wall


def thermophoresis(temperature, gradient, tac_mean):
    r"""Pressure on a thin level disk in gas that is warmer below [Pa], with free molecules.

    .. math:: \frac FA = \frac{4}{5\sqrt\pi}\,(2-\bar\alpha)\,\frac{q}{\sqrt{2RT}},
        \qquad q = \kappa\,\frac{dT}{dz}

    Parameters
    ----------
    temperature, gradient, tac_mean : float
        [K], downwards [K/m], [1].

    Notes
    -----
    The gas far away has Grad's distribution of a heat flux, and disk and free path are small and
    large beside each other: it is an upper bound at the Knudsen numbers of these disks. It does not
    depend on the pressure.
    """
    speed = math.sqrt(2.0 * AIR.specific_gas_constant * temperature)
    heat = float(AIR.conductivity(temperature)) * gradient
    return _PUSH_OF_HEAT * (2.0 - tac_mean) * heat / speed


def convection(light, size):
    """Grashof number and the updraft over the weight, at each pressure."""
    temperature, excess = 293.0, light["temperature"] - 293.0
    radius = 0.005 * size
    weight = 1.15e-3 * math.pi * radius**2 * STANDARD_GRAVITY
    return {
        f"{pressure:g} Pa": {
            "knudsen": _digits(knudsen_number(pressure, temperature, radius, AIR)),
            "grashof_disk": _digits(grashof_number(pressure, temperature, excess, 2.0 * radius)),
            "grashof_wall": _digits(grashof_number(pressure, temperature, excess, WALL)),
            "updraft_over_weight": _digits(
                updraft(pressure, temperature, excess, radius, WALL) / weight
            ),
        }
        for pressure in PRESSURES
    }


def tilted(paper, size, angle):
    """Factor on the least light if the disk is tilted by an angle [rad]."""
    film = {name: float(value[0]) for name, value in _film(paper).items()}
    emittance = film.pop("emittance")
    properties = lf.FilmProperties(
        film["areal_density"], film["absorptance"], emittance, emittance,
        film["tac_top"], film["tac_bottom"],
    )  # fmt: skip
    state = lf.Chamber().state(disks.PRESSURES)
    level, leaning = (
        lf.levitate(lf.Disk(properties, radius=0.005 * size, attitude=at), state, lf.Kinetic())
        for at in (None, Attitude(tilt=angle))
    )
    return float(np.min(leaning.irradiance) / np.min(level.irradiance))


def hovering(paper, size, light, pressure):
    """How the lift falls away from the walls in the same light, and what that makes of hovering.

    The walls of the reservoir on all sides move together, so that this is the most that a floor
    alone does.
    """
    film = _film(paper)
    emittance = film["emittance"]
    disk = lf.Disk(
        lf.FilmProperties(
            film["areal_density"], film["absorptance"], emittance, emittance,
            film["tac_top"], film["tac_bottom"],
        ),
        radius=0.005 * size,
    )  # fmt: skip
    forces = [
        float(
            lf.lift(
                disk,
                lf.Chamber(radius=away, radiation=Radiation(irradiance=light)).state(pressure),
                lf.Kinetic(),
            )[0]
        )
        for away in (_NEARER, _FARTHER)
    ]
    mean, rise = 0.5 * sum(forces), _FARTHER - _NEARER
    stiffness = (forces[0] - forces[1]) / rise
    mass = float(disk.own_mass[0])
    drag = float(disk_drag(1e-2, 0.005 * size, pressure, 293.0, AIR)) / 1e-2
    return {
        "slope": _digits(-stiffness * 0.5 * (_NEARER + _FARTHER) / mean),
        "frequency_hz": _digits(math.sqrt(max(stiffness, 0.0) / mass) / (2.0 * math.pi)),
        "damping_ratio": _digits(drag / (2.0 * math.sqrt(max(stiffness, 1e-12) * mass))),
    }


def all_numbers(results):
    """All estimates, for the germanium disks at 4.5 cm from walls."""
    paper = read()["lu2023"]
    at_walls = results["middle"]["walls at 4.5 cm"]["disks"]
    rods = number(paper["setting"]["rods"]).value
    found = {}
    for size in disks.DIAMETERS:
        light = at_walls[f"germanium {size} cm"]
        loss = 0.75 * light["light"] / (light["temperature"] - 293.0)
        found[f"{size} cm"] = {
            "convection": convection(light, size),
            "hovering": hovering(paper, size, float(light["light"]), light["pressure"]),
            "warmer_floor_over_weight": _digits(
                thermophoresis(293.0, LID_COOLER / LID_ABOVE_FLOOR, 0.845)
                / (1.15e-3 * STANDARD_GRAVITY)
            ),
            "light_at_10_degrees_of_tilt": _digits(tilted(paper, size, TILT)),
            "share_in_light_beside_rods": _digits(disks.lit_share(0.005 * size, rods)),
            "heat_travels_mm": _digits(
                1e3 * math.sqrt(MYLAR_CONDUCTIVITY * MYLAR_THICKNESS / loss)
            ),
            "mean_free_path_mm": _digits(1e3 * mean_free_path(light["pressure"], 293.0, AIR)),
        }
    return found


def _film(paper):
    return disks.film(paper, "germanium", middle(disks.NAMES), disks.Terms())


def _digits(value, digits=3):
    return float(f"{float(np.asarray(value)):.{digits}g}")
