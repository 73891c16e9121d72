"""Where a verdict says that a flyer comes to rest, a mission of it ends."""

import numpy as np
import pytest

import lightflyer as lf


@pytest.mark.parametrize("seed", range(4))
def test_a_mission_ends_at_the_place_of_rest(seed):
    """Four disks in a light that is always the same."""
    rng = np.random.default_rng(seed)
    film = lf.FilmProperties(
        rng.uniform(0.8e-3, 1.2e-3), rng.uniform(0.6, 0.9), 0.08, rng.uniform(0.05, 0.1),
        tac_top=0.8, tac_bottom=rng.uniform(0.88, 0.95),
    )  # fmt: skip
    disk = lf.Disk(film, radius=rng.uniform(1e-3, 4e-3))
    earth, model = lf.Earth(), lf.Lu2023()
    rest = lf.predict(disk, earth, model).verdict.rest
    below = lf.Release(
        rest.coordinate - 2e3, latitude=10.0, longitude=0.0, time="2026-06-21T12:00Z"
    )
    level = lf.mission.Level()
    flown = lf.fly(disk, earth, model, release=below, duration="30 h", attitude=level)
    assert float(flown.end_altitude) == pytest.approx(rest.coordinate, abs=10.0)
    assert float(flown.temperature[-1]) == pytest.approx(rest.values["temperature"], abs=0.1)
