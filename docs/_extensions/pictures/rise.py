"""Why a film rises, as a picture that moves; all numbers in it are the package's."""

from __future__ import annotations

import json
import tomllib
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.gas import mean_free_path

_KILOMETRE = 1e3
_ALTITUDES = np.arange(40.0, 111.0, 1.0)  # [km]
_START = 80.0  # [km]
_PLACES = {"dense": 50.0, "in between": 80.0, "thin": 105.0}  # [km]


def table() -> dict[str, Any]:
    """Surroundings of the disk of ``lightflyer init`` and what it does there, over altitude."""
    content = tomllib.loads(templates()["earth"].read())
    design = lf.FlyerFile(**content).design()
    found = lf.predict(design, at=_ALTITUDES * _KILOMETRE).at
    gas = design.setup.environment.state(_ALTITUDES * _KILOMETRE).gas
    path = mean_free_path(found["pressure"], found["gas_temperature"], gas)
    rounded = {
        "altitude": _ALTITUDES,
        "pressure": found["pressure"],
        "cold": found["gas_temperature"],
        "hot": found["temperature"],
        "lift": found["lift_over_weight"],
        "path": path,
    }
    rows = {
        name: [float(f"{value:.4g}") for value in np.asarray(values)]
        for name, values in rounded.items()
    }
    diameter = 2.0 * float(design.setup.flyer.radius)
    film = content["film"]
    faces = {"top": film["tac_top"], "bottom": film["tac_bottom"]}
    return rows | {"diameter": diameter, "faces": faces, "start": _START}


def html() -> str:
    """The picture and its words."""
    found = table()
    low, high = _ALTITUDES[0], _ALTITUDES[-1]
    places = "".join(
        f'<button type="button" data-altitude="{altitude:g}">{escape(name)}</button>'
        for name, altitude in _PLACES.items()
    )
    shares = {face: f"{100 * share:.0f} %" for face, share in found["faces"].items()}
    page = (Path(__file__).parent / "rise.html").read_text(encoding="utf-8")
    return page.format(
        table=escape(json.dumps(found)), low=low, high=high, start=_START, places=places, **shares
    )
