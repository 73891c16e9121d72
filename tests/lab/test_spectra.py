"""Spectra from files of instruments: samples, and files built from the formats' descriptions."""

import contextlib
import io
import struct
import sys
from functools import partial
from pathlib import Path

import jcamp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.lab.ftir.reduction import reduce_ftir, to_dataset
from lightflyer.lab.readers import jcamp_dx, vendors
from lightflyer.lab.readers.formats import Source, read_source
from lightflyer.lab.readers.interpretation import (
    Axis,
    OrdinateUnit,
    ReadOptions,
    axis_of,
    interpret_spectrum,
    parse_ordinate,
)
from lightflyer.lab.readers.jcamp_dx import last_digit, read_rows
from lightflyer.lab.readers.spectrum_data import format_of, read_raw, read_spectrum

from .damage import read_damaged

SAMPLES = Path(__file__).parent / "spectra"
DAMAGES = 200


def read(name, content, **wanted):
    """Read a file that is not written."""
    source = Source(Path(name), content if isinstance(content, bytes) else content.encode())
    wants = ReadOptions(**wanted)
    kind = format_of(source)
    assert kind is not None
    return interpret_spectrum(source, read_raw(source, kind, wants), wants)


def fault(name, content, **wanted):
    with pytest.raises(lf.ConfigurationError) as error:
        read(name, content, **wanted)
    said = str(error.value)
    assert said.startswith(name)
    assert said.isprintable()
    return said


# ---- samples: values from the instruments' own text exports, or from other readers

SHOWN = {
    # the text export of the same spectrum, which ends in 100 %T marks
    "jasco-ftir.jws": ("transmittance", {499.4729: 0.0773327, 501.4014: 0.0825554,
                                         7800.6484: 16.7783}),
    "jasco-v730.txt": ("transmittance", {1e7 / 700: 100 * 10**6.38777e-05,
                                         1e7 / 410: 100 * 10**-0.000211082}),
    # of the authors of the sample, from their own reader
    "perkin-elmer-t.sp": ("transmittance", {1e7 / 800: 50.6031197021558,
                                            1e7 / 847: 46.2502613463013,
                                            1e7 / 900: 41.2719070950721}),
    "perkin-elmer-r.sp": ("reflectance", {1e7 / 350: 15.5291831315929,
                                          1e7 / 397: 40.2625136334783,
                                          1e7 / 850: 52.6907223745948}),
}  # fmt: skip


@pytest.mark.parametrize("name", SHOWN)
def test_samples_have_the_values_of_other_readers(name):
    quantity, values = SHOWN[name]
    found = read_spectrum(SAMPLES / name)
    assert found.quantity == quantity
    for per_cm, percent in values.items():
        at = np.argmin(np.abs(found.wavenumber - 100.0 * per_cm))
        assert found.wavenumber[at] == pytest.approx(100.0 * per_cm, rel=2e-7)
        assert found.value[at] == pytest.approx(percent / 100.0, rel=1e-5)


def test_samples_tell_their_facts():
    metadata = {name: read_spectrum(SAMPLES / name).metadata for name in SHOWN}
    assert metadata["jasco-ftir.jws"].instrument == "FT/IR-4600typeA"
    assert metadata["jasco-ftir.jws"].resolution == "4 cm-1"
    text = metadata["jasco-v730.txt"]
    assert (text.format, text.ordinate, text.resolution, text.accessory) == (
        "JASCO text", "ABSORBANCE", "1.0 nm", "USE-753"
    )  # fmt: skip
    assert metadata["perkin-elmer-t.sp"].sample.startswith("BEV68 NG11")
    assert metadata["perkin-elmer-r.sp"].instrument == "Lambda 1050+"
    assert read_spectrum(SAMPLES / "perkin-elmer-r.sp").collection == "total"  # 150 mm sphere
    assert read_spectrum(SAMPLES / "opus.0").metadata.resolution == "4 cm-1"


def test_points_that_jasco_marks_as_empty_are_left_out():
    found = read_spectrum(SAMPLES / "jasco-ftir.jws")
    assert len(found.wavenumber) == 7573 - 460
    assert found.notes == (
        "460 points without a value, between 516.829 and 3600.45 1/CM, are left out",
    )
    assert not np.any(np.abs(found.wavenumber - 90059.41) < 1.0)  # -1.17549E-038 in the export


