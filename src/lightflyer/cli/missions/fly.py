"""``lightflyer fly``: a mission through days, nights and winds."""

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import named

if TYPE_CHECKING:
    import xarray as xr


def fly_command(
    mission_file: Path,
    /,
    *,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Fly a mission: where a flyer goes, whether it survives the night, what ends it.

    Parameters
    ----------
    mission_file
        TOML file: a flyer file with a section [mission]; "lightflyer init --kind mission" writes
        one.
    out
        Folder to write figures, the dataset (NetCDF), the flight as a table (CSV), the tracks
        (KML, GeoJSON) and the summary (JSON) into. If interrupted, the same command continues
        from the flights of the ensemble or the launches that it kept.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    asked, out = out, figures.folder(out)
    from lightflyer.core.progress import asked_to_end, ends_early, report
    from lightflyer.mission.fleet import forget_flights, keeps_flights
    from lightflyer.mission.mission import fly
    from lightflyer.mission.mission_file import read_mission_file
    from lightflyer.mission.report.summary import summarise
    from lightflyer.mission.report.text import mission_parts

    mission = read_mission_file(mission_file)
    folder = None if asked is None else asked / "flights"
    known = folder is not None and keeps_flights(folder)
    with ends_early(), named(mission_file):
        dataset = fly(mission.design, mission=mission.mission, folder=folder)
        interrupted = asked_to_end()
    found = summarise(dataset)
    dataset.attrs |= {"configuration": mission.design.text, "summary": json.dumps(found)}

    def draw() -> Any:
        from lightflyer.mission.report.figures import mission_figures

        return mission_figures(dataset)

    if out is not None:
        report("writing")
    written = figures.write_folder(out, _files(dataset, found), draw)
    if folder is not None and not interrupted:
        forget_flights(folder)
    if json_output:
        print_json(found)
    else:
        console = printer()
        show(console, mission_parts(dataset))
        if known:
            say(console, "went on where the same command was interrupted")
        figures.tell(console, written, "add --out FOLDER to write figures and data")
    if interrupted:
        raise KeyboardInterrupt


def _files(dataset: "xr.Dataset", found: dict[str, Any]) -> dict[str, Any]:
    """What is written, by name."""
    from lightflyer.mission.report.dataset import (
        has_several,
        write_csv,
        write_ends_csv,
        write_netcdf,
    )
    from lightflyer.mission.report.maps import write_geojson, write_kml

    files = {
        "mission.nc": partial(write_netcdf, dataset),
        "mission.csv": partial(write_csv, dataset),
        "mission.kml": partial(write_kml, dataset),
        "mission.geojson": partial(write_geojson, dataset),
        "mission.json": found,
    }
    if has_several(dataset):
        files["mission-ends.csv"] = partial(write_ends_csv, dataset)
    if "telemetry" in found:
        from lightflyer.mission.report.ground import write_passes_csv

        files["mission-passes.csv"] = partial(write_passes_csv, found["telemetry"])
    return files
