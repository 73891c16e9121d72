"""One clear line for each mistake in a file or in the text of an option."""

import io
import re
from functools import partial
from pathlib import Path

import pytest
from PIL import Image

import lightflyer as lf
from lightflyer.lab.ftir.means import parse_ranges
from lightflyer.lab.readers.height_map import read_height_map, read_mask
from lightflyer.lab.readers.spectrum_data import read_spectrum
from lightflyer.lab.thermography.data import THERMAL, parse_band, read_readings
from lightflyer.lab.thermography.thermal_image import (
    parse_regions,
    parse_scale,
    read_thermal_image,
)

from .test_thermal_images import lines

HEIGHTS = Path(__file__).parent / "height_maps"
NOTHING = "\n".join(["nan " * 20] * 20)
ROWS = "\n".join(["1 2 3 4"] * 4)
HEAD = "# Value units: m\n# Width: 1 um\n"
TINY = HEAD.replace("units: m", "units: nm") + "\n".join(["1e-8 2e-8 " * 10] * 20)


def changed(name, old, new):
    content = (HEIGHTS / name).read_bytes()
    assert old in content
    return content.replace(old, new)


def picture():
    stream = io.BytesIO()
    Image.new("RGB", (20, 20)).save(stream, "TIFF")
    return stream.getvalue()


KELVIN = "hotplate [K],lower [K],upper [K],ambient [K]\n"
BAND = "wavelength [um],response\n"


def response(path):
    return parse_band(str(path))


