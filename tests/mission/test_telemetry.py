"""Passes over receivers, against spherical trigonometry and the power that a link takes."""

import csv

import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.budget.payload import RadioLink
from lightflyer.cli.commands.init import templates
from lightflyer.mission.path.integration import ALTITUDE_SCALE, Trajectory
from lightflyer.mission.report.ground import Receiver, margin, passes_of, write_passes_csv

RADIUS, HEIGHT, SPEED, END = 6.371e6, 70e3, 100.0, 4e4
LINK = RadioLink(300e3, 434e6, 50.0, 300.0, duty=0.1)


def eastward(times):
    """Along the equator at 100 m/s over ground, as scaled states."""
    angle = SPEED / RADIUS * times
    height = np.full_like(angle, HEIGHT / ALTITUDE_SCALE)
    return np.stack([np.cos(angle), np.sin(angle), 0.0 * angle, height], axis=-1)


WAY = Trajectory(np.array([0.0, 0.5 * END, END]), eastward)


def elevation(arc):
    """Elevation [deg] of what is an arc [rad] away, by the tangent rule."""
    return np.degrees(np.arctan2(np.cos(arc) - RADIUS / (RADIUS + HEIGHT), np.sin(arc)))


def distance(arc):
    return np.sqrt(
        RADIUS**2 + (RADIUS + HEIGHT) ** 2 - 2.0 * RADIUS * (RADIUS + HEIGHT) * np.cos(arc)
    )


def test_a_pass_follows_spherical_trigonometry():
    overhead = 2e4  # s
    receiver = Receiver("here", 0.0, np.degrees(SPEED / RADIUS * overhead), lowest_elevation=5.0)
    (found,) = passes_of(WAY, [receiver], LINK, RADIUS)
    edge = brentq(lambda arc: elevation(arc) - 5.0, 1e-3, 0.3) * RADIUS / SPEED
    np.testing.assert_allclose(
        [found.begin, found.end], [overhead - edge, overhead + edge], atol=0.02
    )
    assert found.highest_elevation == pytest.approx(90.0, abs=0.02)
    assert found.nearest == pytest.approx(HEIGHT, rel=1e-6)
    assert found.farthest == pytest.approx(distance(edge * SPEED / RADIUS), rel=1e-5)
    # where the link's power, sized for any distance, is that of the link as it is sized
    power = float(LINK.transmit_power())

    def spare(arc):
        needed = RadioLink(distance(arc), 434e6, 50.0, 300.0, duty=0.1, margin_db=0.0)
        return power / float(needed.transmit_power()) - 1.0

    reach = brentq(spare, 1e-3, 0.3) * RADIUS / SPEED
    assert reach < edge
    assert found.data == pytest.approx(2.0 * reach * 50.0 * 0.1, rel=1e-5)
    assert found.least_margin < 0.0
    assert float(margin(LINK, 150e3)) == pytest.approx(3.0 + 20.0 * np.log10(2.0))


def test_what_is_never_seen_or_always():
    far = Receiver("far", 60.0, 100.0)
    near = Receiver("near", 0.0, 18.0, lowest_elevation=0.0)
    slow = Trajectory(np.array([0.0, 100.0]), lambda times: eastward(times + 2e4))
    assert passes_of(WAY, [far], LINK, RADIUS) == []
    (found,) = passes_of(slow, [far, near], None, RADIUS)
    assert (found.receiver, found.begin, found.end) == (1, 0.0, 100.0)
    assert np.isnan(found.data)


MISSION = """
[[mission.receivers]]
name = "Munich"
latitude = "48.1 deg"
longitude = "11.6 deg"

[[mission.receivers]]
name = "Sydney"
latitude = "-33.9 deg"
longitude = "151.2 deg"

[payload.link]
range = "300 km"
frequency = "434 MHz"
data_rate = "50 bit/s"
noise_temperature = "300 K"
"""


def test_a_mission_tells_its_passes(write, tmp_path):
    text = templates()["mission"].read() + MISSION
    shorter = ('duration = "48 h"', 'duration = "3 h"')
    mission = lf.mission.read_mission_file(write(text, "mission.toml", shorter))
    every = [lf.fly(mission.design, **mission.arguments() | {"every": s}) for s in (60.0, 3600.0)]
    found, sparse = (lf.mission.summarise(flown)["telemetry"] for flown in every)
    assert found == sparse  # from the flight, not from what is kept of it
    (one,) = found["passes"]
    assert one["receiver"] == "Munich"
    assert one["begin"] == "2026-06-21 12:00 UTC"
    flown = every[0]
    seen = flown.receiver_elevation.sel(receiver="Munich") > 5.0
    assert found["in_sight_h"] == pytest.approx(float(seen.mean()) * 3.0, abs=0.03)
    assert found["data_bit"] == pytest.approx(one["data_bit"])
    assert not (flown.receiver_elevation.sel(receiver="Sydney") > 0.0).any()
    assert "in sight" in lf.mission.describe(flown)
    one["receiver"] = "Munich, roof"  # a comma stays in its cell
    write_passes_csv(found, tmp_path / "passes.csv")
    (row,) = csv.DictReader((tmp_path / "passes.csv").read_text("utf-8").splitlines())
    assert row["receiver"] == "Munich, roof"
    assert float(row["farthest_km"]) == pytest.approx(one["farthest_km"])


def test_a_receiver_needs_a_name(write):
    nameless = MISSION.replace('name = "Munich"\n', "")
    path = write(templates()["mission"].read() + nameless, "mission.toml")
    with pytest.raises(lf.ConfigurationError, match="receivers"):
        lf.mission.read_mission_file(path)
