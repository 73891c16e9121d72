"""Public reports of readers of spectra and tables: inputs of our own, values by hand.

`lab/test_spectra.py` has the cases of https://github.com/nzhagen/jcamp/pull/36 and issues/46, and
of https://github.com/spectrochempy/spectrochempy/issues/858.
"""

import struct
from pathlib import Path

import numpy as np
import pytest

from lightflyer.core.quantity import Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.readers.formats import Source
from lightflyer.lab.readers.interpretation import ReadOptions, interpret_spectrum
from lightflyer.lab.readers.spectrum_data import format_of, read_raw


def read(name, content, **wanted):
    source = Source(Path(name), content if isinstance(content, bytes) else content.encode())
    wants = ReadOptions(**wanted)
    kind = format_of(source)
    assert kind is not None
    return interpret_spectrum(source, read_raw(source, kind, wants), wants)


HEAD = """\
##TITLE=case
##JCAMP-DX=4.24
##DATA TYPE=INFRARED SPECTRUM
##XUNITS=1/CM
##YUNITS=%T
##XFACTOR=1
##YFACTOR=0.1
##FIRSTX={first}
##LASTX={last}
##NPOINTS={count}
{table}
##END=
"""


LINES, PAIRS = "##XYDATA=(X++(Y..Y))\n", "##XYPOINTS=(XY..XY)\n"


@pytest.mark.parametrize(
    ("table", "last", "count", "places", "percent"),
    [
        # https://github.com/nzhagen/jcamp/pull/37: lines of differences repeat the last ordinate,
        # which is no point. A0 is 10, J5 adds 15, K0 adds 20, H0 is 80
        (
            LINES + "1000A0J5J5K0K0\n1004H0J0j0",
            1006,
            7,
            np.arange(1000, 1007),
            [10, 25, 40, 60, 80, 90, 80],
        ),
        # https://github.com/nzhagen/jcamp/issues/41: the lines' own places are rounded
        (
            LINES + "1000 100 200 300\n1010 400 500",
            1013.2,
            5,
            1000 + 3.3 * np.arange(5),
            [100, 200, 300, 400, 500],
        ),
        # https://github.com/nzhagen/jcamp/issues/13: @ is 0, %T twice a difference of 0
        (LINES + "1000@%TK5", 1003, 4, [1000, 1001, 1002, 1003], [0, 0, 0, 25]),
        # https://github.com/ComPlat/chem-spectra-app/issues/242: pairs have factors too
        (PAIRS + "1000, 855; 1003, 745; 1010, 410", 1010, 3, [1000, 1003, 1010], [855, 745, 410]),
    ],
)
def test_ordinates_of_jcamp(table, last, count, places, percent):
    found = read("case.dx", HEAD.format(first=1000, last=last, count=count, table=table))
    assert found.wavenumber / 100.0 == pytest.approx(np.asarray(places))
    assert 1e3 * found.value == pytest.approx(np.asarray(percent))  # YFACTOR=0.1


WAVES = np.array([1000.0, 1010.0, 1030.0, 1035.0], "<f4")
SHARES = np.array([0.5, 0.25, 0.125, 0.75], "<f4")


def spc(flags, curves, exponent=-128, of_curve=-128, own_x=(), common_x=None):
    """SPC.H: 512 bytes, then for each spectrum 32 bytes, its own abscissae and its values."""
    head = struct.pack(
        "<BBBbIddIBBB", flags, 0x4B, 4, exponent, len(WAVES), WAVES[0], WAVES[-1], len(curves),
        1, 128, 0,
    ).ljust(512, b"\0")  # fmt: skip
    out = head + (b"" if common_x is None else common_x.tobytes())
    for number, one in enumerate(curves):
        below = struct.pack("<BbHfffII", 0, of_curve, number, 0.0, 0.0, 0.0, len(one), 0)
        out += below.ljust(32, b"\0")
        out += own_x[number].tobytes() if own_x else b""
        out += one.tobytes()
    return out


def test_floats_whose_spectrum_states_no_exponent():
    """https://github.com/rohanisaac/spc/issues/10: the exponent is that of the file."""
    found = read("case.spc", spc(0, [SHARES], of_curve=0))
    assert found.value == pytest.approx(SHARES)


@pytest.mark.parametrize(
    ("flags", "places"),
    [
        # https://github.com/spectrochempy/spectrochempy/issues/1151: abscissae of its own
        (0x04 | 0x40 | 0x80, {"own_x": [WAVES, WAVES + np.float32(500.0)]}),
        # https://github.com/spectrochempy/spectrochempy/pull/1544: shared; the second had none
        (0x04 | 0x80, {"common_x": WAVES}),
    ],
)
def test_a_second_spectrum_has_its_abscissae(flags, places):
    found = read("case.spc", spc(flags, [SHARES, SHARES / 2], **places), spectrum="2")
    assert found.wavenumber / 100.0 == pytest.approx(WAVES + (500.0 if "own_x" in places else 0.0))
    assert found.value == pytest.approx(SHARES / 2)


@pytest.mark.parametrize(("bits", "flag"), [(32, 0x00), (16, 0x01)])
def test_abscissae_have_no_exponent(bits, flag):
    """https://github.com/rohanisaac/spc/pull/2: the exponent is that of the values.

    Values of so many bits are whole numbers over 2^bits, times 2 to the exponent, here 3.
    """
    whole = (SHARES / 8.0 * 2.0**bits).astype(f"<i{bits // 8}")
    content = spc(0x80 | flag, [whole], exponent=3, of_curve=3, common_x=WAVES)
    found = read("case.spc", content)
    assert found.wavenumber / 100.0 == pytest.approx(WAVES)
    assert found.value == pytest.approx(SHARES, rel=1e-3 if flag else 1e-6)


CURRENT = (Column("current", Quantity("A"), required=True), Column("time", Quantity("s")))


@pytest.mark.parametrize(
    ("text", "amperes"),
    [
        # https://github.com/pandas-dev/pandas/issues/59299
        ("name;current [A]\na;1,20\nb;22,3\nc;1.234,56\n", [1.2, 22.3, 1234.56]),
        # https://github.com/pola-rs/polars/issues/18797: by the file, not by its first rows
        ("name;current [A]\na;1.299,99\nb;1.299,5\nc;12,25\n", [1299.99, 1299.5, 12.25]),
        # https://github.com/Rello/analytics/issues/357: 0.673 became 673
        ("time [s],current [A]\n1,0.619\n2,0.673\n3,0.62\n4,0.598\n", [0.619, 0.673, 0.62, 0.598]),
        # https://github.com/umap-project/umap/issues/44
        ("time [s];current [A]\n1;48,85\n2;2,35\n", [48.85, 2.35]),
        # https://github.com/deadlocker8/BudgetMaster/issues/731: 1.355,90 became 1.35
        ("name;current [A]\na;1.355,90\nb;12,10\n", [1355.9, 12.1]),
    ],
)
def test_marks_of_decimals_and_thousands(write, text, amperes):
    assert read_table(write(text), CURRENT).numbers["current"] == pytest.approx(amperes)
