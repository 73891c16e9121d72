"""Compare force models with the kinetic one: figures and numbers of docs/force-models.md.

    python studies/force_models/study.py

Writes docs/images/force-ratio.png, flight.png and results.json.
"""

import json
from pathlib import Path

import jax.numpy as jnp
import numpy as np

import lightflyer as lf
from lightflyer.core import constants
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.environment import EnvironmentState, Lu2023Atmosphere, Radiation, sunlight
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force import PRINTED, REPORTED, fit_simple_form
from lightflyer.gas import AIR, LU2023_AIR, mean_free_path
from lightflyer.kinetic_theory import solve

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
RADIUS = 0.01
COLD = 205.0  # gas in the upper mesosphere [K]
RATIOS = (1.0, 1.5, 2.0, 2.5)
LINEAR_EXCESS = 1e-4
KNUDSEN = np.geomspace(0.01, 100.0, 161)
FITTED = (0.03, 3.0)  # Knudsen numbers between which the simple form is fitted
SIZES = np.round(np.arange(0.2, 6.01, 0.2), 1) * 1e-2
ALTITUDES = np.linspace(55e3, 95e3, 401)
INCIDENCES = (0.0, 45.0)
SEED, SAMPLES = 1, 4000
AREAL_DENSITIES = 1.3e-3, 1.0e-3  # that the paper states [kg/m²]
TAC_ERROR = 0.03  # that the paper states of each

# mean free path of hard spheres, (32/5π) μ/(ρ v̄), over the one used here
HARD_SPHERES = 16.0 / (5.0 * np.pi)
# direct simulations of nitrogen: Kn of hard spheres, temperatures [K], force over its free-mol.
# value with one standard deviation, heat likewise; TACs 0.5 and 1, a reservoir at 4 radii
SIMULATIONS = (
    (3.0, 450.0, 300.0, 0.976, 0.022, 0.9827),
    (1.0, 450.0, 300.0, 0.865, 0.015, 0.9389),
    (0.1, 450.0, 300.0, 0.189, 0.017, 0.5633),
    (1.0, 480.0, 205.0, 0.906, 0.008, 0.9427),
)

PAPER, AEROSOL = lf.Lu2023(0.4, 3.0), lf.Lu2023(1.0, 1.0)
MODELS = {
    "kinetic": lf.Kinetic(),
    "Lu et al. (0.4, 3)": PAPER,
    "Lu et al. (1, 1)": AEROSOL,
    "free-molecular": lf.FreeMolecular(),
}
LOOKS = {
    "kinetic": (palette.BLUE, "-"),
    "Lu et al. (0.4, 3)": (palette.VERMILION, "-"),
    "Lu et al. (1, 1)": (palette.ORANGE, "--"),
    "free-molecular": (palette.GREY, ":"),
}
COMPARED = ("kinetic", "Lu et al. (0.4, 3)")  # in all surroundings


def paper_with_air(incidence):
    """The paper's atmosphere and light with the gas of reference data."""
    return lf.Earth(
        atmosphere=Lu2023Atmosphere(),
        gravity=constants.GRAVITY_LU2023,
        radiation=Radiation(
            constants.SOLAR_CONSTANT_LU2023,
            incidence,
            stefan_boltzmann=constants.STEFAN_BOLTZMANN_LU2023,
        ),
    )


PAPER_PLACE, AIR_ALONE, EARTH = "paper", "paper, air", "earth"
SURROUNDINGS = {
    PAPER_PLACE: lambda incidence: lf.lu2023_earth(incidence=incidence),
    AIR_ALONE: paper_with_air,
    EARTH: lambda incidence: lf.Earth(radiation=sunlight(zenith_angle=incidence)),
}
"""Surroundings by zenith angle [rad]: the paper's; with air; the package's own."""


def surroundings(knudsen):
    """Gas of the mesosphere at the pressures that give a disk of RADIUS these Knudsen numbers."""
    pressure = mean_free_path(1.0, COLD, AIR) / (2.0 * RADIUS * knudsen)
    return EnvironmentState(pressure, COLD, 9.6, AIR, Radiation())


