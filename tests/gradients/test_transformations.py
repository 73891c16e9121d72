"""Every public numeric function under jit, vmap and grad of a script in JAX's single precision.

A script that knows nothing of double precision must get the same numbers, rounded.
"""

import importlib
import inspect

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.environment.horizon import (
    facing_share,
    ground_view_factor,
    horizon_depression,
    lit_ground,
    visible_share,
)
from lightflyer.environment.light.mars import solar_longitude, sun_from_mars
from lightflyer.environment.light.sun import sun_from_earth, sun_in_sky
from lightflyer.environment.mars import season_irradiance
from lightflyer.environment.wind.gradient import balanced_rotation
from lightflyer.film.media import compound
from lightflyer.film.media.dispersion import CodyLorentz, Drude, Gaussian, Lorentz, TaucLorentz

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
STATE = lf.Earth().state(72e3)
CURVE = lf.film.EmittanceCurve.through(np.linspace(0.05, 0.09, lf.film.optics.curve.NODES))
GASES = {
    "AbstractReferenceGas": lf.gas.AIR,
    "Lu2023Air": lf.gas.LU2023_AIR,
    "US1976Air": lf.gas.US1976_AIR,
    "CarbonDioxide": lf.gas.CARBON_DIOXIDE,
}
MODELS = {
    "FreeMolecular": lf.FreeMolecular(),
    "LinearFreeMolecular": lf.force.LinearFreeMolecular(),
    "Lu2023": lf.Lu2023(),
    "Kinetic": lf.Kinetic(),
}
ATMOSPHERES = {
    "US1976": lf.environment.US1976(),
    "Lu2023Atmosphere": lf.environment.Lu2023Atmosphere(),
    "MarsAtmosphere": lf.environment.MarsAtmosphere(),
}


def disk(radius):
    return lf.Disk(FILM, 0.01 * radius)


