"""``lightflyer init``: files to start from."""

import re
import tomllib
from importlib import resources
from pathlib import Path
from typing import NamedTuple

from lightflyer.cli.output import printer
from lightflyer.core.atomic_files import write_whole
from lightflyer.core.errors import ConfigurationError, OutputError, ParameterError

_PREFIX, _SUFFIX = "flyer-", ".toml"


class Template(NamedTuple):
    """A commented file that comes with the package."""

    source: str  #: Its name in ``data/``
    name: str  #: Name under which it is written where none is given
    following: tuple[str, ...]  #: Commands that use it; ``{}`` stands for its path
    changes: tuple[tuple[str, str], ...] = ()  #: Texts of the source, and what replaces them

    @property
    def is_flyer(self) -> bool:
        """Whether it describes a flyer."""
        return self.source.startswith(_PREFIX)

    def read(self) -> str:
        folder = resources.files("lightflyer") / "data"
        text = (folder / self.source).read_text(encoding="utf-8")
        for before, after in self.changes:
            text = text.replace(before, after, 1)
        return text


_MODEL = re.compile(r'^model = "([^"]*)".*$', re.M)
_PREDICT = "predict {} --out prediction"
_OTHERS = {
    "mission": Template("mission.toml", "mission.toml", ("fly {} --out mission",)),
    "sweep": Template("study-sweep.toml", "study.toml", ("sweep {} --out results.zarr",)),
    "optimise": Template(
        "study-optimise.toml", "study.toml", ("optimise {} --write best-flyer.toml",)
    ),
    "optimise-film": Template(
        "study-optimise-film.toml", "study.toml", ("optimise {} --write best-flyer.toml",)
    ),
    "optimise-structure": Template(
        "study-optimise-structure.toml", "study.toml", ("optimise {} --write best-flyer.toml",)
    ),
    "sensitivity": Template(
        "study-sensitivity.toml", "study.toml", ("sensitivity {} --out sensitivity",)
    ),
    "points": Template(
        "points.csv",
        "points.csv",
        ("calibrate {} --out fit", "lab levitation {} --out levitation"),
    ),
}
_FLYERS = {"optimise-film": " --kind layers", "optimise-structure": " --kind ligaments"}
_FIRST = "earth"
_LADEN = (
    ("the 2-cm germanium-coated mylar disk", "a 5-mm germanium-coated mylar disk"),
    (
        "(2023).\n",
        "(2023),\n# laden so that it comes to rest low enough for its film to survive.\n",
    ),
    ('diameter = "2 cm"', 'diameter = "5 mm"'),
    ('payload = "0 mg"    ', 'payload = "0.03 mg" '),
)


def templates() -> dict[str, Template]:
    """Commented files that come with the package, by kind, such as ``"earth"``."""
    names = (entry.name for entry in (resources.files("lightflyer") / "data").iterdir())
    flyers = {
        name.removeprefix(_PREFIX).removesuffix(_SUFFIX): Template(
            name,
            "flyer.toml",
            ("film {} --out film", _PREDICT) if "layers" in name else (_PREDICT,),
        )
        for name in sorted(names)
        if name.startswith(_PREFIX) and name.endswith(_SUFFIX)
    }
    first = flyers.pop(_FIRST)
    return {_FIRST: first, "laden": first._replace(changes=_LADEN), **flyers, **_OTHERS}


def init(
    path: Path | None = None,
    /,
    *,
    kind: str = _FIRST,
    model: str | None = None,
    force: bool = False,
) -> None:
    """Write a commented file to start from.

    Parameters
    ----------
    path
        Where to write it; by default flyer.toml, study.toml or points.csv.
    kind
        What it is. Flyer files: earth (a disk over Earth), laden (a smaller one that survives,
        for what it carries), chamber (the disk in a vacuum chamber),
        mars (the disk over Mars), layers (a film given by its layers), sandwich (two perforated
        membranes over Earth), ligaments (the same on posts, which may sag and tear), plate
        (nanocardboard in the chamber), balloon (a solar balloon over Earth), hollow (a sphere that
        pumps gas, over Earth), particle (soot over Earth). A mission: mission. Studies: sweep,
        optimise, optimise-film, optimise-structure, sensitivity. Measurements: points (of
        levitation, to calibrate with); "lightflyer lab example" writes those of the lab bench.
    model
        Force model of a flyer file, in place of its own: lu2023 (the paper's fit), kinetic,
        free-molecular or another that is for the flyer.
    force
        Overwrite an existing file.
    """
    known = templates()
    if kind not in known:
        raise ParameterError(f'--kind "{kind}" is unknown; choose from {", ".join(known)}')
    template = known[kind]
    path = Path(template.name) if path is None else path
    text = template.read()
    if model is not None:
        if not template.is_flyer:
            raise ParameterError(f'--model "{model}": --kind "{kind}" is not a flyer file')
        from lightflyer.config.flyer_file import FlyerFile, models_for

        suitable = models_for(type(FlyerFile(**tomllib.loads(text)).flyer))
        if model not in suitable:
            raise ParameterError(
                f'--model "{model}" is not for --kind "{kind}"; choose from {", ".join(suitable)}'
            )
        own = _MODEL.search(text)
        assert own is not None  # every template names its model
        # the line goes on with what else there is
        exchanged = {f'"{own[1]}"': f'"{model}"', f'"{model}"': f'"{own[1]}"'}
        line = re.sub("|".join(exchanged), lambda name: exchanged[name[0]], own[0])
        text = text.replace(own[0], line)
        try:
            setup = FlyerFile(**tomllib.loads(text)).build()
            gas = getattr(setup.environment, "gas", None)  # every template's environment has one
            if gas is not None:
                setup.model.require_gas(gas)
        except (ConfigurationError, ParameterError) as error:
            raise ParameterError(f'--model "{model}" with --kind "{kind}": {error}') from None
    try:
        if path.exists() and not force:
            raise OutputError(f"{path}: already exists; --force overwrites it")
        if path.exists() and not path.is_file():  # such as /dev/stdout
            path.write_text(text, encoding="utf-8")
        else:
            write_whole(path, text.encode())
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    console = printer()
    console.print(f"wrote {path}", soft_wrap=True)
    flyer = path.parent / "flyer.toml"
    if template.source.startswith("study-") and not flyer.exists():
        command = f"lightflyer init {flyer}{_FLYERS.get(kind, '')}"
        console.print(f"it needs a flyer file: {command}", soft_wrap=True)
    for command in template.following:
        console.print(f"next: lightflyer {command.format(path)}", soft_wrap=True)
