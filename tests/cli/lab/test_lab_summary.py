"""Numbers of many records: what a person wants first, and all of it on demand."""

import json

NUMBER = {"value": 0.7, "interval_95": [0.6, 0.8], "unit": ""}


def test_it_prints_thirty_lines_and_all_on_demand(run, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")
    samples = {f"Ge {n}": {"minimum_irradiance": NUMBER | {"unit": "W/m^2"}} for n in range(40)}
    record = {"samples": samples, "warnings": []}
    (tmp_path / "levitation.json").write_text(json.dumps(record), encoding="utf-8")
    text = run("lab", "summary", str(tmp_path))[1]
    assert "Ge 29, minimum irradiance" in text
    assert "Ge 30" not in text
    assert 'and 10 more numbers, with --quantity ""' in text
    assert "next:" not in text
    assert "Ge 39" in run("lab", "summary", str(tmp_path), "--quantity", "minimum irradiance")[1]
    assert len(json.loads(run("lab", "summary", str(tmp_path), "--json")[1])["records"]) == 40
