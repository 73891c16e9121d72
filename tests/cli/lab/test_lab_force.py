import json

import numpy as np
import xarray as xr

VANE = ("--diameter", "12 cm", "--hot", "419 ± 2 K", "--cold", "394 ± 2 K")


def test_points_beside_the_curve(folder, lab_prints):
    text = "pressure [mTorr], force [uN], force_uncertainty [uN]\n1, 16, 1\n4, 27, 1\n20, 19, 1\n"
    (folder / "vane.csv").write_text(text, encoding="utf-8")
    out = lab_prints("force", "vane.csv", *VANE, "--out", "o")
    assert "assumes a thin vane in open space" in out
    assert "bands contain both, and that normal motion" in " ".join(out.split())
    assert "largest force predicted: 27." in out
    assert {path.name for path in (folder / "o").iterdir()} == {
        "force.json", "force.nc", "force.png", "force.svg"
    }  # fmt: skip
    found = json.loads((folder / "o" / "force.json").read_text(encoding="utf-8"))
    points, ratio = found["points"], found["measured_over_predicted"]
    np.testing.assert_allclose(points["pressure_pa"], np.array([1, 4, 20]) * 0.133322, rtol=1e-5)
    assert ratio["interval_95"][0] < 1.0 < ratio["interval_95"][1]
    with xr.open_dataset(folder / "o" / "force.nc") as record:
        np.testing.assert_allclose(record.predicted_force, points["predicted_n"])
        assert record.force.attrs["units"] == "N"
