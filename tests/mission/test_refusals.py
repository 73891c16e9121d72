"""What cannot fly, land, hang, spread or be carried is refused in one line that says why."""

import pytest

import lightflyer as lf
from lightflyer.mission import Circle, Ensemble, Landing, Mission, Polygon, Tether
from lightflyer.mission.mission import times_of
from lightflyer.mission.swarms.over_altitude import drift_over_altitude, stability_over_altitude

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DISK, LADEN = lf.Disk(FILM, 0.01), lf.Disk(FILM, 0.01, payload=1e-7)
EARTH, LU, FREE = lf.Earth(), lf.Lu2023(), lf.FreeMolecular()
STATE = EARTH.state(70e3)
PLACE = {"latitude": 45.0, "longitude": 10.0, "time": "2026-06-21T12:00Z"}
REST = lf.Release("75 km", **PLACE)
STATION = Circle(20.2, -179.9, "60 km")
BALLOON = lf.Balloon(lf.FilmProperties(1e-2, 0.9, 0.5, 0.5, 0.9, 0.9), radius=3.0)
SPHERE = lf.Sphere(2e-6, 0.8, 0.3, 0.4, tac_top=0.8, tac_bottom=0.9, density=1500.0)
TOWARDS = {"release": lf.Release("20 km", **PLACE), "duration": "1 h",
           "attitude": lf.mission.TowardsStation(STATION)}  # fmt: skip


class Unknown(lf.Disk):
    """A flyer without a law of drag."""

    def drag(self, *arguments, **named):
        return lf.AbstractFlyer.drag(self, *arguments, **named)


def moving(*velocity, altitude="75 km"):
    return lf.Release(altitude, **PLACE, velocity=velocity)


def fly(flyer=DISK, environment=EARTH, model=FREE, release=REST, **more):
    return lf.fly(flyer, environment, model, release=release, duration="1 h", **more)


def spread(release=REST, duration="1 h", **more):
    given = {"ensemble": Ensemble(3)} | more
    return lf.mission.disperse_ensemble(
        DISK, EARTH, LU, release=release, duration=duration, **given
    )


def hang(flyer=LADEN, state=STATE, rod=1e-3, **more):
    return lf.mission.hanging_stability(flyer, state, rod=rod, **more)


def carry(payload, altitude=72e3, **more):
    return lf.mission.tethered_swarm(DISK, EARTH, LU, payload=payload, altitude=altitude, **more)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: Mission(Circle(45.0, 0.0, 1e5), "1 h"), "must be of class Release, not Circle"),
        (lambda: Mission(REST, "1 kg"), "duration"),
        (lambda: times_of(-5.0), "duration"),
        (lambda: lf.Release(75e3, **PLACE | {"time": "soon"}), "soon"),
        (lambda: lf.Release("75 km", **PLACE, velocity=5.0), "three components"),
        (lambda: moving(0.0, 0.0, "12 km/s"), "leaves the Earth"),
        (lambda: fly(Unknown(FILM, 0.01)), "has no law of drag"),
        (lambda: fly(environment=lf.Chamber()), "over altitude"),
        (lambda: fly(release=moving(3000.0, 0.0, 0.0, altitude="95 km")), "lost in this model"),
        (lambda: fly(ensemble=Ensemble(3, velocity=1.0)), r"add \[mission.release\]"),
        (
            lambda: fly(BALLOON, EARTH, lf.BalloonConvection(), moving(1, 0, 0, altitude="10 km")),
            "moves with a balloon",
        ),
        (
            lambda: lf.mission.trajectory(DISK, EARTH, FREE, moving(1.0, 0.0, 0.0), [0.0, 60.0]),
            "takes no velocity",
        ),
        (
            lambda: lf.fly(BALLOON, EARTH, lf.BalloonConvection(), **TOWARDS),
            "a balloon hangs upright",
        ),
        (
            lambda: lf.mission.disperse_ensemble(
                BALLOON, EARTH, lf.BalloonConvection(), **TOWARDS, ensemble=Ensemble(3)
            ),
            "a balloon hangs upright",
        ),
        (
            lambda: fly(SPHERE, model=lf.KineticSphere(), attitude=lf.mission.FollowSun()),
            "FollowSun: a sphere has no tilt: its lower half",
        ),
        (
            lambda: drift_over_altitude(lf.Setup(SPHERE, EARTH, lf.KineticSphere())),
            "a sphere has no tilt",
        ),
        (lambda: lf.mission.ChooseWind(STATION, "80 km", "70 km"), "highest of the winds"),
        (lambda: Ensemble(members=2, waves=1.0).waves_over(lf.Mars()), "over Mars leave waves out"),
        (lambda: Landing(objects=0), "at least 1"),
        (lambda: Landing(flight_levels=()), "hundreds of feet"),
        (lambda: Landing(flight_levels=(24_500,)), "hundreds of feet"),
        (lambda: Polygon([0.0, 1.0], [0.0, 1.0]), "2 corners"),
        (lambda: Polygon([0.0, 1.0, 2.0], [0.0, 1.0]), "each corner"),
        (lambda: Polygon([0.0, 0.0, 0.0], [0.0, 120.0, 240.0]), "half of the planet"),
        (lambda: Polygon([0.0, 91.0, 2.0], [0.0, 1.0, 1.0]), "latitudes"),
        (lambda: spread(ensemble=Ensemble(members=0)), "0 members"),
        (lambda: spread(areas=["Bavaria"]), "not str"),
        (lambda: spread(duration="-1 h"), "duration"),
        (lambda: spread(lowest=76e3), "release altitude 75 km"),
        (lambda: carry(1e-4, 40e3), "does not lift itself at 40 km"),
        (lambda: carry(0.0), "nothing to carry"),
        (lambda: carry(1e-4, spacing=1.5e-2), "diameter of a flyer"),
        (lambda: carry(1e-1, tether=Tether(1e-5)), "do not carry it"),
        (lambda: hang(rod=-1e-3), "rod"),
        (lambda: hang(rod=0.0), "no distance"),
        (lambda: hang(payload_drag=-1.0), "payload_drag"),
        (lambda: hang(DISK), "payload is zero"),
        (lambda: hang(DISK, EARTH.state([7e4, 8e4])), "one flyer at one place"),
        (lambda: hang(BALLOON), "flat"),
        (lambda: drift_over_altitude(lf.Setup(DISK, lf.Chamber(), LU)), "over pressure"),
        (lambda: drift_over_altitude(lf.Setup(lf.Disk(FILM, 0.2), EARTH, LU)), "give altitudes"),
        (
            lambda: stability_over_altitude(lf.Setup(DISK, EARTH, LU), rod="1 mm"),
            "payload is zero",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(call, says):
    with pytest.raises((lf.ParameterError, lf.ConfigurationError), match=says) as caught:
        call()
    assert "\n" not in str(caught.value)
