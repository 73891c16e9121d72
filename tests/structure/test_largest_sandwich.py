"""The study of the largest sandwich that carries 10 mg and keeps its gap, as its user runs it."""

import lightflyer as lf
from lightflyer.cli.commands.init import templates


def test_the_largest_sandwich_that_carries_10_mg_keeps_its_gap(tmp_path):
    known = templates()
    (tmp_path / "flyer.toml").write_text(known["ligaments"].read(), encoding="utf-8")
    text = known["optimise-structure"].read().replace("starts = 4", "starts = 1")
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    best = lf.optimise(lf.search.read_problem(tmp_path / "study.toml"))
    kept = best.outputs
    assert best.value > 0.02  # wider than 16 cm
    assert kept["lift_over_weight"] >= 1.0 - 1e-5
    assert kept["gap_closed"] <= 0.1 + 1e-6
    assert kept["lift_kept"] >= 0.9 - 1e-5
    assert kept["stress_over_strength"] <= 0.33 + 1e-5
    # structure and force together end it
    assert {"lift_kept", "lift_over_weight"} <= set(best.active_constraints)
