"""Every piece of Python, TOML and console on the pages works, and prints what the page shows.

They take minutes, so that they run with the documentation, ``make docs``, not with the tests.

A figure below "% drawn above: FILE" is the one that the commands above it write. After a change of
figures on purpose, ``make figures`` takes the new ones, and ``make listings`` the new lines of what
commands print. Read the difference: each line is taken from the printed one that is most like it.
"""

import io
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from contextlib import redirect_stdout
from difflib import SequenceMatcher
from pathlib import Path

import matplotlib as mpl
import pytest
import tomlkit
from matplotlib.testing.compare import compare_images
from PIL import Image

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.flyer_file import FlyerFile
from lightflyer.config.reader import FLYER_FILE, read_film_file
from lightflyer.files.toml_file import validate
from lightflyer.lab.commands import measurements
from lightflyer.lab.optics.data import SAMPLE_FILE, SampleFile
from lightflyer.lab.synthetic import example_files
from lightflyer.study.sections import STUDY_FILE, StudyFile

pytestmark = pytest.mark.snippets

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
COMMAND_PAGES = sorted((DOCS / "commands").glob("*.md"))
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md")), *COMMAND_PAGES]
# "% not run: why" stands above what needs a file that no reader has
# a block of Python may be followed by what it prints
BLOCK = re.compile(
    r"^(% not run: .+\n)?```(python|toml|console)\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?",
    re.M | re.S,
)
DRAWN = re.compile(r"^% drawn above: (\S+)\n!\[[^]]+\]\((\S+)\)$", re.M)
RENEW = os.environ.get("LIGHTFLYER_RENEW_FIGURES") == "yes"
RENEW_LISTINGS = os.environ.get("LIGHTFLYER_RENEW_LISTINGS") == "yes"
COLOURS = 256  # of a picture in the repository, which makes it a third as large
ALIKE = 3.0  # root-mean-square difference of two pictures, of 255; a curve elsewhere makes tens

NOT_OURS = ("pip", "make", "source", "dask", "kubectl", "python", "#")
STUDY_SECTIONS = {"sweep", "outputs", "sampling", "optimise", "sensitivity"}
SAMPLE_KEYS = {"substrate", "ambient"}
MEASUREMENTS = tuple(measurements())


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """What a reader has made with ``lightflyer init`` and ``lightflyer lab example``."""
    folder = tmp_path_factory.mktemp("files")
    names = {"flyer.toml": "earth", "my-flyer.toml": "earth", "disk.toml": "earth"}
    names |= {f"{kind}.toml": kind for kind, one in templates().items() if one.is_flyer}
    names |= {"study.toml": "sweep", "points.csv": "points", "mission.toml": "mission"}
    for name, kind in names.items():
        (folder / name).write_text(templates()[kind].read(), encoding="utf-8")
    for measurement in MEASUREMENTS:
        for name, content in example_files(measurement).files.items():
            data = content if isinstance(content, bytes) else content.encode()
            (folder / name).write_bytes(data)
    return folder


def blocks_of(text):
    """Blocks that are run, each with its kind and what stands below it."""
    found = BLOCK.findall(text)
    return [(kind, block, printed) for left_out, kind, block, printed in found if not left_out]


def run_elsewhere():
    """Commands on the pages of commands, as words."""
    texts = [page.read_text(encoding="utf-8") for page in COMMAND_PAGES]
    blocks = [block for text in texts for kind, block, _ in blocks_of(text) if kind == "console"]
    return [shlex.split(command) for block in blocks for command, _ in commands(block)]


def pages():
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        blocks = blocks_of(text)
        if blocks:
            drawn = [(made, page.parent / shown) for made, shown in DRAWN.findall(text)]
            yield pytest.param(page, blocks, drawn, id=str(page.relative_to(ROOT).with_suffix("")))


@pytest.mark.parametrize(("page", "blocks", "drawn"), list(pages()))
def test_the_page_works(page, blocks, drawn, files, run, tmp_path, monkeypatch):
    folder = tmp_path / "here"
    shutil.copytree(files, folder)
    monkeypatch.chdir(folder)
    monkeypatch.delenv("COLUMNS", raising=False)  # tables are as wide as they are
    mpl.use("agg")
    names, renewed = {}, []
    for kind, text, printed in blocks:
        if kind == "python":
            with redirect_stdout(io.StringIO()) as stream:
                exec(compile(text, "page", "exec"), names)
            lines = [line.rstrip() for line in stream.getvalue().splitlines()]
            stale = [line for line in printed.splitlines() if line not in ("...", *lines)]
            if RENEW_LISTINGS:
                renewed += [(line, most_alike(line, lines)) for line in stale]
            else:
                assert not stale, f"{stale[0]}\n{stream.getvalue()}"
        elif kind == "toml":
            require_readable(text)
        else:
            for command, shown in commands(text):
                if not stands_on_its_page(command, page):
                    renewed += require_shown(command, shown, run)
    for made, picture in drawn:
        require_alike(Path(made), picture)
    text = page.read_text(encoding="utf-8")
    for old, new in renewed:
        text = text.replace(f"\n{old}\n", f"\n{new}\n")
    if renewed:
        page.write_text(text, encoding="utf-8")


