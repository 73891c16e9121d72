"""Thicknesses of germanium and mylar that carry most, by gradient: see README.md."""

import json
import time
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import minimize

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
ALTITUDE = 72e3
RADIUS = 0.01
SKIN = 10e-9  # alumina on top where germanium is, to keep the top's accommodation low
BOUNDS = np.array([[2e-9, 100e-9], [100e-9, 2000e-9]])  # germanium, mylar [m]
STARTS = np.array([[5e-9, 200e-9], [30e-9, 500e-9]])
RESOLUTION = 100  # wavelengths per factor e; the optimum is confirmed with the default

GE, PET, ALUMINA = (lf.film.material(name) for name in ("Ge", "PET", "Al2O3"))
SIDES = {
    "below": lambda ge, pet: (lf.film.Layer(PET, pet), lf.film.Layer(GE, ge)),
    "above": lambda ge, pet: (
        lf.film.Layer(ALUMINA, SKIN),
        lf.film.Layer(GE, ge),
        lf.film.Layer(PET, pet),
    ),
    "both": lambda ge, pet: (
        lf.film.Layer(ALUMINA, SKIN),
        lf.film.Layer(GE, ge),
        lf.film.Layer(PET, pet),
        lf.film.Layer(GE, ge),
    ),
}


def relative_payload(thicknesses, side, resolution=RESOLUTION):
    """Payload over the film's own mass, at thicknesses of germanium and mylar [m]."""
    layers = SIDES[side](*thicknesses)
    film = lf.film.Film(layers)
    top, bottom = (
        lf.film.emittance_curve(film, face, points_per_e_fold=resolution)
        for face in ("top", "bottom")
    )
    properties = lf.FilmProperties(
        film.areal_density,
        lf.film.absorptance(film).value,
        top,
        bottom,
        tac_top=layers[0].material.tac.value,
        tac_bottom=layers[-1].material.tac.value,
    )
    disk = lf.Disk(properties, RADIUS)
    state = lf.lu2023_earth().state(ALTITUDE)
    return lf.payload(disk, state, lf.Lu2023(), throw=False) / disk.own_mass


def optimise(side):
    """Best thicknesses [m] and relative payload, from several starts."""
    # not compiled as a whole: its parts are, once for both faces and all starts
    negative = jax.value_and_grad(lambda logs: -relative_payload(jnp.exp(logs), side))
    best = None
    for start in STARTS:
        found = minimize(
            lambda x: tuple(np.asarray(part, float) for part in negative(x)),
            np.log(start),
            jac=True,
            bounds=np.log(BOUNDS),
            method="L-BFGS-B",
        )
        if best is None or found.fun < best.fun:
            best = found
    return np.exp(best.x), -float(best.fun)


def draw(side, best, path):
    """Map of the relative payload over both thicknesses."""
    germanium, mylar = (np.geomspace(*bounds, 21) for bounds in BOUNDS)
    grid = np.stack(np.meshgrid(germanium, mylar, indexing="ij"), axis=-1)
    table = jax.jit(
        lambda points: jax.lax.map(lambda point: relative_payload(point, side, 100), points)
    )(grid.reshape(-1, 2))
    figure = plot.new_figure()
    ax = figure.axes[0]
    values = np.asarray(table).reshape(grid.shape[:2])
    image = ax.contourf(germanium * 1e9, mylar * 1e9, values.T, levels=20, cmap="cividis")
    figure.colorbar(image, ax=ax, label="relative payload [own mass]")
    ax.plot(
        *best * 1e9, "o", color=palette.VERMILION, ms=8, clip_on=False, label="optimum by gradient"
    )
    ax.set(xscale="log", yscale="log", xlabel="germanium [nm]", ylabel="mylar [nm]")
    ax.legend(loc="upper right")
    plot.save(figure, [path])


def main():
    """Optimise every side, confirm, draw the best, write the numbers."""
    results = {}
    with lf.float64():
        for side in SIDES:
            begin = time.perf_counter()
            thicknesses, payload = optimise(side)
            results[side] = {
                "germanium_nm": round(float(thicknesses[0]) * 1e9, 2),
                "mylar_nm": round(float(thicknesses[1]) * 1e9, 1),
                "relative_payload": round(payload, 4),
                "confirmed": round(float(relative_payload(thicknesses, side, 4000)), 4),
                "seconds": round(time.perf_counter() - begin, 1),
            }
            print(side, results[side])
        best = max(results, key=lambda side: results[side]["relative_payload"])
        found = np.array([results[best]["germanium_nm"], results[best]["mylar_nm"]]) * 1e-9
        draw(best, found, HERE / "payload.png")
    (HERE / "results.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
