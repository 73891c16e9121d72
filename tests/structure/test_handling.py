"""What flyers bear, how they ring, and what curl costs, beside finite elements and molecules."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.special import j1

import lightflyer as lf
from lightflyer.design.operating_point import OperatingPoint
from lightflyer.flyer.hanging import Held
from lightflyer.flyer.shape import shape_of_film
from lightflyer.structure import (
    Curl,
    Lamina,
    Laminate,
    Ligaments,
    dimpling_load,
    fold_curvature,
    fold_tension,
    free_plate_frequency,
    free_plate_profile,
    free_shear_frequency,
    laminate_stiffness,
    open_sphere_frequency,
    perforated_share,
    projected_share,
    rim_buckling_pressure,
    rod_mass,
    root_moment,
    root_stiffness,
    shear_profile,
    sphere_frequency,
    tac_within,
    tension_at_holes,
    tether_mass,
    three_point_profile,
    three_point_shear,
    umbrella_frequency,
)
from lightflyer.structure.vibrations import UMBRELLA_PLACES

STUDY = Path(__file__).parents[2] / "studies" / "structure"
ROOM = 293.15
MYLAR = Laminate([Lamina(5e-7, 4.9e9, 0.38, 1.7e-5, 0.0, 1e8)])
ALUMINA = Laminate([Lamina(1e-7, 1.4e11, 0.24, 4.2e-6, 1.3e8, 1.7e9)])


def rows(name):
    with (STUDY / name).open(encoding="utf-8") as file:
        return list(csv.reader(file))[1:]


def solved(problem):
    return [pytest.param(*map(float, row[1:]), id=row[1]) for row in rows("results.csv")
            if row[0] == problem]  # fmt: skip


@pytest.mark.parametrize(("poisson", "ring", "droop"), solved("three points"))
def test_three_points_bend_a_plate_as_finite_elements(poisson, ring, droop):
    towards, between = three_point_profile(1.0, 1.0, ring, 1.0, poisson, np.linspace(0.0, 1.0, 101))
    assert np.ptp([*towards, *between]) == pytest.approx(droop, rel=6e-4)
    # points and edge alone, of which outputs are made
    few = three_point_profile(1.0, 1.0, ring, 1.0, poisson, np.array([0.0, ring, 1.0]))
    assert np.ptp(few) == pytest.approx(droop, rel=4e-3)


@pytest.mark.parametrize(("ring", "shear", "rise"), solved("sandwich plate"))
def test_a_sandwich_bends_and_shears_as_finite_elements(ring, shear, rise):
    bent = free_plate_profile(1.0, 1.0, ring, 1.0, 0.24, 1.0)
    assert bent + shear_profile(1.0, 1.0, ring, shear, 1.0) == pytest.approx(rise, rel=2e-4)


def test_three_points_shear_a_plate_as_their_waves():
    radius, ring, hold = 1.0, 0.6, 0.01
    waves = np.arange(3, 3000, 3)
    near = (1.0 - hold / ring) ** waves
    expected = np.sum((near + (ring / radius) ** (2 * waves)) / waves) / (2.0 * math.pi)
    towards, _ = three_point_shear(1.0, radius, ring, 1.0, hold, ring)
    even = shear_profile(1.0, radius, ring, 1.0, ring)
    assert even - towards == pytest.approx(expected, rel=1e-6)
    signs = np.resize([-1.0, 1.0], waves.size)
    _, between = three_point_shear(1.0, radius, ring, 1.0, hold, 0.4)
    even = shear_profile(1.0, radius, ring, 1.0, 0.4)
    shares = ((0.4 / ring) ** waves + (0.4 * ring) ** waves) / waves
    assert even - between == pytest.approx(np.sum(signs * shares) / (2.0 * math.pi), rel=1e-6)


@pytest.mark.parametrize(("share", "_", "peak"), solved("holes pulled alike"))
def test_holes_pulled_alike_raise_stress_as_finite_elements(share, _, peak):
    found = tension_at_holes(1.0, 1.0, share) / perforated_share(share)
    assert found == pytest.approx(peak, rel=0.042)


@pytest.mark.parametrize(("share", "_", "peak"), solved("holes pulled in one direction"))
def test_holes_pulled_in_one_direction_likewise(share, _, peak):
    found = tension_at_holes(0.0, 1.0, share) / perforated_share(share)
    assert found == pytest.approx(peak, rel=0.045)


@pytest.mark.parametrize(("share", "_", "stiffness"), solved("stiffness with holes"))
def test_films_with_holes_are_no_stiffer_than_their_bound(share, _, stiffness):
    assert stiffness <= float(perforated_share(share)) * (1.0 + 1e-3)
    assert stiffness > 0.7 * float(perforated_share(share))


def test_a_lone_hole_has_kirschs_stress():
    assert tension_at_holes(1.0, 0.0, 1e-9) == pytest.approx(3.0, rel=1e-6)
    assert tension_at_holes(1.0, -1.0, 1e-9) == pytest.approx(4.0, rel=1e-6)
    assert tension_at_holes(2.0, 1.0, 0.0) == 2.0


@pytest.mark.parametrize(("poisson", "_", "root"), solved("frequency"))
def test_a_free_plate_rings_as_finite_elements(poisson, _, root):
    found = free_plate_frequency(1.0, 1.0, 1.0, poisson)
    assert found * 2.0 * math.pi == pytest.approx(root, rel=0.006)


def test_a_plate_under_a_heavy_payload_rings_as_one_held_in_its_middle():
    # λ² = 3.752 of ν = 0.3: Leissa (1969), Blevins (1979)
    profile = free_plate_profile(1.0, 1.0, 1e-6, 1.0, 0.3, UMBRELLA_PLACES)
    found = umbrella_frequency(profile, 0.0, math.pi, 1e9) * 2.0 * math.pi
    assert found == pytest.approx(3.752, rel=0.003)
    # and without one faster than as a saddle
    free = umbrella_frequency(profile, 0.0, math.pi, 0.0)
    assert free > free_plate_frequency(1.0, 1.0, 1.0, 0.3)


def test_a_plate_that_shears_rings_as_a_drum_with_a_free_edge():
    from scipy.special import jvp

    root = free_shear_frequency(2.0, 3.0, 48.0) * 2.0 * math.pi * 2.0 / 4.0
    assert abs(jvp(2, root)) < 1e-9


def test_a_sphere_rings_as_lamb_has_it():
    # ω R √(ρ/E) of the lowest mode, ν = 0.3: Baker (1961) has 0.73
    found = sphere_frequency(2.0, 3.0, 5.0, 0.3) * 2.0 * math.pi * 2.0 * math.sqrt(3.0 / 5.0)
    assert found == pytest.approx(0.734, abs=1e-3)
    assert sphere_frequency(2.0, 3.0, 5.0, 0.3, 1e9) < 1e-3 * sphere_frequency(2.0, 3.0, 5.0, 0.3)


@pytest.mark.parametrize("opening", [0.3, 0.8, 1.0])
def test_an_open_sphere_rings_by_its_change_of_curvature(opening):
    # energies of Rayleigh's displacements, with curvatures by differences of the displacement
    def rise(angle):
        return (2.0 + math.cos(angle)) * math.tan(0.5 * angle) ** 2

    def bent(angle):
        step = 1e-4
        second = (rise(angle + step) - 2.0 * rise(angle) + rise(angle - step)) / step**2
        return (second + rise(angle)) ** 2 * math.sin(angle)

    def moved(angle):
        grows = math.tan(0.5 * angle) ** 4
        flat = 2.0 * math.sin(angle) ** 2
        return (grows * flat + rise(angle) ** 2) * math.sin(angle)

    end = math.pi - math.asin(opening)
    ratio = quad(bent, 1e-3, end)[0] / quad(moved, 1e-3, end)[0]
    found = open_sphere_frequency(1.0, opening, 1.0, 1.0, 0.3) * 2.0 * math.pi
    assert found == pytest.approx(math.sqrt(4.0 * 0.7 * ratio), rel=2e-4)


def test_a_strip_folds_as_the_elastica():
    # D φ'' = N sin φ from a right angle at the hold to none far away
    tension, stiffness = 0.2, 6e-11
    start = float(fold_curvature(tension, stiffness))
    unit = math.sqrt(stiffness / tension)
    found = solve_ivp(
        lambda _, y: [y[1], math.sin(y[0])], (0.0, 4.0), [0.5 * math.pi, -start * unit],
        rtol=1e-10, atol=1e-12,
    )  # fmt: skip
    assert abs(found.y[0, -1]) < 0.1  # it lies flat there, and did not turn back before
    assert np.all(np.diff(found.y[0]) < 0.0)
    margin = 3.0 * tension + 7.0 * start
    assert fold_tension(margin, 3.0, 7.0, stiffness) == pytest.approx(tension, rel=1e-10)


def test_a_face_dimples_at_the_zero_of_bessel():
    film = laminate_stiffness(ALUMINA)
    root = math.sqrt(float(dimpling_load(2e-5, film)) / film.plate) * 2e-5
    assert abs(j1(root)) < 1e-12


def test_a_post_bends_the_film_at_its_edge():
    posts = Ligaments(1e-4, 1e-5, 1e-7)
    film, a, b = laminate_stiffness(ALUMINA), 1e-5, float(posts.cell_radius)
    # f cos φ: f = r, f' = 1 at the post; f = 0, f'' + f'/r - f/r² = 0 at the cell's edge
    powers = np.array([[a, 1 / a, a**3, a * math.log(a)],
                       [1, -1 / a**2, 3 * a**2, math.log(a) + 1],
                       [b, 1 / b, b**3, b * math.log(b)],
                       [0, 0, 8 * b, 2 / b]])  # fmt: skip
    scale = np.array([1 / a, a, 1 / a**3, 1 / a])
    found = scale * np.linalg.solve(powers * scale, [a, 1, 0, 0])
    bent = abs(found @ [0, 2 / a**3, 6 * a, 1 / a]) * film.plate  # moment per width, a turn of 1
    moment = float(root_stiffness(posts, film))
    # a shear force Q turns the post's ends by the moment Q/(2n)
    expected = bent / moment / (2.0 * posts.number_density)
    assert root_moment(posts) == pytest.approx(expected, rel=1e-6)


CAPS = [[float(part) for part in row] for row in rows("hollow_face.csv")]


@pytest.mark.parametrize(("rim", "tac", "opening", "found"), CAPS)
def test_free_molecules_meet_a_hollow_face_again(rim, tac, opening, found):
    assert tac_within(tac, opening) == pytest.approx(found, rel=1.5e-3)
    # a cap of radius one, whose film is as wide as its arc
    assert opening - 0.03 * rim**4 < projected_share(Curl(rim, rim), 1.0) <= opening


def test_what_is_seen_from_above_to_the_first_term():
    small = 1e-3
    found = projected_share(Curl(3.0 * small, small), 2.0)
    assert 1.0 - found == pytest.approx(0.5 * 10.0 * small**2, rel=1e-5)


def test_a_rim_buckles_as_a_ring():
    # Lévy (1884) of a ring: 3 EI/R³
    assert rim_buckling_pressure(2.0, 2.0, 5.0) == pytest.approx(15.0 / 8.0)


def test_a_tether_hangs_by_its_strength_and_a_rod_stands_by_its_stiffness():
    mass = float(tether_mass(9.8e-5, 0.1, 970.0, 2.7e9))
    section = mass / (970.0 * 0.1)
    assert 9.8e-5 / section == pytest.approx(2.7e9 / 2.0)
    mass = float(rod_mass(9.8e-5, 0.1, 1800.0, 2e11, 1.0))
    section = mass / (1800.0 * 0.1)
    assert math.pi**2 * 2e11 * section**2 / (4.0 * math.pi) / 0.01 == pytest.approx(9.8e-5)


def disk(laminate=MYLAR, **changed):
    film = lf.FilmProperties(7e-4, 0.75, 0.08, 0.08, 0.8, 0.9, laminate=laminate)
    return lf.Disk(film, **{"radius": 0.01, **changed})


def shape_of(flyer, pressure=0.0):
    """Its shape at room temperature 70 km up, in plain numbers."""
    with lf.float64():
        found = flyer.shape(lf.Earth().state(70e3), (ROOM,) * len(flyer.nodes), 0.0, pressure)
        return type(found)(*(float(number) for number in found))


@pytest.mark.parametrize("hanging", ["circle", "three points"])
@pytest.mark.parametrize("radius", [None, 6e-3])
def test_the_load_that_is_borne_breaks_it(hanging, radius):
    if radius is None and hanging != "circle":
        with pytest.raises(lf.ParameterError, match="give its hanging_radius"):
            disk(hanging=hanging)
        return
    free = shape_of(disk(hanging=hanging, hanging_radius=radius))
    gravity = float(lf.Earth().state(70e3).gravity)
    loaded = disk(hanging=hanging, hanging_radius=radius, payload=free.bearable_load / gravity)
    assert shape_of(loaded).stress_over_strength == pytest.approx(1.0, rel=1e-9)
    assert shape_of(loaded).bearable_load == pytest.approx(0.0, abs=1e-6 * free.bearable_load)


def test_three_points_bend_more_than_their_circle_and_less_than_the_middle():
    middle, circle, three = (
        shape_of(disk(payload=1e-12, hanging_radius=radius, hanging=hanging)).deflection
        for radius, hanging in ((None, "circle"), (6e-3, "circle"), (6e-3, "three points"))
    )
    assert circle < three < 0.35 * middle


def test_outputs_of_handling_are_those_loads():
    setup = lf.Setup(disk(), lf.Earth(), lf.Lu2023())
    with lf.float64():
        case = OperatingPoint(setup, 70e3)
        load = float(case.shape.bearable_load)
        drag = setup.flyer.drag(case.state, case.balance.unknowns, case.bearable_wind)
        assert float(drag) == pytest.approx(load, rel=1e-6)
    table = lf.predict(setup, at=[70e3]).at
    expected = load / setup.flyer.own_mass
    assert table["bearable_acceleration"][0] == pytest.approx(float(expected), rel=1e-6)


def test_curl_costs_lift_where_the_hollow_face_meets_molecules_again():
    flat = shape_of(disk())
    assert flat.lift_kept == pytest.approx(1.0, abs=1e-9)
    coat = Lamina(2e-8, 8e10, 0.22, 6e-6, 5e5)
    up, down = ([coat, *MYLAR.layers], [*MYLAR.layers, coat])
    kept = {}
    for name, layers in (("up", up), ("down", down)):
        found = shape_of(disk(Laminate(layers)))
        assert (found.curvature > 0) == (name == "up")
        kept[name] = found.lift_kept
        share = float(projected_share(Curl(found.curvature, 0.0), 0.01))  # it rolls
    # edges up: the face of less accommodation is hollow, and both become alike
    assert kept["up"] < share**2 < kept["down"]
    change = (0.8 + 0.8 * 0.2 * (1 - share) - 0.8) / 0.1
    assert kept["up"] == pytest.approx(share**2 * (1 - change), rel=2e-2)


def hollow(form="sphere", **changed):
    film = lf.FilmProperties(2e-4, 0.5, 0.8, 0.1, 0.9, 0.9, laminate=ALUMINA)
    numbers = {"size": 0.1, "outlet_radius": 0.02, "open_fraction": 0.5, "channel_width": 1e-4,
               "wall_thickness": 1e-4, "sheet_thickness": 5e-8, "sheet_conductivity": 1.8,
               }  # fmt: skip
    return lf.HollowBody(film, film, **{**numbers, **changed}, form=form)


@pytest.mark.parametrize("form", ["sphere", "cone", "rocket"])
def test_a_hollow_body_buckles_by_pressure_from_outside_alone(form):
    within, outside = (shape_of(hollow(form), sign * 3.0) for sign in (1, -1))
    assert within.load_over_buckling == 0.0
    assert outside.load_over_buckling == pytest.approx(3.0 / outside.buckling_pressure)
    assert within.stress_over_strength > outside.stress_over_strength
    assert math.isnan(within.curvature)


def test_a_wall_of_equal_films_has_the_hoop_stress():
    found = shape_of(hollow(open_fraction=1e-12), 3.0)
    hoop = 3.0 * 0.05 / 2.0 / 2e-7 / 1.7e9
    assert found.stress_over_strength == pytest.approx(2.0 * hoop, rel=1e-6)  # at a lone hole


def test_a_balloon_has_its_hoop_stress_and_rings_only_taut():
    film = lf.FilmProperties(1e-2, 0.9, 0.9, 0.9, 0.9, 0.9, laminate=MYLAR)
    taut, slack = (shape_of(lf.Balloon(film, 2.0), pressure) for pressure in (5.0, 0.0))
    assert taut.stress_over_strength == pytest.approx(5.0 * 2.0 / 2.0 / 5e-7 / 1e8, rel=1e-6)
    assert slack.lowest_frequency == 0.0
    assert taut.lowest_frequency > 0.0


def test_a_prediction_of_a_hollow_body_has_its_shape():
    found = lf.predict(lf.Setup(hollow(), lf.Earth(), lf.force.HollowPump()), at=[70e3])
    assert found.at["buckling_pressure"][0] > 0.0
    assert found.at["load_over_buckling"][0] == 0.0
    assert found.at["lowest_frequency"][0] > 1.0


CASES = {
    "three points": lambda x: three_point_profile(1.0, 0.01 * x, 6e-3, 1.0, 0.3 * x, 6e-3)[0],
    "profile": lambda x: free_plate_profile(1.0, 0.01 * x, 6e-3, 1.0, 0.3 * x, 8e-3),
    "holes": lambda x: tension_at_holes(2.0 * x, 1.0, 0.3 * x),
    "open sphere": lambda x: open_sphere_frequency(0.01, 0.005 * x, 1e-3, 1e-9 * x, 0.3),
    "sphere": lambda x: sphere_frequency(0.01 * x, 1e-3, 1.0, 0.3 * x, 0.1),
    "fold": lambda x: fold_tension(1e8 * x, 1e6, 1e3, 1e-10 * x),
    "hollow face": lambda x: tac_within(0.8 * x, 0.9),
    "rod": lambda x: rod_mass(x, 0.1 * x, 1e3, 1e9),
    "film": lambda x: shape_of_film(MYLAR, 0.01 * x, ROOM, Held(2e-7, 1e-9, 9.8)).lowest_frequency,
}


def test_derivatives_are_those_of_finite_differences(require_derivatives):
    def of_all(x):
        return lf.xp.stack([function(x[0]) for function in CASES.values()])

    require_derivatives(of_all, np.ones(1), rtol=1e-5, atol=1e-12)
