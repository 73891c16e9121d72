"""What the page gives away: the design as TOML and Python, its results as CSV and NetCDF."""

import pprint
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import lightflyer
from lightflyer.explorer.compute import prediction_of, uncertainty_of
from lightflyer.explorer.grammar import MISSION
from lightflyer.explorer.maps import Choices
from lightflyer.explorer.state import Document, Workplace, to_toml
from lightflyer.prediction.tables import to_dataset, write_csv

_WIDTH = 88


class Download(NamedTuple):
    """A file for the user."""

    name: str
    kind: str  # Media type
    content: bytes


def download(what: str, workplace: Workplace, document: Document, choices: Choices) -> Download:
    """A file with a design or its results; ``choices``: of the figure."""
    if what in KINDS:
        return KINDS[what](workplace, document)
    from lightflyer.explorer.figures import figure_bytes

    name, _, ending = what.rpartition(".")
    content = figure_bytes(name, ending, workplace, document, choices)
    kind = "image/svg+xml" if ending == "svg" else "image/png"
    return Download(f"lightflyer-{what}", kind, content)


def _without_mission(document: Document) -> Document:
    return {name: part for name, part in document.items() if name != MISSION}


def _heading(command: str) -> str:
    return (
        f"# Written by lightflyer explore {lightflyer.__version__}. "
        f"The same numbers come from:  lightflyer {command}\n\n"
    )


def _toml(workplace: Workplace, document: Document) -> Download:
    workplace.design(document)
    text = _heading("predict flyer.toml --out FOLDER") + to_toml(_without_mission(document))
    return Download("flyer.toml", "application/toml", text.encode())


def _mission_toml(workplace: Workplace, document: Document) -> Download:
    workplace.mission(document)
    text = _heading("fly mission.toml --out FOLDER") + to_toml(document)
    return Download("mission.toml", "application/toml", text.encode())


def python_lines(document: Document) -> str:
    """Lines of Python that give the results of the page."""
    parts = _without_mission(document)
    arguments = ",\n".join(f"    {name}={_literal(part)}" for name, part in parts.items())
    lines = f"import lightflyer as lf\n\nflyer_file = lf.FlyerFile(\n{arguments},\n)\n"
    lines += "prediction = lf.predict(flyer_file)\nprint(prediction.summary())\n"
    if MISSION in document:
        lines += (
            "\n# mission.toml is another download of the explorer\n"
            'mission = lf.mission.read_mission_file("mission.toml")\n'
            "flown = lf.fly(mission.design, mission=mission.mission)\n"
            'print(flown.attrs["end"])\n'
        )
    return lines


def _literal(part: Any) -> str:
    return pprint.pformat(part, width=_WIDTH, sort_dicts=False).replace("\n", "\n    ")


def _python(workplace: Workplace, document: Document) -> Download:
    workplace.design(document)
    return Download("explored.py", "text/x-python", python_lines(document).encode())


def _file_content(write: Callable[[Path], object], ending: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"prediction.{ending}")
        write(path)
        return path.read_bytes()


def _csv(workplace: Workplace, document: Document) -> Download:
    prediction = prediction_of(workplace.design(document))
    content = _file_content(lambda path: write_csv(prediction, path), "csv")
    return Download("prediction.csv", "text/csv", content)


def _netcdf(workplace: Workplace, document: Document) -> Download:
    design = workplace.design(document)
    dataset = to_dataset(prediction_of(design), design.text)
    uncertainty = uncertainty_of(design)
    if uncertainty is not None:
        uncertainty.add_to_dataset(dataset)
    content = bytes(dataset.to_netcdf(engine="h5netcdf"))
    return Download("prediction.nc", "application/x-netcdf", content)


KINDS: dict[str, Callable[[Workplace, Document], Download]] = {
    "toml": _toml,
    "mission.toml": _mission_toml,
    "python": _python,
    "csv": _csv,
    "netcdf": _netcdf,
}
"""Files by what the page calls them."""
