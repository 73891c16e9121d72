"""Synthetic levitation points of two coatings."""

import numpy as np

from lightflyer.environment.chamber import Chamber
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import Lu2023
from lightflyer.lab.synthetic.faults import TORR, faulty_table, label
from lightflyer.statics.levitation import levitate

_EMITTANCES = {"Ge 2 cm": 0.08, "CNT 2 cm": 0.48}  # of the paper's samples
_PRESSURES = (1.2, 40.0)  # [Pa]
_POINTS = 28  # of each sample
_NOISE = 0.05  # relative


def lift_off_irradiance(pressure: np.ndarray, sample: str) -> np.ndarray:
    """True irradiance at which a synthetic sample lifts off [W/m²], shape (n,)."""
    emittance = _EMITTANCES[sample]
    film = FilmProperties(1e-3, 0.75, emittance, emittance, tac_top=0.8, tac_bottom=0.9)
    return levitate(Disk(film=film, radius=0.01), Chamber().state(pressure), Lu2023()).irradiance


def levitation_files(seed: int = 0) -> dict[str, str]:
    """Points of two samples, and points of one sample on two launchpads; text by file name."""
    rng = np.random.default_rng(seed)
    fine = np.geomspace(*_PRESSURES, 2000)
    least = {name: lift_off_irradiance(fine, name) for name in _EMITTANCES}
    truth = "truth: " + "; ".join(
        f"{name} {light.min():.1f} W/m^2 at {fine[light.argmin()]:.3f} Pa"
        for name, light in least.items()
    )
    lines = label("levitation", truth)
    rows = [
        [name, str(_EMITTANCES[name]), f"{p / TORR * 1e3:.4g}", f"{light / 1e3:.5g}"]
        for name in _EMITTANCES
        for p, light in _points(rng, name)
    ]
    header = ["sample", "emittance", "pressure [mTorr]", "irradiance [kW/m^2]"]
    pads = [
        ["Ge 2 cm", pad, "20", str(gap), f"{p:.4g}", f"{share * light:.5g}"]
        for pad, gap, share in (("mesh", 60, 1.0), ("plate", 5, 0.9))
        for p, light in _points(rng, "Ge 2 cm")
    ]
    pad_header = ["Sample", "Launchpad", "Diameter (mm)", "Floor gap (mm)", "Pressure (Pa)",
                  "Irradiance (W/m2)"]  # fmt: skip
    return {
        "levitation.csv": faulty_table(lines, header, rows, rng, shuffled=True),
        "launchpads.csv": faulty_table(
            [*lines, "# the floor is close to the plate: 10 % less light"], pad_header, pads, rng,
            delimiter=";", decimal_comma=True,
        ),
    }  # fmt: skip


def _points(rng: np.random.Generator, name: str) -> list[tuple[float, float]]:
    low, high = np.log(_PRESSURES)
    pressure = np.exp(np.sort(rng.uniform(low, high, _POINTS)))
    light = lift_off_irradiance(pressure, name) * np.exp(_NOISE * rng.normal(size=_POINTS))
    return list(zip(pressure.tolist(), light.tolist(), strict=True))
