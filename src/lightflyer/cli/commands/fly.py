"""``lightflyer fly``: a mission through days, nights and winds."""

import json
from pathlib import Path
from typing import Any

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, show


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
    from lightflyer.core.progress import asked_to_end, ends_early, report
    from lightflyer.mission.mission import fly
    from lightflyer.mission.mission_file import read_mission_file
    from lightflyer.mission.report.kml import write_kml
    from lightflyer.mission.report.summary import summarise
    from lightflyer.mission.report.tables import write_csv
    from lightflyer.mission.report.text import mission_parts

    mission = read_mission_file(mission_file)
    with ends_early():
        dataset = fly(mission.design, **mission.arguments())
        interrupted = asked_to_end()
    found = summarise(dataset)
    dataset.attrs |= {"configuration": mission.design.text, "summary": json.dumps(found)}

    def draw() -> Any:
        from lightflyer.mission.report.figures import mission_figures

        return mission_figures(dataset)

    if out is not None:
        report("writing")
    files = {
        "mission.nc": lambda path: dataset.to_netcdf(path, engine="h5netcdf"),
        "mission.csv": lambda path: write_csv(dataset, path),
        "mission.kml": lambda path: write_kml(dataset, path),
        "mission.json": found,
    }
    written = figures.write_folder(out, files, draw)
    if json_output:
        print_json(found)
    else:
        console = printer()
        show(console, mission_parts(dataset))
        figures.tell(console, written, "add --out FOLDER to write figures and data")
    if interrupted:
        raise KeyboardInterrupt