def test_opus_absorbance_is_that_of_its_single_beams():
    beams = {one.ordinate_name: one for one in vendors.read_opus(read_source(SAMPLES / "opus.0"))}
    ratio = beams["single channel"].ordinate / beams["single channel of the reference"].ordinate
    found = read_spectrum(SAMPLES / "opus.0")  # the only result among three spectra
    np.testing.assert_allclose(found.value, ratio[::-1], rtol=3e-7)
    np.testing.assert_allclose(found.wavenumber[[0, -1]], [39927.189168, 399657.661624], rtol=1e-9)


def test_raw_values_of_omnic_and_grams():
    """As spectrochempy-omnic 0.2.1 and spc-io 0.2.1 read them."""
    (one,) = vendors.read_omnic(read_source(SAMPLES / "omnic.spa"))
    np.testing.assert_array_equal(
        one.ordinate[[0, 1000, 3631]],
        [0.017102178186178207, 0.8031986951828003, 0.032076966017484665],
    )
    assert one.abscissa[[0, 1, -1]] == pytest.approx([3996.82324219, 3994.89463318, -3005.95605469])
    (two,) = vendors.read_spc(read_source(SAMPLES / "grams.spc"))
    np.testing.assert_array_equal(two.abscissa[[0, 50, 150]], [15590.0, 15585.0, 15575.0])
    np.testing.assert_array_equal(two.ordinate[[0, 50, 150]], [27.0, 30.0, 43.0])


@pytest.mark.parametrize("name", ["difference", "packed", "linked"])
def test_jcamp_against_another_reader(name):
    path = SAMPLES / f"{name}.jdx"
    with contextlib.redirect_stdout(io.StringIO()):
        other = jcamp.readfile(path)
    blocks = other.get("children") or [other]
    ours = jcamp_dx.read_jcamp(read_source(path))
    assert len(ours) == len(blocks)
    for one, block in zip(ours, blocks, strict=True):
        np.testing.assert_allclose(one.abscissa, block["x"], rtol=1e-12)
        np.testing.assert_allclose(one.ordinate, block["y"], rtol=1e-12)


# ---- files built from the descriptions of their formats

WAVES = np.linspace(4000.0, 400.0, 25)
SHARES = 0.4 + 0.3 * np.sin(WAVES / 300.0)
PER_METRE, INCREASING = 100.0 * WAVES[::-1], SHARES[::-1]


def same(found, values=INCREASING, rtol=1e-5):
    np.testing.assert_allclose(found.wavenumber, PER_METRE, rtol=1e-6)
    np.testing.assert_allclose(found.value, values, rtol=rtol)


def spc_file(kind="floats", order="<", x=0, y=128, curves=(SHARES,), own_x=False, labels=b""):
    """SPC.H: header of 512 bytes, then for each spectrum one of 32 bytes and the values."""
    flags = (0x01 if kind == "short" else 0) | (0x04 if len(curves) > 1 else 0)
    flags |= (0x80 if own_x else 0) | (0x20 if labels else 0)
    exponent = -128 if kind == "floats" else 1
    head = struct.pack(
        order + "BBBbIddIBBBBI9s9s", flags, 0x4B if order == "<" else 0x4C, 4, exponent, len(WAVES),
        WAVES[0], WAVES[-1], len(curves), x, y, 0, 0, 0, b"4 cm-1", b"FTS",
    )  # fmt: skip
    head = head.ljust(88, b"\0") + b"a film".ljust(130, b"\0") + labels.ljust(30, b"\0")
    out = head.ljust(512, b"\0")
    if own_x:
        out += WAVES.astype(order + "f4").tobytes()
    bits = {"floats": 0, "short": 16, "long": 32}[kind]
    for number, one in enumerate(curves):
        out += struct.pack(order + "Bb30x", 0, exponent - number if bits else exponent)
        if bits:
            scaled = np.round(one / 2.0 ** (exponent - number - bits))
            out += scaled.astype(f"{order}i{bits // 8}").tobytes()
        else:
            out += one.astype(order + "f4").tobytes()
    return out


