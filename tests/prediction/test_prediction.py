import dataclasses

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.design.outputs import table_of
from lightflyer.prediction.evaluator import POINTS


@pytest.fixture
def setup(disk):
    return lf.Setup(disk, lf.lu2023_earth(), lf.Lu2023())


def test_tables_are_what_the_functions_give(setup):
    prediction = lf.predict(setup, at=[68e3, 72e3])
    flyer, earth, model = setup.flyer, setup.environment, setup.model
    assert prediction.coordinates.size == POINTS
    for altitude, table in (
        (
            prediction.coordinates[100:200:20],
            {k: v[100:200:20] for k, v in prediction.table.items()},
        ),
        (np.array([68e3, 72e3]), prediction.at),
    ):
        state = earth.state(altitude)
        levitation = lf.levitate(flyer, state, model)
        np.testing.assert_allclose(table["levitation_irradiance"], levitation.irradiance, rtol=1e-9)
        np.testing.assert_allclose(table["lift"], lf.lift(flyer, state, model), rtol=1e-9)
        np.testing.assert_allclose(
            table["payload"], lf.payload(flyer, state, model), rtol=1e-6, atol=1e-15
        )


def test_optima_are_stationary(setup):
    prediction = lf.predict(setup)
    flyer, earth, model = setup.flyer, setup.environment, setup.model
    for point, function, sign in (
        (prediction.best.coordinate, lf.payload, 1.0),
        (prediction.easiest.coordinate, lambda *args: lf.levitate(*args).irradiance, -1.0),
    ):
        near = earth.state(point + np.array([-20.0, 0.0, 20.0]))
        below, at, above = sign * function(flyer, near, model)
        assert at >= max(below, above)


def test_no_more_than_the_searched_range(setup):
    prediction = lf.predict(dataclasses.replace(setup, search_range=(70e3, 74e3)))
    assert prediction.bands == [(70e3, 74e3)]
    assert prediction.coordinates[[0, -1]].tolist() == [70e3, 74e3]
    assert prediction.asked.tolist() == [70e3]


def test_any_number_of_points_may_be_asked_for(setup):
    many = np.linspace(60e3, 80e3, POINTS + 7)
    prediction = lf.predict(setup, at=many)
    assert len(prediction.summary()["at"]) == POINTS + 7
    with pytest.raises(lf.ParameterError, match="altitude"):
        lf.predict(setup, at=[130e3])


def test_chamber_map_and_table_agree(disk):
    chamber = lf.Chamber(radiation=lf.environment.Radiation(1000.0))
    prediction = lf.predict(disk, chamber, lf.Lu2023())
    found = prediction.map
    row = int(np.argmin(np.abs(found.irradiance - 1000.0)))
    irradiance = found.irradiance[row]
    state = lf.Chamber(radiation=lf.environment.Radiation(irradiance)).state(found.coordinate)
    expected = lf.equilibrium(disk, state, lf.Lu2023()).temperature
    np.testing.assert_allclose(found.temperature[:, row], expected, rtol=1e-10)


def test_dataset_without_a_file(setup):
    dataset = lf.prediction.to_dataset(lf.predict(setup))
    assert dataset["lift"].attrs["units"] == "N"
    assert not np.isinf(dataset["levitation_irradiance"]).any()
    assert np.isnan(dataset["levitation_irradiance"]).any()


def test_a_few_points_without_a_solution_are_missing(film, monkeypatch):
    """A large balloon low in the air: the levitation of some altitudes misses the tolerance."""
    balloon = lf.Balloon(film, 10.0, payload=1.0)
    setup = lf.Setup(balloon, lf.Earth(), lf.BalloonModel())
    prediction = lf.predict(setup)
    missing = np.isnan(prediction.table["levitation_irradiance"])
    assert 0 < missing.sum() < 10
    assert f"levitation missed its tolerance at {missing.sum()} of 301" in str(prediction)
    assert np.isfinite(prediction.table["payload"]).all()
    upper = float(lf.levitation_band(balloon, setup.environment, setup.model).upper)
    assert prediction.bands[-1][1] == pytest.approx(upper, abs=0.1)
    monkeypatch.setattr("lightflyer.design.outputs._FEW", 0)
    monkeypatch.setattr("lightflyer.design.outputs._SMALL_SHARE", 0.0)
    with pytest.raises(lf.ConvergenceError, match="of 301 not converged"):
        lf.predict(setup)


def test_a_point_without_a_balance_does_not_cut_a_band(disk, monkeypatch):
    setup = lf.Setup(disk, lf.lu2023_earth(), lf.Lu2023())
    whole = lf.predict(setup)
    ((low, high),) = whole.bands
    lost = whole.coordinates[np.searchsorted(whole.coordinates, 0.5 * (low + high))]

    def with_a_hole(setup, coordinates, *rest):
        table = table_of(setup, coordinates, *rest)
        return {n: np.where(coordinates == lost, np.nan, v) for n, v in table.items()}

    monkeypatch.setattr("lightflyer.prediction.evaluator.table_of", with_a_hole)
    found = lf.predict(setup)
    assert found.bands == whole.bands
    assert found.verdict.usable == whole.verdict.usable
    assert any("heat balance missed its tolerance at 1 of 301" in text for text in found.warnings)
