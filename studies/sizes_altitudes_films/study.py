"""Fig. S8 of Lu et al. (2023) from a million designs: see README.md."""

import json
import sys
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.parametric.run import sweep_into
from lightflyer.study.study import read_study

HERE = Path(__file__).parent
MILLIGRAM, CENTIMETRE, KILOMETRE, GRAM = 1e-6, 1e-2, 1e3, 1e-3
NOMINAL = {"film.emittance": 0.08, "film.areal_density": 1e-3}


def best_over_altitude(dataset, name):
    """Largest value over altitude, and the altitude there."""
    filled = dataset[name].fillna(-np.inf)
    return filled.max("altitude"), filled.idxmax("altitude")


def nominal_numbers(payload, relative, altitude):
    """What the paper's text says of its own film."""
    film = {name: float(payload[name].sel({name: value}, method="nearest"))
            for name, value in NOMINAL.items()}  # fmt: skip
    payload, relative, altitude = (part.sel(film) for part in (payload, relative, altitude))
    diameter = payload["flyer.diameter"].values / CENTIMETRE
    at_three = {"flyer.diameter": 3.0 * CENTIMETRE}
    return {
        "payload_of_3_cm_mg": round(float(payload.interp(at_three)) / MILLIGRAM, 4),
        "relative_payload_of_3_cm": round(float(relative.interp(at_three)), 4),
        "largest_payload_mg": round(float(payload.max()) / MILLIGRAM, 4),
        "diameter_of_largest_payload_cm": round(float(diameter[payload.values.argmax()]), 3),
        "largest_disk_that_lifts_itself_cm": round(float(diameter[payload.values > 0.0].max()), 3),
        "relative_payload_of_5_mm": round(float(relative.interp({"flyer.diameter": 5e-3})), 4),
        "altitude_of_5_mm_km": round(float(altitude.interp({"flyer.diameter": 5e-3})) / 1e3, 2),
    }


def draw(payload, relative, path):
    """Payload and relative payload over size: films of one weight, films of one emittance."""
    figure = plot.new_figure(columns=2, rows=2, height=8.0)
    colours = (palette.BLUE, palette.VERMILION, palette.GREEN, palette.ORANGE, palette.GREY)
    families = (
        ("film.emittance", "film.areal_density", "emittance {:g}"),
        ("film.areal_density", "film.emittance", "{:g} kg/m²"),
    )
    for row, (varied, held, words) in enumerate(families):
        for column, (values, label, scale) in enumerate(
            ((payload, "largest payload [mg]", MILLIGRAM), (relative, "relative payload", 1.0))
        ):
            ax = figure.axes[2 * row + column]
            at = values.sel({held: NOMINAL[held]}, method="nearest")
            for colour, amount in zip(colours, at[varied].values, strict=False):
                line = at.sel({varied: amount}) / scale
                shown = f"{1e3 * amount:g} g/m²" if "density" in varied else words.format(amount)
                ax.plot(line["flyer.diameter"] / CENTIMETRE, line, color=colour, label=shown)
            ax.axhline(0.0, color=palette.GREY, lw=0.8)
            top = float((at / scale).max())
            ax.set(xlabel="diameter [cm]", ylabel=label, ylim=(-0.05 * top, 1.08 * top))
            ax.grid(alpha=0.25)
            if column:
                ax.legend(title=f"{held.split('.')[1].replace('_', ' ')} {_nominal(held)}")
    plot.save(figure, [path])


def _nominal(name):
    value = NOMINAL[name]
    return f"{value / GRAM:g} g/m²" if "density" in name else f"{value:g}"


def main(folder):
    """Sweep into a folder, which continues what is there; draw; write the numbers."""
    study = read_study(HERE / "study.toml")
    report = sweep_into(study, folder)
    dataset = lf.parametric.open_sweep(folder).load()
    payload, altitude = best_over_altitude(dataset, "payload")
    relative, _ = best_over_altitude(dataset, "relative_payload")
    results = {"designs": report.designs, **nominal_numbers(payload, relative, altitude)}
    results["share_that_flies"] = round(float((dataset.payload > 0.0).mean()), 4)
    print(results)
    draw(payload, relative, HERE / "payload.png")
    (HERE / "results.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "sizes_altitudes_films.zarr"))
