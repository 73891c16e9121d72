"""What others on the same computer may read or write, and what ends otherwise than well."""

import csv
import errno
import json
import os
import signal
import stat
import subprocess
import sys
import tempfile
import time
import webbrowser
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import lightflyer as lf
from lightflyer import cli
from lightflyer.cli import code_cache
from lightflyer.core import atomic_files, cache
from lightflyer.core.text import cell_text
from lightflyer.environment.wind import layouts
from lightflyer.explorer import server
from lightflyer.files.result_text import unwrap
from lightflyer.mission.report.ground import write_passes_csv

POSIX = pytest.mark.skipif(os.name != "posix", reason="of POSIX")


def command(*arguments, prefix="", **more):
    """A command in a process of its own, begun by a shell."""
    words = " ".join(map(str, (sys.executable, "-m", "lightflyer", *arguments)))
    return subprocess.run(["bash", "-c", f"{prefix} {words} {more.pop('suffix', '')}"],
                          capture_output=True, text=True, check=False, **more)  # fmt: skip


@POSIX
def test_the_token_of_the_explorer_stands_in_no_command_line(prints, monkeypatch):
    shown, read = [], []

    def opens(address):
        shown.append(address)
        path = Path(address.removeprefix("file://"))
        read.append((path.read_text(encoding="utf-8"), stat.S_IMODE(path.stat().st_mode),
                     stat.S_IMODE(path.parent.stat().st_mode)))  # fmt: skip

    def serves(workplace, port, opened):
        opened(f"http://127.0.0.1:{port}/SECRET/")
        begun = time.monotonic()
        while not read and time.monotonic() - begun < 10.0:
            time.sleep(0.01)

    monkeypatch.setattr(webbrowser, "open", opens)
    monkeypatch.setattr(server, "serve", serves)
    assert "/SECRET/" in prints("explore")  # the terminal is the user's own
    ((page, mode, above),) = read
    assert "SECRET" not in shown[0]
    assert 'content="0; url=http://127.0.0.1:8470/SECRET/"' in page
    assert (mode, above) == (0o600, 0o700)
    assert not Path(shown[0].removeprefix("file://")).parent.exists()


def test_without_room_for_a_file_the_address_is_printed(run, monkeypatch):
    shown = []
    monkeypatch.setattr(webbrowser, "open", shown.append)
    monkeypatch.setattr(tempfile, "mkdtemp", full)
    monkeypatch.setattr(server, "serve", lambda _, port, opened: opened(f"http://h:{port}/S/"))
    code, text, _ = run("explore")
    assert (code, shown) == (0, [])
    assert "explore at http://h:8470/S/" in text


@POSIX
@pytest.mark.parametrize(("mode", "kept"), [(0o777, False), (0o770, False), (0o1777, True),
                                            (0o755, True)])  # fmt: skip
def test_code_is_kept_where_nobody_else_may_exchange_it(tmp_path, monkeypatch, mode, kept, prints):
    above = tmp_path / "above"
    above.mkdir()
    above.chmod(mode)
    monkeypatch.setenv(cache.SETTING, str(above / "cache"))
    for name in (code_cache._OF_NUMBA, code_cache._OF_JAX):
        monkeypatch.setenv(name, "")  # restored in the end
        monkeypatch.delenv(name)
    monkeypatch.setattr(cache, "refused", [])
    monkeypatch.setattr(code_cache, "refused", cache.refused)
    monkeypatch.setattr(code_cache.atexit, "register", lambda *_: None)
    code_cache.keep_code()
    assert (code_cache._OF_NUMBA in os.environ) == kept
    assert cache.keeps_code() == kept
    text = prints("doctor", "--json")
    assert (json.loads(text)["compiled_code"]["open_to_others"] is None) == kept


def test_numba_writes_nothing_where_nothing_is_to_be_kept():
    look = (
        "from lightflyer.kinetic_theory.grid import kernels\n"
        "@kernels.kernel\ndef f(x):\n    return x + 1.0\n"
        "print(f._cache.cache_path, kernels.keeps_code())"
    )
    done = subprocess.run([sys.executable, "-c", look], env=os.environ | {cache.SETTING: "OFF"},
                          capture_output=True, text=True, check=True)  # fmt: skip
    assert done.stdout.split() == ["None", "False"]


def test_a_spreadsheet_takes_no_name_for_a_formula(tmp_path):
    for text in ("=1+1", "+1", "-1", "@SUM(A1)", "\t=1"):
        assert cell_text(text) == f"'{text}"
    assert cell_text("disk-1=2") == "disk-1=2"
    one = {"receiver": '=HYPERLINK("x")', "begin_h": -1.5}
    write_passes_csv({"passes": [one]}, tmp_path / "passes.csv")
    (row,) = csv.DictReader((tmp_path / "passes.csv").read_text(encoding="utf-8").splitlines())
    assert (row["receiver"], row["begin_h"]) == ('\'=HYPERLINK("x")', "-1.5")


