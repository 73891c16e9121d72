import contextlib
import ctypes
import gc
import importlib
import importlib.metadata
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from zlib import crc32

# Most of the suite's time is XLA's optimisation of small kernels. These are the flags of the XLA
# in the lock file; another's might not know them, and would refuse to start.
if importlib.metadata.version("jaxlib").startswith("0.10."):
    os.environ.setdefault(
        "XLA_FLAGS",
        "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
        "--xla_cpu_opt_preset=CPU_OPT_PRESET_FAST_COMPILE --xla_llvm_disable_expensive_passes=true "
        "--xla_cpu_parallel_codegen_split_count=1",
    )

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # workers share the processors
os.environ.setdefault("LIGHTFLYER_PROGRESS", "off")  # a slow machine would see it anywhere

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer import cli
from lightflyer.array import transformations
from lightflyer.files.result_text import NARROW, unwrap

# Every worker, and every command that a test starts, would compile package and tests again.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# What one worker traced and compiled serves the others, and the next run; a program is known by its
# content. A largest size makes JAX lock the folder. Tests of what is kept choose a folder of their
# own.
SHARED = Path(__file__).parents[1] / ".pytest_cache"
os.environ.setdefault("LIGHTFLYER_CACHE", str(SHARED / "traces"))
os.environ.setdefault("NUMBA_CACHE_DIR", str(SHARED / "numba"))
jax.config.update("jax_traceback_in_locations_limit", 0)  # lines of source that nobody asks for
jax.config.update("jax_compilation_cache_dir", str(SHARED / "programs"))
jax.config.update("jax_compilation_cache_max_size", 2 * 10**9)
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.2)


def pytest_addoption(parser):
    """Let a run take a share of the files, which share what they trace and compile."""
    parser.addoption("--part", default="1/1", help="run one part of the test files, such as 2/8")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Mark slow tests by their folder, and keep those of the part that is asked for."""
    # numba compiles the kinetic solver for minutes
    for item in items:
        if "kinetic_theory" in item.nodeid:
            item.add_marker(pytest.mark.slow)
    part, parts = map(int, config.getoption("part").split("/"))
    left = {item for item in items if crc32(str(item.location[0]).encode()) % parts != part - 1}
    config.hook.pytest_deselected(items=[*left])
    items[:] = [item for item in items if item not in left]


def pytest_unconfigure(config):
    """Say in the last line how many tests were skipped for want of a browser."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None:  # of a worker
        return
    reasons = [str(report.longrepr) for report in reporter.stats.get("skipped", ())]
    lacking = sum("needs a browser" in reason for reason in reasons)
    if lacking:
        reporter.write_line(
            f"{lacking} tests of the explorer's and the calculator's pages were skipped: install "
            "Chromium, such as by: sudo apt install chromium"
        )


@pytest.fixture(scope="session")
def film():
    """The paper's germanium-coated film."""
    return lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)


@pytest.fixture(scope="session")
def disk(film):
    return lf.Disk(film, radius=0.01)


@pytest.fixture(scope="session")
def compiled():
    """Make a function run by JAX, in double precision."""
    return transformations.compiled


@pytest.fixture(scope="session")
def require_derivatives(compiled):
    """Compare derivatives of a function of a vector, by JAX, with differences by NumPy."""

    def require(function, point, rtol, atol, *, reverse=False):
        shifts = 1e-5 * np.diag(point)
        moved = np.concatenate([point + shifts, point - shifts, point[None]]).T

        def forward(x):  # each element moves in an input of its own
            return jax.jvp(function, (x,), (jax.numpy.diag(point),))

        def backward(x):
            value, pull = jax.vjp(function, x)
            slopes = jax.vmap(lambda row: pull(row)[0])(jax.numpy.eye(value.size))
            return value[:, None], slopes * point

        with lf.float64():
            values = np.asarray(function(moved))
            if reverse:
                value, slope = compiled(backward)(point)
            else:
                value, slope = compiled(forward)(np.repeat(point[:, None], point.size, 1))
        np.testing.assert_allclose(value, np.broadcast_to(values[:, -1:], value.shape), rtol=1e-12)
        differences = (values[:, : point.size] - values[:, point.size : -1]) / 2e-5
        np.testing.assert_allclose(slope, differences, rtol=rtol, atol=atol)

    return require


STUDIES = Path(__file__).parents[1] / "studies"


@pytest.fixture(scope="session")
def study_of():
    """Import modules of a study with its folder on the path, as where it runs."""

    def names_of_studies():
        files = {name: getattr(module, "__file__", None) for name, module in sys.modules.items()}
        return {name for name, file in files.items() if file and STUDIES in Path(file).parents}

    @contextlib.contextmanager
    def modules(folder, *names):
        path, before = list(sys.path), {name: sys.modules[name] for name in names_of_studies()}
        for file in (STUDIES / folder).glob("*.py"):  # others have modules of the same names
            sys.modules.pop(file.stem, None)
        sys.path.insert(0, str(STUDIES / folder))
        found = {name: importlib.import_module(name) for name in names}
        yield found if len(found) > 1 else found[names[0]]
        sys.path[:] = path
        for name in names_of_studies():
            del sys.modules[name]
        sys.modules.update(before)

    return modules


@pytest.fixture
def rng():
    return np.random.default_rng(20231118)


