import dataclasses
from functools import partial

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.design.tables import table_of, tabulate_places
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
    assert prediction.asked.tolist() == np.arange(70e3, 74.1e3, 500.0).tolist()


def test_round_coordinates_around_the_bands_are_reported(setup):
    prediction = lf.predict(setup)  # 68.0 km to 78.0 km
    assert prediction.asked.tolist() == [68e3, 70e3, 72e3, 74e3, 76e3, 78e3]
    chamber = lf.Chamber().coordinate
    assert chamber.round_points(0.95, 7.2, 8).tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    decades = chamber.round_points(0.02, 40.0, 8)
    assert decades == pytest.approx([0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0])
    assert chamber.round_points(1.1, 1.2, 8).tolist() == [1.1, 1.2]


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


@pytest.mark.parametrize("unsolved", [3, 20])
def test_a_few_points_without_a_solution_are_missing(setup, monkeypatch, unsolved):
    def with_failures(setup, coordinates, light, names):
        table = tabulate_places(setup, coordinates, light, names)
        if "levitation_converged" not in table or coordinates.size != POINTS:
            return table
        return table | {"levitation_converged": np.arange(POINTS) >= unsolved}

    whole = lf.predict(setup)
    monkeypatch.setattr(
        "lightflyer.prediction.evaluator.table_of", partial(table_of, tabulated=with_failures)
    )
    if unsolved > 10:
        with pytest.raises(lf.ConvergenceError, match="20 of 301 not converged"):
            lf.predict(setup)
        return
    found = lf.predict(setup)
    assert np.isnan(found.table["levitation_irradiance"]).sum() == unsolved
    assert found.table["payload"].tolist() == whole.table["payload"].tolist()
    assert "levitation missed its tolerance at 3 of 301" in str(found)


def test_a_large_balloon_has_a_prediction():
    """Low in the air the levitation of some altitudes misses the tolerance."""
    film = lf.FilmProperties(
        12.3e-3, 0.9, 0.9, 0.9, transmittance=0.05, tac_top=0.9, tac_bottom=0.9
    )
    setup = lf.Setup(lf.Balloon(film, 10.0, payload=1.0), lf.Earth(), lf.BalloonConvection())
    band = lf.levitation_band(setup.flyer, setup.environment, setup.model)
    assert lf.predict(setup).bands[-1][1] == pytest.approx(float(band.upper), abs=0.1)


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
