"""``lightflyer drift``, ``stability``, ``swarm``: what tilt, rods and tethers do by altitude."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from lightflyer.cli.figure_files import ResultOptions
from lightflyer.cli.options import Json, coordinate_range
from lightflyer.cli.output import print_json, printer, show
from lightflyer.core.atomic_files import write_netcdf
from lightflyer.files.quantities import exact

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr


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


AS_USUAL = AltitudeOptions()


def drift_command(
    flyer_file: Path, /, *, azimuth: str = "0 deg", options: AltitudeOptions = AS_USUAL
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
    options: AltitudeOptions = AS_USUAL,
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
    options: AltitudeOptions = AS_USUAL,
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