# Traces are millions of objects that live long: looking for garbage among them, as often as Python
# does, takes a tenth of the suite's time.
gc.set_threshold(50_000, 20, 20)

ROOM = 5e8
"""Memory that traces and compiled programs may fill before they are forgotten [bytes]."""


def resident():
    """Memory of this process [bytes]; zero where the system does not tell."""
    statistics = Path("/proc/self/statm")
    pages = int(statistics.read_text().split()[1]) if statistics.exists() else 0
    return pages * os.sysconf("SC_PAGE_SIZE") if pages else 0


def give_back():
    """Give memory that nothing uses back to the system, where the C library can."""
    library = ctypes.CDLL(None) if sys.platform == "linux" else None
    if hasattr(library, "malloc_trim"):
        library.malloc_trim(0)


@pytest.fixture(scope="session")
def memory():
    """Memory of this process when programs were last forgotten, under ``"before"`` [bytes]."""
    return {"before": resident()}


@pytest.fixture(autouse=True, scope="module")
def room_for_programs(memory):
    """Forget compiled programs before they fill the memory of a worker."""
    yield
    if resident() > memory["before"] + ROOM:
        jax.clear_caches()
        gc.collect()
        give_back()
        memory["before"] = resident()


@pytest.fixture(autouse=True)
def single_precision_elsewhere():
    """lightflyer must never change the precision of the process it runs in."""
    before = jax.config.jax_enable_x64
    yield
    assert jax.config.jax_enable_x64 == before


FLYER_FILE = """\
[flyer]
shape = "disk"
diameter = "2 cm"
payload = "0 mg"

[film]
areal_density = "1.0 g/m^2"
absorptance = 0.75            # for the incoming light
emittance = 0.08              # per face
tac_top = 0.8
tac_bottom = 0.9

[environment]
kind = "earth"
atmosphere = "lu2023"
irradiance = "1360 W/m^2"
incidence = "0 deg"

[force]
model = "lu2023"
reading = "reported"
c_fm = 0.4
c_cont = 3.0
"""


@pytest.fixture
def write(tmp_path):
    """Write a file, after changes of texts that have to be in it; returns its path."""

    def write(content, name="table.csv", *changes):
        for old, new in changes:
            assert old in content
            content = content.replace(old, new, 1)
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture
def flyer_file(write):
    """Write a flyer file, with one text replaced by another; returns its path."""
    return lambda old="", new="", text=FLYER_FILE: write(text, "flyer.toml", (old, new))


FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}


@pytest.fixture(scope="session")
def film_section():
    """The section [film] of :func:`flyer`."""
    return FILM


@pytest.fixture(scope="session")
def flyer():
    """The paper's disk as a flyer file, with the paper's force, which compiles fastest."""
    return lf.FlyerFile(
        flyer={"diameter": "2 cm"},
        film=FILM,
        environment={"atmosphere": "lu2023"},
        force={"model": "lu2023", "force_error": 0},
    )


@pytest.fixture(scope="session")
def design(flyer):
    """The design of that file."""
    return flyer.design()


@pytest.fixture
def run(capsys):
    """Run a command in this process; returns exit code, output and errors, each a line again."""

    def command(*arguments):
        code = 0
        try:
            cli.main([str(argument) for argument in arguments])
        except SystemExit as error:
            code = error.code or 0
        captured = capsys.readouterr()
        for line in captured.err.splitlines():  # only a path may be wider
            assert len(line) <= NARROW or max(map(len, line.split())) > NARROW // 2, line
        return code, captured.out, "".join(f"{line}\n" for line in unwrap(captured.err))

    return command


@pytest.fixture
def prints(run):
    """What a command prints that ends well and says nothing on the error stream."""

    def command(*arguments):
        code, text, errors = run(*arguments)
        assert (code, errors) == (0, "")
        return text

    return command


@pytest.fixture
def refuses(run):
    """The one line in which a command says why it does nothing."""

    def command(*arguments):
        code, text, errors = run(*arguments)
        assert (code, text, errors.count("\n")) == (2, "", 1), errors
        assert errors.startswith("lightflyer: error: ")
        return errors

    return command


# runs calls of functions that the scripts before it define; JSON has no infinity and no NaN
DRIVER = """
{
  const asked = JSON.parse(require("fs").readFileSync(0, "utf8"));
  const plain = (_, value) =>
    typeof value === "number" && !Number.isFinite(value) ? String(value) : value;
  const found = asked.map(([name, ...given]) => eval(name)(...given));
  process.stdout.write(JSON.stringify(found, plain));
}
"""


@pytest.fixture(scope="session")
def node():
    """Path of Node.js, which runs JavaScript without a browser."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("Node.js is not installed: what the calculator computes is not compared")
    return found


@pytest.fixture(scope="session")
def run_javascript(node, tmp_path_factory):
    """A function that makes many calls of a script's functions in one process."""

    def run(script, calls):
        file = tmp_path_factory.mktemp("javascript") / "script.js"
        file.write_text(script + DRIVER, encoding="utf-8")
        given = json.dumps([[name, *arguments] for name, arguments in calls])
        done = subprocess.run(
            [node, str(file)], input=given, capture_output=True, text=True, check=False, timeout=60
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def numbers():
    """A function that makes an array of what JavaScript gave."""
    return lambda found: np.array([float(value) for value in found])