def test_names_of_flyer_files_are_no_formulas(run, prints, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("init", "=1+1.toml", "--model", "lu2023")
    Path("b.toml").write_bytes(Path("=1+1.toml").read_bytes())
    heights = ("--altitudes", "70 km to 72 km", "--samples", "0")
    prints("compare", "=1+1.toml", "b.toml", *heights, "--out", "o", "--format", "svg")
    rows = list(csv.reader(Path("o/comparison.csv").read_text(encoding="utf-8").splitlines()))
    assert {row[0] for row in rows[1:]} == {"'=1+1", "b"}


def full(*_, **__):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_disk_that_is_full_leaves_no_empty_file(refuses, tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", full)
    errors = refuses("init", tmp_path / "flyer.toml")
    assert errors.strip().endswith("flyer.toml: cannot be written: No space left on device")
    assert not list(tmp_path.iterdir())


def test_netcdf_is_made_in_memory(tmp_path, monkeypatch):
    """HDF5 itself ends the process where a disk is full."""
    import xarray as xr

    table = xr.Dataset({"lift": ("x", np.arange(3.0))})
    path = tmp_path / "o" / "table.nc"
    monkeypatch.setattr(Path, "write_bytes", full)
    with (
        pytest.raises(lf.OutputError, match="No space left"),
        atomic_files.output_directory(path.parent) as stage,
    ):
        atomic_files.write_netcdf(table, stage(path.name))
    assert not path.parent.exists()
    monkeypatch.undo()
    atomic_files.write_netcdf(table, tmp_path / "table.nc")
    xr.testing.assert_identical(xr.load_dataset(tmp_path / "table.nc"), table)


def test_netcdf_is_written_by_nothing_else():
    sources = Path(lf.__file__).parent.rglob("*.py")
    texts = {path.name: path.read_text(encoding="utf-8") for path in sources}
    written = [name for name, text in texts.items() if ".to_netcdf(" in text]
    assert sorted(written) == ["atomic_files.py", "editing.py", "layouts.py"]  # the last advises
    assert '.to_netcdf(engine="h5netcdf")' in texts["editing.py"]  # into memory


def test_a_report_that_cannot_be_written_is_told_first(refuses, flyer_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Path, "mkdir", full)
    errors = refuses("predict", flyer_file(), "--report", "r.html")
    assert f"--report r.html: {tmp_path}: cannot be written: No space left on device" in errors


@POSIX
def test_closed_streams_change_nothing_else(flyer_file, tmp_path):
    asked = ("predict", flyer_file(), "--samples 0", "--format svg", "--out", tmp_path / "o")
    done = command(*asked, suffix="2>&-")
    assert done.returncode == 0
    assert "It flies" in done.stdout
    assert (tmp_path / "o" / "prediction.nc").stat().st_size
    assert command("predict", tmp_path / "none.toml", suffix="2>&-").returncode == 2
    if Path("/dev/full").exists():
        for prefix in ("env -u PYTHONUNBUFFERED", "PYTHONUNBUFFERED=1"):
            lost = {"prefix": prefix, "suffix": "2>/dev/full"}
            assert command("predict", tmp_path / "none.toml", **lost).returncode == 2
        warned = flyer_file("tac_bottom = 0.9", "tac_bottom = 1.05")
        assert command("predict", warned, "--samples 0", **lost).returncode == 0
    done = command("predict", tmp_path / "none.toml", suffix=">&- <&-")
    assert len(unwrap(done.stderr)) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="of Linux")
@pytest.mark.parametrize("limit", [150_000, 460_000])
def test_too_little_memory_for_libraries_is_a_line(flyer_file, limit):
    """Where it would end depends on libraries; that of linear algebra ends the process itself."""
    done = command("predict", flyer_file(), "--samples 0", prefix=f"ulimit -v {limit};")
    assert done.returncode == 2
    assert len(unwrap(done.stderr)) == 1
    assert "raise the limit" in done.stderr


def test_a_library_that_finds_no_room_is_a_line(refuses, monkeypatch):
    def fails(_):
        raise ImportError("libx.so: failed to map segment from shared object")

    monkeypatch.setattr(cli, "_require_files", fails)
    errors = refuses("predict", "flyer.toml")
    assert errors.startswith("lightflyer: error: libraries find no room in memory")


@POSIX
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_is_ended_leaves_nothing(tmp_path, number):
    program = (
        "import time, sys\n"
        "import lightflyer.cli as cli, lightflyer.__main__ as command\n"
        "from lightflyer.core.atomic_files import output_directory\n"
        "def run():\n"
        f"    with output_directory(__import__('pathlib').Path({str(tmp_path / 'o')!r})):\n"
        "        print('begun', flush=True)\n"
        "        time.sleep(60)\n"
        "cli.main = run\n"
        "command.main()\n"
    )
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True,
                          stderr=subprocess.PIPE) as process:  # fmt: skip
        assert process.stdout.readline() == "begun\n"
        assert list((tmp_path / "o").iterdir())
        process.send_signal(number)
        assert process.wait(10) == 128 + number
        assert "interrupted" in process.stderr.read()
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("depth", [30, 150, 500, 5000])
def test_deep_files_are_a_line(refuses, flyer_file, tmp_path, depth):
    text = flyer_file().read_text(encoding="utf-8")
    for number, extra in enumerate((f"[deep]\nx = {'[' * depth}{']' * depth}\n",
                                    f"[deep]\nx = {'{a=' * depth}1{'}' * depth}\n",
                                    f"[{'.'.join('a' * depth)}]\nb = 1\n")):  # fmt: skip
        path = tmp_path / f"deep{number}.toml"
        path.write_text(f"{text}\n{extra}", encoding="utf-8")  # the fixture's file is another
        refuses("predict", path, "--samples", "0")


