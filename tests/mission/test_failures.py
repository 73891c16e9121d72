"""Flights end where their flyer fails, its film too hot or torn, and where they are interrupted."""

from itertools import chain, repeat

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.compute import scheduler, store
from lightflyer.core import progress
from lightflyer.core.progress import report, report_to, reported_as_part
from lightflyer.mission import fleet
from lightflyer.mission.fleet import forget_flights, keeps_flights
from lightflyer.mission.path import integration
from lightflyer.mission.path.integration import TerminationReason
from lightflyer.mission.report.summary import summarise

LIMIT = 480.0


def disk(limit=LIMIT, **more):
    film = lf.FilmProperties(
        1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9, highest_temperature=limit, **more
    )
    return lf.Disk(film, radius=0.0025)


def fly(flyer, **more):
    release = lf.Release("75 km", latitude=10.0, longitude=0.0, time="2026-06-21T11:00Z")
    options = {"release": release, "duration": "3 h", "every": "1 min"} | more
    return lf.fly(flyer, lf.Earth(), lf.FreeMolecular(), **options)


@pytest.fixture(scope="module")
def beyond():
    """The same flight of a film that bears more."""
    return fly(disk(limit=2000.0))


@pytest.mark.parametrize("every", ["1 min", "1 h"])
def test_a_flight_ends_where_its_film_is_too_hot(beyond, every):
    flown = fly(disk(), every=every)
    assert TerminationReason(int(flown.end_reason)) is TerminationReason.TOO_HOT
    crossing = np.interp(LIMIT, beyond["temperature"][:60], beyond["elapsed"][:60])
    assert float(flown.end_elapsed) == pytest.approx(crossing, abs=0.1)
    found = summarise(flown)
    assert found["film"] == {"bears_k": LIMIT, "hottest_k": pytest.approx(LIMIT, abs=1e-6)}
    assert found["end"] == "got hotter than its film withstands"
    assert "because   it got hotter than its film withstands" in lf.mission.describe(flown)
    assert "the flyer reaches" not in lf.mission.describe(flown)


def test_a_film_that_is_too_hot_at_its_release_does_not_fly():
    flown = fly(disk(limit=300.0))
    assert float(flown.end_elapsed) == 0.0
    assert flown.attrs["end"] == "got hotter than its film withstands"


def test_members_of_an_ensemble_end_as_the_stated_flight_does(beyond):
    """The altitude of release decides when each is too hot."""
    ensemble = lf.mission.Ensemble(members=6, altitude=200.0)
    flown = fly(disk(), ensemble=ensemble, every="10 min")
    assert summarise(flown)["ensemble"]["ends"] == {"too_hot": 6}
    assert "6 flights: 100.0 % too hot" in lf.mission.describe(flown)
    ends = flown.ensemble_end_altitude
    # the same film is too hot at one altitude, under a sun that hardly moves
    assert float(np.abs(ends - flown.end_altitude).max()) < 0.1 * float(ends.mean() - 75e3)
    exact = fly(
        disk(), ensemble=lf.mission.Ensemble(members=6, drag=0.0, waves=0.0), every="10 min"
    )
    np.testing.assert_allclose(exact.ensemble_end_elapsed, exact.end_elapsed, atol=0.05)


def test_a_film_that_tears_ends_the_flight():
    still, grows = (lf.structure.Lamina(5e-7, 7e10, 0.3, expansion, strength=5.6e7)
                    for expansion in (0.0, 1e-5))  # fmt: skip
    flyer = disk(limit=None, laminate=lf.structure.Laminate([still, grows]))
    torn = fly(flyer)
    assert torn.attrs["end"] == "tore: a layer's tension passed its strength"
    state = lf.Earth().state(float(torn.end_altitude))
    heat = lf.equilibrium(flyer, state, lf.FreeMolecular())
    with lf.float64():
        shape = flyer.shape(state, heat.temperatures, 0.0)
    assert float(shape.stress_over_strength) == pytest.approx(1.0, abs=1e-6)


def test_an_interrupted_flight_keeps_what_was_flown(monkeypatch):
    asked = chain([False] * 3, repeat(True))
    monkeypatch.setattr(integration, "asked_to_end", lambda: next(asked))
    flown = fly(disk(limit=None))
    assert flown.attrs["end"] == "was interrupted"
    assert 0.0 < float(flown.end_elapsed) < 3.0 * 3600.0
    assert np.isfinite(flown.altitude.values).sum() > 1