def old_spc_file():
    """Version 4Dh: 224 bytes, a header of 32 bytes, integers with exchanged words."""
    head = struct.pack("<BBhfffBB", 0, 0x4D, 1, len(WAVES), WAVES[0], WAVES[-1], 1, 128)
    words = np.round(SHARES / 2.0**-31).astype("<i4").view("<u2").reshape(-1, 2)[:, ::-1]
    return head.ljust(224, b"\0") + bytes(32) + np.ascontiguousarray(words).tobytes()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", ["floats", "short", "long"])
def test_grams_in_every_form_of_numbers(kind, order):
    rtol = 1e-3 if kind == "short" else 1e-6
    same(read("s.spc", spc_file(kind, order, x=1)), rtol=rtol)
    several = spc_file(kind, order, x=1, curves=(SHARES, SHARES / 2))
    assert "holds 2 spectra; choose one" in fault("s.spc", several)
    same(read("s.spc", several, spectrum="2"), INCREASING / 2, rtol=rtol)


def test_grams_of_other_axes():
    same(read("s.spc", old_spc_file()))
    same(read("s.spc", spc_file(x=1, own_x=True)))
    same(read("s.spc", spc_file(x=0, labels=b"Wavenumber (cm-1)\0% T\0"), scale="1"))
    metadata = read("s.spc", spc_file(x=1)).metadata
    assert (metadata.instrument, metadata.resolution, metadata.sample) == (
        "FTS",
        "4 cm-1",
        "a film",
    )
    assert 'abscissa "Raman shift" is not known' in fault("s.spc", spc_file(x=13))
    assert "shows Kubelka-Munk units" in fault("s.spc", spc_file(x=1, y=3))
    assert "shows an interferogram" in fault("s.spc", spc_file(x=1, y=1))


def omnic_file(values=(SHARES,), ordinate=21, unit=1, titles=("film",)):
    """Entries of 16 bytes from byte 304 on: headers (2), values (3) and titles (107)."""
    keys = [key for _ in values for key in (2, 3, 107)]
    at = 304 + 16 * (len(keys) + 1)
    entries, body = b"", b""
    for one, title in zip(values, titles, strict=True):
        head = struct.pack("<4xIB3xB3xff", len(one), unit, ordinate, WAVES[0], WAVES[-1])
        for key, block in ((2, head), (3, one.astype("<f4").tobytes()),
                           (107, title.encode().ljust(256, b"\0"))):  # fmt: skip
            entries += struct.pack("<BxII6x", key, at + len(body), len(block))
            body += block
    start = b"Spectral Data File".ljust(30, b"\0") + b"group".ljust(264, b"\0")
    start += struct.pack("<H8x", len(keys))
    return start + entries + bytes(16) + body


def test_omnic():
    same(read("s.spa", omnic_file()))
    same(read("s.spa", omnic_file((100 * SHARES,), ordinate=16)))
    same(read("s.spa", omnic_file((-np.log10(SHARES),), ordinate=17)), rtol=1e-5)
    group = omnic_file((SHARES, SHARES / 2), titles=("bare", "coated"))
    assert "holds 2 spectra; choose one" in fault("s.spg", group)
    assert "1 reflectance of bare, 2 reflectance of coated" in fault("s.spg", group)
    for wanted in ("2", "coated"):
        same(read("s.spg", group, spectrum=wanted), INCREASING / 2)
    assert 'has 0 spectra "3"; it holds 1 reflectance of bare' in fault(
        "s.spg", group, spectrum="3"
    )
    assert "shows a single beam" in fault("s.spa", omnic_file(ordinate=15))
    assert "share a code" in fault("s.spa", omnic_file(ordinate=12))
    assert "shows Raman intensity" in fault("s.spa", (SAMPLES / "omnic.spa").read_bytes())


def asc_file(ordinate="%T", values=100 * SHARES, count=None, technique="IR"):
    """PEDS 4.00: names in lines 9 and 12, axes behind #GR, pairs behind #DATA."""
    lines = [f"PE {technique}       SUBTECH     SPECTRUM    ASCII       PEDS        4.00", "-1",
             "film.sp", "26/01/31", "12:00:00.00", "", "", "a lab", "a film", "", "",
             "Spectrum Two", "serial", "software", "#HDR", "-1", "-1", "#GR", "cm-1", ordinate,
             "1.0", "0.0", "4000.0", "-150.0", str(count or len(values)), "8", "100.0", "0.0",
             "#DATA"]  # fmt: skip
    rows = [f"{x:.6f}\t{y:.9f}" for x, y in zip(WAVES, values, strict=True)]
    return "\r\n".join([*lines, *rows, ""])


