"""Areas against closed forms and rotations, spreads against diffusion, tethers against balances."""

import json

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation
from scipy.stats import binomtest

import lightflyer as lf
from lightflyer.mission import Circle, Polygon, Tether
from lightflyer.mission.report.figures import plot_spread
from lightflyer.mission.report.landing import binomial_interval
from lightflyer.mission.swarms import spreading
from lightflyer.mission.swarms.tethers import _Layer

RADIUS = 6.371e6
FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
HOURS, WIND, MEMBERS = 6.0, 15.0, 45


@pytest.fixture(scope="module")
def everywhere():
    normal = np.random.default_rng(3).standard_normal((200_000, 3))
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


@pytest.mark.parametrize(
    ("area", "share"),
    [
        (Circle(45.0, 170.0, 3e6), 0.5 * (1.0 - np.cos(3e6 / RADIUS))),
        (Polygon([0.0, 0.0, 90.0], [170.0, -100.0, 0.0]), 0.125),
        (Polygon([60.0] * 4, [0.0, 90.0, 180.0, 270.0]), None),  # around a pole
        (Polygon([0, 40, 40, 10, 40, 40, 0], [0, 0, 10, 20, 30, 40, 40]), None),  # a notch
    ],
)
def test_areas_cover_their_share_of_the_sphere(everywhere, area, share):
    if share is None:
        share = girard(area) / (4.0 * np.pi)
    found = area.contains(everywhere, RADIUS).mean()
    assert found == pytest.approx(share, abs=4.0 * np.sqrt(share / len(everywhere)))


def girard(polygon):
    """Area of a spherical polygon by its angles, which may be reflex."""
    north, east = np.radians(polygon.latitudes), np.radians(polygon.longitudes)
    units = np.stack([np.cos(north) * np.cos(east), np.cos(north) * np.sin(east), np.sin(north)], 1)
    total = 0.0
    for before, here, after in zip(np.roll(units, 1, 0), units, np.roll(units, -1, 0), strict=True):
        back, forth = (other - here * (here @ other) for other in (before, after))
        total += np.arctan2(here @ np.cross(back, forth), back @ forth) % (2.0 * np.pi)
    excess = total - (len(units) - 2) * np.pi
    return min(excess, 2.0 * np.pi * len(units) - total - (len(units) - 2) * np.pi)


def test_a_polygon_turned_as_a_whole_has_the_same_places(everywhere):
    turn = Rotation.from_euler("xyz", [70.0, 35.0, 160.0], degrees=True)
    square = [(10.0, 10.0), (10.0, 30.0), (35.0, 30.0), (35.0, 10.0)]
    units = [Rotation.from_euler("zy", [east, -north], degrees=True) for north, east in square]
    upright = np.array([unit.inv().apply([1.0, 0.0, 0.0], inverse=True) for unit in units])
    before, turned = (
        Polygon(np.degrees(np.arcsin(z)), np.degrees(np.arctan2(y, x)))
        for x, y, z in (upright.T, turn.apply(upright).T)
    )
    inside = before.contains(everywhere, RADIUS)
    assert inside.sum() > 100
    np.testing.assert_array_equal(turned.contains(turn.apply(everywhere), RADIUS), inside)


def test_intervals_of_shares_are_scipys():
    counts = np.array([0, 1, 7, 99, 100])
    low, high = binomial_interval(counts, 100)
    exact = [binomtest(int(count), 100).proportion_ci() for count in counts]
    np.testing.assert_allclose(low, [part.low for part in exact], rtol=1e-8)
    np.testing.assert_allclose(high, [part.high for part in exact], rtol=1e-8)