def stands_on_its_page(command, page):
    """Whether the README's command, perhaps with more options, is run for the page about it."""
    words = shlex.split(command, comments=True)
    return (
        page.name == "README.md"
        and words[1:2] != ["init"]
        and any(longer[: len(words)] == words for longer in run_elsewhere())
    )


def require_alike(made, picture):
    """The picture on the page is the one that the commands of the page wrote."""
    if RENEW:
        with Image.open(made) as image:
            image.convert("RGB").quantize(COLOURS).save(picture, optimize=True)
        return
    difference = compare_images(str(picture), str(made), tol=ALIKE, in_decorator=True)
    assert difference is None, f"{picture.name}, {made}: rms {difference['rms']:.3g} of 255"


def require_readable(text):
    """A whole file, or sections that stand in one."""
    content = tomllib.loads(text)
    if "spectra" in content:
        validate(SampleFile, content, text, Path("sample.toml"), SAMPLE_FILE)
        return
    if SAMPLE_KEYS & set(content.get("film", {})):  # of "lightflyer film" alone
        path = Path("page.toml")
        path.write_text(text, encoding="utf-8")
        read_film_file(path)
        return
    if STUDY_SECTIONS & set(content):
        path = Path("study.toml")
        base = tomllib.loads(path.read_text(encoding="utf-8"))
        validate(StudyFile, base | content, text, path, STUDY_FILE)
        if "flyer" in content:
            path.write_text(text, encoding="utf-8")
        elif not set(content) & set(base):  # further sections of the same file
            path.write_text(f"{path.read_text(encoding='utf-8')}\n{text}", encoding="utf-8")
        return
    kind = fitting(content)
    base = tomllib.loads(templates()[kind].read()) if kind in templates() else {}  # a page's own
    if "mission" in content:
        path = Path("page.toml")
        path.write_text(tomlkit.dumps(base | content), encoding="utf-8")
        lf.mission.read_mission_file(path)
        return
    merged = {name: {**base.get(name, {}), **content.get(name, {})} for name in {**base, **content}}
    for name, section in content.items():
        if "layers" in section:
            merged[name] = section | {"tac_top": 0.8, "tac_bottom": 0.9}
        if name == "environment":
            merged[name] = section  # its keys replace each other
    validate(FlyerFile, merged, text, Path("flyer.toml"), FLYER_FILE)


def fitting(content):
    """Kind of flyer file in which some sections may stand."""
    if "mission" in content:
        return "mission"
    shape = content.get("flyer", {}).get("shape", "earth")
    return {"disk": "earth"}.get(shape, shape)


def commands(text):
    """Commands of a console block, each with the lines that it shows."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif found:
            found[-1][1].append(line)
    return found


def require_shown(command, shown, run):
    """What the page shows is printed; else, where listings are renewed, lines old and new."""
    words = shlex.split(command, comments=True)
    if words and words[0] == "sed":
        subprocess.run(command, shell=True, check=True)
        return []
    if not words or words[0] in NOT_OURS or "--scheduler" in words:
        return []
    assert words[0] == "lightflyer", command
    for word in words:
        if words[1] == "init" and os.path.isfile(word):
            os.remove(word)  # which the fixture made beforehand
    code, text, errors = run(*words[1:])
    assert code == 0, f"{command}: {errors}"
    lines = [line.rstrip() for line in (text + errors).splitlines()]
    printed = [" ".join(line.split()) for line in lines]
    wanted = {line: " ".join(line.split()) for line in shown}
    stale = [line for line, words in wanted.items() if words not in ("", "...", *printed)]
    if RENEW_LISTINGS:
        return [(line, most_alike(line, lines)) for line in stale]
    assert not stale, f"{command}:\n{stale[0]}\n{text}"
    return []


def most_alike(line, lines):
    """The line that has the words of another, whatever its numbers."""

    def likeness(other):
        first = [text.split()[:1] for text in (line, other)]
        masked = [" ".join(re.sub(r"\d[\d.]*", "0", text).split()) for text in (line, other)]
        return (first[0] == first[1]) + SequenceMatcher(None, *masked).ratio()

    return max(filter(None, lines), key=likeness)
