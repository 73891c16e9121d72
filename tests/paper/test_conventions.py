"""One reading of the paper is a choice of many: the study that counts them."""

import json
from pathlib import Path

import numpy as np
import pytest

from lightflyer.paper.conditions import COLUMNS, over_altitude
from lightflyer.paper.results import bands, best_payload

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "studies" / "conventions"
ALTITUDES = np.array([60e3, 68e3, 72e3, 78e3, 82e3])


@pytest.fixture
def study(study_of):
    with study_of("conventions", "study") as module:
        yield module


@pytest.fixture
def results():
    return json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))


def laws(model, key):
    """Heat and force law of a column of the report."""
    if key == "printed":
        return model.PRINTED_HEAT, model.PRINTED_FORCE
    divisor, numerator, *rest = model.REPORTED_FORCE
    numerator = "T_mean" if key == "reported-mean" else numerator
    return model.REPORTED_HEAT, (divisor, numerator, *rest)


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.key)
@pytest.mark.parametrize("diameter", [0.005, 0.02, 0.04])
def test_the_package_is_the_model_at_its_readings(study, column, diameter):
    model = study.model
    heat, law = laws(model, column.key)
    ours = over_altitude(column, ALTITUDES, diameter, 1360.0)
    there = model.place(model.PRINTED_ENVIRONMENT, ALTITUDES, 0.5 * diameter)
    hot = model.levitation_temperature(law, there)
    possible = np.isfinite(hot)
    assert np.array_equal(possible, np.isfinite(ours["levitation_irradiance"]))
    needed = model.levitation_irradiance(heat, hot, there)
    sunlit = model.temperature_in_light([heat], there)[0]
    lift = model.force(law, sunlit, there) / there.weight
    for found, name, where in (
        (hot, "levitation_temperature", possible),
        (needed, "levitation_irradiance", possible),
        (sunlit, "temperature", ...),
        (lift, "lift_over_weight", ...),
    ):
        np.testing.assert_allclose(found[where], ours[name][where], rtol=1e-6, err_msg=name)


def test_edges_and_payloads_of_the_study_are_those_of_the_report(study):
    model = study.model
    pairs = [laws(model, column.key) for column in COLUMNS]
    heats, forces = ([pair[i] for pair in pairs] for i in (0, 1))
    found = study.outcome(heats, forces, model.PRINTED_ENVIRONMENT)
    for row, column in enumerate(COLUMNS):
        edges = [bands(column, 0.02, angle)[i][0] / 1e3 for angle in (0.0, 45.0) for i in (0, 2)]
        np.testing.assert_allclose(found.edges[row, row], edges, atol=0.005)
        relative = best_payload(column, 1e-2 * np.array(study.SIZES))[1]
        np.testing.assert_allclose(found.payload[row, row], relative, atol=1e-3)


def test_a_subset_has_many_that_meet_claims_1_and_2_and_none_that_meets_all(study):
    """The paper's surroundings, both faces, mean TACs, the Rayleigh term: 4374 combinations."""
    model = study.model
    heats = [h for h in model.all_of(model.HEAT) if h[2:4] == ("2A", "mean") and h[5] == "in"]
    heats = [h for h in heats if h[7] == "two"]
    forces = [f for f in model.all_of(model.FORCE) if f[4] == "mean"]
    summary = study.summary_of(model.PRINTED_ENVIRONMENT, heats, forces)
    assert summary["combinations"] == 4374
    rows = summary["rows"]
    chosen = [(row["heat"], row["force"]) for row in rows]
    assert (model.REPORTED_HEAT, model.REPORTED_FORCE) in chosen
    assert (model.PRINTED_HEAT, model.PRINTED_FORCE) not in chosen
    assert 32 <= len(rows) <= 36
    together = dict(zip(study.TOGETHER, summary["together"], strict=True))
    assert together[1, 2, 3] == together[1, 2, 4, 5, 6] == 0
    assert min(row["coldest"] for row in rows) > 315.0
    assert all(row["force"][0] != "T_c" for row in rows)  # (19) as printed


def test_the_study_covers_all_combinations(study, results):
    model = study.model
    sizes = [len(model.all_of(part)) for part in (model.HEAT, model.FORCE, model.ENVIRONMENT)]
    assert results["combinations"] == np.prod(sizes)
    assert sum(results["number_of_claims_met"].values()) == results["combinations"]
    parts = results["by_atmosphere_gas_and_gravity"]
    assert sum(part["meet_together"]["1 2"] for part in parts) == results["meet_together"]["1 2"]
    for shares in results["choices_of_those_that_meet_1_and_2"].values():
        assert sum(shares.values()) == results["meet_together"]["1 2"]


def test_the_documentation_quotes_the_study(results):
    page = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
    printed, *_ = results["by_atmosphere_gas_and_gravity"]
    assert printed["environment"] == "paper | paper | 9.8"
    quoted = [
        results["combinations"],
        results["meet_together"]["1 2"],
        results["meet_together"]["1 2 3"],
        printed["combinations"],
        printed["meet_together"]["1 2"],
    ]
    for number in quoted:
        assert f"{number:,}" in page
    assert f"{printed['coldest_k'][0]:.1f} K" in page
    assert f"{results['coldest_of_those_that_meet_1_and_2_k'][0]:.1f} K" in page
    assert results["meet_together"]["1 2 4 5 6"] == printed["meet_together"]["1 2 3"] == 0
    assert results["choices_of_those_that_meet_1_and_2"]["(19): temperature that divides"][
        "T_c"
    ] == 0  # fmt: skip
    assert len(results["with_fewest_changes"]) == 11
    assert results["fewest_changes_from_printed"] == 4


@pytest.mark.parametrize(("scaled", "same"), [(False, True), (True, False)])
def test_as_printed_a_heater_does_not_tell_its_three_parameters_apart(study, scaled, same):
    """Powers (1)-(5), (16) of a heater; ``scaled`` lets (5) grow with the effective area too."""
    model = study.model
    gas, pressure = model.GASES["paper"], np.geomspace(1e-4, 200.0, 30)
    heater = model.Place(np.full(30, 293.0), pressure, np.full(30, 9.8), gas, np.array(0.012))
    hot = np.full(30, 401.0)

    def power(tac, area_ratio, offset):
        thin = area_ratio * tac * model.free_molecular_heat(hot, heater, "T_mean", "T_mean")
        dense = model.continuum_heat(hot, heater, "T_mean", "in") * (area_ratio if scaled else 1.0)
        leak = offset * area_ratio * heater.area * (hot - heater.cold)
        return thin * dense / (thin + dense) + leak

    first, second = power(0.75, 1.22, 4.09), power(1.5, 0.61, 8.18)  # the same δα and δC
    assert np.allclose(first, second, rtol=1e-12) is same