def test_perkin_elmer_text():
    found = read("s.asc", asc_file())
    same(found)
    assert (found.metadata.sample, found.metadata.instrument) == ("a film", "Spectrum Two")
    assert read("s.asc", asc_file("%R")).quantity == "reflectance"
    same(read("s.asc", asc_file("A", -np.log10(SHARES))))
    assert ":54: has 25 points; its header says 26" in fault("s.asc", asc_file(count=26))
    assert "fluorescence" in fault("s.asc", asc_file(technique="FL"))
    words = asc_file().replace("\t0.", "\tOVLD 0.").replace("4000.000000\t", "4000.000000\tOVLD ")
    assert ':30: "4000.000000 OVLD' in fault("s.asc", words)


def jasco_file(unit="TRANSMITTANCE", axis="%T", values=100 * SHARES, mark=",", **header):
    """Header, XYDATA, pairs, a blank line, and Japanese words in Shift-JIS below."""
    labels = {"TITLE": "a film", "DATA TYPE": "INFRARED SPECTRUM", "ORIGIN": "JASCO",
              "SPECTROMETER/DATA SYSTEM": "", "XUNITS": "1/CM", "YUNITS": unit,
              "FIRSTX": f"{WAVES[0]:.4f}", "LASTX": f"{WAVES[-1]:.4f}", "NPOINTS": len(values),
              "MAXY": f"{values.max():.5f}", **header}  # fmt: skip
    lines = [f"{key}{mark}{value}" for key, value in labels.items()]
    pairs = zip(WAVES, values, strict=False)
    rows = [f"{x:.4f}{mark}{y:.8g}" for x, y in pairs]
    below = {
        "縦軸": axis,
        "機種名": "FT/IR-4600typeA",
        "分解": "4 cm-1",
        "付属品名": "積分球 ISN-470",
    }
    footer = ["", "##### Extended Information", "[測定情報]"]
    footer += [f"{key}{mark}{value}" for key, value in below.items()]
    return "\r\n".join([*lines, "XYDATA", *rows, *footer, ""]).encode("cp932")


def test_jasco_text():
    found = read("s.csv", jasco_file())
    same(found)
    assert found.metadata.instrument == "FT/IR-4600typeA"
    assert (found.metadata.resolution, found.metadata.ordinate) == ("4 cm-1", "%T")
    assert found.notes == ()
    mirror = read("s.txt", jasco_file("REFLECTANCE", "%R", mark="\t"))
    same(mirror)
    assert (mirror.quantity, mirror.collection) == ("reflectance", "total")  # ISN: a sphere
    same(
        read("s.txt", jasco_file("ABSORBANCE", "Abs", -np.log10(SHARES)), quantity="transmittance")
    )
    comma = jasco_file(mark=";").decode("cp932").replace(".", ",")
    same(read("s.txt", comma), rtol=1e-5)
    dim = read("s.csv", jasco_file(values=SHARES))  # 0.7 % at most: still per cent
    assert dim.value.max() == pytest.approx(0.007, rel=0.01)
    assert "nowhere above 0.70 %; if the file holds fractions" in dim.notes[0]
    same(read("s.csv", jasco_file(values=SHARES), scale="1"))


def test_jasco_text_is_checked_against_its_header():
    assert ":36: has 25 points; its header says NPOINTS 26" in fault(
        "s.csv", jasco_file(NPOINTS=26)
    )
    assert "header says LASTX 4100, the data 400" in fault("s.csv", jasco_file(LASTX="4100.0"))
    assert "says MAXY 90" in read("s.csv", jasco_file(MAXY="90.0")).notes[0]
    raman = (SAMPLES / "jasco-raman.csv").read_bytes()
    assert 'is of "RAMAN SPECTRUM", not transmittance' in fault("s.csv", raman)


# ---- JCAMP-DX

