"""The best thickness of germanium over altitude and sunlight: see README.md."""

import json
from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
NANOMETRE, KILOMETRE = 1e-9, 1e3
THIN = 50e-9  # [m], between the first and the second maximum of the absorptance
THICKNESS = "film.layers.1.thickness"
OVER = {
    THICKNESS: {"from": "1 nm", "to": "200 nm", "points": 36, "scale": "log"},
    "environment.irradiance": {"from": "600 W/m^2", "to": "1400 W/m^2", "points": 81},
    "altitude": {"from": "66 km", "to": "84 km", "points": 181},
}


def best_thickness(table):
    """Thickness of the largest payload, by a parabola through three in its logarithm, and that."""
    values = table.relative_payload.transpose(THICKNESS, ...).values
    logs = np.log(table[THICKNESS].values)
    peak = np.clip(np.argmax(values, axis=0), 1, len(logs) - 2)
    left, middle, right = (
        np.take_along_axis(values, peak[None] + step, axis=0)[0] for step in (-1, 0, 1)
    )
    way = np.clip(0.5 * (left - right) / (left - 2.0 * middle + right), -1.0, 1.0)
    best = np.exp(logs[peak] + way * (logs[1] - logs[0]))
    return best, middle - 0.25 * (left - right) * way


def draw(table, best, payload, path):
    """Map of the best thickness where it flies, with lines of the payload."""
    altitude = table.altitude.values / KILOMETRE
    sunlight = table["environment.irradiance"].values
    figure = plot.new_figure()
    ax = figure.axes[0]
    shown, able = best / NANOMETRE, payload >= 0.0
    thin = shown[able & (best < THIN)]
    levels = np.arange(np.floor(5.0 * thin.min()), 5.0 * thin.max() + 1.0) / 5.0
    image = ax.contourf(altitude, sunlight, np.where(best < THIN, shown, np.nan), levels=levels,
                        cmap="cividis", extend="both")  # fmt: skip
    figure.colorbar(image, ax=ax, label="best thickness of germanium [nm]")
    thick = able & (best >= THIN)
    if thick.any():
        ax.contourf(altitude, sunlight, thick, levels=[0.5, 1.5], colors="tab:red")
        ax.text(altitude[0] + 0.2, sunlight[-1] - 150.0, f"red: {shown[thick].mean():.0f} nm",
                color="tab:red", bbox={"color": "white"})  # fmt: skip
    lines = ax.contour(altitude, sunlight, payload, levels=[0.25, 0.5, 0.75, 1.0], colors="white")
    ax.clabel(lines, fmt=lambda level: f"{level:g}")
    area = ax.contourf(altitude, sunlight, payload, levels=[-2.0, 0.0], colors="white",
                       hatches=["///"])  # fmt: skip
    area.set_edgecolor(palette.GREY)
    area.set_linewidth(0.0)
    ax.set(xlabel="altitude [km]", ylabel="sunlight [W/m²]")
    ax.set_title("white lines: payload over the film's own mass; hatched: none flies", fontsize=9)
    plot.save(figure, [path])


def main():
    """Sweep, find the best, draw, write the numbers."""
    table = lf.sweep(HERE / "flyer.toml", over=OVER, outputs=["relative_payload", "absorptance"])
    best, payload = best_thickness(table)
    sun = int(np.argmin(np.abs(table["environment.irradiance"].values - 1360.0)))
    results = {"designs": int(table.relative_payload.size)}
    for kilometres in (72, 75, 78):
        place = int(np.argmin(np.abs(table.altitude.values - kilometres * KILOMETRE)))
        results[f"at_{kilometres}_km_1360_w_m2"] = {
            "germanium_nm": round(float(best[sun, place]) / NANOMETRE, 2),
            "relative_payload": round(float(payload[sun, place]), 4),
        }
    able = payload >= 0.0
    results["least_sunlight_w_m2"] = float(
        table["environment.irradiance"].values[able.any(axis=1)].min()
    )
    for name, part in (("thin", able & (best < THIN)), ("thick", able & (best >= THIN))):
        results[f"{name}_germanium_nm_where_it_flies"] = [
            round(float(end) / NANOMETRE, 2) for end in (best[part].min(), best[part].max())
        ]
        results[f"{name}_share_of_the_map_where_it_flies"] = round(
            float(part.sum() / able.sum()), 4
        )
    print(results)
    draw(table, best, payload, HERE / "thickness.png")
    (HERE / "results.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
