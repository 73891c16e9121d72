"""The best film for a payload among the library's materials: see README.md."""

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
NANOMETRE, MILLIGRAM, KILOMETRE = 1e-9, 1e-6, 1e3
ALTITUDES_KM = (80, 75, 85)
MAIN_KM = 80
POLICIES = ("error", "lossless", "hold")
SHOWN = 6
LABELLED = {palette.BLUE: (71.0, 0.13), palette.ORANGE: (84.2, 0.108), palette.GREEN: (77.0, -0.21)}
PENALTY = 10.0  # [mg] for a film twice as hot as allowed
ASKED = tomllib.loads((HERE / "study.toml").read_text(encoding="utf-8"))["optimise"]
FLYER = tomllib.loads((HERE / "flyer.toml").read_text(encoding="utf-8"))
HOTTEST = float(ASKED["constraints"]["temperature"]["at_most"].removesuffix(" K"))
NOMINAL = (("Al2O3", 50.0), ("Ge", 20.0), ("PET", 500.0), ("Ge", 20.0))  # of Lu et al. (2023)


def flyer_with(layers, policy="error", model=None):
    """The flyer with other layers: names and thicknesses in nanometres, top to bottom."""
    entries = [{"material": name, "thickness": f"{size!r} nm"} for name, size in layers]
    film = {"layers": entries, "extrapolation": policy}
    force = {"force": {"model": model}} if model else {}
    return lf.FlyerFile(**(FLYER | {"film": film} | force))


def payload(setup, altitude_km):
    """Payload of a flyer at an altitude [mg]."""
    state = setup.environment.state(altitude_km * KILOMETRE)
    return float(lf.payload(setup.flyer, state, setup.model)) / MILLIGRAM


def search(altitude_km, policy):
    """The best stack at an altitude, with a policy for optical data that end."""
    flyer = flyer_with([("PET", 500.0), ("Ge", 12.0)], policy)
    return lf.optimise(
        flyer,
        maximise="payload",
        over={"altitude": f"{altitude_km} km"},
        constraints=ASKED["constraints"],
        stacks=ASKED["stacks"],
    )


def layers_of(stack):
    """Names and thicknesses in nanometres."""
    return list(zip(stack.materials, (stack.thickness / NANOMETRE).tolist(), strict=True))


def bounds(layers, altitude_km):
    """Payload where missing optical data let the film absorb nothing or everything [mg]."""
    design = flyer_with(layers).design()
    found = {}
    for name, ends in design.data_bounds().items():
        pair = [payload(design.build({}, {"film": end["film"]}), altitude_km) for end in ends]
        found[name.removeprefix("film.")] = sorted(round(value, 4) for value in pair)
    return found


def by_differential_evolution(layers, altitude_km):
    """The coatings' thicknesses by SciPy, with films on the full grids and no gradient.

    The carrier, which comes first, stays as it is.
    """
    asked = {one["material"]: one for one in ASKED["stacks"]["materials"]}
    carrier, *coatings = layers
    names = [name for name, _ in coatings]
    ends = [[float(asked[name][end].removesuffix(" nm")) for end in ("from", "to")]
            for name in names]  # fmt: skip

    def loss(logs):
        sizes = zip(names, np.exp(logs).tolist(), strict=True)
        setup = flyer_with([carrier, *sizes]).build()
        state = setup.environment.state(altitude_km * KILOMETRE)
        excess = float(lf.equilibrium(setup.flyer, state, setup.model).temperature) / HOTTEST - 1.0
        return -payload(setup, altitude_km) + PENALTY * max(excess, 0.0)

    found = differential_evolution(
        loss, np.log(ends), maxiter=40, popsize=5, rng=1, polish=False, tol=0.0, atol=1e-5
    )
    return -float(found.fun), np.exp(found.x).tolist(), int(found.nfev)


def by_tmm(layers):
    """Largest difference of the stack's absorptance from that of tmm (Byrnes 2016) [1]."""
    import tmm

    film = flyer_with(layers).film.film()
    wavelengths, worst = np.array([0.45, 0.6, 0.9, 2.0, 8.0, 14.0]) * 1e-6, 0.0
    for angle in (0.0, 0.6, 1.2):
        ours = film.optics(wavelengths, angle).polarisation_mean()
        n, k = film.index(wavelengths)
        for number, wavelength in enumerate(wavelengths):
            index = [1.0, *(n[:, number] + 1j * k[:, number]), 1.0]
            thickness = [np.inf, *film.thickness, np.inf]
            both = tmm.unpolarized_RT(index, thickness, angle, wavelength)
            theirs = 1.0 - both["R"] - both["T"]
            worst = max(worst, abs(float(ours.absorptance[number]) - theirs))
    return worst