HEAD = """\
##TITLE={title}
##JCAMP-DX=4.24 $$ a comment
##DATA TYPE=INFRARED SPECTRUM
##XUNITS={xunits}
##YUNITS={yunits}
##XFACTOR=1
##YFACTOR=1e-06
##FIRSTX=4000
##LASTX=400
##NPOINTS=25
##XYDATA=(X++(Y..Y))
"""


def jdx(values=SHARES, title="film", xunits="1/CM", yunits="TRANSMITTANCE", **labels):
    rows = [
        " ".join(f"{one:.12g}" for one in (WAVES[at], *np.round(values[at : at + 5] * 1e6)))
        for at in range(0, len(values), 5)
    ]
    head = HEAD.format(title=title, xunits=xunits, yunits=yunits)
    for label, value in labels.items():
        lines = [line for line in head.splitlines() if not line.startswith(f"##{label}=")]
        head = "\n".join([*lines[:-1], *([f"##{label}={value}"] if value else []), lines[-1], ""])
    return head + "\n".join(rows) + "\n##END=\n"


def linked(*blocks):
    return "##TITLE=all\n##DATA TYPE=LINK\n##BLOCKS=3\n" + "".join(blocks) + "##END=\n"


def test_jcamp_units_and_labels():
    same(read("s.dx", jdx()))
    same(read("s.dx", "\ufeff$$ first a comment\n" + jdx()))
    same(read("s.txt", jdx().replace("\n", "\r\n")))
    for name in ("NPOINTS", "LASTX", "FIRSTX"):
        same(read("s.dx", jdx(**{name: "", "DELTAX": "-150."})))
    same(read("s.dx", jdx(NPOINTS="", LASTX="", FIRSTX="")))
    for name in ("%T", "Percent Transmittance"):
        same(read("s.dx", jdx(100 * SHARES, yunits=name)))
    assert read("s.dx", jdx(yunits="%R", values=100 * SHARES)).quantity == "reflectance"
    for name in ("A", "ABS", "ABSORBANCE"):
        found = read("s.dx", jdx(-np.log10(SHARES), yunits=name))
        same(found, rtol=1e-5)
        assert found.notes == ("absorbance is taken as log10(1/T), of transmittance",)
    dark = read("s.dx", jdx(-np.log10(SHARES), yunits="A"), quantity="reflectance")
    assert dark.quantity == "reflectance"
    assert dark.notes == ("absorbance is taken as log10(1/R): it is said to be of reflectance",)
    for unit, metres in (("NANOMETERS", 1e-9), ("MICROMETERS", 1e-6), ("nm", 1e-9), ("um", 1e-6)):
        found = read("s.dx", jdx(xunits=unit))
        np.testing.assert_allclose(found.wavelength, WAVES[np.argsort(-WAVES)] * metres)
        np.testing.assert_allclose(found.value, SHARES, rtol=1e-5)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", ":1: is not JCAMP-DX"),
        ("\0ÿ" * 50, ":1: is not JCAMP-DX"),
        (jdx().replace("##END=\n", ""), ":16: ends without ##END="),
        (HEAD.split("##XYDATA")[0] + "##END=\n", "contains no spectrum"),
        (jdx(NPOINTS="99999999999"), ":10: ##NPOINTS="),
        (jdx(NPOINTS="x"), ":10: ##NPOINTS="),
        (jdx(yunits="COUNTS"), 'shows "COUNTS", which is not known'),
        (jdx(NPOINTS="24"), "##NPOINTS= 24, but its table has 25 points"),
        (jdx(FIRSTX="4300"), "a line starts at 4000, where the ends and the number of points say"),
        (jdx(LASTX="800"), "a line starts at"),
        (jdx(LASTX="nowhere"), '##LASTX= "nowhere" is not a number'),
        (jdx(YFACTOR="0"), "##YFACTOR= 0 is not a factor"),
        (jdx(yunits="KUBELKA-MUNK"), "shows Kubelka-Munk units"),
        (jdx(yunits="SINGLE BEAM"), "shows a single beam"),
        (jdx(yunits="ABSORPTANCE"), "shows absorption"),
        (jdx(xunits="MINUTES"), 'abscissa "MINUTES" is not known'),
        (jdx(yunits="LOG(1/R)", values=-np.log10(SHARES)), ""),
        (jdx().replace("INFRARED SPECTRUM", "RAMAN SPECTRUM"), "but a Raman spectrum"),
        (jdx().replace("##XYDATA=(X++(Y..Y))", "##PEAK TABLE=(XY..XY)"), "but a peak table"),
        (jdx().replace("XYDATA=(X++(Y..Y))", "XYDATA=(X++(R..R))"), '"(X++(R..R))" is not'),
        (jdx().replace("##XYDATA", "##NTUPLES"), "but an NTUPLES table"),
        ((SAMPLES / "peaks.jdx").read_text(), "contains no spectrum, but a peak table"),
        (
            (SAMPLES / "difference.jdx").read_text().replace("k81l", "k82l"),
            ":21: fails its checksum",
        ),
    ],
)
def test_jcamp_that_is_no_spectrum_or_damaged(text, says):
    if says:
        assert says in fault("s.dx", text)
    else:
        found = read("s.dx", text)
        assert found.quantity == "reflectance"
        same(found, rtol=1e-5)


