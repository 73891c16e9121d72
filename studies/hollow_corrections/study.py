"""What each correction does to the published force of hollow bodies: see README.md."""

import json
import sys
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.core import constants
from lightflyer.environment import EnvironmentState, Lu2023Atmosphere, Radiation
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.pumps import celenza2023_laws as published
from lightflyer.force.pumps.hollow_flow import Corrections

HERE = Path(__file__).parent
FORMS = ("cone", "sphere", "rocket")
ALTITUDES = np.array([50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0])  # [km]
SIZE = 0.1  # [m]
GRAVITY = 9.8  # of the published code [m/s²]
MILLIGRAM, GRAM = 1e-6, 1e-3
OFF = dict.fromkeys(Corrections._fields, False)


def surroundings(altitudes_km):
    """The published ones: a polynomial atmosphere, light that grows with altitude, nothing else."""
    atmosphere, altitude = Lu2023Atmosphere(), np.asarray(altitudes_km) * 1e3
    exponent = (9.81 / 287.0) / (constants.GRAVITY_LU2023
                                 / constants.GAS_CONSTANT_LU2023)  # fmt: skip
    ratio = atmosphere.pressure(altitude) / constants.SEA_LEVEL_PRESSURE
    return EnvironmentState(
        101300.0 * ratio**exponent,
        atmosphere.temperature(altitude),
        GRAVITY,
        lf.gas.AIR,
        Radiation(1000.0 + 3.8 * np.asarray(altitudes_km)),
    )


def make(form, size, outlet, width, thickness, open_fraction=0.5, **faces):
    """A body with the published wall: emissive and clear outside, dark and selective within."""
    faces = {"absorptance": 0.9, "outside": 0.8, "inside": 0.08, "tac": 0.9, **faces}
    share = 0.5 * published.FACE_DENSITY
    tac = (faces["tac"], faces["tac"])
    outer = lf.FilmProperties(share, 0.0, faces["outside"], 0.08, *tac, transmittance=1.0)
    inner = lf.FilmProperties(share, faces["absorptance"], 0.08, faces["inside"], *tac)
    return lf.HollowBody(
        outer, inner, size, outlet, open_fraction, width, thickness, 50e-9,
        published.SHEET_CONDUCTIVITY, form, sheet_density=published.SHEET_DENSITY,
    )  # fmt: skip


def force_of(body, state, model):
    """Force and temperatures in balance."""
    found = lf.equilibrium(body, state, model)
    with lf.float64():
        return np.asarray(model.force(body, state, found.unknowns)), found.temperatures


def best_as_published(form):
    """The bodies that lift most as published, with channels as long as wide, the widest allowed."""
    width, outlet = np.meshgrid(
        np.geomspace(1e-5, 5e-3, 120), SIZE * np.geomspace(1 / 20, 1 / 2.011, 150)
    )
    fits = 10.0 * width < 1.9 * outlet  # ten times as long as wide, and within a rocket
    width, outlet = width[fits], outlet[fits]
    bodies, state = make(form, SIZE, outlet, width, width), surroundings(ALTITUDES[:, None])
    force, _ = force_of(bodies, state, lf.Celenza2023())
    with lf.float64():
        spare = force / GRAVITY - np.asarray(bodies.own_mass)
    best = np.argmax(spare, axis=1)
    return width[best], outlet[best], np.take_along_axis(spare, best[:, None], 1)[:, 0]


def corrected(form):
    """Force over published as one correction after the other is switched on."""
    width, outlet, spare = best_as_published(form)
    body, state = make(form, SIZE, outlet, width, width), surroundings(ALTITUDES)
    first, _ = force_of(body, state, lf.Celenza2023())
    ratios, on = [np.ones_like(first)], {}
    for name in Corrections._fields:
        on[name] = True
        force, temperatures = force_of(body, state, lf.HollowPump(**(OFF | on)))
        ratios.append(force / first)
    with lf.float64():
        weight = np.asarray(body.own_mass) * GRAVITY
    return {
        "channel_width_um": rounded(width * 1e6),
        "outlet_radius_mm": rounded(outlet * 1e3),
        "published_payload_mg": rounded(spare / MILLIGRAM),
        "published_lift_over_weight": rounded(first / weight),
        "corrected_lift_over_weight": rounded(
            np.asarray(lf.lift(body, state, lf.HollowPump())) / weight
        ),
        "temperature_inner_k": rounded(temperatures[0]),
        "temperature_outer_k": rounded(temperatures[1]),
        "force_over_published": dict(
            zip(("none", *Corrections._fields), map(rounded, ratios), strict=True)
        ),
    }


