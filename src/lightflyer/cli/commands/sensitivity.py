"""``lightflyer sensitivity``: which uncertain property matters most."""

from pathlib import Path

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, show
from lightflyer.files.result_text import warning_lines


def sensitivity_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Rank uncertain properties by their effect, and say what to measure next.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [sensitivity] and [sensitivity.at];
        uncertainties are those of [sensitivity.inputs], by default those of the flyer file.
    out
        Folder to write the result (JSON) and a tornado figure for each output into.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.search import read_sensitivity_study, sensitivity

    study = read_sensitivity_study(study_file)
    results = sensitivity(study)
    summary = {found.output: found.summary() for found in results}
    written = figures.write_folder(
        out,
        {"sensitivity.json": summary},
        lambda: {f"{found.output}-tornado": found.plot() for found in results},
    )
    if json_output:
        print_json(summary)
        return
    console = printer()
    for found in results:
        show(console, found.text_parts())
    for group in study.groups:
        if len(group) > 1:
            values = (v for pair, v in study.correlations.items() if set(pair) <= set(group))
            console.print(
                f"{' and '.join(group)} vary together (correlation "
                f"{', '.join(f'{value:g}' for value in values)}) and have one share; the last two "
                "columns are quantiles of the output",
                soft_wrap=True,
            )
    show(console, warning_lines(results[0].warnings))
    figures.tell(console, written)
