"""``lightflyer fly``: a mission through days, nights and winds."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, write_json

if TYPE_CHECKING:
    import xarray as xr

_MOST_ROWS = 12  # of nights and of launches in a table; the summary has all


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
    from lightflyer.mission.report.facts import facts_of

    mission = read_mission_file(mission_file)
    dataset = fly(mission.design, **mission.arguments())
    dataset.attrs["configuration"] = mission.design.text
    summary = facts_of(dataset) | {
        "assumptions": dataset.attrs["assumptions"].split("; "),
        "warnings": [text for text in dataset.attrs["warnings"].split("; ") if text],
    }
    written = [] if out is None else _write(out, dataset, summary, figures)
    if json_output:
        print_json(summary)
        return
    console = printer()
    _show(console, dataset, summary)
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


def _show(console: Console, dataset: "xr.Dataset", summary: dict[str, Any]) -> None:
    rows = Table.grid(padding=(0, 2))
    rows.add_row("flyer", dataset.attrs["flyer"])
    rows.add_row("released", f"{summary['released']}, {_place(dataset, 'start')}")
    rows.add_row("ended", f"{summary['ended']}, {_place(dataset, 'end')}")
    rows.add_row("because", f"it {summary['end']}")
    rows.add_row("aloft", f"{summary['duration_h']:.2f} h, {summary['light_h']:.2f} h in light")
    for name in ("lowest", "highest"):
        altitude, when = summary[f"{name}_altitude_km"], summary[f"{name}_at_h"]
        rows.add_row(name, f"{altitude:.2f} km, {when:.2f} h after the release")
    console.print(rows)
    if summary["nights"]:
        console.print(_nights(summary["nights"]))
    if "ensemble" in summary:
        console.print(_ensemble(summary["ensemble"]))
    if "launches" in summary:
        console.print(_launches(summary["launches"]))
    for text in summary["assumptions"]:
        console.print(text, soft_wrap=True)
    for text in summary["warnings"]:
        console.print(f"warning: {text}", soft_wrap=True)


def _place(dataset: "xr.Dataset", which: str) -> str:
    """Altitude and place of the release or of the end, in words."""
    if which == "start":
        parts = [dataset[name].values[0] for name in ("latitude", "longitude", "altitude")]
    else:
        names = ("end_latitude", "end_longitude", "end_altitude")
        parts = [float(dataset[name]) for name in names]
    latitude, longitude, altitude = (float(part) for part in parts)
    north, east = "N" if latitude >= 0.0 else "S", "E" if longitude >= 0.0 else "W"
    return f"{abs(latitude):.2f}° {north}, {abs(longitude):.2f}° {east}, {altitude / 1e3:.2f} km"


def _table(title: str, *headings: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, padding=(0, 1), pad_edge=False)
    for number, heading in enumerate(headings):
        table.add_column(heading, justify="right" if number else "left")
    return table


def _nights(nights: list[dict[str, Any]]) -> Table:
    table = _table("nights", "begins", "ends", "hours", "at its begin\n[km]", "at its end\n[km]")
    for night in nights[:_MOST_ROWS]:
        altitudes = (f"{night[f'altitude_at_{name}_km']:.2f}" for name in ("begin", "end"))
        ends = night["ends"] if night["whole"] else f"{night['ends']} *"
        table.add_row(night["begins"], ends, f"{night['duration_h']:.2f}", *altitudes)
    if not all(night["whole"] for night in nights[:_MOST_ROWS]):
        table.caption = "* not the whole night: the mission begins or ends in it"
        table.caption_justify = "left"
    return table


def _ensemble(found: dict[str, Any]) -> Table:
    share = 100.0 * found["still_flying"]
    table = _table(
        f"{found['members']} flights, {share:.1f} % still flying at the end",
        "95 % interval",
        "from",
        "median",
        "to",
    )
    for name, key in (
        ("time aloft [h]", "duration_h"),
        ("altitude at the end [km]", "end_altitude_km"),
        ("distance from the stated flyer's end [km]", "distance_from_nominal_end_km"),
    ):
        interval = found[key]
        table.add_row(name, *(f"{interval[end]:.2f}" for end in ("low", "median", "high")))
    return table


def _launches(found: list[dict[str, Any]]) -> Table:
    table = _table("launches", "released", "aloft [h]", "lowest [km]", "at the end [km]", "end")
    for launch in found[:_MOST_ROWS]:
        table.add_row(
            launch["released"],
            f"{launch['duration_h']:.2f}",
            f"{launch['lowest_altitude_km']:.2f}",
            f"{launch['end_altitude_km']:.2f}",
            launch["end_reason"].replace("_", " "),
        )
    if len(found) > _MOST_ROWS:
        table.caption = f"and {len(found) - _MOST_ROWS} more in the summary"
        table.caption_justify = "left"
    return table