@pytest.mark.parametrize("date", ["2023-02-29", "2023-06-31T10:00:00Z", "2023-13-01", "25:00"])
def test_days_that_do_not_exist_are_named(run, refuses, tmp_path, date):
    path = tmp_path / "mission.toml"
    run("init", path, "--kind", "mission")
    text = path.read_text(encoding="utf-8").replace("2026-06-21T12:00:00Z", date, 1)
    path.write_text(text, encoding="utf-8")
    errors = refuses("fly", path)
    assert errors.strip().endswith(f"mission.toml:6: date = {date}: there is no such date or time")


def test_a_wind_file_that_was_cut_is_damaged(run, tmp_path):
    import xarray as xr

    wind = np.zeros((2, 3, 4, 5))
    whole = xr.Dataset(dict.fromkeys("uv", (("time", "level", "latitude", "longitude"), wind)))
    for engine, size in (("h5netcdf", 4000), ("scipy", 500), ("h5netcdf", 100)):
        whole.to_netcdf(tmp_path / "w.nc", engine=engine)
        cut = (tmp_path / "w.nc").read_bytes()[:size]
        (tmp_path / "w.nc").write_bytes(cut)
        with pytest.raises(lf.ConfigurationError, match="is damaged or cut short"):
            layouts.open_parts(tmp_path / "w.nc")


@POSIX
@pytest.mark.parametrize("words", ["predict {}", "fly {}", "lab ftir {}", "lab tac {}",
                                   "lab roughness {}", "calibrate {}",
                                   "sweep {} --out o"])  # fmt: skip
def test_devices_are_no_files(refuses, words):
    assert "/dev/zero: cannot be read: is a device" in refuses(*words.format("/dev/zero").split())


def test_a_workbook_that_unpacks_to_much_is_refused(refuses, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    path, bomb = tmp_path / "small.xlsx", tmp_path / "bomb.xlsx"
    book = openpyxl.Workbook()
    book.active.append(["pressure [Pa]", "power [mW]"])
    book.save(path)
    with (
        zipfile.ZipFile(path) as source,
        zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as written,
    ):
        for one in source.namelist():
            if one != "xl/sharedStrings.xml":
                written.writestr(one, source.read(one))
        with written.open("xl/sharedStrings.xml", "w") as file:
            for _ in range(80):
                file.write(b"<si><t>a</t></si>" * (2**20 // 17))
    begun = time.process_time()
    errors = refuses("lab", "tac", bomb)
    assert "unpacks to 8" in errors
    assert "save its table as .csv" in errors
    assert time.process_time() - begun < 5.0


def test_pictures_that_grow_without_end_are_a_line(run, refuses, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    image = pytest.importorskip("PIL.Image")
    monkeypatch.setattr(image, "MAX_IMAGE_PIXELS", 10)
    image.new("L", (64, 64)).save("mask.png")
    run("lab", "example", "roughness", "--out", "lab")
    errors = refuses("lab", "roughness", "lab/germanium.txt", "--mask", "mask.png")
    assert "mask.png: has more pixels than any height map" in errors


def test_code_that_is_not_as_it_was_left_is_removed(tmp_path):
    kept, flipped, planted = (tmp_path / name for name in ("a/f.nbc", "x-cache", "a/g.nbi"))
    kept.parent.mkdir()
    kept.write_bytes(bytes(100))
    flipped.write_bytes(bytes(100))
    code_cache.note_hashes(tmp_path)
    flipped.write_bytes(bytes(50) + b"\x01" + bytes(49))
    planted.write_bytes(b"code")
    (tmp_path / "x-atime").write_bytes(b"1")  # JAX's, not code
    code_cache.remove_strange(tmp_path)
    assert kept.exists()
    assert not flipped.exists()
    assert not planted.exists()
    (tmp_path / "hashes.json").write_text("[")
    code_cache.remove_strange(tmp_path)
    assert not kept.exists()


def test_kernels_of_another_source_have_another_folder(tmp_path, monkeypatch):
    before = code_cache._for_kernels(tmp_path)
    source = Path(lf.__file__).parent / "kinetic_theory" / "solver.py"
    known, later = type(source).stat, SimpleNamespace(st_mtime_ns=1)
    monkeypatch.setattr(
        type(source), "stat", lambda path, **more: later if path == source else known(path, **more)
    )
    assert code_cache._for_kernels(tmp_path) != before
