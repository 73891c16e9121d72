import json
import re
from contextlib import redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.calibration import read_points
from lightflyer.cli import main
from lightflyer.core.progress import report_to
from lightflyer.paper import report as module
from lightflyer.paper.conditions import COLUMNS, Claim, Quantity, Verdict, claims, facts
from lightflyer.paper.figures import FIGURES
from lightflyer.paper.results import (
    difference_uncertainty,
    planck_peak,
    table_1,
    table_s2,
    tac_pairs,
    to_csv,
)

pytestmark = pytest.mark.slow

# T_c, p, T_h and I to levitate (printed, reported), T_h and lift/weight at 1360 W/m² (reported)
CHECK = {
    68: ("224.8909", "6.40953", "349.0435", "866.459", "355.0624", "1365.098", "354.6482",
         "0.995047"),
    72: ("215.3859", "3.44597", "311.5654", "511.581", "323.6874", "811.018", "382.9028",
         "1.589948"),
    78: ("201.9077", "1.29009", "358.6669", "570.523", "452.0910", "1341.540", "454.3642",
         "1.005716"),
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the command writes; its numbers are computed once."""
    out = tmp_path_factory.mktemp("paper") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "compute", cache(module.compute))
        with redirect_stdout(StringIO()) as printed, pytest.raises(SystemExit, match="0"):
            main(["paper", "--out", str(out), "--dpi", "100"])
        assert "reproduced" in printed.getvalue()
        assert "report.html" in printed.getvalue()
        yield out


@pytest.fixture(scope="module")
def report(folder):
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


def shown(value, text):
    """The value with as many digits as the text."""
    return f"{value:.{len(text.partition('.')[2])}f}"


@pytest.mark.parametrize("altitude", CHECK)
def test_check_values_match_to_all_digits(report, altitude):
    rows = {
        key: {row["altitude_km"]: row for row in report["check"][key]}[altitude]
        for key in ("printed", "reported")
    }
    keys = ("levitation_temperature_k", "levitation_irradiance_w_m2")
    ours = [rows["reported"]["gas_temperature_k"], rows["reported"]["pressure_pa"]]
    ours += [rows[column][key] for column in ("printed", "reported") for key in keys]
    ours += [rows["reported"]["temperature_k"], rows["reported"]["lift_over_weight"]]
    assert tuple(map(shown, ours, CHECK[altitude])) == CHECK[altitude]


def test_bands_and_payloads_of_the_reported_reading(report):
    values = report["values"]["reported"]
    expected = {
        "band_low": "68.022", "band_high": "78.047", "band_45_low": "70.28",
        "payload_05cm": "0.02091", "relative_payload_05cm": "1.065", "altitude_05cm": "65.9",
        "payload_3cm": "0.268", "relative_payload_3cm": "0.379",
    }  # fmt: skip
    assert {key: shown(values[key], text) for key, text in expected.items()} == expected
    assert values["band_45_high"] == pytest.approx(76.45, abs=0.006)
    printed = report["values"]["printed"]
    assert shown(printed["band_low"], "65.457") == "65.457"
    assert shown(printed["band_high"], "82.861") == "82.861"
    mean = report["values"]["reported-mean"]
    assert shown(mean["relative_payload_3cm"], "0.30") == "0.30"
    assert shown(mean["payload_3cm"], "0.21") == "0.21"


@pytest.mark.parametrize(("incidence", "name"), [(0.0, "band"), (45.0, "band_45")])
def test_bands_are_those_of_the_flyer_in_the_papers_atmosphere(report, disk, incidence, name):
    """The report looks closer and closer; the band's edges are roots of their own equation."""
    earth = lf.lu2023_earth(incidence=np.radians(incidence))
    band = lf.levitation_band(disk, earth, lf.Lu2023(), (50e3, 95e3))
    values = report["values"]["reported"]
    assert 1e3 * values[f"{name}_low"] == pytest.approx(band.lower, rel=1e-9)
    assert 1e3 * values[f"{name}_high"] == pytest.approx(band.upper, rel=1e-9)


def test_every_claim_has_a_verdict_that_follows_from_its_numbers(report):
    assert [claim["number"] for claim in report["claims"]] == list(range(1, 20))
    for claim in report["claims"]:
        assert claim["place"]
        agreement = [quantity["agrees"]["reported"] for quantity in claim["quantities"]]
        if claim["verdict"] == "reported but not recomputable":
            assert claim["why"].startswith("missing")
            assert claim["reproduced_by"] == []
        else:
            assert (claim["verdict"] == "reproduced") == all(agreement)
            assert agreement
    assert {claim["verdict"] for claim in report["claims"]} == set(map(str, Verdict))


def test_a_verdict_turns_where_the_tolerance_ends():
    quantity = Quantity("edge", "edge", "km", 68.0, 68.0, 1.0)
    claim = Claim(1, "edge at 68 km", (quantity,))
    assert claim.verdict({"edge": 69.0}) is Verdict.REPRODUCED
    assert claim.verdict({"edge": 69.001}) is Verdict.DIFFERS
    assert claim.verdict({"edge": float("nan")}) is Verdict.DIFFERS
    columns = {"printed": {"edge": 68.0}, "reported": {"edge": 70.0}}
    assert claim.overall(columns) is Verdict.DIFFERS  # no picking of columns
    assert claim.reproducers(columns) == ["printed"]
    within = Quantity("density", "density", "g/m²", 1.0, 1.3, 0.0)
    assert within.agrees(1.1)
    assert within.difference(1.5) == pytest.approx(0.2)


def test_columns_are_open_to_more_models():
    assert [column.key for column in COLUMNS][:2] == ["printed", "reported"]
    assert all(claim.quantities or claim.missing for claim in claims())


def test_page_is_self_contained(folder):
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len(FIGURES)
    assert "http://" not in page
    assert "https://" not in page
    assert "<script" not in page
    markdown = (folder / "report.md").read_text(encoding="utf-8")
    for name in FIGURES:
        assert f"figures/{name}.png" in markdown
        assert (folder / "figures" / f"{name}.png").stat().st_size > 10_000
        assert (folder / "figures" / f"{name}.svg").stat().st_size > 10_000


def test_no_measured_figure_without_the_users_points(folder):
    names = {path.stem for path in (folder / "figures").iterdir()}
    assert names == set(FIGURES)
    assert "your data" not in (folder / "figures" / "figure-5bcd.svg").read_text(encoding="utf-8")


def test_twice_gives_the_same_data(folder, tmp_path, write):
    points = write(
        "sample,pressure [mTorr],irradiance [W/m^2],diameter [cm],figure\n"
        "synthetic A,30,1500,2,2\nsynthetic B,20,2000,3,S2\n",
        "points.csv",
    )
    steps = []
    with report_to(steps.append):
        module.reproduce(
            tmp_path / "again", read_points(points), formats=["svg"], style="column", dpi=60
        )
    assert {f"drawing {name}" for name in FIGURES} < {step.doing for step in steps}
    for path in [folder / "report.json", *sorted((folder / "data").iterdir())]:
        again = tmp_path / "again" / path.relative_to(folder)
        assert again.read_bytes() == path.read_bytes(), path.name
    figures = {path.name for path in (tmp_path / "again" / "figures").iterdir()}
    assert {"figure-2.png", "figure-s2.png", "figure-6.svg"} <= figures
    assert "figure-s3.png" not in figures
    drawn = (tmp_path / "again" / "figures" / "figure-5bcd.svg").read_text(encoding="utf-8")
    assert "synthetic A (your data)" in drawn


def test_figure_data_hold_the_claims(folder):
    rows = np.genfromtxt(folder / "data" / "figure-6.csv", delimiter=",", skip_header=1)
    header = (folder / "data" / "figure-6.csv").read_text(encoding="utf-8").splitlines()[0]
    column = header.split(",").index("irradiance reported [W/m^2]")
    flies = rows[:, 0][rows[:, column] <= 1360.0]
    assert flies[0] == pytest.approx(68.022, abs=0.11)
    assert flies[-1] == pytest.approx(78.047, abs=0.11)


def test_altitudes_over_size_hold_the_claims(folder, report):
    rows = np.genfromtxt(folder / "data" / "figure-s8.csv", delimiter=",", names=True)
    two, largest = rows["diameter_cm"] == 2.0, np.isfinite(rows["lower_edge_reported_km"])
    values = report["values"]["reported"]
    assert rows["lower_edge_reported_km"][two] == pytest.approx(values["band_low"], abs=1e-4)
    assert rows["upper_edge_reported_km"][two] == pytest.approx(values["band_high"], abs=1e-4)
    assert rows["diameter_cm"][largest].max() == pytest.approx(values["diameter_largest"], abs=0.1)
    between = rows["lower_edge_reported_km"] < rows["optimal_reported_km"]
    assert np.array_equal(between, largest)
    assert np.array_equal(rows["optimal_reported_km"] < rows["upper_edge_reported_km"], largest)
    assert np.array_equal(rows["payload_reported_mg"] >= 0.0, largest)


def test_larger_disks_are_shown_as_the_2_cm_disk_is(folder):
    data = {
        name: np.genfromtxt(folder / "data" / f"{name}.csv", delimiter=",", names=True)
        for name in ("figure-6", "figure-s7")
    }
    light = {
        2: data["figure-6"]["irradiance_reported_Wm2"],
        3: data["figure-s7"]["irradiance_3_cm_reported_Wm2"],
        4: data["figure-s7"]["irradiance_4_cm_reported_Wm2"],
    }
    needed = [np.nanmin(light[size]) for size in (2, 3, 4)]
    assert needed == sorted(needed)  # the paper: the range of altitudes gets smaller with size
    widths = [np.count_nonzero(light[size] <= 1360.0) for size in (2, 3, 4)]
    assert widths == sorted(widths, reverse=True)
    hot = data["figure-s7"]["temperature_4_cm_reported_K"]
    assert np.nanmin(hot - data["figure-s7"]["gas_temperature_K"]) > 100.0


def test_table_1_follows_from_its_transmittances_and_reflectances():
    rows = {(row["sample"], row["band"]): row for row in table_1()}
    found = {key: round(row["absorptance_from_t_and_r"], 9) for key, row in rows.items()}
    assert found == {
        ("mylar", "infrared"): 0.06, ("mylar", "visible"): 0.04,
        ("Ge", "infrared"): 0.08, ("Ge", "visible"): 0.75,
        ("CNT", "infrared"): 0.48, ("CNT", "visible"): 0.75,
    }  # fmt: skip
    assert rows["mylar", "visible"]["absorptance"] == 0.03  # as printed
    for row in rows.values():  # the printed uncertainties are sums, not those of independent errors
        assert row["its_uncertainty_sum"] == pytest.approx(row["absorptance_uncertainty"])
    assert rows["CNT", "infrared"]["its_uncertainty_independent"] == pytest.approx(5**0.5 / 100)
    assert rows["Ge", "infrared"]["upper_bound_from_t"] == pytest.approx(0.19)
    assert "not available" in to_csv(table_1())  # no bound from FTIR for mylar


def test_table_s2_gives_each_test_and_their_mean():
    rows = {row["sample"]: row for row in table_s2()}
    assert rows["Ge"]["mean"] == pytest.approx(2.71 / 3)
    assert rows["alumina"]["mean"] == pytest.approx(0.7967, abs=5e-5)  # printed as 0.79
    assert rows["CNT"]["mean"] == pytest.approx(1.07)  # printed as 1.08
    for row in rows.values():
        assert row["lowest_1"] < row["test_1"] < row["highest_1"]
        if row["printed_mean"] is not None:
            assert row["deviation"] == pytest.approx(row["printed_uncertainty"], abs=0.005)
    assert rows["gold"]["test_3"] is None
    assert (rows["platinum"]["lowest_1"], rows["platinum"]["highest_1"]) == (0.68, 0.82)


def test_pairs_of_faces_have_the_uncertainties_of_their_samples():
    pairs = {(row["top"], row["bottom"]): row for row in tac_pairs()}
    assert pairs["alumina", "Ge"]["tac_difference"] == pytest.approx(0.11)
    assert pairs["mylar", "CNT"]["tac_difference"] == pytest.approx(0.31)
    assert pairs["alumina", "CNT"]["tac_mean"] == pytest.approx(0.935)
    independent = pairs["alumina", "CNT"]["difference_uncertainty_independent"]
    assert independent == pytest.approx((0.03**2 + 0.05**2) ** 0.5)
    assert pairs["alumina", "CNT"]["difference_uncertainty_correlated"] == pytest.approx(0.02)
    assert pairs["alumina", "Ge"]["difference_uncertainty_correlated"] == 0.0


@pytest.mark.parametrize("number", [10, 12, 13])
def test_claims_from_tables_are_recomputed_and_explained(report, number):
    (claim,) = (claim for claim in report["claims"] if claim["number"] == number)
    assert claim["verdict"] == "reproduced"
    assert claim["why"].startswith("From the")


def test_the_chamber_is_as_warm_as_the_paper_says(report):
    assert facts()["chamber"]["temperature_k"] == 293.0
    # from a gas at 295 K the disk would get 1.9 K warmer
    values = report["values"]["reported"]
    assert values["optimum_temperature_ge"] == pytest.approx(404.46, abs=0.05)


def test_uncertainty_of_a_difference():
    assert difference_uncertainty(0.03, 0.03, 0.0) == pytest.approx(0.0424, abs=5e-5)
    assert difference_uncertainty(0.03, 0.05, 1.0) == pytest.approx(0.02)
    assert difference_uncertainty(0.03, 0.03, 1.0) == 0.0


def test_planck_peak_follows_wien():
    # Wien's displacement per wavenumber: 1.96100 cm⁻¹/K
    assert planck_peak(400.0) == pytest.approx(784.4, rel=1e-4)


def test_bad_points_stop_before_anything_is_written(refuses, write, tmp_path):
    bad = write("sample,pressure [W],irradiance [W/m^2]\na,1,2\n", "points.csv")
    said = refuses("paper", "--out", tmp_path / "out", "--data", bad)
    assert "points.csv:1: column pressure" in said
    assert not (tmp_path / "out").exists()


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def is_part_of(row, rows):
    """Whether some row has these cells, in their order."""
    for whole in rows:
        rest = iter(whole)
        if all(any(is_alike(cell, other) for other in rest) for cell in row):
            return True
    return False


def is_alike(cell, other):
    """Whether two cells are the same but for one unit of a last digit, which processors differ in.

    The diameter of the largest payload is that of a flat optimum.
    """
    numbers, others = (re.findall(r"\d+\.\d+", text) for text in (cell, other))
    if re.sub(r"\d+\.\d+", "", cell) != re.sub(r"\d+\.\d+", "", other):
        return False
    return len(numbers) == len(others) and all(
        abs(float(one) - float(two)) < 1.5 * 10.0 ** -len(one.partition(".")[2])
        for one, two in zip(numbers, others, strict=True)
    )


def test_documentation_shows_what_the_report_says(folder):
    page = (Path(__file__).parents[2] / "docs" / "paper.md").read_text(encoding="utf-8")
    report = (folder / "report.md").read_text(encoding="utf-8")
    told = [cells(line) for line in report.splitlines() if line.startswith("|")]
    shown = [cells(line) for line in page.splitlines() if re.match(r"\| \d", line)]
    assert len(shown) > 20
    for row in shown:
        if len(row) == 7:  # joins two of the report's tables
            assert is_part_of(row[1:6], told), row
            row = [*row[:3], row[6]]
        assert is_part_of(row, told), row


def test_kinetic_theory_beside_the_paper_is_what_the_package_predicts(folder, disk):
    found = json.loads((folder / "report.json").read_text(encoding="utf-8"))["kinetic"]
    band = lf.levitation_band(disk, lf.lu2023_earth(), lf.Kinetic())
    np.testing.assert_allclose(
        [found["band_low"], found["band_high"]], [1e-3 * band.lower, 1e-3 * band.upper], rtol=1e-4
    )
    slanting = lf.lu2023_earth(incidence=np.pi / 4.0)
    assert not lf.levitation_band(disk, slanting, lf.Kinetic(), throw=False).exists
    assert found["band_45_low"] is None
    page = (folder / "report.md").read_text(encoding="utf-8")
    assert f"| 1 | upper edge | 78 km | 78 km | {found['band_high']:.3g} km |" in page
