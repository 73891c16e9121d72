"""``lightflyer doctor``: what is installed, and what is missing."""

import importlib.metadata
import os
import platform
import sys
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from rich.table import Table

import lightflyer
from lightflyer.array.namespace import has_jax, load_jax
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer
from lightflyer.core.cache import SETTING, cache_folder, open_to_others
from lightflyer.core.extras import load_plugins, plugins

_MEGABYTE = 1e6
_EVERY_EXTRA = "all"  # names the others


def doctor_command(*, json_output: Json = False) -> None:
    """Say which extras, devices, libraries, plug-ins and caches are there.

    Send its output with a report of a fault.

    Parameters
    ----------
    json_output
        Print one JSON object instead of tables.
    """
    import numpy as np

    blas = np.show_config(mode="dicts")["Build Dependencies"]["blas"]
    devices = load_jax().devices() if has_jax() else []
    load_plugins()
    extras = importlib.metadata.metadata("lightflyer").get_all("Provides-Extra") or []
    found: dict[str, Any] = {
        "lightflyer": lightflyer.__version__,
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "cores": os.cpu_count(),
        "jax": load_jax().__version__ if has_jax() else None,
        "devices": [f"{device.device_kind} ({device.platform})" for device in devices],
        "numpy": np.__version__,
        "blas": f"{blas['name']} {blas['version']}",
        "requirements": _requirements(None),
        "extras": {name: _requirements(name) for name in sorted({*extras} - {_EVERY_EXTRA})},
        "plug_ins": [f"{entry.name} ({entry.value})" for entry in plugins()],
        "compiled_code": _cache(),
    }
    if json_output:
        print_json(found)
        return
    console = printer()
    table = Table(show_header=False, box=None)
    rows = {
        "lightflyer": f"{found['lightflyer']} in {Path(lightflyer.__file__).parent}",
        "Python": f"{found['python']}, {sys.executable}",
        "system": f"{found['system']}, {found['cores']} cores",
        "JAX": f"{found['jax']} on {', '.join(found['devices'])}"
        if found["jax"]
        else "not installed",
        "NumPy": f"{found['numpy']} with {found['blas']}",
        "plug-ins": ", ".join(found["plug_ins"]) or "none",
        "compiled code": _in_words(found["compiled_code"]),
    }
    for name, text in rows.items():
        table.add_row(name, text)
    console.print(table)
    extras = found["extras"]
    table = Table("extra")
    table.add_column("", no_wrap=True)  # a command to copy
    table.add_column("packages")
    for name, packages in extras.items():
        complete = not any(entry["problem"] for entry in packages)
        state = "ready" if complete else f"pip install 'lightflyer[{name}]'"
        listed = [
            f"{entry['package']} {entry['version'] if not entry['problem'] else entry['problem']}"
            for entry in packages
        ]
        table.add_row(name, state, ", ".join(listed))
    console.print(table)
    lacking = [entry for entry in found["requirements"] if entry["problem"]]
    for entry in lacking:
        console.print(f"{entry['package']}: {entry['problem']}; pip install --upgrade lightflyer")


def _requirements(extra: str | None) -> list[dict[str, Any]]:
    """Packages that the package needs, or one of its extras, and what is wrong with each."""
    found = []
    for need in map(Requirement, importlib.metadata.requires("lightflyer") or []):
        always = need.marker is None or need.marker.evaluate({"extra": ""})
        of_extra = need.marker is not None and need.marker.evaluate({"extra": extra or ""})
        if not (always if extra is None else of_extra and not always):
            continue
        version: str | None = None
        problem: str | None = "missing"
        try:
            version = importlib.metadata.version(need.name)
        except importlib.metadata.PackageNotFoundError:
            pass
        else:
            fits = need.specifier.contains(version, prereleases=True)
            problem = None if fits else f"is {version}, but {need.specifier} is needed"
        found.append({"package": need.name, "version": version, "problem": problem})
    return found


def _cache() -> dict[str, Any]:
    """Where the code of Numba and XLA is kept, and how much."""
    folder = cache_folder()
    if folder is None:
        return {"folder": None, "writable": False, "open_to_others": None, "files": 0, "bytes": 0}
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    above = next(path for path in (folder, *folder.parents) if path.exists())
    writable = os.access(above, os.W_OK)
    found = open_to_others(folder.resolve()) if folder.exists() else None
    return {
        "folder": str(folder),
        "writable": writable,
        "open_to_others": found and str(found),
        "files": len(sizes),
        "bytes": sum(sizes),
    }


def _in_words(cache: dict[str, Any]) -> str:
    if cache["folder"] is None:
        return f"not kept: {SETTING} says so"
    if cache["open_to_others"]:
        return (
            f"not kept: others may write into {cache['open_to_others']}; chmod go-w makes it "
            f"yours, or {SETTING}=FOLDER names another"
        )
    if not cache["writable"]:
        return f"not kept: {cache['folder']} cannot be written; {SETTING}=FOLDER names another"
    size = cache["bytes"] / _MEGABYTE
    return f"{cache['files']} files, {size:.0f} MB in {cache['folder']}"
