"""``lightflyer kinetic``: force and heat of a thin disk from the kinetic equation."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions, only_with
from lightflyer.cli.output import print_json, printer, write_json
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import report
from lightflyer.files.result_text import table_of

if TYPE_CHECKING:
    from rich.console import Console

    from lightflyer.kinetic_theory import ChamberSolution, Solution

SurfaceName = Literal["floor", "lid", "side"]


@only_with(
    top_temperature_ratio="temperature_ratio", floor="lid", lid="side", side="floor",
    reservoir="floor", floor_temperature="floor", lid_temperature="lid", side_temperature="side",
    chamber_tac="floor",
)  # fmt: skip
def kinetic_command(
    *,
    kn: float,
    tac_top: float,
    tac_bottom: float,
    top_temperature: float | None = None,
    bottom_temperature: float | None = None,
    temperature_ratio: float | None = None,
    top_temperature_ratio: float | None = None,
    open_fraction: float = 0.0,
    gas: Literal["monatomic", "diatomic"] = "monatomic",
    wall: Literal["maxwell", "accommodated", "cercignani-lampis"] = "maxwell",
    tangential_accommodation: float | None = None,
    rotational_accommodation: float | None = None,
    boundary: float | None = None,
    floor: float | None = None,
    lid: float | None = None,
    side: float | None = None,
    reservoir: Annotated[list[SurfaceName] | None, Parameter(negative=())] = None,
    floor_temperature: float = 0.0,
    lid_temperature: float = 0.0,
    side_temperature: float = 0.0,
    chamber_tac: float = 1.0,
    local_balance: Annotated[bool, Parameter(negative=())] = False,
    radiation: float = 0.0,
    collisions: Literal["shakhov", "vhs"] = "shakhov",
    viscosity_exponent: float | None = None,
    collision_number: float | None = None,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Solve the kinetic equation around a hot thin disk, or one with holes.

    Without --temperature-ratio, solve the linear problem of small temperature differences.

    Parameters
    ----------
    kn
        Knudsen number, the mean free path of the gas far away over the disk's diameter: 0.03 to
        100.
    tac_top
        Accommodation coefficient of the upper face, above 0 and up to 1.
    tac_bottom
        Accommodation coefficient of the lower face, above 0 and up to 1.
    top_temperature
        Temperature perturbation of the upper face in the linear problem; 1 if not given.
    bottom_temperature
        Temperature perturbation of the lower face in the linear problem; 1 if not given.
    temperature_ratio
        Temperature of both faces over that of the gas far away, 0.5 to 3.5, for the non-linear
        problem.
    top_temperature_ratio
        The same for the upper face, if it differs.
    open_fraction
        Share of the molecules arriving at a face that pass to its other side, 0 to 0.999.
    gas
        Molecules without or with rotation; nitrogen and air are diatomic.
    wall
        Maxwell walls re-emit the share TAC of the molecules at their temperature and reflect the
        rest; at accommodated ones all leave diffusely at one temperature between those of wall and
        arriving gas; those of Cercignani and Lampis accommodate normal motion, tangential
        motion and rotation each on its own; in chambers with --temperature-ratio.
    tangential_accommodation
        Accommodation coefficient of tangential momentum of both faces at walls of Cercignani and
        Lampis, 0 to 1; if not given, tangential energy accommodates as the TAC says.
    rotational_accommodation
        The same of rotational energy.
    boundary
        Half-width and half-height of a cold cylindrical reservoir around the disk, in radii:
        1.5 to 338 Kn.
    floor
        Distance of a solid floor below the disk, in radii, 0.1 to 338 Kn; with --lid and --side.
    lid
        Distance of a solid lid above the disk.
    side
        Radius of a solid side wall around the disk, 1.2 to 338 Kn.
    reservoir
        Floor, lid or side that is the end of a reservoir instead of solid; may be repeated.
    floor_temperature
        Temperature of the floor over that of the gas, less 1; in the linear problem in the unit of
        the disk's perturbation.
    lid_temperature
        The same for the lid.
    side_temperature
        The same for the side wall.
    chamber_tac
        Accommodation coefficient of floor, lid and side wall, 0 to 1.
    local_balance
        Whether each spot of the film loses the heat that it absorbs, the same everywhere. The
        disk's temperature is then the mean over its area.
    radiation
        Heat that such a film also radiates, per unit area and perturbation, over p√(2RT_c).
    collisions
        The model equation of Shakhov and Rykov, or the collision operator of VHS molecules, in the
        linear problem.
    viscosity_exponent
        Of VHS molecules: 0.5 for hard spheres to 1; 0.66, or 0.74 with rotation, if not given.
    collision_number
        Inverse probability that a diatomic VHS molecule exchanges rotational energy in a
        collision, at least 1; 5 if not given.
    out
        Folder for a figure of temperature and streamlines and the result (JSON).
    json_output
        Print one JSON object instead of a table.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    if temperature_ratio is not None and (top_temperature, bottom_temperature) != (None, None):
        raise ParameterError(
            "--top-temperature and --bottom-temperature belong to the linear problem and cannot be "
            "combined with --temperature-ratio"
        )
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.kinetic_theory import solve, solve_in_chamber

    # a folder that cannot be written is found before, not after, a long solution
    written: list[str] = []
    opened = nullcontext() if out is None else output_directory(out)
    with opened as stage, _name_as_options():
        heated: dict[str, Any] = {
            "top_temperature": 1.0 if top_temperature is None else top_temperature,
            "bottom_temperature": 1.0 if bottom_temperature is None else bottom_temperature,
            "temperature_ratio": (
                temperature_ratio
                if temperature_ratio is None or top_temperature_ratio is None
                else (top_temperature_ratio, temperature_ratio)
            ),
            "gas": gas,
            "wall": wall,
            "tangential_accommodation": tangential_accommodation,
            "rotational_accommodation": rotational_accommodation,
        }
        chamber = None
        if floor is not None and lid is not None and side is not None:  # or none is
            from lightflyer.kinetic_theory import Chamber, Surface

            places = {
                "floor": (floor, floor_temperature),
                "lid": (lid, lid_temperature),
                "side": (side, side_temperature),
            }
            chamber = Chamber(
                **{
                    name: Surface(distance, name not in (reservoir or ()), temperature, chamber_tac)
                    for name, (distance, temperature) in places.items()
                }
            )
        others: dict[str, Any] = {
            "open_fraction": open_fraction,
            "boundary": boundary,
            "collisions": collisions,
            "viscosity_exponent": viscosity_exponent,
            "collision_number": collision_number,
        }
        film: dict[str, Any] = {
            "film": "local" if local_balance else "isothermal",
            "radiation": radiation,
        }
        solution: Solution | ChamberSolution
        if chamber is None and film == {"film": "isothermal", "radiation": 0.0}:
            solution = solve(kn, tac_top, tac_bottom, **heated, **others)
        else:
            usual = {"open_fraction": 0.0, "collisions": "shakhov"}
            for name, value in others.items():
                if value != usual.get(name):
                    raise ParameterError(
                        f"--{name.replace('_', '-')} cannot be combined with --floor, --lid, "
                        "--side or --local-balance"
                    )
            solution = solve_in_chamber(kn, tac_top, tac_bottom, **heated, **film, chamber=chamber)
        if stage is not None:
            report("drawing the flow")
            from lightflyer.kinetic_theory.figures import flow_figure

            described = solution.to_json() | {"inputs": solution.inputs}
            write_json(stage("kinetic.json"), described)
            drawn = figures.write(stage, lambda: {"flow": flow_figure(solution)})
            written = ["kinetic.json", *drawn]
    if json_output:
        print_json(solution.to_json())
    else:
        console = printer()
        _show(console, solution)
        hint = "add --out FOLDER to write a figure of the flow"
        figures.tell(console, [] if out is None else [out / name for name in written], hint)


def _show(console: "Console", solution: "Solution | ChamberSolution") -> None:
    described = solution.to_json()
    console.print(solution.title, soft_wrap=True)
    errors, rows = described["error_estimate"], []
    for label, name in (
        ("force", "force_ratio"),
        ("heat", "heat_ratio"),
        ("heat, top", "heat_ratio_top"),
        ("heat, bottom", "heat_ratio_bottom"),
    ):
        value, error = described[name], errors.get(name)
        shown = "–" if value is None else f"{value:.5f}"
        rows.append((label, shown, "" if error is None else f"± {error:.1g}"))
    console.print(table_of(("", "over free-\nmolecular [1]", "error"), rows))
    if "forces" in described:
        rows = [
            (name, f"{force:.6f}", f"{described['heats'][name]:.6f}")
            for name, force in described["forces"].items()
        ]
        rows.append(("error, disk", f"± {errors['force']:.1g}", f"± {errors['heat']:.1g}"))
        if closure := described["closure"]:
            sums = f"{closure['force']:.0e}", f"{closure['heat']:.0e}"
            rows.append(("sum over sum of sizes", *sums))
        console.print(table_of(("", "force up\n[pA]", "heat out\n[p√(2RT_c)A]"), rows))
        profile = described["film_temperature"]
        if described["imbalance"] is not None:
            console.print(
                f"film: T/T_c - 1 is {profile[0]:.4f} in the centre and {profile[-1]:.4f} at the "
                f"edge; absorbed and lost heat differ by at most {described['imbalance']:.0e}",
                soft_wrap=True,
            )
        for words in described["warnings"]:
            console.print(f"warning: {words}", soft_wrap=True)
    count = described["iterations"]
    excluded = " and excludes that of the model" if solution.is_model else ""
    console.print(
        f"{count} iteration{'' if count == 1 else 's'}, {described['seconds']:.1f} s; the error is "
        f"numerical{excluded}",
        soft_wrap=True,
    )


@contextmanager
def _name_as_options() -> Iterator[None]:
    """Name parameters in errors as the command line does."""
    try:
        yield
    except ParameterError as error:
        name, space, rest = str(error).partition(" ")
        option = "--kn" if name == "knudsen" else f"--{name.replace('_', '-')}"
        known = name in signature(kinetic_command).parameters or name == "knudsen"
        raise ParameterError(f"{option}{space}{rest}" if known else str(error)) from None
