"""Damaged tables of every kind: the right numbers, or one clear line. Readers only, no commands."""

import csv
import io

import numpy as np
import openpyxl
import pytest

import lightflyer as lf
from lightflyer.calibration.points import read_points
from lightflyer.files.table import read_table
from lightflyer.film.media.materials import read_index_csv
from lightflyer.lab.synthetic import example_files
from lightflyer.lab.tac.data import read_resistance_calibration, read_tac
from lightflyer.lab.thermography.data import THERMAL, columns_of

EACH = 100
ROWS = 6  # of a file: a damage is then near every kind of cell


@pytest.fixture(scope="module")
def damaged(study_of):
    with study_of("damaged_files", "damage") as module:
        yield module.damaged


POINTS = """\
# synthetic
sample, pressure [mTorr], irradiance [W/m^2], irradiance_uncertainty [W/m^2], diameter [cm]
Ge 2 cm, 8.5, 5973, 239, 2
Ge 2 cm, 12.25, 2026, 81.5, 2
Ge 2 cm, 18, 1181.25, 47, 2
Ge 3 cm, 26.5, 950.5, 38, 3
Ge 3 cm, 38, 1034, 41, 3
"""
INDICES = "wavelength [nm],n,k\n400.5,4.141,2.215\n550,5.17,0.75\n812.5,4.4,0.0102\n900,4.3,0.003\n"
BLOCKS = "wl,n\n0.4,4.141\n0.55,5.17\n0.8125,4.4\n\nwl,k\n0.4,2.215\n0.55,0.75\n0.8125,0.0102\n"
PAGE = """\
REFERENCES: |
    Nobody (2024)
DATA:
  - type: tabulated nk
    data: |
        0.4 4.141 2.215
        0.55 5.17 0.75
        0.8125 4.4 0.0102
"""


def numbers_of_points(path):
    return read_points(path).numbers


def numbers_of_tac(path):
    run = read_tac(path, ambient_temperature=295.0)
    return {"pressure": run.pressure, "power": run.power, "heater": run.heater_temperature}


def numbers_of_resistance(path):
    found = read_resistance_calibration(path)
    return {"slope": np.array([found.slope])}


def numbers_of_indices(path):
    return dict(zip(("wavelength", "n", "k"), read_index_csv(path), strict=True))


def numbers_of_readings(path):
    return read_table(path, columns_of(THERMAL)).numbers


def workbook(text):
    book = openpyxl.Workbook()
    for row in csv.reader(text.splitlines()[1:], skipinitialspace=True):
        book.active.append([number(cell) for cell in row])
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return cell


def head(text):
    """Header and first rows, without the faults that the examples have."""
    lines = text.lstrip("\N{ZERO WIDTH NO-BREAK SPACE}").splitlines()
    sound = [line for line in lines if not line.startswith("#") and line[-1] not in ";D"]
    return "\n".join([lines[0], *sound[: ROWS + 1]]) + "\n"


def example(name, file):
    return head(example_files(name).files[file])


CASES = {
    "points.csv": (numbers_of_points, POINTS),
    "launchpads.csv": (numbers_of_points, example("levitation", "launchpads.csv")),
    "tac-reduced.txt": (numbers_of_tac, example("tac", "tac-reduced.txt")),
    "tac-resistance.csv": (numbers_of_resistance, example("tac", "tac-resistance.csv")),
    "thermal.csv": (numbers_of_readings, example("thermography", "thermal.csv")),
    "film.csv": (numbers_of_indices, INDICES),
    "blocks.csv": (numbers_of_indices, BLOCKS),
    "page.yml": (numbers_of_indices, PAGE),
    "points.xlsx": (numbers_of_points, workbook(POINTS)),
}


def answer(read, path):
    """Columns, or what the one line says; any other exception fails the test."""
    try:
        columns = read(path)
    except lf.LightflyerError as error:
        said = str(error)
        assert "\n" not in said
        assert said.startswith(str(path)), said
        return None, said
    assert all(np.isfinite(values).all() for values in columns.values())
    return columns, ""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["film.csv", "blocks.csv", "page.yml", "points.xlsx"])
def test_any_damage(tmp_path, damaged, name):
    """Of files that the study of damaged files has not: bytes lost, changed and doubled."""
    read, content = CASES[name]
    content = content if isinstance(content, bytes) else content.encode()
    path = tmp_path / name
    for seed in range(EACH):
        changed, _ = damaged(content, np.random.default_rng([seed, 3]))
        path.write_bytes(changed)
        answer(read, path)


