"""Text export of JASCO's Spectra Manager: header, ``XYDATA``, and what was set below it.

The layout is that of files of FT/IR-4600 and V-730 instruments in JASCOFiles.jl (MIT). The ordinate
of transmittance and reflectance is per cent, whatever the header's ``YUNITS`` calls it.
"""

import re

import numpy as np

from lightflyer.lab.readers.formats import Source, one_line
from lightflyer.lab.readers.spectra.raw import RawSpectrum, SpectrumMetadata

FORMAT = "JASCO text"

_START = re.compile(r"\s*TITLE\s*[\t,;]", re.I)
_TABLE = re.compile(r"^XYDATA[\t,; ]*\r?$", re.I | re.M)
_KEYS = {
    "instrument": ("SPECTROMETER/DATA SYSTEM", "Model Name", "Model name", "機種名"),
    "resolution": ("Resolution", "RESOLUTION", "分解", "UV/Vis bandwidth", "UV/Vis バンド幅"),
    "accessory": ("Accessory name", "Accessory", "付属品名"),
    "sample": ("TITLE", "Sample name", "試料名"),
    "measured": ("Measurement Date", "Measurement date", "測定日時", "DATE"),
}
_ORDINATES = ("Vertical axis", "縦軸", "Photometric mode", "測光モード")
_ROUNDED = 1e-3  # by which an extreme value of the header may differ from the data, of the largest
_PER_CENT = {"transmittance", "reflectance", "%t", "%r"}


def is_jasco_text(source: Source) -> bool:
    """Whether a file is a text export of JASCO."""
    text = source.text[:20_000]
    return bool(_START.match(text)) and bool(_TABLE.search(source.text))


def read_jasco_text(source: Source) -> list[RawSpectrum]:
    """Read the spectrum of a text export; one."""
    lines = source.text.splitlines()
    start = next(at for at, line in enumerate(lines) if _TABLE.match(line))
    header = _labels(lines[:start])
    count = _declaration(source, header)
    x, y, end = _rows(source, lines, start + 1, count)
    if count is not None and len(x) != count:
        source.refuse(f"has {len(x)} points; its header says NPOINTS {count}", end)
    said = header | {key: one for key, one in _labels(lines[end:]).items() if key not in header}
    _require_ends(source, header, x)
    kind = header.get("DATA TYPE", "")
    if "RAMAN" in kind.upper():
        source.refuse(f'is of "{one_line(kind)[:40]}", not transmittance or reflectance')
    named = header.get("YUNITS", "")
    ordinate = next((said[key] for key in _ORDINATES if said.get(key)), named)
    return [
        RawSpectrum(
            x, y, header.get("XUNITS", ""),
            # the axis tells %T from a bare "TRANSMITTANCE", but can be in any language
            ordinate if named.casefold() in _PER_CENT and "%" in ordinate else named,
            SpectrumMetadata(FORMAT, **{name: _first(said, keys) for name, keys in _KEYS.items()}),
            percent=True if named.casefold() in _PER_CENT else None,
            notes=tuple(_extremes(header, y)),
        )
    ]  # fmt: skip


def _labels(lines: list[str]) -> dict[str, str]:
    """Words by their keys; the first of equal keys."""
    found: dict[str, str] = {}
    for line in lines:
        parts = re.split(r"[\t,;]", line, maxsplit=1)
        key = parts[0].strip()
        if len(parts) == 2 and key:
            found.setdefault(key, parts[1].strip())
    return found


def _first(said: dict[str, str], keys: tuple[str, ...]) -> str:
    return one_line(next((said[key] for key in keys if said.get(key)), ""))[:80]


def _declaration(source: Source, header: dict[str, str]) -> int | None:
    text = header.get("NPOINTS")
    if text is None:
        return None
    if not (text.isascii() and text.isdigit()):
        source.refuse(f'NPOINTS "{text[:20]}" is not a number of points')
    return int(text[:12])


def _rows(
    source: Source, lines: list[str], first: int, count: int | None
) -> tuple[np.ndarray, np.ndarray, int]:
    """Pairs up to a blank line or the declared number, and the index of the line behind them."""
    pairs: list[tuple[float, float]] = []
    at = first
    for at in range(first, len(lines) + 1):
        if at == len(lines) or not lines[at].strip() or len(pairs) == count:
            break
        pairs.append(_pair(source, lines[at], at + 1))
    x, y = np.array(pairs, float).reshape(-1, 2).T
    return x, y, at


def _pair(source: Source, line: str, number: int) -> tuple[float, float]:
    mark = next((one for one in ("\t", ";", ",") if one in line), None)
    cells = [one.strip() for one in line.split(mark)]
    if mark != ",":
        cells = [one.replace(",", ".") for one in cells]
    if len(cells) != 2:
        source.refuse(
            f"has {len(cells)} columns; a spectrum has two" if len(cells) > 2
            else f'"{line.strip()[:40]}" is not a pair of numbers', number
        )  # fmt: skip
    try:
        return float(cells[0]), float(cells[1])
    except ValueError:
        source.refuse(f'"{line.strip()[:40]}" is not a pair of numbers', number)


def _number(header: dict[str, str], key: str) -> float | None:
    try:
        return float(header.get(key, "").replace(",", "."))
    except ValueError:
        return None


def _require_ends(source: Source, header: dict[str, str], x: np.ndarray) -> None:
    """The header's first and last abscissa are those of the data, to one step."""
    if len(x) < 2:
        source.refuse(f"has {len(x)} points; a spectrum needs two or more")
    step = float(np.abs(np.diff(x)).max())
    for key, value in (("FIRSTX", x[0]), ("LASTX", x[-1])):
        said = _number(header, key)
        if said is not None and not abs(said - value) <= step:
            source.refuse(f"is damaged: its header says {key} {said:g}, the data {value:g}")


def _extremes(header: dict[str, str], y: np.ndarray) -> list[str]:
    """Notes where the header's extreme values are not those of the data."""
    found = []
    for key, value in (("FIRSTY", y[0]), ("MAXY", y.max()), ("MINY", y.min())):
        said = _number(header, key)
        if said is not None and not abs(said - value) <= _ROUNDED * np.abs(y).max():
            found.append(f"its header says {key} {said:g}, the data {value:g}: was it edited?")
    return found