def ratios(model, knudsen, excess):
    """Force and heat loss over their free-molecular values at Maxwell walls."""
    disk, state = lf.Disk(FILM, RADIUS), surroundings(knudsen)
    free_force = 0.5 * state.pressure * disk.area * FILM.tac_difference * (np.sqrt(1 + excess) - 1)
    (free_heat,) = lf.FreeMolecular().heat_loss(disk, state, (excess,))
    (heat,) = model.heat_loss(disk, state, (excess,))
    force = model.force(disk, state, (excess,))
    return np.asarray(force / free_force), np.asarray(heat / free_heat)


def simple_forms():
    """Coefficients of the paper's form fitted to the kinetic force, by temperature ratio."""
    state = surroundings(np.geomspace(*FITTED, 60))
    found = {}
    for name, reading in (("reported", REPORTED), ("printed", PRINTED)):
        for ratio in RATIOS[1:]:
            form = fit_simple_form(lf.Kinetic(), lf.Disk(FILM, RADIUS), state, ratio - 1.0, reading)
            found[f"{name}, T_h/T_c {ratio:g}"] = {
                "c_fm": form.model.c_fm,
                "c_cont": form.model.c_cont,
                "rms_deviation": form.deviation,
                "largest_deviation": form.largest,
            }
    return found


def draw_ratios():
    """Force and heat ratios of every model against the Knudsen number."""
    figure = plot.new_figure(columns=2, height=4.6)
    force_axes, heat_axes = figure.axes
    for ratio, shade in ((RATIOS[0], palette.SKY), (RATIOS[-1], palette.BLUE)):
        excess = max(ratio - 1.0, LINEAR_EXCESS)
        force, heat = ratios(lf.Kinetic(), KNUDSEN, excess)
        force_axes.plot(KNUDSEN, force, color=shade)
        heat_axes.plot(KNUDSEN, heat, color=shade)
    for name, colour, style in (
        ("Lu et al. (0.4, 3)", palette.VERMILION, "-"),
        ("Lu et al. (1, 1)", palette.ORANGE, "--"),
        ("free-molecular", palette.GREY, ":"),
    ):
        force, heat = ratios(MODELS[name], KNUDSEN, 1.0)
        force_axes.plot(KNUDSEN, force, color=colour, ls=style)
        if name != "Lu et al. (1, 1)":  # same heat loss
            heat_axes.plot(KNUDSEN, heat, color=colour, ls=style)
    knudsen, hot, cold, force, deviation, heat = np.transpose(SIMULATIONS)
    where = knudsen / HARD_SPHERES
    same = [
        solve(kn, 0.5, 1.0, temperature_ratio=ratio, gas="diatomic", boundary=4.0)
        for kn, ratio in zip(where, hot / cold, strict=True)
    ]
    points = {"ms": 6, "color": "black", "ls": "none"}
    force_axes.errorbar(where, force, yerr=2 * deviation, marker="o", capsize=3, **points)
    heat_axes.plot(where, heat, marker="o", **points)
    points |= {"marker": "s", "mfc": "none"}
    force_axes.plot(where, [solution.force_ratio for solution in same], **points)
    heat_axes.plot(where, [solution.heat_ratio for solution in same], **points)
    for axes, label in (
        (force_axes, "force / free-molecular"),
        (heat_axes, "heat loss / free-molecular"),
    ):
        axes.set(xscale="log", yscale="log", xlabel="Kn = λ($T_c$) / 2r", ylabel=label)
        axes.grid(alpha=0.3)
        axes.set_ylim(0.01 if axes is force_axes else 0.05, 1.5)
    for axes, where, label, colour in (
        (force_axes, (0.02, 1.02), "Lu et al. (1, 1)", palette.ORANGE),
        (force_axes, (3.0, 0.25), "Lu et al. (0.4, 3)", palette.VERMILION),
        (force_axes, (0.05, 0.013), "kinetic, $T_h/T_c$ = 1", palette.SKY),
        (force_axes, (0.05, 0.02), "kinetic, $T_h/T_c$ = 2.5", palette.BLUE),
        (
            force_axes,
            (0.22, 0.1),
            "circles: direct simulation,\nwalls at 4 r, ±2σ\nsquares: kinetic, the same",
            "black",
        ),
        (heat_axes, (0.012, 0.72), "Lu et al.", palette.VERMILION),
        (heat_axes, (0.012, 1.05), "free molecules", palette.GREY),
    ):
        axes.text(*where, label, color=colour, va="top" if colour == "black" else "baseline")
    plot.save(figure, [IMAGES / "force-ratio.png"])


