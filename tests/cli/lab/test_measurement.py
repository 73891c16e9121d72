"""A measurement is one function: here a thermocouple's calibration, as somebody would add it."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.cli.lab import command_of
from lightflyer.core.errors import Doubt
from lightflyer.core.quantity import Quantity, Temperature
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.options import Kelvins, Share, measurement
from lightflyer.lab.result import Outcome

COLUMNS = (
    Column("temperature", Temperature, (), required=True),
    Column("voltage", Quantity("V"), (), required=True),
)


@measurement(accuracy="update")
def thermocouple(
    file: Path, /, *, cold: Kelvins = "0 °C", accuracy: Share = None, update: Path | None = None
) -> Outcome:
    """Fit a line to a thermocouple's voltage.

    Parameters
    ----------
    file
        Table of temperature and voltage.
    cold
        Temperature of the cold junction.
    accuracy
        Of the voltage.
    update
        Flyer file.
    """
    table = read_table(file, COLUMNS)
    slope, spread = np.polyfit(
        table.numbers["temperature"] - cold, table.numbers["voltage"], 1, cov=True
    )
    found = Estimate.normal(float(slope[0]), float(spread[0, 0] ** 0.5), "V/K", len(table) - 2)
    return Outcome.of(
        "thermocouple", {"film_sensitivity": found}, [table],
        {"voltage": ("row", table.numbers["voltage"], {"units": "V"})},
        warnings=[Doubt("is it one?")] if accuracy else [],
        values={("film", "emittance"): Estimate(0.1, (0.05, 0.15), "", 0.02)} if update else {},
        sources=[file],
    )  # fmt: skip


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{t},{0.0407 * t + 0.003 * (-1) ** t:.5f}\n" for t in range(0, 100, 7))
    Path("tc.csv").write_text(f"temperature [°C],voltage [mV]\n{rows}50,OVLD\n", encoding="utf-8")
    return tmp_path


def test_its_text_json_and_netcdf_follow(files, capsys):
    command = command_of(thermocouple)
    command(Path("tc.csv"), json_output=True, out=files / "tc")
    found = json.loads(capsys.readouterr().out)
    slope = found["film_sensitivity"]
    assert slope["interval_95"][0] < 40.7e-6 < slope["interval_95"][1]
    assert slope["unit"] == "V/K"
    assert found["read"][0]["rejected"] == [
        {"line": 17, "reason": 'voltage: "OVLD" is not a number'}
    ]
    record = json.loads((files / "tc" / "thermocouple.json").read_text("utf-8"))
    assert record == found
    with xr.open_dataset(files / "tc" / "thermocouple.nc") as data:
        assert data["voltage"].attrs["units"] == "V"
        assert data.attrs["files"] == "tc.csv"
    command(Path("tc.csv"))
    text = capsys.readouterr().out
    assert text.startswith("film sensitivity 4.0")
    assert "add --out FOLDER" in text


def test_texts_of_options_become_numbers_and_doubts_are_not_written(files, run):
    run("init")
    command = command_of(thermocouple)
    for options, says in (
        ({"cold": "1 m"}, "--cold"),
        ({"accuracy": "0.5 %"}, "--accuracy needs --update"),
        ({"accuracy": "5", "update": Path("flyer.toml")}, "per cent are written"),
        ({"accuracy": "1 %", "update": Path("flyer.toml")}, "--insist writes it all the same"),
    ):
        with pytest.raises((lf.ConfigurationError, lf.ParameterError), match=says):
            command(Path("tc.csv"), **options)
    before = Path("flyer.toml").read_text("utf-8")
    command(Path("tc.csv"), accuracy="1 %", update=Path("flyer.toml"), insist=True)
    after = Path("flyer.toml").read_text("utf-8")
    assert before != after
    assert 'emittance = "0.100 ± 0.020"' in after
    assert "measured: lab thermocouple, tc.csv" in after