@pytest.fixture(scope="module")
def flown(tmp_path_factory, closed_form_disk):
    """A call that flies a swarm in three batches, and what it gives."""
    patch = pytest.MonkeyPatch()
    patch.setattr(spreading, "MEMBERS", MEMBERS // 3)
    folder = tmp_path_factory.mktemp("swarm") / "kept"
    disk = closed_form_disk(2e-3)

    def fly(**others):
        given = {
            "release": lf.Release("70 km", latitude=80.0, longitude=179.0, time=0.0),
            "duration": HOURS * 3600.0,
            "every": 3.0 * 3600.0,
            "ensemble": lf.mission.Ensemble(members=MEMBERS, wind=WIND, wind_correlation_time=1e9),
            "areas": [Circle(80.0, 179.0, "1 km"), Circle(80.0, 179.0, "5000 km")],
            "folder": folder,
        }
        return lf.mission.disperse_ensemble(disk, lf.Earth(), lf.Lu2023(), **(given | others))

    yield fly, folder, fly()
    patch.undo()


def test_a_constant_random_wind_spreads_a_swarm_in_proportion_to_time(flown):
    dataset = flown[2]
    expected = np.sqrt(2.0) * WIND * dataset.elapsed.values
    # 90 numbers from a normal distribution: 7.5 %; the swarm is at 70 km, over a curved planet
    np.testing.assert_allclose(dataset.distance[1:], expected[1:], rtol=0.2)
    assert dataset.distance[2] / dataset.distance[1] == pytest.approx(2.0, rel=0.02)
    assert dataset.distance[0] < 1e-3
    assert dataset.latitude[0] == pytest.approx(80.0, abs=1e-9)
    assert dataset.longitude[0] == pytest.approx(179.0, abs=1e-9)


def test_shares_are_those_of_members_inside_and_flying(flown):
    dataset = flown[2]
    np.testing.assert_array_equal(dataset.flying, 1.0)
    np.testing.assert_array_equal(dataset.inside[0], [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(dataset.inside[1], 1.0)
    assert (dataset.inside_low <= dataset.inside).all()
    assert (dataset.inside_high >= dataset.inside).all()
    assert int(dataset.ends.sum()) == MEMBERS
    assert "wind" in dataset.attrs["assumptions"]


def test_a_swarm_has_the_draws_of_an_ensemble_in_flight(closed_form_disk):
    release = lf.Release("70 km", latitude=80.0, longitude=179.0, time=0.0)
    ensemble = lf.mission.Ensemble(members=8, wind=20.0, drag=0.3, altitude=500.0, seed=3)
    given = {"release": release, "duration": "2 h", "every": "1 h", "ensemble": ensemble}
    world = closed_form_disk(2e-3), lf.Earth(), lf.Lu2023()
    spread, flight = lf.mission.disperse_ensemble(*world, **given), lf.fly(*world, **given)
    mean = float(flight.ensemble_altitude.isel(elapsed=-1).mean())
    assert float(spread.altitude[-1]) == pytest.approx(mean, abs=1e-6)


def test_the_figure_of_a_spread_shows_every_share_in_percent(flown):
    (axes,) = plot_spread(flown[2]).axes
    drawn = np.array([line.get_ydata() for line in axes.lines])
    expected = 100.0 * np.concatenate([flown[2].flying.values[None], flown[2].inside.values])
    np.testing.assert_allclose(drawn, expected)
    assert len(axes.collections) == len(drawn)  # an interval each


def test_an_interrupted_swarm_goes_on_and_is_the_same(flown):
    fly, folder, whole = flown
    (folder / "batch-000001.npz").unlink()
    (folder / "batch-000002.npz").write_bytes(b"cut")
    again = fly()
    assert again.drop_attrs().equals(whole.drop_attrs())
    batches = folder.glob("batch-*.npz")
    assert len(list(batches)) == 3


def test_a_folder_of_another_swarm_is_refused(flown, tmp_path):
    fly, folder, _ = flown
    with pytest.raises(lf.OutputError, match="another swarm, which differs in release"):
        fly(release=lf.Release("71 km", latitude=80.0, longitude=179.0, time=0.0))
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(lf.OutputError, match="no swarm"):
        fly(folder=tmp_path)
    assert json.loads((folder / "spread.json").read_text())["release"]


def test_forces_on_a_tethered_flyer_are_in_balance():
    hung = _Layer(own=3e-6, spare=4e-6, thread=1e-7, spacing=0.3, depth=1.0)
    carried, (_, lengths, tilts) = hung.carried_weight(30), hung.pulls(30)
    total = 0.0
    for length, tilt in zip(lengths, tilts, strict=True):
        down = hung.own + hung.thread * length
        angle = np.arccos(1.0 / length)

        def balance(unknown, down=down, angle=angle):
            pull, tilt = unknown
            force = hung.own + hung.spare
            return [
                1e6 * (force * np.cos(tilt) - down - pull * np.cos(angle)),
                1e6 * (force * np.sin(tilt) - pull * np.sin(angle)),
            ]

        pull, expected = fsolve(balance, [hung.spare, 0.0], xtol=1e-12)
        assert tilt == pytest.approx(expected, rel=1e-6)
        total += pull * np.cos(angle)
    assert carried == pytest.approx(total, rel=1e-9)


@pytest.fixture(scope="module")
def disk():
    return lf.Disk(FILM, radius=0.01)


def test_tethers_with_a_mass_take_more_flyers(disk):
    given = (disk, lf.Earth(), lf.Lu2023()), {"payload": 1e-4, "altitude": 72e3}
    light, heavy = (lf.mission.tethered_swarm(*given[0], **given[1], tether=Tether(mass))
                    for mass in (0.0, 1e-7))  # fmt: skip
    assert heavy.count > light.count
    assert heavy.tether_mass > 0.5e-7 * heavy.count * heavy.depth


def test_a_tether_that_is_too_weak_is_named(disk):
    around = lf.Earth(), lf.Lu2023()
    # polyethylene of 970 kg/m³; what a fibre bears goes with its section
    strong, weak = (
        lf.mission.tethered_swarm(
            disk, *around, payload=1e-4, altitude=72e3, tether=Tether(7e-9, 970.0, strength)
        )
        for strength in (2.7e9, 1e3)
    )
    assert strong.largest_pull == pytest.approx(weak.largest_pull)
    assert weak.largest_pull > 1e3 * 7e-9 / 970.0
    assert not any("breaks" in text for text in strong.warnings)
    assert any("breaks at 7.22e-09 N" in text for text in weak.warnings)
    # its mass by the pull that it bears
    mass = lf.structure.tether_mass(strong.largest_pull, 1.0, 970.0, 2.7e9, 1.0)
    assert mass < 7e-9
