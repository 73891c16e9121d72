"""Plates, membranes, sandwiches and shells beside finite elements, limits and tables."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.structure import (
    Lamina,
    Laminate,
    Ligaments,
    clamped_deflection,
    curl_of_film,
    cylinder_buckling_pressure,
    free_plate_frequency,
    free_plate_heights,
    laminate_stiffness,
    ligament_shear_stiffness,
    load_curvatures,
    membrane_frequency,
    perforated_share,
    root_stiffness,
    sandwich_stiffness,
    shear_profile,
    sphere_buckling_pressure,
)

STUDY = Path(__file__).parents[2] / "studies" / "structure" / "results.csv"
with STUDY.open(encoding="utf-8") as file:
    FOUND = [
        (row["problem"], float(row["first"]), float(row["second"]), float(row["result"]))
        for row in csv.DictReader(file)
    ]


def solved(problem):
    """Parameters and results of finite elements."""
    return [pytest.param(*row[1:], id=f"{row[1]}-{row[2]}") for row in FOUND if row[0] == problem]


def plate(poisson=0.24, thickness=1e-6, modulus=1e9):
    return laminate_stiffness(Laminate([Lamina(thickness, modulus, poisson)]))


@pytest.mark.parametrize(("poisson", "ring", "rise"), solved("free plate"))
def test_a_free_plate_bends_as_finite_elements(poisson, ring, rise):
    _, edge = free_plate_heights(1.0, 1.0, ring, 1.0, poisson)
    assert edge == pytest.approx(rise, rel=3e-5)


@pytest.mark.parametrize(("poisson", "ring", "rise"), solved("ring of a free plate"))
def test_its_ring_rises_as_finite_elements(poisson, ring, rise):
    on_ring, _ = free_plate_heights(1.0, 1.0, ring, 1.0, poisson)
    assert on_ring == pytest.approx(rise, rel=3e-5, abs=1e-8)


def test_a_plate_that_hangs_from_its_middle_has_the_textbooks_droop():
    ring, edge = free_plate_heights(3.0, 2.0, 0.0, 5.0, 0.3)
    assert ring == 0.0
    assert edge == pytest.approx((7 + 0.9) / 1.3 * 3.0 * 4.0 / (64 * math.pi * 5.0), rel=1e-12)


def test_curvature_under_a_load_is_that_of_the_deflection():
    ring, poisson = 0.3, 0.25
    _, edge = free_plate_heights(1.0, 1.0, ring, 1.0, poisson)

    # from the ring outwards, by Kirchhoff's equation integrated from the curvature in the middle
    curvature, on_ring = load_curvatures(1.0, 1.0, ring, 1.0, poisson)
    r = np.linspace(1e-9, 1.0, 200001)
    pressure = 1.0 / math.pi
    laplacian = 2.0 * curvature + pressure * r**2 / 4.0
    laplacian -= np.where(r > ring, np.log(np.maximum(r, ring) / ring) / (2.0 * math.pi), 0.0)
    slope = (
        np.concatenate(
            [
                [0.0],
                np.cumsum(
                    0.5 * np.diff(r) * (laplacian * r)[:-1] + 0.5 * np.diff(r) * (laplacian * r)[1:]
                ),
            ]
        )
        / r
    )
    assert np.trapezoid(slope, r) == pytest.approx(float(edge), rel=1e-4)
    bent = np.gradient(slope[1:], r[1:])
    assert bent[np.searchsorted(r, ring) - 50] == pytest.approx(float(on_ring), rel=2e-3)
    assert np.abs(bent[100:]).max() < 1.002 * max(abs(curvature), abs(on_ring))
    # nothing bends the free edge
    moment = laplacian[-1] - (1.0 - poisson) * slope[-1]
    assert abs(moment) < 1e-4 * curvature


def test_shear_adds_what_a_membrane_would():
    r = np.geomspace(0.1, 1.0, 20001)
    outside = np.trapezoid((1.0 / r - r) / (2.0 * math.pi), r)
    inside = -0.5 * 0.1**2 / (2.0 * math.pi)
    ring, edge = (shear_profile(1.0, 1.0, 0.1, 1.0, at) for at in (0.1, 1.0))
    assert edge == pytest.approx(outside + inside, rel=1e-6)
    assert ring == pytest.approx(inside, rel=1e-12)


@pytest.mark.parametrize(("pressure", "tension", "sag"), solved("clamped"))
def test_a_held_film_sags_as_finite_elements(pressure, tension, sag):
    # of R = t = E = 1: in units of the film, pressure E (t/R)⁴ and tension E t (t/R)²
    film, radius = plate(), 1e-4
    slender = 1e-6 / radius
    found = clamped_deflection(
        pressure * 1e9 * slender**4, radius, film, tension * 1e9 * 1e-6 * slender**2
    )
    assert found == pytest.approx(1e-6 * sag, rel=0.12)


def test_a_held_film_is_a_plate_and_a_membrane_in_the_limits():
    film, radius = plate(), 1e-4
    small = clamped_deflection(1e-6, radius, film)
    assert small == pytest.approx(1e-6 * radius**4 / (64 * film.plate), rel=1e-6)
    tense = clamped_deflection(1e-3, radius, film, 1e3)
    assert tense == pytest.approx(1e-3 * radius**2 / (4e3), rel=1e-6)
    thin = clamped_deflection(1e12, radius, film)
    stretched = 8 / 3 * (1.015 - 0.247 * 0.24) / 0.76 * 1e3 / radius**4
    assert thin == pytest.approx((1e12 / stretched) ** (1 / 3), rel=1e-3)
    # pressed together it stays flat up to its load, and then buckles
    critical = 16 * film.plate / radius**2
    assert clamped_deflection(0.0, radius, film, -0.99 * critical) == 0.0
    assert clamped_deflection(0.0, radius, film, -1.01 * critical) > 1e-7


@pytest.mark.parametrize(("poisson", "curvature", "rise"), solved("dish"))
def test_a_dish_stretches_as_finite_elements(poisson, curvature, rise):
    # R = t = E = 1: curvatures are t/R²
    found = curl_of_film(curvature * 1e-6 / 0.01**2, plate(poisson), 0.01)
    assert found.largest * 0.01**2 / 2 / 1e-6 == pytest.approx(rise, rel=0.1)


@pytest.mark.parametrize(("share", "_", "stiffness"), solved("root in square cell"))
def test_a_film_holds_a_post_as_finite_elements(share, _, stiffness):
    spacing = 1e-4
    posts = Ligaments(spacing, share * spacing / math.sqrt(math.pi), 1e-7, "square")
    film = plate()
    assert root_stiffness(posts, film) / film.plate == pytest.approx(stiffness, rel=0.025)


def test_the_pattern_decides_area_and_number():
    posts = Ligaments(1e-4, 1e-5, 1e-7)
    cell = 3**0.5 / 2 * 1e-8
    assert posts.fraction == pytest.approx(2 * math.pi * 1e-5 * 1e-7 / cell)
    assert posts.covered == pytest.approx(math.pi * 1e-10 / cell)
    assert math.pi * posts.cell_radius**2 == pytest.approx(cell)
    assert posts.free_radius == pytest.approx(1e-4 / 3**0.5 - 1e-5)
    with pytest.raises(lf.ParameterError, match="touch"):
        Ligaments(1e-5, 1e-5, 1e-7)


def test_posts_that_films_hold_firmly_are_beams():
    posts = Ligaments(1e-4, 1e-5, 1e-7, "square", modulus=1e11)
    firm = plate(thickness=1e-3, modulus=1e12)
    beam = 12e11 * math.pi * 1e-15 * 1e-7 / 1e-4 / 1e-8
    assert ligament_shear_stiffness(posts, 1e-4, firm, firm) == pytest.approx(beam, rel=1e-4)
    soft = plate(thickness=1e-8)
    roots = 2 * root_stiffness(posts, soft) / 1e-8
    assert ligament_shear_stiffness(posts, 1e-4, soft, soft) == pytest.approx(roots, rel=1e-4)


def test_a_sandwich_is_a_plate_without_its_middle():
    face, whole, core = plate(0.3, 1e-7, 1e11), plate(0.3, 1.2e-6, 1e11), plate(0.3, 1e-6, 1e11)
    found = sandwich_stiffness(face, face, 1.1e-6)
    assert found.plate == pytest.approx(whole.plate - core.plate, rel=1e-12)
    assert found.membrane == pytest.approx(whole.membrane - core.membrane, rel=1e-12)
    assert found.poisson == pytest.approx(0.3)
    assert found.neutral == pytest.approx(0.55e-6)
    assert perforated_share(0.0) == 1.0
    assert perforated_share(0.5) == pytest.approx(0.25)


@pytest.mark.parametrize(("poisson", "root"), [(0.25, 5.513), (0.3, 5.358), (0.33, 5.262)])
def test_a_free_plate_rings_as_tables_have_it(poisson, root):
    # λ² of the mode of two nodal diameters, Leissa (1969), Blevins (1979)
    found = free_plate_frequency(1.0, 1.0, 1.0, poisson)
    assert found * 2 * math.pi == pytest.approx(root, rel=0.006)


def test_a_membrane_rings_at_the_first_zero_of_bessel():
    from scipy.special import j0

    root = membrane_frequency(2.0, 3.0, 48.0) * 2 * math.pi * 2.0 / 4.0
    assert abs(j0(root)) < 1e-12


def test_shells_buckle_at_the_classical_pressures():
    # Zoelly (1915) of spheres: 1.21 E (t/R)² of ν = 0.3; Southwell-Windenburg of cylinders
    film = plate(0.3, 1e-3, 7e10)
    sphere = sphere_buckling_pressure(1.0, film, knock_down=1.0)
    assert sphere == pytest.approx(1.21 * 7e4, rel=1e-3)
    cylinder = cylinder_buckling_pressure(1.0, 2.0, film, knock_down=1.0)
    assert cylinder == pytest.approx(0.918 * 7e10 * 1e-3**2.5 / 2.0, rel=1e-3)
    assert sphere_buckling_pressure(1.0, film) == pytest.approx(0.14 * sphere)


CASES = {
    "free plate": lambda x: free_plate_heights(x, 0.01 * x, 1e-3, 1e-9, 0.3)[1],
    "load": lambda x: load_curvatures(x, 0.01 * x, 1e-3, 1e-9, 0.3)[1],
    "shear": lambda x: shear_profile(1.0, 0.01 * x, 1e-3, 0.1, 0.01 * x),
    "held": lambda x: clamped_deflection(10.0 * x, 1e-4, plate()),
    "stretched": lambda x: clamped_deflection(1e5 * x, 1e-4 * x, plate()),
    "buckled": lambda x: clamped_deflection(1e-3 * x, 1e-4 * x, plate(), -1.0),
    "root": lambda x: root_stiffness(Ligaments(1e-4, 1e-5 * x, 1e-7), plate()),
    "frequency": lambda x: free_plate_frequency(0.01 * x, 1e-3, 1e-9, 0.3 * x),
    "drum": lambda x: membrane_frequency(0.01 * x, 1e-3, 1.0 * x),
    "sphere": lambda x: sphere_buckling_pressure(0.01 * x, plate(0.2 * x)),
    "cylinder": lambda x: cylinder_buckling_pressure(0.01 * x, 0.1, plate(0.2, 1e-7 * x)),
}


def test_derivatives_are_those_of_finite_differences(require_derivatives):
    def of_all(x):
        return lf.xp.stack([function(x[0]) for function in CASES.values()])

    require_derivatives(of_all, np.ones(1), rtol=1e-5, atol=1e-12)
