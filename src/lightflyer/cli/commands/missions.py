"""``lightflyer fly``, ``spread``, ``drift``, ``stability``, ``swarm``: flyers on their way."""

import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions, coordinate_range
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import named
from lightflyer.files.quantities import exact

if TYPE_CHECKING:
    from collections.abc import Callable

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
    from lightflyer.mission.report.dataset import (
        has_several,
        write_csv,
        write_ends_csv,
        write_netcdf,
    )
    from lightflyer.mission.report.ground import write_passes_csv
    from lightflyer.mission.report.maps import write_geojson, write_kml
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
        files["mission-passes.csv"] = partial(write_passes_csv, found["telemetry"])
    written = figures.write_folder(out, files, draw)
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
    from lightflyer.core.atomic_files import write_netcdf
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


@Parameter(name="*")
@dataclass(frozen=True)
class AltitudeOptions(ResultOptions):
    """Where, and how results are written.

    Parameters
    ----------
    altitudes
        Range such as "60 km to 80 km"; by default where the flyer levitates.
    out
        Folder to write the figure, the table (CSV), the dataset (NetCDF) and the summary (JSON)
        into.
    json_output
        Print one JSON object instead of a table.
    """

    altitudes: str | None = None
    out: Path | None = None
    json_output: Json = False

    def run(
        self, flyer_file: Path, told: str, compute: "Callable[..., xr.Dataset]", **asked: Any
    ) -> None:
        """Read the file, compute, write and print; ``told``: the command and what it is asked."""
        name = told.partition(" ")[0]
        out = self.folder(self.out)
        from lightflyer.config.reader import read_design
        from lightflyer.core.atomic_files import write_netcdf
        from lightflyer.mission.report.figures import plot_over_altitude
        from lightflyer.mission.swarms.over_altitude import summary_of, table_parts, write_csv

        design, ends = read_design(flyer_file), None
        if self.altitudes is not None:
            where = design.setup.environment.coordinate
            ends = coordinate_range("--altitudes", self.altitudes, where)
        dataset = compute(design.setup, ends, **asked)
        warnings = "\n".join(filter(None, [*design.warnings, dataset.attrs["warnings"]]))
        flyer = f"{dataset.attrs['flyer']}, {told}"
        dataset.attrs |= {"warnings": warnings, "flyer": flyer}
        summary = summary_of(dataset)
        dataset.attrs["configuration"] = design.text
        files = {
            f"{name}.nc": lambda path: write_netcdf(dataset, path),
            f"{name}.csv": lambda path: write_csv(dataset, path),
            f"{name}.json": summary,
        }
        written = self.write_folder(out, files, lambda: {name: plot_over_altitude(dataset)})
        if self.json_output:
            print_json(summary)
            return
        console = printer()
        console.print(flyer, soft_wrap=True)
        show(console, table_parts(dataset))
        self.tell(console, written, "add --out FOLDER to write the figure and data")


AT_ALTITUDES = AltitudeOptions()


def drift_command(
    flyer_file: Path, /, *, azimuth: str = "0 deg", options: AltitudeOptions = AT_ALTITUDES
) -> None:
    """Drift sideways by tilt: how fast, and at which tilt a flyer still keeps its altitude.

    Parameters
    ----------
    flyer_file
        TOML file of the flyer. Its own tilt has no effect.
    azimuth
        Direction towards which the top face is tilted, from the same axis as the light's.
    options
        Where, and how results are written.
    """
    from lightflyer.mission.swarms.over_altitude import drift_over_altitude

    angle = exact("--azimuth", azimuth, "rad")
    options.run(flyer_file, f"drift to {azimuth}", drift_over_altitude, azimuth=angle)


def stability_command(
    flyer_file: Path,
    /,
    *,
    rod: str = "1 mm",
    string: str = "0 mm",
    options: AltitudeOptions = AT_ALTITUDES,
) -> None:
    """Tell whether a flyer keeps level with its payload hanging below it.

    Parameters
    ----------
    flyer_file
        TOML file of a flat flyer with a payload.
    rod
        Length over which the payload is held at a right angle to the flyer.
    string
        Length of a loose string below the rod.
    options
        Where, and how results are written.
    """
    from lightflyer.mission.swarms.over_altitude import stability_over_altitude

    told = f"stability on a rod of {rod} and a string of {string}"
    options.run(flyer_file, told, stability_over_altitude, rod=rod, string=string)


def swarm_command(
    flyer_file: Path,
    /,
    *,
    payload: str,
    tether: str = "0 kg/m",
    spacing: str | None = None,
    depth: str | None = None,
    options: AltitudeOptions = AT_ALTITUDES,
) -> None:
    """Count the flyers that carry one payload together, each on a tether of its own.

    Parameters
    ----------
    flyer_file
        TOML file of one of the flyers. Its own payload has no effect.
    payload
        What they carry, such as "1 g".
    tether
        Mass over length of a tether; a fibre of 3 um of polyethylene has "7e-9 kg/m".
    spacing
        Distance between neighbours; by default three diameters.
    depth
        Depth of the payload below the layer of flyers; by default twice the layer's radius.
    options
        Where, and how results are written.
    """
    from lightflyer.mission.swarms.over_altitude import swarm_over_altitude
    from lightflyer.mission.swarms.tethers import Tether

    how = {"payload": payload, "tether": Tether(tether), "spacing": spacing, "depth": depth}
    told = f"swarm for {payload} on tethers of {tether}"
    options.run(flyer_file, told, swarm_over_altitude, **how)
