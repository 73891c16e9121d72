"""Synthetic forces on a heated vane."""

import numpy as np

from lightflyer.core.units import Measured
from lightflyer.lab.force.vane import Vane
from lightflyer.lab.synthetic.faults import faulty_table, label

TRUE_VANE = Vane(
    Measured(0.12),
    Measured(419.0),
    Measured(394.0),
    tac_hot=Measured(0.85),
    tac_cold=Measured(0.85),
)
_PRESSURES, _POINTS, _NOISE = (0.01, 5.0), 14, 0.03  # [Pa]; relative


def force_files(seed: int = 0) -> dict[str, str]:
    """Forces over pressure; text by file name."""
    rng = np.random.default_rng(seed)
    pressure = np.geomspace(*_PRESSURES, _POINTS)
    force = TRUE_VANE.force(pressure) * (1.0 + _NOISE * rng.normal(size=_POINTS))
    rows = [
        [f"{p:.4g}", f"{1e6 * one:.4g}", f"{1e6 * _NOISE * one:.2g}"]
        for p, one in zip(pressure, force, strict=True)
    ]
    lines = label("force", "truth: vane of 12 cm at 419 K and 394 K in argon at 295 K, TAC 0.85")
    header = ["pressure [Pa]", "force [uN]", "force_uncertainty [uN]"]
    return {"vane.csv": faulty_table(lines, header, rows, rng)}
