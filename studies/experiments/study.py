"""Published experiments with light-flyers beside what the package predicts, nothing refitted.

    python studies/experiments/study.py          # three minutes on one core

Writes results.json and docs/images/experiments.png. `--table` prints tables in Markdown.
"""

import argparse
import json
from pathlib import Path

import disks
import estimates
import figure
import numpy as np
import others
from disks import DIAMETERS, FILMS, NAMES, Terms
from measurements import interval, middle, number, read, shares

import lightflyer as lf

RESULTS = Path(__file__).parent / "results.json"

SURROUNDINGS = {
    "open space": {},
    "walls at 15 cm": {"radius": 0.15},
    "walls at 6 cm": {"radius": 0.06},
    "walls at 4.5 cm": {"radius": 0.045},
    "floor at 4.5 cm, else 15 cm": {"floor": 0.045, "lid": 0.15, "radius": 0.15},
    "floor at 4.5 cm, else 10 cm": {"floor": 0.045, "lid": 0.10, "radius": 0.10},
    "floor at 4.5 cm, else 7 cm": {"floor": 0.045, "lid": 0.07, "radius": 0.07},
}
"""What :class:`lightflyer.Chamber` is told of walls.

`radius` alone is that of a reservoir all round; with a floor all surfaces are solid.
"""

ACRYLIC_RETURNS = 2.0 * (0.49 / 2.49) ** 2  # both surfaces of a sheet of index 1.49, Fresnel
WARMER = 20.0  # [K], guessed
RODS = 2.4e-3  # [m]
# of the stated layers under a white lamp, germanium over alumina lit: docs/film-comparison.md
LIT_FROM_BELOW = 0.466 / 0.721
BOUND_OF_SPECTRUM = 0.11 / 0.08  # emittance by FTIR over that of the thermal camera, Lu et al.
TERMS = {
    "as it is": Terms(),
    "collisions of the model equation": Terms(model={"collisions": "shakhov"}),
    "Maxwell's walls": Terms(model={"wall": "maxwell"}),
    "accommodated walls": Terms(model={"wall": "accommodated"}),
    "1.0 g/m²": Terms(areal_density=1.0e-3),
    "1.3 g/m²": Terms(areal_density=1.3e-3),
    "TACs divided by 1.08": Terms(tac_scale=1.0 / 1.08),
    "nanotubes' faces 0.25 apart": Terms(nanotubes_apart=0.25),
    "nanotubes' faces 0.29 apart": Terms(nanotubes_apart=0.29),
    "a lid of acrylic returns light": Terms(reflected=ACRYLIC_RETURNS),
    "20 K warmer below": Terms(warmer_below=WARMER),
    "20 K warmer on all sides": Terms(warmer_around=WARMER),
    "floor 10 K warmer than the rest": Terms(warmer_floor=0.5 * WARMER),
    "floor 20 K warmer than the rest": Terms(warmer_floor=WARMER),
    "germanium's emittance at its bound": Terms(germanium={"emittance": BOUND_OF_SPECTRUM}),
    "germanium lit from below absorbs less": Terms(germanium={"absorptance": LIT_FROM_BELOW}),
    "film over the rods in the dark": Terms(rods=RODS),
    "both": Terms(germanium={"absorptance": LIT_FROM_BELOW}, rods=RODS),
    "both, and 20 K warmer on all sides": Terms(
        germanium={"absorptance": LIT_FROM_BELOW}, rods=RODS, warmer_around=WARMER
    ),
    "both, and the floor 20 K warmer than the rest": Terms(
        germanium={"absorptance": LIT_FROM_BELOW}, rods=RODS, warmer_floor=WARMER
    ),
}
"""One change each; their effect on the middle of all samples."""

BANDS = {
    "": Terms(),
    ", TAC ± 0.05": Terms(tac_uncertainty=0.05),
    ", differences of TACs as published": Terms(tac_together=True),
    ", lift-off repeats to 2 %": Terms(),
    ", germanium lit from below, film over the rods in the dark": TERMS["both"],
}
"""Other uncertainties and terms; their effect on the intervals."""

STEADY, STEADY_LIFT_OFF = ", lift-off repeats to 2 %", 0.02

KNOWN = ("germanium 2 cm", "nanotubes 2 cm", "reduction 2 cm")
"""What is no test of a prediction that knows the 2-cm disks."""

FITTED_WITH = {"tac_top": 0.8, "tac_bottom": 0.9}

NEAR_AND_FAR = ("open space", "walls at 4.5 cm", "floor at 4.5 cm, else 10 cm")


def with_walls(terms, surroundings):
    """Terms in some surroundings."""
    return Terms(**(vars(terms) | {"chamber": SURROUNDINGS[surroundings]}))