FILES = {
    read_height_map: [
        ("a.stp", changed("wsxm.stp", b"13.7008 nm", b"13.7008 pA"), "[pA]"),
        ("a.stp", changed("wsxm.stp", b"channel: Topography", b"channel: Phase     "),
         'channel "Phase [nm]" is not a height'),
        ("a.sur", changed("mountains.sur", b"mm   ", b"V    "), '"Z [V]" is not a height'),
        ("a.sur", b"DSCOMPRESSED" + bytes(400), "save it in MountainsMap without"),
        ("a.spm", changed("nanoscope-10.spm", b"Samps/line: 48", b"Samps/line: 99"),
         "cannot be read as a Nanoscope file"),
        ("a.001", b"?*File list\r\n", "save it in binary form"),
        ("a.spm", b"", "cannot be read as a Nanoscope file"),
        ("a.jpk-qi-data", b"PK", "a map of force curves, not a map of heights"),
        ("a.jpk", b"II*\0", "cannot be read as a JPK file"),
        ("a.nid", changed("nanosurf.nid", b"Dim2Unit=m", b"Dim2Unit=V"), "no map of"),
        ("a.mi", changed("picoview.mi", b"xPixels       48", b"xPixels       9999999"),
         "9999999 x 40 pixels, more than the file holds"),
        ("a.mi", changed("picoview.mi", b"bufferUnit    um", b"bufferUnit    m "),
         "0.1 m is the most"),
        ("m.ibw", b"", "cannot be read as an Igor file"),
        ("m.ibw", b"\x05\x00" + b"\x7f" * 500, "cannot be read as an Igor file"),
        ("m.gwy", b"", "cannot be read as a Gwyddion file"),
        ("m.gwy", b"GWYPGwyContainer\x00\xff\xff", "as a Gwyddion file: it is damaged"),
        ("m.txt", "", "is empty"),
        ("m.txt", b"\x00\xff\xfe", "is not a text file"),
        ("m.txt", ROWS, "heights have no unit"),
        ("m.txt", "# Value units: m\n" + ROWS, "has no width"),
        ("m.txt", f"# Channel: Phase\n{HEAD}{NOTHING}", "is not a height"),
        ("m.txt", "# Value units: W\n# Width: 1 um\n" + ROWS, "wrong kind"),
        ("m.txt", HEAD + ROWS, "has 4 x 4 pixels"),
        ("m.txt", HEAD + "\n".join(["1 " * 20] * 20), "height of 1 m"),
        ("m.txt", ROWS + "\n1 2 3", ":5: has 3 heights, the first row has 4"),
        ("m.txt", HEAD + NOTHING, "400 of its"),
        ("m.txt", TINY, "all heights are within 1e-17 m; atoms are larger, the unit is wrong"),
        ("m.txt", "1,469\t2,345\n3,210\t1,111", ':1: heights: "1,469" may be 1469 or 1.469'),
        ("m.txt", "1,5\t2\n3\t4.5", '"1,5" has other marks than "4.5" in line 2'),
        ("m.txt", "23,05,24,10\n23,15,24,20", '"05" between commas suggest decimal commas'),
        ("m.txt", "a b\n1 2\n3 x", ':3: "x" is not a number'),
        ("m.txt", "1 2\n1.2.3 4", ':2: "1.2.3" is not a number'),
        ("m.txt", "1 2 x\n1 2 3\n1 2 3", ':1: "x" is not a number'),
    ],
    read_mask: [
        ("m.txt", "0 2\n1 1\n", "0 and 1"),
        ("m.txt", "", "empty"),
    ],
    read_thermal_image: [
        ("a.csv", lines(";", True).encode(), 'has no unit; state the unit by --image-unit "°C"'),
        ("a.csv", lines(";", True, "[C] [F]").encode(), "names °C and °F"),
        ("a.csv", b"[C]\n20 21\n22 x\n", ':3: "x" is not a number'),
        ("a.csv", b"[K]\n20 21\n22 23\n", "the unit or the scale is wrong"),
        ("a.csv", b"[C]\nnan nan\nnan nan\n", "no pixel has a temperature"),
        ("a.tif", picture(), "is a picture (RGB)"),
        ("a.tif", b"II*\0", "cannot be read as TIFF"),
        ("a.seq", b"FFF\0", "a sequence of FLIR; export one image"),
        ("a.is2", b"", "Fluke's own format; export CSV"),
        ("a.jpg", b"\xff\xd8\xff\xe1\0\x08DJIxxx", "it has no FLIR data; DJI's own format needs"),
        ("a.fff", b"FFF\0" + bytes(60), "unknown version"),
        ("a.jpg", b"", "is not a radiometric FLIR image"),
        ("a.jpg", b"\xff\xd8\xff\xe0" + bytes(40), "is not a radiometric FLIR image"),
        ("a.jpg", b"text", "is not a radiometric FLIR image"),
    ],
    partial(read_readings, method=THERMAL): [
        ("a.csv", "hotplate [K],lower [K],upper [K]\n400,300,350\n", "ambient_temperature is miss"),
        ("a.csv", KELVIN + "290,300,350,295\n", ":2: hotplate_temp"),
        ("a.csv", KELVIN + "-4,300,350,295\n", ":2: hotplate_temp"),
        ("a.csv", KELVIN.replace(" [K]", "", 1) + "400,300,350,295\n", ":1: column hotplate"),
        ("a.csv", KELVIN.replace("r [K]", "r [°C]", 1) + "400,-300,350,295\n", "not between 200"),
        ("a.csv", KELVIN + "150,50,130,22\n", ":2: hotplate_temp"),
        ("a.csv", KELVIN.replace("[K]", "[°C]") + "423,323,403,295\n", "ambient_temp"),
        ("a.csv", KELVIN + "323,400,390,295\n", "exchanged?"),
        ("a.csv", KELVIN + "400,330,280,295\n", "upper_temp"),
        ("a.csv", KELVIN + "400,330,nan,295\n", "is nan"),
        ("a.csv", KELVIN + "299,297,297,295\n", "by less than 5"),
    ],
    response: [
        ("a.csv", BAND + "8,1\n8,1\n", "must increase"),
        ("a.csv", BAND + "8,0\n9,0\n", "zero everywhere"),
        ("a.csv", BAND + "8,1\n", "two or more"),
        ("a.csv", BAND + "8,-1\n9,1\n", ":2: response = -1"),
        ("a.csv", BAND + "8,x\n9,1\n", ":2: response"),
        ("a.csv", BAND + "0.1,1\n9,1\n", "is not between"),
    ],
    read_spectrum: [
        ("s.csv", "wavenumber [cm^-1],transmittance\n1000,800\n2000,9\n", ":2: transmittance"),
        ("s.csv", "wavenumber [cm^-1],transmittance\n1000,0.8\n", "has 1 wavenumber"),
        ("s.csv", "wavenumber [cm^-1]\n1000\n", "needs one of the columns transmittance"),
        ("s.csv", "transmittance\n0.8\n", "needs one column wavenumber, wavelength or"),
        ("s.csv", "wavenumber,transmittance\n1000,0.8\n", "wavenumber has no unit"),
    ],
}  # fmt: skip
TEXTS = {
    parse_band: [
        ("14-7.5 um", "must be below"),
        ("7.5-14", "is not a band"),
        ("7.5-14 kg", "wrong kind"),
        ("0-14 um", "is not between"),
        ("7.5-7.5 um", "must be below"),
        ("none.csv", "none.csv: cannot be read"),
        ("", "is not a band"),
    ],
    parse_ranges: [
        ("2400-2280 cm^-1", "must be below"),
        ("2280 cm^-1", "is not a range"),
        ("2280-2400", "is not a range"),
        ("2280-2400 kg", "wrong kind"),
        (" , ", "has no range"),
    ],
    parse_scale: [(text, "--image-unit: ") for text in ("m", "-1 K", "0 K", "1e K", "", "0.1")],
    parse_regions: [
        (text, "--regions")
        for text in ("hotplate", "hotplate=1:1,2:3", "hotplate=1:2", "plate=1:2,3:4",
                     "upper=1:2,3:4;upper=1:2,3:4")
    ],
}  # fmt: skip


def cases(table):
    return [(read, *case) for read, every in table.items() for case in every]


@pytest.mark.parametrize(("read", "name", "content", "says"), cases(FILES))
def test_one_clear_line_for_each_mistake(write, read, name, content, says):
    if read is read_height_map:
        pytest.importorskip("SurfaceTopography")
    path = write(content, name)
    with pytest.raises(lf.ConfigurationError) as error:
        read(path)
    said = str(error.value)
    assert said.startswith(str(path))
    assert says in said
    assert "\n" not in said
    assert "Error(" not in said


@pytest.mark.parametrize(("read", "text", "says"), cases(TEXTS))
def test_texts_that_are_refused(read, text, says):
    with pytest.raises(lf.ConfigurationError, match=re.escape(says)):
        read(text)
