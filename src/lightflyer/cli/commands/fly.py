"""``lightflyer fly``: a mission through days, nights and winds."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, show, write_json

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
        Folder to write figures, the dataset (NetCDF), the flight as a table (CSV), the track
        (KML) and the summary (JSON) into.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.mission.mission import fly
    from lightflyer.mission.mission_file import read_mission_file
    from lightflyer.mission.report.summary import summarise
    from lightflyer.mission.report.text import mission_parts

    mission = read_mission_file(mission_file)
    dataset = fly(mission.design, **mission.arguments())
    dataset.attrs["configuration"] = mission.design.text
    found = summarise(dataset)
    written = [] if out is None else _write(out, dataset, found, figures)
    if json_output:
        print_json(found)
        return
    console = printer()
    show(console, mission_parts(dataset))
    figures.tell(console, written, "add --out FOLDER to write figures and data")


def _write(
    out: Path, dataset: "xr.Dataset", summary: dict[str, Any], figures: FigureOptions
) -> list[Path]:
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.core.progress import report
    from lightflyer.mission.report.kml import write_kml
    from lightflyer.mission.report.tables import write_csv

    def draw() -> Any:
        from lightflyer.mission.report.figures import mission_figures

        return mission_figures(dataset)

    report("writing")
    dataset.attrs["summary"] = json.dumps(summary)
    names = ["mission.nc", "mission.csv", "mission.kml", "mission.json"]
    with output_directory(out) as stage:
        dataset.to_netcdf(stage("mission.nc"), engine="h5netcdf")
        write_csv(dataset, stage("mission.csv"))
        write_kml(dataset, stage("mission.kml"))
        write_json(stage("mission.json"), summary)
        names += figures.write(stage, draw)
    return [out / name for name in names]
