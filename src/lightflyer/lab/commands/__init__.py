"""Measurements, one a module: ``lab_tac`` has the function ``tac``, for ``lightflyer lab tac``.

The function makes an :class:`~lightflyer.lab.result.Outcome` of files and options. The first
line of the module is what the list of commands says of it.
"""

from pathlib import Path


def measurements() -> dict[str, str]:
    """What each measurement is of, by the name of its command; nothing is imported."""
    modules = sorted(Path(__file__).parent.glob("lab_*.py"))
    return {one.stem[4:]: one.read_text(encoding="utf-8").split('"""')[1] for one in modules}
