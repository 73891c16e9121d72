"""Compiled programs, kept from one command to the next.

Most of a prediction's time is compiling. JAX keeps what it compiled in a folder where one is
named, under a key that contains the program, the compiler's version and its settings: an upgrade
finds nothing of the old version's, and the least used is removed first. Code for one processor
may not run on another, so each has a folder of its own, for home directories that several
machines share.
"""

import hashlib
import os
import platform
import shutil
import sys
import time
from collections.abc import Sequence
from pathlib import Path

SETTING = "LIGHTFLYER_CACHE"
"""Environment variable: ``off``, or the folder to keep compiled programs in."""

_LARGEST = 500_000_000  # bytes
_COMPILES_NOTHING = {
    *("init", "materials", "doctor"),
    *("--help", "-h", "--version", "--install-completion"),
}
_OF_JAX = ("JAX_COMPILATION_CACHE_DIR", "JAX_ENABLE_COMPILATION_CACHE")
_OF_NUMBA = "NUMBA_CACHE_DIR"
_KERNELS = "kinetic"  # room of what Numba compiles
_KEPT_UNUSED = 30 * 86_400.0  # seconds


def compiled_folder() -> Path | None:
    """Folder for the compiled programs of this processor.

    Returns
    -------
    Path or None
        It need not exist yet; None where the user wants none, or names one of JAX's own.
    """
    setting = os.environ.get(SETTING, "")
    if setting.lower() == "off" or os.environ.keys() & set(_OF_JAX):
        return None
    import platformdirs

    return Path(setting or platformdirs.user_cache_dir("lightflyer")) / _processor()


def keep_compiled(arguments: Sequence[str]) -> None:
    """Have JAX and Numba keep compiled programs; to be called before they are loaded.

    Nothing is kept where the folder cannot be made or written. What the environment says for JAX
    or Numba itself (``JAX_COMPILATION_CACHE_DIR``, ``NUMBA_CACHE_DIR``) takes precedence.

    Parameters
    ----------
    arguments : sequence of str
        Of the command line.
    """
    if not arguments or _COMPILES_NOTHING & set(arguments):
        return
    folder = compiled_folder()
    if folder is None:
        return
    is_new = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return
    if not os.access(folder, os.W_OK):
        return
    os.environ |= {
        "JAX_COMPILATION_CACHE_DIR": str(folder),
        "JAX_COMPILATION_CACHE_MAX_SIZE": str(_LARGEST),
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    os.environ.setdefault(_OF_NUMBA, str(_for_numba(folder / "numba")))
    if is_new:
        print(  # noqa: T201
            f"lightflyer: compiled programs are kept in {folder.parent}, so that the next command "
            f"starts faster; {SETTING}=off keeps none",
            file=sys.stderr,
        )


def _for_numba(folder: Path) -> Path:
    """Folder for the kernels as they are now, since Numba sees changes of their own files only."""
    sources = sorted((Path(__file__).parents[1] / _KERNELS).glob("*.py"))
    state = repr([(source.name, source.stat().st_mtime_ns) for source in sources])
    chosen = folder / hashlib.sha256(state.encode()).hexdigest()[:12]
    if not chosen.exists():
        for other in folder.glob("*"):
            if time.time() - other.stat().st_mtime > _KEPT_UNUSED:
                shutil.rmtree(other, ignore_errors=True)
    return chosen


def _processor() -> str:
    """Name of a folder for this kind of processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        known = sorted({line for line in lines if line.startswith(("model name", "flags"))})
    except OSError:
        known = [platform.machine(), platform.processor()]
    return hashlib.sha256("\n".join(known).encode()).hexdigest()[:12]