def at_the_middle(paper, terms):
    """The least light of each disk and what germanium saves, for the middle of all samples."""
    found = disks.predict(paper, middle(NAMES), terms)
    return {
        "disks": {_label(*key): _place(values) for key, values in found.items()},
        "reductions": _numbers({s: v[0] for s, v in disks.reductions(found).items()}),
    }


def of_a_term(paper, terms):
    """What a term does, plainly and with forces with which the 2-cm disks fly as measured."""
    forces = disks.forces_needed(paper, terms)
    matched = disks.predict(paper, middle(NAMES), terms, forces)
    return {
        "plain": at_the_middle(paper, terms),
        "force": _numbers(forces),
        "matched": {_label(*key): _place(values) for key, values in matched.items()},
        "matched_reductions": _numbers({s: v[0] for s, v in disks.reductions(matched).items()}),
    }


def of_the_fit(paper):
    """Least light by the paper's own model, whose two coefficients were fitted to all its points.

    The text has none of the points, and says that this model agrees with them at all pressures. As
    the model was there, both films have the TACs 0.8 and 0.9. The ends are for 1.0 and 1.3 g/m².
    """
    temperature = number(paper["setting"]["temperature"]).value
    found = {}
    for film in FILMS:
        properties = disks.film(paper, film, middle(NAMES), Terms())
        properties |= {key: np.array([value] * 2) for key, value in FITTED_WITH.items()}
        properties = {key: np.broadcast_to(value, 2) for key, value in properties.items()}
        properties["areal_density"] = np.array([1.0e-3, 1.3e-3])
        for size in DIAMETERS:
            lifted = disks.levitation(
                properties, 0.01 * size, Terms(), {}, temperature, model=lf.Lu2023()
            )
            found[_label(film, size)] = {
                name: [float(f"{value:.3g}") for value in values]
                for name, values in zip(
                    ("light", "temperature", "pressure"), disks.least(lifted), strict=True
                )
            }
    return found


def band(paper, terms):
    """Intervals of all that was measured, before and after the 2-cm disks are known."""
    drawn = shares(NAMES)
    found = disks.predict(paper, drawn, terms)
    weights = disks.likelihood(paper, found, drawn)
    melting = number(paper["setting"]["melting"]).value
    result = {"samples_left": round(float(weights.sum() ** 2 / (weights**2).sum()))}
    measured = disks.measured(paper, drawn)
    saved, saw = disks.reductions(found), disks.measured_reductions(paper, drawn)
    for name, weighting in (("before", None), ("given_2_cm", weights)):
        result[name] = {
            "light": {_label(*k): interval(v[0], weighting) for k, v in found.items()},
            "temperature": {_label(*k): interval(v[1], weighting) for k, v in found.items()},
            "pressure": {_label(*k): interval(v[2], weighting) for k, v in found.items()},
            "over_measured": {
                _label(*k): interval(v[0] / measured[k], weighting) for k, v in found.items()
            },
            "reductions": {str(s): interval(v, weighting) for s, v in saved.items()},
            "less_than_measured": {
                str(s): interval(saw[s] - v, weighting) for s, v in saved.items()
            },
            "share_melted": {
                _label(*k): _share(v[1] > melting, weighting) for k, v in found.items()
            },
        }
    return result


def reading(paper, lift_off):
    """The file with another repeatability of lift-off."""
    entry = paper["reading"]["lift_off"] | {"uncertainty": lift_off}
    return paper | {"reading": paper["reading"] | {"lift_off": entry}}


def verdicts(found, paper, elsewhere, known=()):
    """Whether each measurement is inside of the 95 % interval of what is predicted.

    Parameters
    ----------
    found : dict
        Of :func:`band`, before or after the 2-cm disks are known.
    paper, elsewhere : dict
        Of the file; of :func:`of_others`.
    known : sequence of str
        Measurements that the prediction knows of, which prove nothing.

    Returns
    -------
    dict of str to bool
    """
    inside = {}
    for film in FILMS:
        for size in DIAMETERS:
            over = found["over_measured"][_label(film, size)]
            exact = "least" in paper[film]["disks"][str(size)]
            inside[_label(film, size)] = over["low"] <= 1.0 and (
                not exact or over["high"] is None or over["high"] >= 1.0
            )
    for size in DIAMETERS:
        missing = found["less_than_measured"][str(size)]
        high = np.inf if missing["high"] is None else missing["high"]
        inside[f"reduction {size} cm"] = missing["low"] <= 0.0 <= high
    inside |= {name: one["over_used"]["low"] <= 1.0 for name, one in elsewhere.items()}
    return {name: bool(value) for name, value in inside.items() if name not in known}