@pytest.mark.parametrize(
    "row",
    ["400 1000 2000 2001 2002 2003 2003 2003", "400+1000+2000+2001+2002+2003+2003+2003",
     "400A000B000B001B002B003B003B003", "400A000J000JJJ%%", "400A000J000JU%T"],
)  # fmt: skip
def test_seven_ordinates_in_every_form(row):
    """Coded by hand: R. S. McDonald, P. A. Wilks, Appl. Spectrosc. 42, 151 (1988)."""
    expected = [1000.0, 2000.0, 2001.0, 2002.0, 2003.0, 2003.0, 2003.0]
    assert read_rows([row]).ordinate.tolist() == expected


def test_missing_ordinates_of_jcamp_are_left_out():
    text = jdx()
    value = f" {np.round(SHARES[7] * 1e6):.12g} "
    found = read("s.dx", text.replace(value, " ? ", 1))
    assert len(found.value) == 24
    assert "1 points without a value" in found.notes[0]


def test_of_several_blocks_none_is_taken_silently():
    both = linked(jdx(title="a"), jdx(SHARES / 2, title="b"))
    assert "holds 2 spectra" in fault("s.dx", both)
    assert "1 TRANSMITTANCE of a, 2 TRANSMITTANCE of b" in fault("s.dx", both)
    same(read("s.dx", both, spectrum="b"), INCREASING / 2, rtol=1e-5)
    unlike = linked(jdx(), jdx(SHARES / 2, yunits="REFLECTANCE"))
    assert "holds 2 spectra" in fault("s.dx", unlike)
    same(read("s.dx", unlike, quantity="transmittance"))
    same(read("s.dx", unlike, quantity="reflectance"), INCREASING / 2, rtol=1e-5)
    peaks = "##TITLE=p\n##DATA CLASS=PEAK TABLE\n##PEAKTABLE=(XY..XY)\n1,2\n##END=\n"
    found = read("s.dx", linked(peaks, jdx()))
    same(found)
    assert found.notes == ("a peak table in the same file is left out",)
    assert "holds 5 spectra" in fault("s.dx", (SAMPLES / "linked.jdx").read_text())


# ---- per cent or fraction, impossible values, collected light


def test_per_cent_that_is_not_marked_is_read_by_value():
    found = read("s.dx", jdx(100 * SHARES))
    same(found)
    assert found.notes == (
        f"values up to {100 * SHARES.max():.4g} are taken as per cent, although they are not "
        "marked as %",
    )
    unclear = np.where(WAVES > 3000.0, 2.0, 1.0)  # 1 to 2 %, or noise above 1
    said = fault("s.dx", jdx(unclear))
    assert "7 of its 25 values of TRANSMITTANCE exceed 1.5 (highest 2), and it is not" in said
    assert "say --scale % or --scale 1" in said
    np.testing.assert_allclose(read("s.dx", jdx(unclear), scale="%").value[0], 0.01)
    assert "is not between -0.2 and 1.5" in fault("s.dx", jdx(unclear), scale="1")


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("wavenumber [cm^-1],transmittance\n1000,0.8\n2000,0.9\n", None),
        ("Wavelength (µm);Transmittance (%)\n10,0;80,0\n5,0;90,0\n", None),
        ("instrument X\ncm-1,%T\n2000,90\n1000,80\n", None),
        ("wavelength [um] absorbance\n10 0.0969100130\n5 0.0457574906\n", None),
        ("1000 80\n2000 90\n", "wavenumber [cm^-1], transmittance [%]"),
    ],
)
def test_tables(text, columns, write):
    found = read_spectrum(write(text, "s.csv"), columns=columns)
    np.testing.assert_allclose(found.wavenumber, [1e5, 2e5])
    np.testing.assert_allclose(found.value, [0.8, 0.9])


