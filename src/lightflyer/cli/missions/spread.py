"""``lightflyer spread``: where the members of a released swarm are after days."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, show
from lightflyer.core.atomic_files import write_netcdf
from lightflyer.core.errors import named

Members = Annotated[int | None, Parameter(negative=())]


def spread_command(
    mission_file: Path,
    /,
    *,
    members: Members = None,
    out: Path | None = None,
    scheduler: str | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Spread a swarm: shares that still fly and that are near a place, with their intervals.

    Parameters
    ----------
    mission_file
        TOML file with the sections [mission] and [mission.ensemble]. Near is within
        [mission.station], by default 100 km about the place of the release.
    members
        Number released; by default that of [mission.ensemble].
    out
        Folder to write the shares over time (NetCDF), the summary (JSON) and the figure into. It
        keeps what was flown: the same command continues where it was interrupted.
    scheduler
        Address of a running Dask scheduler, such as tcp://127.0.0.1:8786; by default this machine
        computes.
    json_output
        Print one JSON object instead of a table.
    figures
        How figures are written.
    """
    asked, out = out, figures.folder(out)
    from lightflyer.mission.mission_file import read_mission_file
    from lightflyer.mission.report.figures import plot_spread
    from lightflyer.mission.report.summary import summarise
    from lightflyer.mission.report.text import spread_parts
    from lightflyer.mission.swarms.spreading import disperse_ensemble

    mission = read_mission_file(mission_file)
    folder = None if asked is None else asked / "members"
    with named(mission_file):
        dataset = disperse_ensemble(
            mission.design, **mission.swarm_arguments(members), folder=folder, scheduler=scheduler
        )
    found = summarise(dataset)
    dataset.attrs["configuration"] = mission.design.text
    files = {
        "spread.nc": lambda path: write_netcdf(dataset, path),
        "spread.json": found,
    }
    written = figures.write_folder(out, files, lambda: {"spread": plot_spread(dataset)})
    if json_output:
        print_json(found)
        return
    console = printer()
    show(console, spread_parts(dataset))
    figures.tell(console, written, "add --out FOLDER to write the figure and data")
