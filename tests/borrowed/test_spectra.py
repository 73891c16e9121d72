"""Public reports of readers of spectra and tables: inputs of our own, values by hand."""

import struct
from pathlib import Path

import numpy as np
import pytest

from lightflyer.core.quantity import Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.readers.formats import Source
from lightflyer.lab.readers.interpretation import ReadOptions, interpret_spectrum
from lightflyer.lab.readers.spectrum_data import format_of, read_raw, read_spectrum


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


def jcamp(first, last, count, table):
    found = read("case.dx", HEAD.format(first=first, last=last, count=count, table=table))
    return found.wavenumber / 100.0, 100.0 * found.value


def test_a_check_of_the_last_ordinate_is_no_point():
    """https://github.com/nzhagen/jcamp/pull/37

    Lines of differences repeat the last ordinate. A0 is 10, J5 adds 15, K0 adds 20, H0 is 80.
    """
    table = "##XYDATA=(X++(Y..Y))\n1000A0J5J5K0K0\n1004H0J0j0"
    wavenumber, percent = jcamp(1000, 1006, 7, table)
    assert wavenumber == pytest.approx(np.arange(1000, 1007))
    assert percent == pytest.approx([1.0, 2.5, 4.0, 6.0, 8.0, 9.0, 8.0])


def test_places_follow_from_the_ends_not_from_rounded_lines():
    """https://github.com/nzhagen/jcamp/issues/41: the lines' own places are rounded."""
    table = "##XYDATA=(X++(Y..Y))\n1000 100 200 300\n1010 400 500"
    wavenumber, percent = jcamp(1000, 1013.2, 5, table)
    assert wavenumber == pytest.approx(1000 + 3.3 * np.arange(5))
    assert percent == pytest.approx([10, 20, 30, 40, 50])


def test_repeats_count_the_value_itself():
    """https://github.com/nzhagen/jcamp/pull/36: J0T is twice a difference of 10."""
    _, percent = jcamp(1000, 1002, 3, "##XYDATA=(X++(Y..Y))\n1000A0J0T")
    assert percent == pytest.approx([1.0, 2.0, 3.0])


def test_zeros_in_packed_form():
    """https://github.com/nzhagen/jcamp/issues/13: @ is 0, %T twice a difference of 0."""
    _, percent = jcamp(1000, 1003, 4, "##XYDATA=(X++(Y..Y))\n1000@%TK5")
    assert percent == pytest.approx([0.0, 0.0, 0.0, 2.5])


def test_an_ordinate_without_a_value_is_left_out():
    """https://github.com/nzhagen/jcamp/issues/46"""
    wavenumber, percent = jcamp(1000, 1003, 4, "##XYDATA=(X++(Y..Y))\n1000 100 ? 300 400")
    assert wavenumber == pytest.approx([1000, 1002, 1003])
    assert percent == pytest.approx([10, 30, 40])


def test_pairs_have_factors_too():
    """https://github.com/ComPlat/chem-spectra-app/issues/242"""
    table = "##XYPOINTS=(XY..XY)\n1000, 855; 1003, 745; 1010, 410"
    wavenumber, percent = jcamp(1000, 1010, 3, table)
    assert wavenumber == pytest.approx([1000, 1003, 1010])
    assert percent == pytest.approx([85.5, 74.5, 41.0])


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


def test_each_spectrum_has_abscissae_of_its_own():
    """https://github.com/spectrochempy/spectrochempy/issues/1151"""
    places = [WAVES, WAVES + np.float32(500.0)]
    content = spc(0x04 | 0x40 | 0x80, [SHARES, SHARES / 2], own_x=places)
    found = read("case.spc", content, spectrum="2")
    assert found.wavenumber / 100.0 == pytest.approx(places[1])
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


def test_spectra_share_their_abscissae():
    """https://github.com/spectrochempy/spectrochempy/pull/1544: the second had none."""
    content = spc(0x04 | 0x80, [SHARES, SHARES / 2], common_x=WAVES)
    found = read("case.spc", content, spectrum="2")
    assert found.wavenumber / 100.0 == pytest.approx(WAVES)
    assert found.value == pytest.approx(SHARES / 2)


@pytest.mark.parametrize("turned", [1, -1])
def test_an_order_of_wavenumbers_does_not_matter(tmp_path, turned):
    """https://github.com/spectrochempy/spectrochempy/issues/858: values stood the other way."""
    rows = [f"{x:.1f},{100 * y:.3f}" for x, y in zip(WAVES, SHARES, strict=True)][::turned]
    path = tmp_path / "case.csv"
    path.write_text("wavenumber [cm^-1],T [%]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    found = read_spectrum(path)
    order = np.argsort(found.wavenumber)
    assert found.wavenumber[order] / 100.0 == pytest.approx(WAVES)
    assert found.value[order] == pytest.approx(SHARES)


CURRENT = (Column("current", Quantity("A"), required=True), Column("time", Quantity("s")))


def currents(folder, text):
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8")
    return read_table(path, CURRENT).numbers["current"]


def test_points_between_thousands_beside_decimal_commas(tmp_path):
    """https://github.com/pandas-dev/pandas/issues/59299"""
    found = currents(tmp_path, "name;current [A]\na;1,20\nb;22,3\nc;1.234,56\n")
    assert found == pytest.approx([1.2, 22.3, 1234.56])


def test_thousands_are_told_by_the_file_not_by_its_first_rows(tmp_path):
    """https://github.com/pola-rs/polars/issues/18797"""
    found = currents(tmp_path, "name;current [A]\na;1.299,99\nb;1.299,5\nc;12,25\n")
    assert found == pytest.approx([1299.99, 1299.5, 12.25])


def test_three_decimals_are_no_thousands(tmp_path):
    """https://github.com/Rello/analytics/issues/357: 0.673 became 673."""
    found = currents(tmp_path, "time [s],current [A]\n1,0.619\n2,0.673\n3,0.62\n4,0.598\n")
    assert found == pytest.approx([0.619, 0.673, 0.62, 0.598])


def test_decimal_commas_are_not_cut(tmp_path):
    """https://github.com/umap-project/umap/issues/44"""
    found = currents(tmp_path, "time [s];current [A]\n1;48,85\n2;2,35\n")
    assert found == pytest.approx([48.85, 2.35])


def test_a_point_between_thousands_is_no_decimal_point(tmp_path):
    """https://github.com/deadlocker8/BudgetMaster/issues/731: 1.355,90 became 1.35."""
    found = currents(tmp_path, "name;current [A]\na;1.355,90\nb;12,10\n")
    assert found == pytest.approx([1355.9, 12.1])
