"""Reading a flyer file, and the film in it."""

from pathlib import Path
from typing import Any

from lightflyer.config.flyer_file import FileDesign, FlyerFile, section_at
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.text import read_text
from lightflyer.files.section import Section
from lightflyer.files.toml_file import (
    FileKind,
    load,
    named_keys,
    parse_toml,
    place_of,
    read_file,
    validate,
)
from lightflyer.film.layered_section import SampleSection


def _keys_of(section: str, document: Any) -> list[str]:
    kind = section_at(section, document)
    return [] if kind is None else list(kind.model_fields)


def is_study(document: Any) -> str:
    """What to do with a study file; empty for another."""
    named = isinstance(document.get("flyer"), str)
    return "a study file: run it with sweep, optimise or sensitivity" if named else ""


def _mistaken_for(document: Any) -> str:
    mission = "mission" in document
    return "a mission file: run it with fly or spread" if mission else is_study(document)


FLYER_FILE = FileKind(
    "a flyer file", _keys_of, "'lightflyer init' writes an example", _mistaken_for
)
"""Names that messages about a flyer file use."""


def read_flyer_file(path: str | Path) -> FlyerFile:
    """Read and check a flyer file.

    Parameters
    ----------
    path : str or path
        A TOML file; ``lightflyer init`` writes a commented one.

    Returns
    -------
    FlyerFile

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    return read_file(FlyerFile, Path(path), FLYER_FILE)[0]


def read_design(path: str | Path) -> FileDesign:
    """Read a flyer file, and build what it describes."""
    path = Path(path)
    return design_of_text(read_text(path), path)


def design_of_text(text: str, path: Path) -> FileDesign:
    """What the text of a flyer file describes."""
    document = parse_toml(text, path, FLYER_FILE)
    design = validate(FlyerFile, document, text, path, FLYER_FILE).design(text)
    try:
        design.file.environment.require_search_range(design.setup.environment)
    except ParameterError as error:
        raise ConfigurationError(
            f"{place_of(named_keys(str(error)), text, path)}: {error}"
        ) from None
    return design


def read_film_file(path: str | Path) -> SampleSection:
    """Read the layers of a film; ``path`` [film]."""
    path = Path(path)
    document, text = load(path, FLYER_FILE)
    film = document.get("film")
    if not isinstance(film, dict) or "layers" not in film:
        example = '{material = "Ge", thickness = "20 nm"}'
        raise ConfigurationError(f"{path}: needs a section [film] with layers = [{example}, ...]")
    return validate(_FilmFile, {"film": film}, text, path, FLYER_FILE).film


class _FilmFile(Section):
    film: SampleSection