def rewritten(text, name, rng):
    """The same table in other clothes."""
    if name.endswith(".yml"):
        encodings = ["utf-8", "utf-8-sig", "utf-16"]
        return text.encode(encodings[int(rng.integers(3))])
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    mark = next(mark for mark in "\t;," if mark in lines[0])
    cells = list(csv.reader(lines, delimiter=mark, skipinitialspace=True))
    if mark == ";":  # with decimal commas
        cells = [cells[0], *([one.replace(",", ".") for one in row] for row in cells[1:])]
    decimal = ",."[int(rng.integers(2))]
    cells = [cells[0], *([one.replace(".", decimal) for one in row] for row in cells[1:])]
    if name != "blocks.csv":
        order = rng.permutation(len(cells[0]))
        cells = [[row[place] for place in order] for row in cells]
    out = io.StringIO()
    delimiter = "\t;,"[int(rng.integers(3))]
    end = ["\n", "\r\n", "\r"][int(rng.integers(3))]
    csv.writer(out, delimiter=delimiter, lineterminator=end).writerows(cells)
    encoding = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"]
    return ("# note" + end + out.getvalue()).encode(encoding[int(rng.integers(6))])


@pytest.mark.parametrize("name", [name for name in CASES if not name.endswith(".xlsx")])
def test_the_same_table_in_other_clothes(tmp_path, name):
    """Delimiter, decimal mark, order of columns, line ends and encoding change no number."""
    read, text = CASES[name]
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    truth, _ = answer(read, path)
    for seed in range(EACH // 4):
        path.write_bytes(rewritten(text, name, np.random.default_rng([seed, 5])))
        found, said = answer(read, path)
        # sensible only without a comment above the first block
        if name == "blocks.csv" and found is None:
            continue
        assert found is not None, said
        assert found.keys() == truth.keys()
        for column in truth:
            np.testing.assert_allclose(found[column], truth[column], rtol=1e-12)


def shortened(text, rng):
    """Rows lost, doubled, swapped or cut, cells emptied: the others keep their meaning."""
    lines = text.splitlines(keepends=True)
    kind = int(rng.integers(6))
    one, two = (int(place) for place in rng.integers(0, len(lines), 2))
    if kind == 0:
        return text[: int(rng.integers(1, len(text)))]
    if kind == 1:
        del lines[one]
    elif kind == 2:
        lines.insert(one, lines[two])
    elif kind == 3:
        lines[one], lines[two] = lines[two], lines[one]
    elif kind == 4:
        mark = next(mark for mark in "\t;, " if mark in lines[one]) if one else ","
        cells = lines[one].rstrip("\n").split(mark)
        cells[int(rng.integers(len(cells)))] = ["", "OVLD", "nan", "#N/A"][int(rng.integers(4))]
        lines[one] = mark.join(cells) + "\n"
    else:
        lines[one] = lines[one].rstrip("\n") + lines[two]
    return "".join(lines)


def remarked(text, rng):
    """A comma, point, semicolon, tab or space in the place of another behind the header."""
    header = next(line for line in text.splitlines() if not line.startswith("#"))
    body = text.index(header) + len(header)
    places = [place for place in range(body, len(text)) if text[place] in ",.;\t "]
    place, mark = places[int(rng.integers(len(places)))], ",.;\t "[int(rng.integers(5))]
    if text[place] == " " and mark in ",.":  # ".3" is a number
        return text
    return text[:place] + mark + text[place + 1 :]


@pytest.mark.parametrize("change", [shortened, remarked])
@pytest.mark.parametrize(
    "name", ["points.csv", "launchpads.csv", "tac-reduced.txt", "thermal.csv", "film.csv"]
)
def test_numbers_that_are_read_are_numbers_of_the_file(tmp_path, name, change):
    """But for the last number of a file that is cut, which a note names."""
    read, text = CASES[name]
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    truth, _ = answer(read, path)
    read_at_all = 0
    for seed in range(EACH):
        content = change(text, np.random.default_rng([seed, 7]))
        path.write_text(content, encoding="utf-8")
        found, _ = answer(read, path)
        if found is None:
            continue
        read_at_all += 1
        last = len(next(iter(found.values()))) - (not content.endswith("\n"))
        for column in found:
            for value in found[column][:last]:
                near = np.isclose(value, truth.get(column, ()), rtol=1e-12, atol=0.0)
                assert near.any(), (seed, column, value)
    assert read_at_all > 0