def of_others(experiments, surroundings):
    """Least light over the light used, of flyers of others.

    The models of plate and sandwich are taken in open space whatever the surroundings.
    """
    found = {
        "azadi2021": others.azadi(experiments["azadi2021"], with_walls(Terms(), surroundings)),
        "cortes2020": others.cortes(experiments["cortes2020"]),
        "schafer2025": others.schafer(experiments["schafer2025"]),
    }
    return {
        name: {
            "over_used": interval(ratio),
            "temperature": interval(np.where(np.isfinite(ratio), temperature, np.inf)),
        }
        for name, (ratio, temperature) in found.items()
    }


def _label(film, size):
    return f"{film} {size} cm"


def _place(values):
    light, temperature, pressure = (float(value[0]) for value in values)
    return {
        "light": round(light),
        "temperature": round(temperature),
        "pressure": round(pressure, 2),
    }


def _numbers(values):
    return {str(name): round(float(value), 3) for name, value in values.items()}


def _share(where, weights):
    return round(float(np.average(where, weights=weights)), 3)


def compute():
    """All numbers."""
    experiments = read()
    paper = experiments["lu2023"]
    results = {"middle": {}, "bands": {}, "others": {}, "inside": {}, "terms": {}}
    for name in SURROUNDINGS:
        results["middle"][name] = at_the_middle(paper, with_walls(Terms(), name))
        elsewhere = results["others"][name] = of_others(experiments, name)
        for what, terms in BANDS.items() if name in NEAR_AND_FAR else [("", Terms())]:
            read_so = reading(paper, STEADY_LIFT_OFF) if what == STEADY else paper
            found = results["bands"][name + what] = band(read_so, with_walls(terms, name))
            results["inside"][name + what] = {
                when: verdicts(found[when], paper, elsewhere, known)
                for when, known in (("before", ()), ("given_2_cm", KNOWN))
            }
        print(name, flush=True)
    for what, terms in TERMS.items():
        results["terms"][what] = {
            name: of_a_term(paper, with_walls(terms, name)) for name in NEAR_AND_FAR
        }
    results["fit"] = of_the_fit(paper)
    return results | {"estimates": estimates.all_numbers(results)}


def write(results):
    """Write the numbers, one line for each name of a section."""
    sections = []
    for section, found in results.items():
        lines = [f"  {_text(name)}: {_text(value)}" for name, value in found.items()]
        sections.append(f" {_text(section)}: {{\n" + ",\n".join(lines) + "\n }")
    RESULTS.write_text("{\n" + ",\n".join(sections) + "\n}\n", "utf-8")


def _text(value):
    return json.dumps(value, ensure_ascii=False)


def tables(results):
    """Tables of the page, in Markdown."""
    yield "| surroundings | Ge 2 cm | Ge 3 cm | Ge 4 cm | CNT 2 cm | CNT 3 cm | CNT 4 cm |"
    yield "|---|" + 6 * "---|"
    for name, found in results["middle"].items():
        places = found["disks"].values()
        cells = [f"{one['light']} ({one['temperature']} K)" for one in places]
        yield f"| {name} | {' | '.join(cells)} |"
    for when in ("before", "given_2_cm"):
        yield ""
        yield f"{when}: light over the measured, light saved, share of samples beyond melting"
        for name, found in results["bands"].items():
            one = found[when]
            cells = [_span(value) for value in one["over_measured"].values()]
            cells += [_span(value) for value in one["reductions"].values()]
            cells += [f"{value:.2f}" for value in one["share_melted"].values()]
            inside = results["inside"][name][when].values()
            yield f"| {name} | {' | '.join(cells)} | {sum(inside)} of {len(inside)} |"
    yield ""
    yield "terms: force needed (Ge, CNT); then Ge 4 cm and light saved"
    for what, where in results["terms"].items():
        for name, found in where.items():
            four = found["matched"]["germanium 4 cm"]
            saved = found["matched_reductions"]
            plain = found["plain"]["disks"]
            yield (
                f"| {what} | {name} | {plain['germanium 2 cm']['light']} | "
                f"{plain['nanotubes 2 cm']['light']} | "
                f"{found['force']['germanium']:.2f} | {found['force']['nanotubes']:.2f} | "
                f"{four['light']} ({four['temperature']} K) | "
                + " | ".join(f"{100 * saved[str(size)]:.0f}" for size in DIAMETERS)
                + " |"
            )
    yield ""
    for name, found in results["others"].items():
        yield f"| {name} | " + " | ".join(_span(v["over_used"]) for v in found.values()) + " |"


def _span(found):
    low, median, high = ("∞" if found[k] is None else found[k] for k in ("low", "median", "high"))
    return f"{median} ({low} to {high})"


def main():
    """Write the numbers and the figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--table", action="store_true", help="print tables and stop")
    if parser.parse_args().table:
        print("\n".join(tables(json.loads(RESULTS.read_text("utf-8")))))
        return
    results = compute()
    write(results)
    figure.draw(results, read())


if __name__ == "__main__":
    main()
