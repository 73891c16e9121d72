"""Synthetic raw files with known truth, one module per measurement."""

from typing import NamedTuple

from lightflyer.core.errors import ParameterError


class Example(NamedTuple):
    """Synthetic files and the commands that reduce them."""

    files: dict[str, str | bytes]  # Content by file name
    commands: list[str]  # Arguments of ``lightflyer lab``


def example_files(name: str, seed: int = 0) -> Example:
    """Synthetic raw files of a measurement, each labelled as synthetic.

    Parameters
    ----------
    name : str
        Name of the measurement.
    seed : int
        Seed of the noise.

    Returns
    -------
    Example

    Raises
    ------
    ParameterError
        If the name is unknown.
    """
    if name == "force":
        from lightflyer.lab.synthetic.force import force_files

        vane = 'vane.csv --diameter "12 cm" --hot "419 K" --cold "394 K"'
        return Example({**force_files(seed)}, [f"force {vane} --out force"])
    if name == "ftir":
        from lightflyer.lab.synthetic.ftir import ftir_files

        return Example(
            {**ftir_files(seed)},
            ["ftir film.jdx --out ftir", "ftir film.csv --reflectance film-reflectance.csv"],
        )
    if name == "levitation":
        from lightflyer.lab.synthetic.levitation import levitation_files

        return Example(
            {**levitation_files(seed)},
            ["levitation levitation.csv --out levitation", "levitation launchpads.csv"],
        )
    if name == "optics":
        from lightflyer.lab.synthetic.optics import optics_files

        return Example({**optics_files(seed)}, ["optics sample.toml --out optics"])
    if name == "roughness":
        from lightflyer.lab.synthetic.surface import roughness_files

        files = roughness_files(seed)
        return Example(files, [f"roughness {' '.join(files)} --out roughness"])
    if name == "tac":
        from lightflyer.lab.synthetic.tac import tac_files

        return Example(
            {**tac_files(seed)},
            ["tac tac-raw.csv --calibration tac-resistance.csv", "tac tac-reduced.txt --out tac",
             "tac --top tac-top.txt --bottom tac-bottom.txt --out faces"],
        )  # fmt: skip
    if name == "thermography":
        from lightflyer.lab.synthetic.thermography import thermography_files

        return Example(
            {**thermography_files(seed)},
            ['thermography thermal.csv --band "7.5-14 um" --accuracy "0.5 K" --out thermography',
             "thermography light-meter.csv --light-meter"],
        )  # fmt: skip
    raise ParameterError(f'there are no synthetic files for "{name}"')
