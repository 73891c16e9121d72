"""Published claims of other flyers beside this package's models.

    python studies/published_claims/study.py            # minutes on one core
    python studies/published_claims/study.py device     # that claim alone, the others as they were

Writes results.json and docs/images/other-claims.png. Numbers of the device at 25 km are those of
studies/outer_flow.
"""

import json
import sys
from pathlib import Path

import figures
import hollow
import numpy as np
import plates
import sandwiches
from sampling import central, interval

HERE = Path(__file__).parent
STUDIES = HERE.parent
MILLIGRAM, GRAM = 1e-6, 1e-3  # [kg]
CLAIMED_FACTOR = 2.0  # "approximately double"


def plate():
    """10 Pa to 200 Pa."""
    found = plates.levitation()
    seen = np.isin(plates.AROUND, plates.OBSERVED)
    return {
        "ratio": interval(found[:, seen].min(axis=1)),
        "by_pressure_pa": {
            f"{pressure:g}": interval(column)
            for pressure, column in zip(plates.AROUND, found.T, strict=True)
        },
    }


def device():
    """1 cm at 26.7 Pa and 750 W/m²."""
    found = {name: interval(values) for name, values in sandwiches.device().items()}
    return {"ratio": found[sandwiches.BETWEEN], "by_model": found}


def ten_milligrams():
    """3 cm radius at 75 km."""
    found = sandwiches.large()
    return {
        "ratio": interval(found[sandwiches.BEST][0]),
        "by_model": {name: interval(ratio) for name, (ratio, _) in found.items()},
        "payload_mg": {name: interval(carried / MILLIGRAM) for name, (_, carried) in found.items()},
    }


def stratosphere():
    """285 mg at 25 km."""
    found = json.loads((STUDIES / "outer_flow" / "results.json").read_text("utf-8"))["claim"]
    return {
        "ratio": found["over_needed"],
        "lift_mg": {
            name: found[f"by_{name}_mg"]
            for name in ("slab", "flow", "flow_in_warm_air", "warm_air")
        },
        "films_mg": found["films_mg"],
    }


def kilogram():
    """1 kg at 80 km."""
    ratios = {form: hollow.kilogram(form) for form in hollow.OUTLETS}
    anew = {form: hollow.designed_anew(form) for form in ("cone", "sphere")}
    return {
        "ratio": interval(ratios["rocket"]),
        "by_form": {form: interval(values) for form, values in ratios.items()},
        "payload_kg": hollow.as_published(),
        "designed_anew": {
            form: {"ratio": interval(ratio), "payload_g": interval(carried / GRAM)}
            for form, (ratio, carried) in anew.items()
        },
    }


def germanium():
    """Germanium approximately doubles the force."""
    factor = hollow.germanium()[0]
    return {"ratio": interval(factor / CLAIMED_FACTOR), "factor": interval(factor)}


CLAIMS = {
    "plate": plate,
    "device": device,
    "ten milligrams": ten_milligrams,
    "stratosphere": stratosphere,
    "kilogram": kilogram,
    "germanium": germanium,
}


def centres():
    """Ratio at the middle of all ranges, of the claims that take no search."""
    plate_found = plates.levitation(central(plates.GUESSES))[0]
    return {
        "plate": float(plate_found[np.isin(plates.AROUND, plates.OBSERVED)].min()),
        "device": float(_device_at_centre()),
        "kilogram": float(hollow.kilogram(guesses=central(hollow.GUESSES))[0]),
    }


def _device_at_centre():
    middle = central(sandwiches.DEVICE_GUESSES)
    return sandwiches.device(middle, [sandwiches.BEST])[sandwiches.BEST][0]


def main():
    """Write the numbers and the figure."""
    path = HERE / "results.json"
    known = json.loads(path.read_text("utf-8")) if path.exists() else {}
    asked = sys.argv[1:] or CLAIMS
    results = {name: claim() if name in asked else known[name] for name, claim in CLAIMS.items()}
    for name, value in centres().items():
        results[name]["central"] = value
    path.write_text(json.dumps(results, indent=1) + "\n", "utf-8")
    figures.draw(results)


if __name__ == "__main__":
    main()
