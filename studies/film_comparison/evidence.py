"""Computed evidence behind docs/film-comparison.md; writes results.json."""

import json
from pathlib import Path

import numpy as np

from lightflyer import film

HERE = Path(__file__).parent
VISIBLE = film.Spectrum("400 nm to 700 nm, flat", np.array([400e-9, 700e-9]), np.ones(2))
GE, PET, ALUMINA = film.material("Ge"), film.material("PET"), film.material("Al2O3")


def paper_film(germanium=GE, below=20e-9, above=20e-9, alumina=50e-9, oxide=0.0):
    """Alumina, germanium, mylar, germanium, and silica below in place of the native oxide."""
    layers = [film.Layer(germanium, above), film.Layer(PET, 500e-9), film.Layer(germanium, below)]
    if alumina:
        layers.insert(0, film.Layer(ALUMINA, alumina))
    if oxide:
        layers.append(film.Layer(film.material("SiO2"), oxide))
    return film.Film(tuple(layers))


def bruggeman(material, share):
    """Porous material: n and k of a mixture with vacuum by Bruggeman (1935)."""
    wavelength = np.geomspace(0.4e-6, 15e-6, 800)
    n, k = material.index(wavelength)
    solid = (n + 1j * k) ** 2
    half = 0.25 * ((3 * share - 1) * solid + (2 - 3 * share))
    root = np.sqrt(half**2 + 0.5 * solid)
    mixed = np.sqrt(half + np.where((half + root).imag >= 0, root, -root))
    return film.tabulated_material("porous Ge", wavelength, mixed.real, np.abs(mixed.imag))


def optical(stack):
    """Absorptance from the top for three lights, and from the bottom for the lamp."""
    lights = {"AM0": None, "LED": film.cold_white_led(), "visible": VISIBLE}
    found = {name: film.absorptance(stack, light).value for name, light in lights.items()}
    found["LED, bottom"] = film.absorptance(stack, film.cold_white_led(), side="bottom").value
    return {name: round(float(value), 3) for name, value in found.items()}


def thermal(stack, temperature=441.0):
    """Hemispherical emittance of both faces, and the share of the spectrum that the data cover."""
    faces = [film.emittance(stack, temperature, side=side) for side in ("top", "bottom")]
    values = [round(float(face.value), 4) for face in faces]
    return {"top": values[0], "bottom": values[1], "covered": round(float(faces[0].covered), 3)}


def means(optics, weight=None):
    """Transmittance, reflectance and absorptance, averaged over wavelengths."""
    names = ("transmittance", "reflectance", "absorptance")
    values = (np.average(getattr(optics, name), weights=weight) for name in names)
    return {name: round(float(value), 3) for name, value in zip(names, values, strict=True)}


def window(stack):
    """At normal incidence, over 900 ± 400 cm⁻¹ as far as the data reach."""
    wavenumber = np.linspace(667.0, 1300.0, 400)
    return means(stack.optics(0.01 / wavenumber).polarisation_mean())


def in_lamp(stack):
    """At normal incidence, over the light of a cold-white LED."""
    lamp, wavelength = film.cold_white_led(), np.linspace(400e-9, 780e-9, 2000)
    weight = np.interp(wavelength, lamp.wavelength, lamp.irradiance)
    return means(stack.optics(wavelength).polarisation_mean(), weight)


def main():
    """Compute and write all results."""
    nominal = paper_film()
    mylar = film.Film((film.Layer(PET, 500e-9),))
    porous = bruggeman(GE, 0.5)
    results = {
        "emittance at 441 K": {"nominal": thermal(nominal), "mylar": thermal(mylar)},
        "667-1300 1/cm": {"nominal": window(nominal), "mylar": window(mylar)},
        "cold-white LED": {"nominal": in_lamp(nominal), "mylar": in_lamp(mylar)},
        "absorptance": {
            "nominal": optical(nominal),
            "mylar": optical(mylar),
            "no alumina": optical(paper_film(alumina=0.0)),
            "index of a 20-nm film": optical(paper_film(film.material("Ge-20nm"))),
            "index of the crystal": optical(paper_film(film.material("Ge-crystal"))),
            "germanium 25 nm": optical(paper_film(below=25e-9, above=25e-9)),
            "germanium 15 nm": optical(paper_film(below=15e-9, above=15e-9)),
            "4 nm of Ge below oxidised": optical(paper_film(below=16e-9, oxide=5e-9)),
            "porous, 40 nm at 50 %": optical(paper_film(porous, 40e-9, 40e-9)),
        },
    }
    text = json.dumps(results, indent=2, ensure_ascii=False)
    (HERE / "results.json").write_text(text + "\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
