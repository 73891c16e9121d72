"""Which germanium film the optical measurements of Lu et al. (2023) allow: see README.md."""

import json
from itertools import product
from pathlib import Path

import numpy as np
from scipy.interpolate import RectBivariateSpline

from lightflyer import film
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.film.optics.spectra import planck

HERE = Path(__file__).parent
NM = 1e-9
FIXED = {"PET": 500 * NM, "Al2O3": 50 * NM, "GeO2": 4 * NM}  # thicknesses
NOMINAL = 20 * NM
LIMIT = 9.49  # of the sum of four squared deviations: exceeded by chance in 5 %
HOT = 441.0  # temperature of the paper's flyers [K]
LAMP, SUN = film.cold_white_led(), film.am0()
THICKNESS = np.linspace(2.0, 100.0, 99) * NM
POROSITY, FINE = np.linspace(0.0, 0.8, 17), np.linspace(0.0, 0.8, 65)
# wavelengths and weights: the flashlight, the camera's infrared, sunlight, a black body
VISIBLE = np.linspace(400 * NM, 780 * NM, 77)
INFRARED = 0.01 / np.linspace(667.0, 1300.0, 25)  # of 900 ± 400 cm⁻¹, what the data cover
SOLAR = np.geomspace(0.4e-6, 4e-6, 120)
THERMAL = np.geomspace(3e-6, 15e-6, 60)
BANDS = (
    (VISIBLE, np.interp(VISIBLE, LAMP.wavelength, LAMP.irradiance)),
    (INFRARED, np.ones_like(INFRARED)),
    (SOLAR, SOLAR * np.interp(SOLAR, SUN.wavelength, SUN.irradiance)),
    (THERMAL, THERMAL * planck(THERMAL, HOT)),
)
NAMES = ("visible T", "visible R", "infrared T", "infrared R")
# table 1 of the paper: value and ±, taken as standard uncertainty
GERMANIUM_FILM = np.array([[0.18, 0.01], [0.07, 0.02], [0.81, 0.01], [0.11, 0.01]])
BARE_MYLAR = np.array([[0.94, 0.01], [0.02, 0.01], [0.92, 0.01], [0.02, 0.01]])

LIKELY = "both faces, alumina on the lit one"
STRUCTURES = {
    LIKELY: ("Al2O3", "Ge", "PET", "Ge"),
    "both faces, alumina on the other": ("Ge", "PET", "Ge", "Al2O3"),
    "both faces, no alumina": ("Ge", "PET", "Ge"),
    "the lit face only": ("Ge", "PET"),
    "the other face only": ("PET", "Ge"),
}


def thin_germanium():
    """Constants of a 20-nm film where they are known, beyond 2 µm those of the 0.42-µm film."""
    thin, thick = film.material("Ge-20nm"), film.material("Ge")
    near, far = np.linspace(0.4e-6, 2e-6, 400), np.geomspace(2.01e-6, 15e-6, 600)
    n, k = (np.concatenate(pair) for pair in zip(thin.index(near), thick.index(far), strict=True))
    return film.tabulated_material("Ge-20nm", np.concatenate([near, far]), n, k, density=5323.0)


CONSTANTS = {
    "Ge": film.material("Ge"),
    "Ge-20nm": thin_germanium(),
    "Ge-crystal": film.material("Ge-crystal", extrapolation="hold"),
}
OTHERS = {
    "PET": film.material("PET"),
    "Al2O3": film.material("Al2O3"),
    "GeO2": film.material("main/GeO2/Nunley", extrapolation="hold").with_density(3650.0),
}


def germanium(name, porosity):
    """A medium of germanium with pores."""
    return film.porous(CONSTANTS[name], porosity) if porosity else CONSTANTS[name]


def shares(names, medium, thickness):
    """Mean T and R in each band, for thicknesses of germanium, shape (4 bands, 2, thicknesses)."""
    heights = np.array([[FIXED.get(name, one) for one in thickness] for name in names])
    found = []
    for wavelength, weight in BANDS:
        pairs = [OTHERS.get(name, medium).index(wavelength) for name in names]
        n, k = (np.stack(part)[:, None] for part in zip(*pairs, strict=True))
        optics = film.stack_optics(n, k, heights[..., None], wavelength)
        both = (optics.transmittance[0], optics.reflectance[0])
        found.append([np.average(one, axis=-1, weights=weight) for one in both])
    return np.array(found)


def mass(names, medium, thickness):
    """Areal density for thicknesses of germanium [kg/m²]."""
    return sum(
        FIXED[name] * OTHERS[name].density if name in FIXED else thickness * medium.density
        for name in names
    )