def test_table_in_per_cent_without_the_mark(write):
    path = write("wavelength [nm],transmittance\n500,80\n1000,70\n", "s.csv")
    found = read_spectrum(path)
    np.testing.assert_allclose(found.value, [0.7, 0.8])
    np.testing.assert_allclose(found.wavelength, [1e-6, 5e-7])
    assert "taken as per cent" in found.notes[0]
    for header, notes in (("%T", 1), ("transmittance", 0)):  # a mirror may transmit as little
        path.write_text(
            f"wavelength [nm],{header}\n500,{'0.8' if notes else '0.008'}\n1000,0.007\n"
        )
        assert len(read_spectrum(path).notes) == notes
    path.write_text("wavelength [nm],%T\n500,80\n1000,70\n")
    np.testing.assert_allclose(read_spectrum(path, scale="%").value, [0.7, 0.8])
    path.write_text("wavelength [nm],%T\n500,0.8\n1000,0.7\n")
    np.testing.assert_allclose(read_spectrum(path, scale="1").value, [0.7, 0.8])
    path.write_text("wavelength [nm],%T\n500,8000\n1000,7000\n")
    with pytest.raises(lf.ConfigurationError, match="transmittance = 80 at 20000"):
        read_spectrum(path)
    path.write_text("wavelength [nm],transmittance [%],reflectance [%]\n500,80,10\n1000,70,20\n")
    with pytest.raises(lf.ConfigurationError, match="needs one of the columns"):
        read_spectrum(path)
    np.testing.assert_allclose(read_spectrum(path, quantity="reflectance").value, [0.2, 0.1])


def test_table_over_photon_energy(write):
    path = write("eV,%T\n1,80\n2,70\n", "s.csv")
    np.testing.assert_allclose(read_spectrum(path).wavelength, [1.239841984e-6, 0.619920992e-6])
    with pytest.raises(lf.ConfigurationError, match='is a table of one spectrum, not of "2"'):
        read_spectrum(path, spectrum="2")


def test_ends_without_light_are_left_out():
    grid = np.linspace(4000.0, 400.0, 200)
    value = np.where(grid < 500.0, 3.0, 0.5)
    rows = "\n".join(f"{x:.3f}, {y}" for x, y in zip(grid, value, strict=True))
    head = HEAD.format(title="", xunits="1/CM", yunits="TRANSMITTANCE").replace("1e-06", "1")
    head = head.replace("NPOINTS=25", "NPOINTS=200").replace(
        "XYDATA=(X++(Y..Y))", "XYPOINTS=(XY..XY) $$ pairs"
    )
    found = read("s.dx", f"{head}{rows}\n##END=\n", scale="1")
    assert found.value.max() == 0.5
    assert found.notes[0].startswith("points outside 508.54 to 4000 cm^-1 are left out")
    value[100] = 3.0  # in the middle: all is in doubt
    rows = "\n".join(f"{x:.3f}, {y}" for x, y in zip(grid, value, strict=True))
    assert "transmittance = 3 at" in fault("s.dx", f"{head}{rows}\n##END=\n", scale="1")