def germanium():
    """Force with germanium within over that of grey films, by the emittances (inside, outside).

    Germanium absorbs 0.75 of sunlight and emits 0.08, nanotubes 0.75 and 0.48 [Lu2023].
    """
    state, model = surroundings(ALTITUDES), lf.HollowPump()
    width, outlet, _ = best_as_published("sphere")

    def force(inside, outside):
        body = make("sphere", SIZE, outlet, width, width, absorptance=0.75, inside=inside,
                    outside=outside)  # fmt: skip
        return force_of(body, state, model)[0]

    grey = force(0.48, 0.48)
    pairs = ((0.08, 0.08), (0.08, 0.48), (0.48, 0.8), (0.08, 0.8))
    return {f"{inside}, {outside}": rounded(force(inside, outside) / grey)
            for inside, outside in pairs}  # fmt: skip


def again(size, altitude, light_sheets):
    """The payload of a sphere that is optimised with all corrections."""
    body = make("sphere", size, 0.3 * size, 1e-3, 1e-3)
    if light_sheets:
        body = tree.replace_at(lambda body: body.sheet_density, body, 1.0)
    state = surroundings(altitude)
    chamber = lf.Chamber(
        temperature=float(state.temperature), gravity=GRAVITY, radiation=state.radiation
    )
    best = lf.optimise(
        body, chamber, lf.HollowPump(), maximise="payload",
        over={
            "flyer.outlet_radius": {"from": f"{0.05 * size} m", "to": f"{0.475 * size} m"},
            "flyer.open_fraction": {"from": 0.1, "to": 0.9},
            "flyer.channel_width": {"from": "20 um", "to": "4 mm", "scale": "log"},
            "flyer.wall_thickness": {"from": "10 um", "to": "10 mm", "scale": "log"},
            "pressure": f"{float(state.pressure)} Pa",
        },
        starts=2,
        beyond_range=True,
    )  # fmt: skip
    return {
        "payload_mg": float(f"{best.value / MILLIGRAM:.3g}"),
        **{name: float(f"{value:.3g}") for name, value in best.design.items()},
    }


def rounded(values):
    """Three digits of each."""
    return [float(f"{value:.3g}") for value in np.asarray(values)]


def draw(found, path):
    """Force over published at the highest altitude, correction by correction."""
    figure = plot.new_figure(columns=1, rows=1, height=5.0)
    (ax,) = figure.axes
    names = list(found["sphere"]["force_over_published"])
    for form, colour in zip(FORMS, (palette.BLUE, palette.VERMILION, palette.GREEN), strict=True):
        line = [found[form]["force_over_published"][name][-1] for name in names]
        ax.plot(line, marker="o", color=colour)
        ax.annotate(form, (len(names) - 1, line[-1]), (8, 0), textcoords="offset points",
                    va="center", color=colour)  # fmt: skip
    labels = ["as published", *(f"({n}) {name.replace('_', ' ')}"
              for n, name in enumerate(names[1:], 1))]  # fmt: skip
    ax.set_xticks(range(len(names)), labels, rotation=35, ha="right")
    ax.set_yscale("log")
    ax.set_ylabel(f"force over published, {ALTITUDES[-1]:g} km")
    ax.set_xlim(-0.7, len(names) + 0.5)
    plot.save(figure, [path])


PARTS = {
    "at_the_published_optimum": lambda: {form: corrected(form) for form in FORMS},
    "force_over_that_of_0.48_inside_and_outside": germanium,
    "optimised_again_at_80_km": lambda: {
        f"{size:g} m, {'films alone' if light else 'with sheets'}": again(size, 80.0, light)
        for size in (0.1, 10.0)
        for light in (True, False)
    },
}


def main(names):
    """Compute some parts, all by default; write and draw."""
    path = HERE / "results.json"
    results = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    results["altitudes_km"] = ALTITUDES.tolist()
    for name in names or PARTS:
        results[name] = PARTS[name]()
        path.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    draw(results["at_the_published_optimum"], HERE / "corrections.png")


if __name__ == "__main__":
    main(sys.argv[1:])