def flight(model, environment):
    """Irradiance and temperature to levitate over altitude; bands [km]."""
    disk = lf.Disk(FILM, RADIUS)
    state = environment.state(ALTITUDES)
    levitation = lf.levitate(disk, state, model, throw=False)
    bands = lf.statics.levitation_bands(disk, environment, model)
    return levitation, bands


def best_payloads(model, environment):
    """Largest payload over its own mass for each size, and where [m]."""
    state = environment.state(ALTITUDES)
    best, where = [], []
    for size in SIZES:
        disk = lf.Disk(FILM, size / 2)
        relative = lf.payload(disk, state, model, throw=False) / disk.own_mass
        best.append(relative.max())
        where.append(ALTITUDES[relative.argmax()])
    return np.array(best), np.array(where)


def draw_flight():
    """Draw the paper's Figs. 6 and S8 by each model; return their numbers."""
    figure = plot.new_figure(columns=2, rows=2, width=5.6, height=8.4)
    irradiance_axes, temperature_axes, payload_axes, altitude_axes = figure.axes
    numbers = {}
    for place, surroundings in SURROUNDINGS.items():
        environment, numbers[place] = surroundings(0.0), {}
        for name, model in MODELS.items():
            if place != EARTH and name not in COMPARED:
                continue
            levitation, _ = flight(model, environment)
            irradiance = np.where(np.isfinite(levitation.irradiance), levitation.irradiance, np.nan)
            payload, altitude = best_payloads(model, environment)
            numbers[place][name] = summary(model, surroundings, irradiance, payload, altitude)
            if place == AIR_ALONE:
                continue  # between the two that are drawn
            colour, style = LOOKS[name]
            look = {"color": colour, "ls": style, "label": name}
            if place != EARTH:
                look |= {
                    "lw": 1.0,
                    "alpha": 0.7,
                    "ls": (0, (5, 2)),
                    "label": f"{name}, as the paper",
                }
            irradiance_axes.plot(ALTITUDES / 1e3, irradiance, **look)
            temperature_axes.plot(ALTITUDES / 1e3, levitation.temperature, **look)
            payload_axes.plot(SIZES * 1e2, payload, **look)
            flies = np.where(payload > 0, altitude / 1e3, np.nan)
            altitude_axes.plot(SIZES * 1e2, flies, **look)
    irradiance_axes.axhline(constants.TOTAL_SOLAR_IRRADIANCE, color="black", lw=0.8)
    irradiance_axes.set(
        yscale="log", ylim=(200, 2e4), ylabel="irradiance to levitate [W/m²]", title="2 cm"
    )
    temperature_axes.set(ylim=(200, 700), ylabel="temperature then [K]", title="2 cm")
    payload_axes.set(ylim=(-0.5, 3), ylabel="largest payload / own mass", title="in sunlight")
    payload_axes.axhline(0.0, color="black", lw=0.8)
    altitude_axes.set(ylabel="at altitude [km]", title="where it flies")
    for axes in (irradiance_axes, temperature_axes):
        axes.set_xlabel("altitude [km]")
    for axes in (payload_axes, altitude_axes):
        axes.set_xlabel("diameter [cm]")
    for axes in figure.axes:
        axes.grid(alpha=0.3)
    payload_axes.legend(fontsize=8)
    plot.save(figure, [HERE / "flight.png"])
    return numbers


def summary(model, surroundings, irradiance, payload, altitude):
    """Numbers that the figures show."""
    lifts = SIZES[payload > 0.0]
    lowest = int(np.nanargmin(irradiance))
    three = int(np.argmin(np.abs(SIZES - 0.03)))
    best_lift, best_altitude = best_lift_over_weight(model, surroundings(0.0))
    return {
        "bands_2_cm_km": {
            f"{incidence:g} deg": [
                [float(low) / 1e3, float(high) / 1e3]
                for low, high, exists in zip(bands.lower, bands.upper, bands.exists, strict=True)
                if exists
            ]
            for incidence in INCIDENCES
            for _, bands in [flight(model, surroundings(np.radians(incidence)))]
        },
        "best_lift_over_weight_2_cm": {
            "value": float(best_lift),
            "altitude_km": float(best_altitude) / 1e3,
        },
        "least_irradiance_2_cm": {
            "value_w_m2": float(irradiance[lowest]),
            "altitude_km": float(ALTITUDES[lowest]) / 1e3,
        },
        "relative_payload_3_cm": {
            "value": float(payload[three]),
            "altitude_km": float(altitude[three]) / 1e3,
        },
        "largest_that_flies_cm": float(lifts.max()) * 1e2 if lifts.size else None,
        "largest_with_own_mass_cm": float(np.max(SIZES[payload >= 1.0], initial=0.0) * 1e2),
    }