def deviation(found, spread):
    """Sum of the squared deviations of the four measured shares, shape (thicknesses,)."""
    values = found[:2].reshape(4, -1)
    return (((values - GERMANIUM_FILM[:, :1]) / spread[:, None]) ** 2).sum(axis=0)


def described(found, number, names, medium):
    """One film in numbers."""
    one = found[:, :, number]
    absorbed = 1.0 - one.sum(axis=1)
    return {
        "thickness_nm": THICKNESS[number] / NM,
        "visible": [*one[0], absorbed[0]],
        "infrared": [*one[1], absorbed[1]],
        "absorptance_sunlight": absorbed[2],
        "emittance_normal": absorbed[3],
        "areal_density_g_m2": 1e3 * mass(names, medium, THICKNESS[number]),
    }


def scan(structure, constants, spreads):
    """By the reading of ±: deviations, the best film, and the ranges of what is allowed."""
    names, porosities = STRUCTURES[structure], FINE if structure == LIKELY else POROSITY
    tables = {reading: np.empty((porosities.size, THICKNESS.size)) for reading in spreads}
    allowed, best = {reading: [] for reading in spreads}, dict.fromkeys(spreads, (np.inf, None))
    for row, porosity in enumerate(porosities):
        medium = germanium(constants, porosity)
        found = shares(names, medium, THICKNESS)

        def told(number, porosity=porosity, found=found, medium=medium):
            return {"porosity": porosity, **described(found, number, names, medium)}

        for reading, spread in spreads.items():
            cost = tables[reading][row] = deviation(found, spread)
            allowed[reading] += [told(number) for number in np.flatnonzero(cost <= LIMIT)]
            number = int(cost.argmin())
            if cost[number] < best[reading][0]:
                best[reading] = cost[number], told(number)
    return tables, {
        reading: {"deviation": best[reading][0], "best": best[reading][1],
                  "allowed": ranges(allowed[reading])}
        for reading in spreads
    }  # fmt: skip


def ranges(films):
    """Least and largest value of each number of films that are allowed."""
    if not films:
        return None
    solid = [one["thickness_nm"] * (1.0 - one["porosity"]) for one in films]
    found = {"count": len(films), "solid_nm": [min(solid), max(solid)]}
    for name in ("thickness_nm", "porosity", "absorptance_sunlight", "emittance_normal",
                 "areal_density_g_m2"):  # fmt: skip
        values = [one[name] for one in films]
        found[name] = [min(values), max(values)]
    lamp = [one["visible"][2] for one in films]
    return found | {"absorptance_lamp": [min(lamp), max(lamp)]}


def causes():
    """What each cause does by itself to the film with the stated layers, alumina lit."""
    names = STRUCTURES[LIKELY]
    cases = {
        "stated layers": (names, "Ge", 0.0, 20.0),
        "4 nm of oxide on the bare face": ((*names, "GeO2"), "Ge", 0.0, 20.0),
        "half as much": (names, "Ge", 0.0, 10.0),
        "a third as much": (names, "Ge", 0.0, 6.5),
        "pores 40 %, same mass": (names, "Ge", 0.4, 20.0 / 0.6),
        "pores 60 %, same mass": (names, "Ge", 0.6, 50.0),
        "crystal": (names, "Ge-crystal", 0.0, 20.0),
    }
    found = {}
    for case, (layers, constants, porosity, thickness) in cases.items():
        medium = germanium(constants, porosity)
        one = shares(layers, medium, np.array([thickness * NM]))[:, :, 0]
        found[case] = {"visible": [*one[0], 1.0 - one[0].sum()],
                       "infrared": [*one[1], 1.0 - one[1].sum()],
                       "absorptance_sunlight": 1.0 - one[2].sum()}  # fmt: skip
    return found | {"rough": rough(), "light_returned": returned()}


def rough(height=34.8 * NM):
    """Share of the lamp's light that the rough upper face of the germanium scatters."""
    names = STRUCTURES[LIKELY]
    layers = tuple(
        film.Layer(
            OTHERS.get(name, CONSTANTS["Ge"]),
            FIXED.get(name, NOMINAL),
            roughness=height if number < 2 else None,
        )
        for number, name in enumerate(names)
    )
    optics = film.Film(layers).optics(VISIBLE).polarisation_mean()
    found = {"T": optics.transmittance, "R": optics.reflectance, "absorbed": optics.absorptance,
             "scattered": optics.scattered}  # fmt: skip
    return {name: np.average(one, weights=BANDS[0][1]) for name, one in found.items()}


