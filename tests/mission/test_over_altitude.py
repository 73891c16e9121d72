"""Drift, hanging payloads and swarms over altitude, against closed forms and each other."""

import numpy as np

import lightflyer as lf
from lightflyer.files.result_text import as_text
from lightflyer.mission.swarms.over_altitude import (
    drift_over_altitude,
    stability_over_altitude,
    summary_of,
    swarm_over_altitude,
    table_parts,
)

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
ENDS = 66e3, 80e3


def setup(flyer):
    return lf.Setup(flyer, lf.Earth(), lf.Lu2023())


def test_where_a_tilted_disk_keeps_its_altitude_it_drifts_as_the_closed_form_says(
    closed_form_disk,
):
    disk = closed_form_disk(0.01, inertia=0.0)
    found = drift_over_altitude(setup(disk), (60e3, 80e3))
    state = lf.Earth().state(found.altitude.values)
    with lf.float64():
        edgewise = np.asarray(disk.drag(state, (0.0,), 1.0, "edgewise"))
    tilt = np.radians(found.steepest)
    held = np.isfinite(tilt.values)
    assert 5 < held.sum() < held.size  # the lowest do not fly
    np.testing.assert_array_equal(held, found.climb.values[:, 0] >= 0.0)
    speed = float(disk.mass) * np.asarray(state.gravity) / edgewise * np.tan(tilt)
    np.testing.assert_allclose(found.fastest[held], speed[held], rtol=2e-4)
    climbs = found.climb.where(found.tilt < found.steepest)
    assert float(climbs.min()) > 0.0


def test_a_rod_is_stable_up_to_the_longest_that_is():
    disk = lf.Disk(FILM, radius=0.01, payload=1e-7)
    found = stability_over_altitude(setup(disk), ENDS, rod="2 mm")
    stable = found.growth_rate < 0.0  # by the modes; the longest rod is Routh's
    assert 3 < int(stable.sum()) < stable.size - 3
    np.testing.assert_array_equal(stable, found.longest_rod > 2e-3)


def test_a_deep_payload_takes_the_spare_lift_of_every_flyer_at_every_altitude():
    disk = lf.Disk(FILM, radius=0.01)
    found = swarm_over_altitude(setup(disk), (60e3, 80e3), payload=1e-4, depth="9 km")
    each = lf.payload(disk, lf.Earth().state(found.altitude.values), lf.Lu2023())
    expected = np.where(each > 0.0, np.ceil(1e-4 / np.asarray(each)), np.nan)
    assert 0 < np.isnan(expected).sum() < expected.size
    # 9 km is deep for a layer of some hundred flyers, not for one of tens of thousands
    few = ~(expected > 1e4)
    np.testing.assert_array_equal(found["count"].values[few], expected[few])


def test_altitudes_are_those_at_which_a_flyer_lifts_its_payload():
    disk = lf.Disk(FILM, radius=0.01, payload=1e-7)
    found = stability_over_altitude(setup(disk), rod="1 mm")
    band = lf.levitation_band(disk, lf.Earth(), lf.Lu2023())
    edges = found.altitude.values[[0, -1]] - [band.lower, band.upper]
    assert 0.0 <= edges[0] < 250.0
    assert -250.0 < edges[1] <= 0.0


def test_what_is_nowhere_is_empty_in_tables_and_null_in_json(disk):
    found = drift_over_altitude(setup(disk), (40e3, 60e3))
    summary = summary_of(found)
    assert set(summary["fastest"]["values"]) == {None}
    assert summary["altitude"] == {"unit": "m", "values": found.altitude.values.tolist()}
    heading, *rows = as_text(table_parts(found)).splitlines()
    assert "speed at 5°" in heading or "speed at 5°" in rows[0] + rows[1]
    numbers = [row for row in rows if row.split()[0] == "60"]
    told = next(row for row in rows if row.startswith("warning"))
    assert rows.index(numbers[0]) == rows.index(told) - 1
