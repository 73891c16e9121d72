"""Write docs/published.json, our verdicts on published flyers: ``make verdicts``."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

import lightflyer as lf
from lightflyer.config.reader import read_design
from lightflyer.prediction.text import verdict_lines
from published.table import VERDICTS, Published, published

_SAMPLES = 200


def verdict(flyer: Published) -> dict[str, Any]:
    """Our verdict on a flyer, in words and in numbers."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{flyer.name}.toml"
        path.write_text(flyer.flyer_file(), encoding="utf-8")
        design = read_design(path)
    prediction = lf.predict(design)
    found = lf.propagate(design, prediction=prediction, samples=_SAMPLES, seed=0)
    summary = prediction.summary()
    where = "pressure" if "pressure" in prediction.coordinate.name else "altitude"
    kept = {
        "coordinate": where,
        "bands": prediction.bands,
        "own_mass": float(prediction.setup.flyer.own_mass),
        "lines": list(verdict_lines(prediction, found.bands, found.shares)),
        "warnings": summary["warnings"],
    }
    return {"digest": flyer.digest(), "version": lf.__version__} | json.loads(json.dumps(kept))


def main(names: list[str]) -> None:
    """Compute those whose file has changed, or those named."""
    kept = json.loads(VERDICTS.read_text(encoding="utf-8")) if VERDICTS.is_file() else {}
    found = {}
    for flyer in published():
        old = kept.get(flyer.name)
        is_new = old is None or old["digest"] != flyer.digest() or flyer.name in names
        found[flyer.name] = verdict(flyer) if is_new else old
        sys.stdout.write("\n".join((f"== {flyer.name}", *found[flyer.name]["lines"], "")))
        sys.stdout.flush()
        text = json.dumps(kept | found, indent=1, ensure_ascii=False)
        VERDICTS.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