def returned():
    """Most that the stated film absorbs of the lamp, if all that passes comes back once."""
    names = STRUCTURES[LIKELY]
    top, bottom = (
        shares(order, CONSTANTS["Ge"], np.array([NOMINAL]))[0, :, 0]
        for order in (names, names[::-1])
    )
    return (1.0 - top.sum()) + top[0] * (1.0 - bottom.sum())


def draw(tables, printed):
    """Visible T and R of structures, and the allowed thicknesses and porosities."""
    figure = plot.new_figure(rows=2, height=8.4)
    ax, map_ax = figure.axes
    for name, names in STRUCTURES.items():
        for porosity, style in ((0.0, "-"), (0.6, "--")):
            found = shares(names, germanium("Ge", porosity), THICKNESS)[0]
            colour = palette.BLUE if name == LIKELY else palette.GREY
            ax.plot(*found, style, color=colour, lw=2.0 if name == LIKELY else 0.8)
            at = np.argmin(np.abs(THICKNESS * (1.0 - porosity) - NOMINAL))
            ax.plot(*found[:, at], "o", ms=4, color=colour)
    (t, dt), (r, dr) = GERMANIUM_FILM[:2]
    ax.errorbar(t, r, 1.96 * dr, 1.96 * dt, "k", capsize=3, lw=1.5, label="measured, 95 %")
    ax.plot([], [], "-", color=palette.BLUE, lw=2.0, label="both faces, alumina on the lit one")
    ax.plot([], [], "-", color=palette.GREY, lw=0.8, label="four other orders of layers")
    ax.plot([], [], "k--", label="dashed: 60 % pores")
    ax.plot([], [], "o", color=palette.GREY, label="mass of 20 nm per face")
    ax.set(xlabel="transmittance, white lamp [1]", ylabel="reflectance, white lamp [1]",
           xlim=(0.0, 0.6), ylim=(0.0, 0.7))  # fmt: skip
    plot.legend_below(ax, most=2)
    for number, name in enumerate(CONSTANTS):
        colour = palette.PALETTE[number]
        table = tables[LIKELY, name]
        # the allowed strip is hardly wider than the grid's steps
        smooth = RectBivariateSpline(FINE, THICKNESS, np.log(table))
        thickness, porosity = np.linspace(2.0, 100.0, 500), np.linspace(0.0, 0.8, 600)
        cost = smooth(porosity, thickness * NM)
        map_ax.contour(thickness, porosity, cost, levels=[np.log(LIMIT)], colors=colour)
        map_ax.plot([], [], color=colour, label=f"allowed, constants {name}")
        best = printed[LIKELY][name]["best"]
        map_ax.plot(best["thickness_nm"], best["porosity"], "o", color=colour)
    map_ax.plot(THICKNESS / NM, 1.0 - NOMINAL / THICKNESS, "k:", label="mass of 20 nm per face")
    map_ax.set(xlabel="thickness of germanium on each face [nm]", ylabel="porosity [1]",
               xlim=(0.0, 100.0), ylim=(0.0, 0.8))  # fmt: skip
    plot.legend_below(map_ax, most=2)
    plot.save(figure, [HERE / "which-germanium.png"])


def rounded(value):
    """Numbers with four digits, for the record."""
    if isinstance(value, dict):
        return {name: rounded(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(one) for one in value]
    return value if value is None or isinstance(value, str | int) else float(f"{value:.4g}")


def main():
    """Scan, write the numbers, draw."""
    known = shares(("PET",), CONSTANTS["Ge"], THICKNESS[:1])[:2].reshape(4)
    missed = BARE_MYLAR[:, 0] - known
    # bare mylar is known: by how much the set-ups miss it is an error that they may have again
    wide = np.hypot(GERMANIUM_FILM[:, 1], missed)
    spreads = {"printed": GERMANIUM_FILM[:, 1], "as bare mylar shows": wide}
    results = {"bare mylar": {
        "computed": dict(zip(NAMES, known, strict=True)),
        "measured less computed": dict(zip(NAMES, missed, strict=True)),
    }, **{reading: {one: {} for one in STRUCTURES} for reading in spreads}}  # fmt: skip
    tables = {}
    for structure, constants in product(STRUCTURES, CONSTANTS):
        costs, found = scan(structure, constants, spreads)
        tables[structure, constants] = costs["printed"]
        for reading, one in found.items():
            results[reading][structure][constants] = one
    results["causes"] = causes()
    draw(tables, results["printed"])
    text = json.dumps(rounded(results), indent=1)
    (HERE / "results.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