def at_altitude(altitude_km):
    """What the best films at an altitude are, and what they carry."""
    best = search(altitude_km, "error")
    ranking = best.ranking
    germanium = next(one for one in ranking.stacks if one.materials == ("PET", "Ge"))
    made = best.as_made
    names = [
        f"film.layers.{number}.thickness" for number in range(len(ranking.stacks[0].materials))
    ]
    return best, {
        "stacks": ranking.allowed,
        "best": [(name, round(size, 3)) for name, size in layers_of(ranking.stacks[0])],
        "best_mg": round(best.value / MILLIGRAM, 5),
        "germanium_on_mylar": [(name, round(size, 3)) for name, size in layers_of(germanium)],
        "germanium_on_mylar_mg": round(germanium.value / MILLIGRAM, 5),
        "nominal_film_mg": round(payload(flyer_with(NOMINAL).build(), altitude_km), 5),
        "temperature_k": round(best.outputs["temperature"], 1),
        "one_sigma_mg": {
            name: [round(made.effects[name].less / MILLIGRAM, 5),
                   round(made.effects[name].more / MILLIGRAM, 5)]
            for name in names
        },
        "made_mean_mg": round(made.mean / MILLIGRAM, 5),
        "made_95_percent_above_mg": round(made.low / MILLIGRAM, 5),
    }  # fmt: skip


def draw(results, path):
    """Payload of the best stacks, with bounds, and of three films over altitude."""
    figure = plot.new_figure(rows=2, height=7.6)
    bars, curves = figure.axes
    shown = results["ranking"][::-1]
    rows = np.arange(len(shown))
    values = np.array([entry["mg"] for entry in shown])
    bars.barh(rows, values, color=palette.BLUE, label="computed")
    for row, entry in zip(rows, shown, strict=True):
        low, high = entry["bounds_mg"]["emittance_without_data"]
        (line,) = bars.plot([low, high], [row, row], color="black", lw=1.2, marker="|")
    line.set_label("where missing infrared data let the film\nabsorb everything or nothing")
    words = [", ".join(f"{name} {size:.0f}" for name, size in entry["layers"]) for entry in shown]
    bars.set_yticks(rows, words)
    bars.set_title("layers from top to bottom, thickness in nm", fontsize="medium")
    bars.axvline(0.0, color=palette.GREY, lw=1.0)
    bars.set_xlabel(f"payload at {MAIN_KM} km [mg]")
    plot.legend_below(bars, most=2)
    altitude = np.linspace(70.0, 95.0, 101)
    main = results[f"at_{MAIN_KM}_km"]
    films = {
        f"best film for {MAIN_KM} km": (main["best"], palette.BLUE),
        "germanium on mylar,\nbest thickness": (main["germanium_on_mylar"], palette.ORANGE),
        "nominal film of\nLu et al. (2023)": (NOMINAL, palette.GREEN),
    }
    for label, (layers, colour) in films.items():
        setup = flyer_with(layers).build()
        state = setup.environment.state(altitude * KILOMETRE)
        carried = np.asarray(lf.payload(setup.flyer, state, setup.model)) / MILLIGRAM
        hot = np.asarray(lf.equilibrium(setup.flyer, state, setup.model).temperature) > HOTTEST
        curves.plot(altitude, carried, color=colour, lw=1.0, ls=":")
        curves.plot(altitude, np.where(hot, np.nan, carried), color=colour)
        curves.text(*LABELLED[colour], label, color=colour)
    curves.plot([], [], color=palette.GREY, lw=1.0, ls=":", label=f"hotter than {HOTTEST:g} K")
    curves.axhline(0.0, color=palette.GREY, lw=1.0)
    curves.set(xlabel="altitude [km]", ylabel="payload [mg]", ylim=(-0.25, 0.16))
    plot.legend_below(curves, most=1)
    plot.save(figure, [path])


def main():
    """Search, verify, draw, write the numbers; with ``draw`` only the figure anew."""
    file = HERE / "results.json"
    if sys.argv[1:] == ["draw"]:
        draw(json.loads(file.read_text(encoding="utf-8")), HERE / "payload.png")
        return
    results = {}
    for altitude_km in ALTITUDES_KM:
        best, found = at_altitude(altitude_km)
        results[f"at_{altitude_km}_km"] = found
        print(altitude_km, found, flush=True)
        if altitude_km == MAIN_KM:
            ranking = best.ranking.stacks
    results["ranking"] = [
        {
            "layers": [(name, round(size, 2)) for name, size in layers_of(stack)],
            "mg": round(stack.value / MILLIGRAM, 5),
            "bounds_mg": bounds(layers_of(stack), MAIN_KM),
        }
        for stack in ranking[:SHOWN]
    ]
    winner = layers_of(ranking[0])
    value, sizes, films = by_differential_evolution(winner, MAIN_KM)
    results["differential_evolution"] = {
        "mg": round(value, 5), "nm": [round(one, 2) for one in sizes], "films": films
    }  # fmt: skip
    results["largest_difference_from_tmm"] = float(f"{by_tmm(winner):.1e}")
    results["by_lu2023_mg"] = {
        word: round(payload(flyer_with(layers, model="lu2023").build(), MAIN_KM), 5)
        for word, layers in (
            ("best", winner),
            ("germanium_on_mylar", results[f"at_{MAIN_KM}_km"]["germanium_on_mylar"]),
        )
    }
    for policy in POLICIES[1:]:
        other = search(MAIN_KM, policy)
        stack = other.ranking.stacks[0]
        germanium = next(one for one in other.ranking.stacks if one.materials == ("PET", "Ge"))
        results[f"data_{policy}"] = {
            "best": [(name, round(size, 2)) for name, size in layers_of(stack)],
            "best_mg": round(stack.value / MILLIGRAM, 5),
            "germanium_on_mylar_mg": round(germanium.value / MILLIGRAM, 5),
        }
    file.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    draw(results, HERE / "payload.png")


if __name__ == "__main__":
    main()
