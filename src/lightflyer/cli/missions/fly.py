"""``lightflyer fly``: a mission through days, nights and winds."""

import json
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import ParameterError, named

Tracks = Annotated[list[Path] | None, Parameter(consume_multiple=True, negative=())]

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.mission.measured.track import MeasuredTrack
    from lightflyer.mission.mission_file import MissionFile


def fly_command(
    mission_file: Path,
    /,
    *,
    compare: Tracks = None,
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
    compare
        Measured tracks to lay beside the flight: tables (CSV) with time, latitude, longitude and
        altitude, GPX, or KML with times.
    out
        Folder to write figures, the dataset (NetCDF), the flight as a table (CSV), the tracks
        (KML, GeoJSON) and the summary (JSON) into. Of an interrupted command it keeps the flights
        of ensemble and launches: the same command goes on.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    asked, out = out, figures.folder(out)
    from lightflyer.core.progress import asked_to_end, ends_early, report
    from lightflyer.mission.kept import forget_flights, keeps_flights
    from lightflyer.mission.mission import fly
    from lightflyer.mission.mission_file import read_mission_file
    from lightflyer.mission.report.summary import summarise
    from lightflyer.mission.report.text import mission_parts

    mission = read_mission_file(mission_file)
    tracks = _read_tracks(compare, mission)
    folder = None if asked is None else asked / "flights"
    known = folder is not None and keeps_flights(folder)
    with ends_early():
        with named(mission_file):
            dataset = fly(mission.design, **mission.arguments(), folder=folder)
        compared = _compare(tracks, mission)
        interrupted = asked_to_end()
    found = summarise(dataset)
    if compared:
        from lightflyer.mission.measured.comparison import join_comparisons
        from lightflyer.mission.measured.summary import comparison_parts, summarise_comparison

        found["measured"] = [summarise_comparison(one) for one in compared]
        dataset = dataset.merge(join_comparisons(compared), combine_attrs="override")
    dataset.attrs |= {"configuration": mission.design.text, "summary": json.dumps(found)}

    def draw() -> Any:
        from lightflyer.mission.report.figures import mission_figures

        figures = mission_figures(dataset)
        if compared:
            from lightflyer.mission.measured.figures import comparison_figure

            figures["comparison"] = comparison_figure(dataset, compared)
        return figures

    if out is not None:
        report("writing")
    written = figures.write_folder(out, _files(dataset, found, compared), draw)
    if folder is not None and not interrupted:
        forget_flights(folder)
    if json_output:
        print_json(found)
    else:
        console = printer()
        show(console, mission_parts(dataset))
        for one in found.get("measured", ()):
            show(console, ["", *comparison_parts(one)])
        if known:
            say(console, "went on where the same command was interrupted")
        figures.tell(console, written, "add --out FOLDER to write figures and data")
    if interrupted:
        raise KeyboardInterrupt


def _files(
    dataset: "xr.Dataset", found: dict[str, Any], compared: "list[xr.Dataset]"
) -> dict[str, Any]:
    """What is written, by name."""
    from lightflyer.mission.report.geojson import write_geojson
    from lightflyer.mission.report.kml import write_kml
    from lightflyer.mission.report.netcdf import write_netcdf
    from lightflyer.mission.report.tables import has_several, write_csv, write_ends_csv

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
        from lightflyer.mission.telemetry import write_passes_csv

        files["mission-passes.csv"] = partial(write_passes_csv, found["telemetry"])
    if compared:
        from lightflyer.mission.measured.tables import write_comparison_csv

        files["comparison.csv"] = partial(write_comparison_csv, compared)
    return files


def _read_tracks(paths: list[Path] | None, mission: "MissionFile") -> "list[MeasuredTrack]":
    """Measured tracks that share time with the mission."""
    if paths is None:
        return []
    if not paths:
        raise ParameterError("--compare needs a file")
    from lightflyer.lab.record import require_distinct
    from lightflyer.mission.measured.comparison import require_comparable
    from lightflyer.mission.measured.track import read_track

    tracks = [read_track(path) for path in paths]
    require_distinct([(one.source, (one.time, one.latitude, one.altitude)) for one in tracks])
    for track in tracks:
        require_comparable(track, mission.mission.build_release(), mission.mission.duration.value)
    return tracks


def _compare(tracks: "list[MeasuredTrack]", mission: "MissionFile") -> "list[xr.Dataset]":
    """The mission beside each track, until interrupted."""
    if not tracks:
        return []
    from lightflyer.mission.measured.comparison import compare_track

    compared: list[xr.Dataset] = []
    with suppress(KeyboardInterrupt):
        for track in tracks:
            compared.append(compare_track(track, mission.design, **mission.flight_arguments()))
    return compared
