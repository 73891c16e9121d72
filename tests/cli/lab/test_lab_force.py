import json

import numpy as np
import pytest
import xarray as xr

VANE = ("--diameter", "12 cm", "--hot", "419 ± 2 K", "--cold", "394 ± 2 K")
CURVE = ("--pressures", "0.01 Pa, 10 Pa")


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


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((*VANE, "--pressures", "2 Pa, 1 Pa"), "write two that increase"),
        ((*VANE, *CURVE, "--tac-hot", "0.9"), "either --tac, or both --tac-hot and --tac-cold"),
        ((*VANE, *CURVE, "--force-accuracy", "5"), 'per cent are written "5 %"'),
        (("--diameter", "12", *VANE[2:], *CURVE), '"12" has no unit'),
    ],
)
def test_mistakes_are_one_line(folder, lab, options, said):
    code, out, err = lab("force", *options)
    assert code != 0
    assert out == ""
    assert said in err
    assert len(err.splitlines()) == 1