def sandwich(radius):
    top = lf.FilmProperties(3e-4, 0.02, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
    return lf.Sandwich(top, FILM, 0.01 * radius, 1e-4, 0.5, 5e-5, 1e-4, 1.8)


# a function of a number near one for each public function or method
CASES = {
    "statics.equilibrium": lambda x: lf.equilibrium(disk(x), STATE, lf.Lu2023()).temperature,
    "statics.lift": lambda x: lf.lift(disk(x), STATE, lf.Lu2023()),
    "statics.force_vector": lambda x: lf.statics.force_vector(disk(x), STATE, lf.Lu2023())[2],
    "statics.payload": lambda x: lf.payload(disk(x), STATE, lf.Lu2023()),
    "statics.weight": lambda x: lf.statics.weight(disk(x), STATE),
    "statics.levitate": lambda x: lf.levitate(disk(x), STATE, lf.Lu2023()).irradiance,
    "statics.sinking_speed": lambda x: lf.statics.sinking_speed(disk(x), STATE),
    "statics.levitation_band": lambda x: (
        lf.levitation_band(disk(x), lf.Chamber(), lf.Lu2023()).upper
    ),
    "environment.season_irradiance": lambda x: season_irradiance(1.2 * x),
    "environment.solar_longitude": lambda x: solar_longitude(2e8 * x),
    "environment.sun_from_mars": lambda x: sun_from_mars(1e4 * x).direction[0],
    "environment.ground_view_factor": lambda x: ground_view_factor(1.5 * x, 0.97),
    "environment.visible_share": lambda x: visible_share(0.002 * x, 0.0047),
    "environment.facing_share": lambda x: facing_share(0.002 * x, 0.0047),
    "environment.lit_ground": lambda x: lit_ground(1.55 * x, 0.978),
    "environment.horizon_depression": lambda x: horizon_depression(
        lf.environment.EARTH_LIMB, 75e3 * x, 6.371e6
    ),
    "environment.sun_from_earth": lambda x: sun_from_earth(1e4 * x).direction[0],
    "environment.sun_in_sky": lambda x: sun_in_sky(sun_from_earth(1e4), 0.7 * x, 0.2).zenith_angle,
    "environment.balanced_rotation": lambda x: balanced_rotation(1e-9 * x, 0.7, 7.3e-5),
    "environment.Dust.depth_above": lambda x: lf.environment.Dust().depth_above(0.5 * x),
    "environment.Planet.curvature_radius": lambda x: lf.environment.EARTH_PLANET.curvature_radius(
        0.7 * x, 0.3
    ),
    "film.stack_optics": lambda x: lf.film.stack_optics(
        np.array([3.5]), np.array([0.1]), x * np.array([5e-8]), 5e-7
    ).transmittance[0],
    "film.EmittanceCurve.__call__": lambda x: CURVE(300.0 * x),
    "film.EmittanceCurve.growth": lambda x: CURVE.growth(300.0, 0.1 * x),
    "gas.mean_free_path": lambda x: lf.gas.mean_free_path(3.0 * x, 230.0, lf.gas.AIR),
    "gas.knudsen_number": lambda x: lf.gas.knudsen_number(3.0 * x, 230.0, 0.01, lf.gas.AIR),
    "gas.AbstractGas.density": lambda x: lf.gas.AIR.density(3.0, 230.0 * x),
    "gas.AbstractGas.mean_speed": lambda x: lf.gas.AIR.mean_speed(230.0 * x),
    "gas.AbstractGas.viscosity_exponent": lambda x: lf.gas.NITROGEN.viscosity_exponent(300.0 * x),
    "gas.AbstractGas.prandtl_number": lambda x: lf.gas.NITROGEN.prandtl_number(300.0 * x),
    "gas.AbstractGas.reduced_conductivity": lambda x: lf.gas.AIR.reduced_conductivity(300.0 * x),
    "gas.AbstractGas.eucken_factor": lambda x: lf.gas.NITROGEN.eucken_factor(300.0 * x),
    "gas.AbstractGas.internal_degrees_of_freedom": lambda x: (
        lf.gas.CARBON_DIOXIDE.internal_degrees_of_freedom(300.0 * x)
    ),
    "gas.AbstractGas.rotational_collision_number": lambda x: lf.gas.AIR.rotational_collision_number(
        300.0 * x
    ),
    "gas.Parker.__call__": lambda x: lf.gas.Parker(18.1, 91.5)(300.0 * x),
    "gas.vhs_collision_rate": lambda x: lf.gas.vhs_collision_rate(0.7 * x),
    "force.Schafer2025.heat_loss": lambda x: lf.Schafer2025().heat_loss(
        sandwich(x), STATE, (0.2, 0.4)
    )[1],
    "force.Schafer2025.force": lambda x: lf.Schafer2025().force(sandwich(x), STATE, (0.2, 0.4)),
}
for name, gas in GASES.items():
    for law in ("viscosity", "viscosity_exponent", "conductivity", "heat_capacity"):
        CASES[f"gas.{name}.{law}"] = lambda x, gas=gas, law=law: getattr(gas, law)(230.0 * x)
CASES["gas.CarbonDioxide.heat_capacity_ratio_at"] = lambda x: (
    lf.gas.CARBON_DIOXIDE.heat_capacity_ratio_at(230.0 * x)
)
for name, model in MODELS.items():
    CASES[f"force.{name}.heat_loss"] = lambda x, model=model: model.heat_loss(
        disk(x), STATE, (0.4,)
    )[0]
    CASES[f"force.{name}.force"] = lambda x, model=model: model.force(disk(x), STATE, (0.4,))
for name, atmosphere in ATMOSPHERES.items():
    for law in ("pressure", "temperature", "molar_mass_ratio", "density", "viscosity",
                "mean_free_path"):  # fmt: skip
        if hasattr(atmosphere, law):
            CASES[f"environment.{name}.{law}"] = lambda x, atmosphere=atmosphere, law=law: getattr(
                atmosphere, law
            )(73e3 * x)  # between the knots of every table

_EV = 1.602176634e-19
CASES["film.TaucLorentz.permittivity"] = lambda x: TaucLorentz(
    122.0 * _EV, 3.45 * x * _EV, 2.54 * _EV, 1.2 * _EV
).permittivity(2.2 * _EV)[0]
CASES["film.Lorentz.permittivity"] = lambda x: Lorentz(1.5, 2.0 * x * _EV, 0.3 * _EV).permittivity(
    1.8 * _EV
)[1]
CASES["film.Drude.permittivity"] = lambda x: Drude(9.0 * _EV, 0.1 * _EV).permittivity(
    0.2 * x * _EV
)[1]
CASES["film.Gaussian.permittivity"] = lambda x: Gaussian(
    0.8, 0.12 * x * _EV, 0.03 * _EV
).permittivity(0.11 * _EV)[0]
CASES["film.CodyLorentz.permittivity"] = lambda x: CodyLorentz(
    80.0 * _EV, 3.5 * _EV, 2.3 * x * _EV, 1.1 * _EV, 0.9 * _EV
).permittivity(2.2 * _EV)[0]
for name in ("bruggeman", "maxwell_garnett", "parallel", "series"):
    CASES[f"film.{name}"] = lambda x, name=name: getattr(compound, name)(
        np.array([1.0, 2.5]) * x, np.array([0.1, 0.3]), np.array([0.4, 0.6])
    )[0]

ELSEWHERE = {
    "environment.Daylight": "tests/environment/test_sky.py",
    "environment.GlobalNRLMSIS": "tests/environment/test_global_nrlmsis.py",
    "environment.TabulatedSun": "an argument of what is traced; tests/environment/test_sun.py",
    "environment.NRLMSIS": "needs pymsis, is not traced; tests/environment",
    "statics.outputs_of": "a list",
    "statics.in_the_dark": "takes the light away; sinking_speed uses it",
    "statics.settling_time": "a number, not traced; tests/statics/test_sinking.py",
    "statics.steady_speed": "takes a function, in the caller's precision; sinking_speed uses it",
    "statics.levitation_bands": "levitation_band is one of them",
    "environment.sphere_view_factor": "tests/environment",
    "force.BalloonConvection": "tests/force/test_balloon_model.py",
    "force.Celenza2023": "tests/force/test_hollow.py",
    "force.ChannelPump": "tests/force/test_channel_pump.py",
    "force.FreeMolecularSphere": "tests/force/test_spheres.py",
    "force.HollowPump": "tests/force/test_hollow.py",
    "force.KineticSphere": "tests/force/test_spheres.py",
    "force.Rohatschek1995": "tests/force/test_spheres.py",
}
ROOMS = ["environment", "film", "statics", "flyer", "force", "gas"]


def public_numeric_names():
    """Entry points of the rooms of physics, and the functions of flight that wrap one."""
    for room in ROOMS:
        package = importlib.import_module(f"lightflyer.{room}")
        for name in package.__all__:
            found = getattr(package, name)
            if inspect.isclass(found):
                for inner, method in [*vars(found).items()]:  # Pydantic adds more when asked
                    if hasattr(method, "is_entry_point"):
                        yield f"{room}.{name}.{inner}"
            elif hasattr(found, "is_entry_point") or (
                room == "statics" and inspect.isfunction(found)
            ):
                yield f"{room}.{name}"


def test_every_public_numeric_function_has_a_case():
    missing = [
        name
        for name in public_numeric_names()
        if name not in CASES and not any(name.startswith(known) for known in ELSEWHERE)
    ]
    assert not missing


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_transformations_in_single_precision(name):
    function, points = CASES[name], np.array([0.95, 1.0])
    plain = np.array([float(function(point)) for point in points])
    values, slopes = jax.jit(jax.vmap(jax.value_and_grad(function)))(points)
    np.testing.assert_allclose(values, plain, rtol=1e-5)
    np.testing.assert_allclose(slopes[1], difference(function), rtol=1e-4, atol=1e-9 * plain[1])


def difference(function):
    step = 1e-4
    return float(function(1.0 + step) - function(1.0 - step)) / (2.0 * step)


@pytest.mark.parametrize(
    "name",
    ["gas.Parker.__call__", "environment.visible_share", "film.stack_optics",
     "force.FreeMolecular.force", "statics.weight"],
)  # fmt: skip
def test_derivatives_in_double_precision_and_outside_jit(name, compiled):
    function = CASES[name]
    forward = compiled(lambda x: jax.jvp(function, (x,), (jax.numpy.ones_like(x),)))
    with lf.float64():
        value, slope = forward(1.0)
    np.testing.assert_allclose(value, function(1.0), rtol=1e-12)
    np.testing.assert_allclose(slope, difference(function), rtol=1e-6)
    np.testing.assert_allclose(jax.grad(function)(1.0), slope, rtol=1e-5)
