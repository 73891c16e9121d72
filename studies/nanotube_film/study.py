"""Mixtures of carbon and vacuum that absorb and emit as the nanotube film: see README.md."""

import json
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.film import Film, Layer, Mixture, material, vacuum

HERE = Path(__file__).parent
IMAGE = HERE / "nanotube-film.png"
MEASURED = {"visible_absorptance": (0.75, 0.02), "infrared_emittance": (0.48, 0.03)}  # Table 1
MYLAR, COATING = 500e-9, 300e-9  # [m], by the paper
WINDOW = 1e-2 / np.linspace(667.0, 1300.0, 60)  # [m], the camera's band as far as mylar has data
CARBONS = {
    "graphite pellet KS-2": "main/C/Querry-DixonKS2",
    "graphite pellet HPN-2": "main/C/Querry-DixonHPN2",
    "graphite pellet Micro 260": "main/C/Querry-AsburyMicro260",
    "pyrolytic graphite": "main/C/Querry-Pyrolytic",
    "graphite, ordinary ray": "main/C/Djurisic-o",
    "amorphous carbon": "main/C/Hagemann",
}
ARRANGEMENTS = {
    "mat": ("maxwell-garnett", "mat"),
    "needles": ("maxwell-garnett", "needles"),
    "spheres": ("bruggeman", "spheres"),
}
GRAPHITE = 2200.0  # [kg/m³]


def film(carbon, arrangement, fraction, thickness=COATING):
    """Mylar with nanotubes below."""
    parts = (vacuum(), material(CARBONS[carbon], extrapolation="hold").with_density(GRAPHITE))
    tubes = Mixture(parts, fraction, *ARRANGEMENTS[arrangement])
    return Film((Layer(material("PET"), MYLAR), Layer(tubes, thickness)))


def optics(sample):
    """What the paper measured: shares of a white lamp's light, and of the infrared window."""
    lamp = lf.film.light_shares(sample, lf.film.cold_white_led())
    window = sample.optics(WINDOW).polarisation_mean()
    reflected, passed = window.reflectance.mean(), window.transmittance.mean()
    return {
        "visible_absorptance": lamp.absorptance.value,
        "visible_transmittance": lamp.transmittance.value,
        "visible_reflectance": lamp.reflectance.value,
        "infrared_emittance": 1.0 - reflected - passed,
        "infrared_transmittance": passed,
        "infrared_reflectance": reflected,
    }


def misfit(carbon, arrangement, fraction, thickness=COATING):
    """Sum of squares of the deviations of both measured values, over their uncertainties."""
    found = optics(film(carbon, arrangement, fraction, thickness))
    return sum(((found[name] - value) / spread) ** 2 for name, (value, spread) in MEASURED.items())


def best(carbon, arrangement, thickness=COATING):
    """Volume fraction that fits best, and what the film does then."""
    found = minimize_scalar(
        lambda fraction: misfit(carbon, arrangement, fraction, thickness),
        bounds=(0.02, 0.9),
        method="bounded",
        options={"xatol": 1e-3},
    )
    sample = film(carbon, arrangement, float(found.x), thickness)
    return {
        "fraction": float(found.x),
        "misfit": float(found.fun),
        **optics(sample),
        "coating_g_m2": 1e3 * GRAPHITE * float(found.x) * thickness,
    }


def draw(sample):
    """Spectra of the film, with the measured means over their bands."""
    figure = plot.new_figure()
    ax = figure.axes[0]
    wavelength = np.geomspace(0.4e-6, 19.9e-6, 400)
    spectra = sample.optics(wavelength).polarisation_mean()
    table_1 = {  # visible, infrared [Lu2023]
        "absorptance": (palette.VERMILION, "-", (0.75, 0.02), (0.48, 0.03)),
        "transmittance": (palette.GREEN, "-.", (0.22, 0.01), (0.47, 0.02)),
        "reflectance": (palette.BLUE, "--", (0.03, 0.01), (0.05, 0.01)),
    }
    bands = ((0.4, 0.7), (1e6 * WINDOW.min(), 1e6 * WINDOW.max()))
    for name, (colour, line, *measured) in table_1.items():
        ax.plot(wavelength * 1e6, getattr(spectra, name), color=colour, ls=line, label=name)
        for (value, spread), (first, last) in zip(measured, bands, strict=True):
            middle = np.sqrt(first * last)
            reach = [[middle - first], [last - middle]]
            ax.errorbar(middle, value, spread, reach, fmt="o", ms=4, color=colour, capsize=2)
    ax.plot([], [], "o", ms=4, color=palette.GREY, label="measured, mean over a band")
    ax.set(xscale="log", ylim=(0.0, 1.0), xlabel="wavelength [µm]", ylabel="share of light [1]")
    ax.set_xticks([0.5, 1.0, 2.0, 5.0, 10.0, 20.0], ["0.5", "1", "2", "5", "10", "20"])
    ax.minorticks_off()
    plot.legend_below(ax)
    plot.save(figure, [IMAGE])


def main():
    """All carbons and arrangements; then other thicknesses of the one that is shipped."""
    results = {}
    for carbon in CARBONS:
        for arrangement in ARRANGEMENTS:
            results[f"{carbon}, {arrangement}"] = best(carbon, arrangement)
    for nanometres in (150, 200, 400, 600):
        name = f"graphite pellet Micro 260, mat, {nanometres} nm"
        results[name] = best("graphite pellet Micro 260", "mat", nanometres * 1e-9)
    shipped = Film((Layer(material("PET"), MYLAR), Layer(material("CNT-mat"), COATING)))
    results["CNT-mat"] = {
        **optics(shipped),
        "solar_absorptance": lf.film.absorptance(shipped).value,
        "hemispherical_emittance_441_K": float(
            lf.film.emittance(shipped, 441.0, side="bottom").value
        ),
    }
    rounded = {
        name: {key: round(float(value), 4) for key, value in row.items()}
        for name, row in results.items()
    }
    draw(shipped)
    for name, row in rounded.items():
        print(name, row)
    (HERE / "results.json").write_text(json.dumps(rounded, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