def test_an_interrupted_ensemble_says_how_many_were_flown(monkeypatch):
    asked = chain([False], repeat(True))
    monkeypatch.setattr(fleet, "BATCH", 1)
    monkeypatch.setattr(scheduler, "processors", lambda: 1)
    monkeypatch.setattr(fleet, "asked_to_end", lambda: next(asked))
    flown = fly(disk(limit=None), ensemble=lf.mission.Ensemble(members=3))
    assert flown.sizes["member"] == 1
    assert "interrupted: 1 of 3 further flights were flown" in flown.attrs["warnings"]


@pytest.mark.parametrize("members", [3, 7])
def test_an_interrupted_ensemble_goes_on_and_is_the_same(monkeypatch, tmp_path, members):
    monkeypatch.setattr(fleet, "BATCH", 3)
    monkeypatch.setattr(scheduler, "processors", lambda: 1)
    folder, given = tmp_path / "flights", {"ensemble": lf.mission.Ensemble(members, wind=5.0)}
    whole = fly(disk(limit=None), launches=[3600.0], **given)
    asked = chain([False], repeat(True))
    with monkeypatch.context() as patch:
        patch.setattr(fleet, "asked_to_end", lambda: next(asked))
        part = fly(disk(limit=None), launches=[3600.0], **given, folder=folder)
    assert "the same call goes on" in part.attrs["warnings"]
    assert part.sizes["member"] == 3
    (first,) = folder.glob("*.npz")
    when = first.stat().st_mtime_ns
    again = fly(disk(limit=None), launches=[3600.0], **given, folder=folder)
    assert again.identical(whole)
    assert first.stat().st_mtime_ns == when
    assert keeps_flights(folder)
    forget_flights(folder)
    assert not folder.exists()


def test_flights_of_another_mission_or_version_are_refused(monkeypatch, tmp_path):
    ensemble, folder = lf.mission.Ensemble(members=2), tmp_path / "flights"
    fly(disk(limit=None), ensemble=ensemble, folder=folder)
    for what, flyer, given in (
        ("ensemble", disk(limit=None), {"ensemble": lf.mission.Ensemble(members=3)}),
        ("object: flyer.film", disk(limit=600.0), {"ensemble": ensemble}),
        ("times", disk(limit=None), {"ensemble": ensemble, "every": "20 min"}),
    ):
        with pytest.raises(lf.OutputError, match=f"another mission, which differs in .*{what}"):
            fly(flyer, **given, folder=folder)
    monkeypatch.setattr(store, "versions", lambda: {"lightflyer": "0.0"})
    with pytest.raises(lf.OutputError, match=r"another mission, .*lightflyer"):
        fly(disk(limit=None), ensemble=ensemble, folder=folder)
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(lf.OutputError, match="is no mission"):
        fly(disk(limit=None), ensemble=ensemble, folder=tmp_path)


def test_a_cut_file_is_flown_again_and_an_interrupted_flight_is_not_kept(monkeypatch, tmp_path):
    ensemble, folder = lf.mission.Ensemble(members=2), tmp_path / "flights"
    whole = fly(disk(limit=None), ensemble=ensemble, folder=folder)
    (folder / "flights-000001.npz").write_bytes(b"cut")
    assert fly(disk(limit=None), ensemble=ensemble, folder=folder).identical(whole)
    asked = chain([False] * 3, repeat(True))  # while the stated flyer is under way
    monkeypatch.setattr(integration, "asked_to_end", lambda: next(asked))
    forget_flights(folder)
    fly(disk(limit=None), ensemble=ensemble, folder=folder)
    assert not keeps_flights(folder)


def test_only_work_that_listens_is_asked_to_end():
    assert not progress.ask_to_end()
    with progress.ends_early():
        assert not progress.asked_to_end()
        assert progress.ask_to_end()
        assert progress.asked_to_end()
        assert not progress.ask_to_end()  # the second time the process ends
    assert not progress.asked_to_end()


def test_an_ensemble_tells_how_far_it_is():
    """All the time, not batch by batch; a swarm counts its members."""
    steps = []
    with report_to(steps.append):
        fly(disk(limit=None), ensemble=lf.mission.Ensemble(members=8, wind=5.0))
    told = [step.done for step in steps if step.unit == "flights"]
    assert told == sorted(told)
    assert len({*told}) > 3
    assert {step.total for step in steps if step.unit == "flights"} == {9}
    with report_to(steps.append), reported_as_part(100, 200, "flights"):
        report("flying", 7, 9, "flights")
        report("flying", 7, 9, "h")
    assert steps[-1] == ("flying", 107, 200, "flights")