def best_lift_over_weight(model, environment, film=FILM):
    """Largest lift over weight of the 2-cm disk over altitude, and where [m]."""
    disk, state = lf.Disk(film, RADIUS), environment.state(ALTITUDES)
    found = lf.lift(disk, state, model, throw=False) / lf.statics.weight(disk, state)
    return found.max(axis=-1), ALTITUDES[found.argmax(axis=-1)]


class LinearKinetic(lf.AbstractForceModel):
    """Kinetic ratios to free molecules of a small temperature difference, at any difference."""

    flyers = (lf.Disk,)

    @lf.entry_point
    def heat_loss(self, flyer, state, unknowns):
        """See the base class."""
        (small,) = lf.Kinetic().heat_loss(flyer, state, (LINEAR_EXCESS,))
        return (small / LINEAR_EXCESS * unknowns[0],)

    @lf.entry_point
    def force(self, flyer, state, unknowns):
        """See the base class."""
        small = lf.Kinetic().force(flyer, state, (LINEAR_EXCESS,))
        growth = (jnp.sqrt(1.0 + unknowns[0]) - 1.0) / (np.sqrt(1.0 + LINEAR_EXCESS) - 1.0)
        return small * growth


def kinetic_error():
    """What the kinetic model's own errors do to the 2-cm disk over Earth."""
    rng = np.random.default_rng(SEED)
    names = ("force_error", "heat_error", "wall_error", "sharing_error")
    errors = dict(zip(names, rng.standard_normal((len(names), SAMPLES, 1)), strict=True))
    environment = SURROUNDINGS[EARTH](0.0)
    best, _ = best_lift_over_weight(lf.Kinetic(**errors), environment)
    measured, _ = best_lift_over_weight(lf.Kinetic(**errors | {"sharing_error": 0.0}), environment)
    state = environment.state(ALTITUDES)
    hot = lf.equilibrium(lf.Disk(FILM, RADIUS), state, lf.Kinetic(), throw=False).temperature
    beyond = ALTITUDES[hot / np.asarray(state.temperature) > RATIOS[-1]]
    return {
        "best_lift_over_weight_95": np.quantile(best, (0.025, 0.975)).tolist(),
        "share_that_flies": float(np.mean(best >= 1.0)),
        "best_lift_over_weight_95_if_shared_evenly": np.quantile(measured, (0.025, 0.975)).tolist(),
        "linear_theory_best_lift_over_weight": float(
            best_lift_over_weight(LinearKinetic(), environment)[0]
        ),
        "table_ends_at_km": float(beyond.min()) / 1e3 if beyond.size else None,
    }


def unknowns():
    """Largest lift over weight of the 2-cm disk over Earth at both ends of each unknown."""
    environment = SURROUNDINGS[EARTH](0.0)

    def best(areal_density=1e-3, top=0.8, bottom=0.9, **model):
        film = lf.FilmProperties(areal_density, 0.75, 0.08, 0.08, tac_top=top, tac_bottom=bottom)
        return float(best_lift_over_weight(lf.Kinetic(**model), environment, film)[0])

    bounds = -NORMAL_HALF_WIDTH_95, NORMAL_HALF_WIDTH_95
    walls = ("accommodated", "maxwell")
    of_errors = {
        name: [best(**{name: bound}) for bound in bounds]
        for name in ("sharing_error", "wall_error", "force_error", "heat_error")
    }
    return {
        "as stated": best(),
        "walls": {wall: best(wall=wall) for wall in walls},
        "areal density": [best(areal_density=density) for density in AREAL_DENSITIES],
        "TAC of one face": [best(bottom=0.9 + change) for change in (-TAC_ERROR, TAC_ERROR)],
        **of_errors,
    }


def main():
    """Write figures and numbers."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    draw_ratios()
    results = {
        "viscosity_of_paper_over_air_at_205_k": float(
            LU2023_AIR.viscosity(COLD) / AIR.viscosity(COLD)
        ),
        "simple_forms": simple_forms(),
        "flight": draw_flight(),
        "kinetic_error": kinetic_error(),
        "unknowns": unknowns(),
    }
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