def test_what_the_reflectance_leaves_out_is_said():
    film = read("t.dx", jdx(SHARES / 2))

    def said(**wanted):
        mirror = read("r.dx", jdx(SHARES / 2, yunits="REFLECTANCE", **wanted.pop("labels", {})),
                      quantity="reflectance", **wanted)  # fmt: skip
        result = reduce_ftir([film], [mirror], accuracy=0.01)
        return "\n".join(result.warnings), to_dataset(result)["reflectance_0"].attrs

    assert "r.dx: does not say which light was collected (--collection)" in said()[0]
    text, attributes = said(collection="specular")
    assert "r.dx: holds specular reflectance; what the film scatters" in text
    assert attributes["collection"] == "specular"
    assert attributes["format"] == "JCAMP-DX"
    assert "light" not in said(collection="total")[0]
    sphere, attributes = said(labels={"SAMPLING PROCEDURE": "integrating sphere"})
    assert "is taken to collect all light; with an open specular port" in sphere
    assert attributes["collection"] == "total"
    with pytest.raises(lf.ParameterError, match="leaves out the specular beam"):
        said(collection="diffuse")
    drift = jdx(-np.log10(SHARES), yunits="A", **{"SAMPLING PROCEDURE": "DRIFT"})
    assert "say whether it is that of transmittance or reflectance" in fault("s.dx", drift)


def test_options_and_missing_packages(monkeypatch):
    assert "is damaged or not JASCO .jws" in fault("s.jws", b"")
    with pytest.raises(lf.ParameterError, match='collection "sphere" is not one of specular'):
        read_spectrum(SAMPLES / "opus.0", collection="sphere")
    assert "shows transmittance, not reflectance" in fault("s.dx", jdx(), quantity="reflectance")
    assert "does not name its ordinate" in fault("s.dx", jdx(yunits=""))
    assert "does not name its ordinate" in fault("s.dx", jdx(yunits=""), quantity="reflectance")
    same(read("s.dx", jdx(yunits=""), quantity="reflectance", scale="1"))
    percent = spc_file(x=1, y=11, curves=(100 * SHARES,))  # of what, the code does not say
    assert 'does not name its ordinate but "%"' in fault("s.spc", percent)
    same(read("s.spc", percent, quantity="reflectance"))
    arbitrary = (SAMPLES / "grams.spc").read_bytes()
    assert "shows arbitrary units" in fault("s.spc", arbitrary, quantity="transmittance")
    for module in ("brukeropus", "brukeropus.file"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(lf.MissingExtraError, match=r"needs brukeropus: pip install"):
        read_spectrum(SAMPLES / "opus.0")


# ---- damage


def contents():
    for path in sorted(SAMPLES.glob("*.*")):
        if path.suffix != ".md":
            yield path.name, path.read_bytes()
    yield "built.spc", spc_file("long", x=1)
    yield "built.spa", omnic_file()
    yield "built.asc", asc_file().encode()
    yield "built.csv", jasco_file()
    yield "built.dx", linked(jdx(), jdx(yunits="REFLECTANCE")).encode()


CONTENTS = dict(contents())


@pytest.mark.parametrize("name", CONTENTS)
def test_damage_gives_one_line_or_a_spectrum(name, tmp_path):
    content, path = CONTENTS[name], tmp_path / name
    rng = np.random.default_rng(len(content))
    read = partial(read_spectrum, quantity="transmittance")
    for near in (len(content), 1200):
        for found, _ in read_damaged(read, path, content, rng, near, DAMAGES // 2):
            assert np.isfinite(found.value).all()
            assert np.abs(found.value).max() <= 1.5
            assert np.all(np.diff(found.wavenumber) > 0.0)
            assert np.isfinite(found.wavelength).all()


def test_last_digits():
    assert (last_digit("0.37"), last_digit("4000")) == (0.01, 1.0)


def test_names_of_axes_and_ordinates():
    assert axis_of("Wavenumber (cm-1)") == Axis(scale=100.0, is_wavelength=False)
    assert axis_of("NANOMETERS").is_wavelength
    assert parse_ordinate("%T") == OrdinateUnit(quantity="transmittance", percent=True)
    assert parse_ordinate("Single Beam").startswith("shows a single beam")


def test_spectra_of_one_name_are_told_apart_by_their_data():
    """Two absorbances of one sample, as Bruker's files hold them."""
    both = linked(jdx(title="film"), jdx(SHARES / 2, title="film"))
    said = fault("s.dx", both)
    assert f"1 TRANSMITTANCE of film (25 points from 4000 to 400, {SHARES.min():.3g}" in said
    assert f"{SHARES.max() / 2:.3g})" in said
