"""Where Numba and XLA keep what they compiled from one command to the next.

That is machine code: it lies in a folder that belongs to this user alone, one for each kind of
processor, since home directories may be shared by several machines. Numba sees changes of a
kernel's own file only, so the kernels as they are now have a folder of their own. Each command
notes the hashes of what it leaves, and the next one removes what is not as noted.
"""

import atexit
import hashlib
import json
import os
import platform
import shutil
import time
from contextlib import suppress
from pathlib import Path

from lightflyer.core.cache import PRIVATE, cache_folder, open_to_others, refused

_OF_NUMBA, _OF_JAX = "NUMBA_CACHE_DIR", "JAX_COMPILATION_CACHE_DIR"
_PARTS = {_OF_NUMBA: "numba", _OF_JAX: "xla"}
_LARGEST = 100_000_000  # bytes of XLA's; the least used go first
_KERNELS = "kinetic_theory"  # room of what Numba compiles
_KEPT_UNUSED = 30 * 86_400.0  # seconds
_HASHES = "hashes.json"
_CODE = ("-cache", ".nbi", ".nbc")  # what names of files of code end with


def keep_code() -> None:
    """Have Numba and XLA keep their code; to be called before they are loaded."""
    # Nothing is kept where the folder cannot be made or is not this user's alone. What the
    # environment says for Numba or JAX itself takes precedence.
    root = cache_folder()
    if root is None:
        return
    # links followed: what they name may change once it was looked at
    folders = {name: (root / part).resolve() for name, part in _PARTS.items()}
    try:
        for folder in folders.values():
            folder.mkdir(parents=True, exist_ok=True, mode=PRIVATE)
        if any(map(open_to_others, folders.values())):
            refused.append(root)
            return
        for folder in folders.values():
            remove_strange(folder)
            atexit.register(note_hashes, folder)
    except OSError:
        refused.append(root)
        return
    os.environ.setdefault(_OF_NUMBA, str(_for_kernels(folders[_OF_NUMBA])))
    if _OF_JAX not in os.environ:
        os.environ[_OF_JAX] = str(
            folders[_OF_JAX] / hashlib.sha256(_processor().encode()).hexdigest()[:12]
        )
        os.environ["JAX_COMPILATION_CACHE_MAX_SIZE"] = str(_LARGEST)
        os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.5"
        os.environ["JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES"] = "-1"


def remove_strange(folder: Path) -> None:
    """Remove code that is not as an earlier command left it: damaged, or from elsewhere."""
    try:
        noted = json.loads((folder / _HASHES).read_bytes())
    except (OSError, ValueError):
        noted = {}
    for name, found in _hashes(folder).items():
        if noted.get(name) != found:
            (folder / name).unlink(missing_ok=True)


def note_hashes(folder: Path) -> None:
    """Write down what the code in a folder is."""
    with suppress(OSError):
        stage = folder / f"{_HASHES}.{os.getpid()}"
        stage.write_text(json.dumps(_hashes(folder)), encoding="utf-8")
        stage.replace(folder / _HASHES)


def _hashes(folder: Path) -> dict[str, str]:
    """SHA-256 of each file of code, by its path in the folder."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.name.endswith(_CODE)
    }


def _for_kernels(folder: Path) -> Path:
    sources = sorted((Path(__file__).parents[1] / _KERNELS).rglob("*.py"))
    state = repr([(source.name, source.stat().st_mtime_ns) for source in sources]) + _processor()
    chosen = folder / hashlib.sha256(state.encode()).hexdigest()[:12]
    if not chosen.exists():
        for other in folder.glob("*"):
            if time.time() - other.stat().st_mtime > _KEPT_UNUSED:
                shutil.rmtree(other, ignore_errors=True)
    return chosen


def _processor() -> str:
    """What tells this kind of processor from others."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        known = sorted({line for line in lines if line.startswith(("model name", "flags"))})
    except OSError:
        known = [platform.machine(), platform.processor()]
    return "\n".join(known)
