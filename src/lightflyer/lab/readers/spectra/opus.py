"""Bruker OPUS, parsed by brukeropus (MIT): results of a measurement among its raw channels."""

import struct
import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from lightflyer.core.extras import extra
from lightflyer.lab.readers.formats import (
    MOST_POINTS,
    RawSpectrum,
    Source,
    SpectrumMetadata,
    one_line,
)

FORMAT = "Bruker OPUS"

MAGIC = b"\n\n\xfe\xfe"
_KINDS = {"t": "transmittance", "a": "absorbance", "r": "reflectance", "km": "Kubelka-Munk",
          "atr": "ATR", "e": "emission", "ra": "Raman intensity", "pas": "photoacoustic signal",
          "sm": "single channel", "rf": "single channel of the reference",
          "igsm": "interferogram", "igrf": "interferogram"}  # fmt: skip
_ABSCISSAE = {"WN": "cm-1", "MI": "um"}
_ROUNDED = 1e-5  # by which the stated extremes may differ from the data, of the largest
_END = b"END"
_PARAMETER = 8  # bytes before a parameter's value


def read_opus(source: Source) -> list[RawSpectrum]:
    """Read all spectra of an OPUS file."""
    with warnings.catch_warnings():  # of Python 3.12 about escapes in its docstrings
        warnings.simplefilter("ignore", SyntaxWarning)
        extra("brukeropus.file", "reading Bruker OPUS files", "lab")
    from brukeropus.file.block import pair_data_and_status_blocks

    blocks = _blocks(source)
    said: dict[str, Any] = {}
    for block in blocks:
        if block.is_sm_param() and isinstance(block.data, dict):
            said.update(block.data)
    metadata = SpectrumMetadata(
        FORMAT,
        instrument=one_line(str(said.get("ins", ""))),
        resolution=f"{said['res']:g} cm-1" if isinstance(said.get("res"), float) else "",
        accessory=one_line(str(said.get("acc", ""))),
        sample=one_line(str(said.get("snm", ""))),
    )
    pairs = pair_data_and_status_blocks(blocks)
    found = [
        _spectrum(source, data, status.data, metadata)
        for data, status in sorted(pairs, key=lambda pair: pair[0].start)
        if data.is_data() and data.get_data_key().rstrip("_2345678") in _KINDS
    ]
    if not found:
        source.refuse("holds no spectrum; a series of spectra must be exported one by one")
    return found


def _blocks(source: Source) -> list[Any]:
    """Blocks of the file; none that the parser would run through without end."""
    from brukeropus.file.block import FileBlock
    from brukeropus.file.parse import parse_directory, parse_header

    data = source.content
    _, start, most, _ = parse_header(data)
    size = 12 * most  # type, size and place of each block
    if not 0 < start < len(data) or not 0 < size <= len(data):
        source.refuse("is damaged: its directory is outside the file")
    listed = data[start : start + size]
    blocks = []
    for kind, length, place in parse_directory(listed[: len(listed) // 12 * 12]):
        if length < 0 or place + length > len(data):
            source.refuse(f"is damaged: a block of {length} bytes does not fit into it")
        block = FileBlock(filebytes=data, block_type=kind, size=length, start=place)
        if block.is_data() or (block.is_param() and _ends(block.bytes)):
            block.parse()
        if block.data is not None and not block.parse_error:
            blocks.append(block)
    return blocks


def _ends(parameters: bytes) -> bool:
    """Whether a list of parameters ends: a negative size would lead back."""
    at = 0
    while at + _PARAMETER <= len(parameters) and parameters[at : at + 3] != _END:
        (size,) = struct.unpack_from("<h", parameters, at + 6)
        if size < 0:
            return False
        at += _PARAMETER + 2 * size
    return True


def _spectrum(
    source: Source, block: Any, said: dict[str, Any], metadata: SpectrumMetadata
) -> RawSpectrum:
    for key in ("npt", "fxv", "lxv"):
        if not isinstance(said.get(key), int | float):
            source.refuse(f"is damaged: a spectrum has no {key.upper()}")
    count = said["npt"]
    # blocks may be longer than their spectrum
    values = block.data[-count:] if block.is_compact_data() else block.data[:count]
    if not 2 <= count <= MOST_POINTS or len(values) != count:
        source.refuse(f"is damaged: it names {count} points and holds {len(values)}")
    with np.errstate(all="ignore"):
        y = values.astype(float) * said.get("csf", 1.0)
    name = _KINDS[block.get_data_key().rstrip("_2345678")]
    for key, value in (("mny", y.min()), ("mxy", y.max())):
        stated = None if "interferogram" in name else said.get(key)
        if isinstance(stated, float) and not abs(stated - value) <= _ROUNDED * np.abs(y).max():
            source.refuse(
                f"is damaged: it says {key.upper()} {stated:g} of {name}, the data {value:g}"
            )
    words = " ".join(str(said[key]) for key in ("dat", "tim") if key in said)
    return RawSpectrum(
        np.linspace(said["fxv"], said["lxv"], count), y,
        _ABSCISSAE.get(str(said.get("dxu")), str(said.get("dxu"))), name,
        replace(metadata, measured=one_line(words)),
        percent=False if name in ("transmittance", "reflectance") else None,
    )  # fmt: skip
