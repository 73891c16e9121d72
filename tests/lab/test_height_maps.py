"""Files of microscopes: numbers of the file, read again from the published descriptions."""

import re
import struct
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.lab.readers.formats import Format, read_number_matrix
from lightflyer.lab.readers.height_map import HeightMap, list_channels, read_height_map
from lightflyer.lab.readers.microscopes import Channel, choose_channel
from lightflyer.lab.surface.reduction import roughness, to_dataset
from lightflyer.lab.synthetic.spectra import igor_wave, roughness_files

from .damage import read_damaged

pytest.importorskip("SurfaceTopography")
EXAMPLES = roughness_files(0)
FILES = Path(__file__).parent / "height_maps"
SHAPE = (40, 48)


def header(content, end):
    return content[: content.index(end)].decode("latin-1")


def number(pattern, text):
    return float(re.search(pattern, text)[1])


def nanoscope(content, index, sensitivity, bits):
    """Raw value times hard scale times soft scale (Nanoscope file description, version 4.3 on)."""
    text = header(content, b"\\*File list end")
    image = text.split("\\*Ciao image list")[1 + index]
    offset, size = (int(number(rf"Data {what}: (\d+)", image)) for what in ("offset", "length"))
    raw = np.frombuffer(content[offset : offset + size], f"<i{bits // 8}").reshape(SHAPE)
    volts = number(r"@2:Z scale: V \[.*?\] \(.*?\) ([\d.]+) V", image)
    nanometres = number(rf"@{re.escape(sensitivity)}: V ([\d.]+) nm/V", text)
    return raw * (volts / 2.0**bits * nanometres * 1e-9)


def nanosurf(content):
    text = header(content, b"#!")
    first = text.split("[DataSet-0:1]")[1]
    least, wide = (number(rf"Dim2{what}=(\S+)", first) for what in ("Min", "Range"))
    start = content.index(b"#!") + 2 + 4 * 40 * 48  # after deflection
    raw = np.frombuffer(content[start : start + 4 * 40 * 48], "<i4").reshape(SHAPE)
    return least + wide * (raw + 2.0**31) / 2.0**32


def digital_surf(content):
    raw = np.frombuffer(content[-4 * 40 * 48 :], "<i4").reshape(SHAPE)
    least = struct.unpack_from("<i", content, 100)[0]
    step = struct.unpack_from("<f", content, 128)[0]  # [mm]
    return np.where(raw < least, np.nan, raw * step * 1e-3)


def wsxm(content, dtype):
    text = header(content, b"[Header end]")
    raw = np.frombuffer(content[-SHAPE[0] * SHAPE[1] * np.dtype(dtype).itemsize :], dtype)
    if dtype == "<f8":  # in the unit of Z
        return raw.reshape(SHAPE) * 1e-9
    high, low = (number(rf"{what}: (\S+)", text) for what in ("Maximum", "Minimum"))
    return raw.reshape(SHAPE) * number(r"Z Amplitude: (\S+)", text) / (high - low) * 1e-9


def picoview(content):
    start = content.index(b"data          BINARY_32\n") + 24
    text = content[:start].decode("latin-1")
    raw = np.frombuffer(content[start : start + 4 * 40 * 48], "<i4").reshape(SHAPE)
    return raw / 2.0**31 * number(r"bufferRange\s+(\S+)", text) * 1e-6


READERS = {
    "nanoscope.001": ("Height", lambda b: nanoscope(b, 0, "Sens. Zscan", 16), 300e-9 / 512),
    "nanoscope-9.1.spm": ("Height", lambda b: nanoscope(b, 3, "Sens. Zsens", 16), 10e-6 / 256),
    "nanoscope-10.spm": ("ZSensor", lambda b: nanoscope(b, 0, "Sens. ZsensSens", 32), 1e-6 / 512),
    "nanosurf.nid": ("Scan forward (Z-Axis)", nanosurf, 20e-6 / 256),
    "mountains.sur": ("Z", digital_surf, 3.484e-6),
    "wsxm.stp": ("Topography", lambda b: wsxm(b, "<f8"), 600e-9 / 256),
    "wsxm.top": ("Topography", lambda b: wsxm(b, "<i2"), 600e-9 / 256),
    "picoview.mi": ("Topography", picoview, 20e-6 / 256),
}


@pytest.mark.parametrize("name", READERS)
def test_heights_are_those_of_the_file(name):
    channel, truth, pixel = READERS[name]
    found = read_height_map(FILES / name)
    assert found.channel == channel
    assert found.height.shape == SHAPE
    assert (found.width, found.length) == pytest.approx((48 * pixel, 40 * pixel), rel=1e-4)
    expected = truth((FILES / name).read_bytes())
    assert np.nanstd(expected) > 1e-10
    # the first line of a file may be the lower or the upper edge
    turned = [expected, expected[::-1], expected[:, ::-1], expected[::-1, ::-1]]
    assert any(np.allclose(found.height, one, 1e-6, 1e-15, equal_nan=True) for one in turned)


def jpk(path, heights, unit="m"):
    """Image scan of JPK: a thumbnail and one page a channel, scaled by tags of the default slot."""
    tifffile = pytest.importorskip("tifffile")
    tags = {
        0x8003: ("s", "2020-01-01 10:00:00"), 0x8040: ("d", 0.0), 0x8041: ("d", 0.0),
        0x8042: ("d", 8e-6), 0x8043: ("d", 5e-6), 0x8044: ("d", 0.0), 0x8045: ("i", 0),
    }  # fmt: skip
    raw = np.round(heights / 1e-12).astype(np.int32)
    pages = [("Phase", "deg", raw), ("Height (measured)", unit, raw)]
    with tifffile.TiffWriter(path) as out:
        write(out, np.zeros((8, 8), np.uint8), tags)
        for name, of, values in pages:
            slot = {
                0x8050: ("s", name), 0x8051: ("i", 0), 0x8052: ("s", name), 0x8080: ("i", 1),
                0x8081: ("s", "nominal"), 0x8090: ("s", "nominal"), 0x8091: ("s", "absolute"),
                0x80A1: ("s", "metres"), 0x80A2: ("s", of), 0x80A3: ("s", "LinearScaling"),
                0x80A4: ("d", 1e-12), 0x80A5: ("d", 2e-6),
            }  # fmt: skip
            write(out, values, slot)


def write(out, values, tags):
    kinds = {"s": 2, "d": 12, "i": 4}
    extra = [
        (code, kinds[kind], 0 if kind == "s" else 1, value, True)
        for code, (kind, value) in tags.items()
    ]
    out.write(values, extratags=extra, contiguous=False, metadata=None, photometric="minisblack")


def surface(shape=(24, 32)):
    return 1e-8 * np.random.default_rng(0).normal(size=shape)


def test_jpk(tmp_path):
    height = surface()
    jpk(tmp_path / "map.jpk", height)
    found = read_height_map(tmp_path / "map.jpk")
    assert found.channel == "Height (measured)"
    assert (found.width, found.length) == pytest.approx((8e-6, 5e-6))
    assert np.allclose(found.height[::-1], height + 2e-6, 0.0, 1e-12)
    jpk(tmp_path / "volts.jpk", height, "V")
    with pytest.raises(lf.ConfigurationError, match=r"volts\.jpk: contains no map of heights$"):
        read_height_map(tmp_path / "volts.jpk")


def test_igor(write):
    height = surface((32, 32)) + 1e-6
    path = write(igor_wave(height, 10e-6, "note"), "map.ibw")
    found = read_height_map(path)
    np.testing.assert_allclose(found.height, height, rtol=1e-6)
    assert (found.channel, found.width, found.length) == ("HeightRetrace", 10e-6, 10e-6)
    for channel, says in (
        ("amplituderetrace", "is not a height"), ("phase", "choose one by --channel: HeightRetrace")
    ):  # fmt: skip
        with pytest.raises(lf.ConfigurationError, match=says):
            read_height_map(path, channel=channel)


def test_channels_are_listed_and_others_refused():
    names = [one.description for one in list_channels(FILES / "picoview.mi")]
    assert names == ["Topography [µm]", "Deflection [V]", "Friction [V]", "Friction (2) [V]"]
    for name in ("Deflection", "Friction (2)"):
        with pytest.raises(lf.ConfigurationError, match=r'" is not a height; choose one .*Topog'):
            read_height_map(FILES / "picoview.mi", channel=name)
    with pytest.raises(lf.ConfigurationError, match=r'has no channel "Hight"; choose one .*Topog'):
        read_height_map(FILES / "picoview.mi", channel="Hight")
    with pytest.raises(lf.ConfigurationError, match=r"Deflection \[nm\]\" is not a height"):
        read_height_map(FILES / "nanoscope.001", channel="Deflection")


def test_other_heights_are_said():
    found = read_height_map(FILES / "nanoscope-9.1.spm")
    assert "other heights in the file, by --channel: ZSensor" in found.notes[0]
    assert found.notes[0] in roughness(found).warnings
    sensor = read_height_map(FILES / "nanoscope-9.1.spm", channel="zsensor")
    assert sensor.notes == ()
    assert np.std(sensor.height) != pytest.approx(np.std(found.height), rel=0.01)


def channels(*named):
    return [Channel(name, unit, (20, 20), 1e-6, 1e-6, dict) for name, unit in named]


@pytest.mark.parametrize(
    ("named", "expected"),
    [
        ([("Phase", "deg"), ("Height", "nm")], "Height"),
        ([("Amplitude", "nm"), ("Channel 2", "nm")], "Channel 2"),  # an amplitude is a length too
        ([("Height", "V"), ("Piezo", "nm")], "Piezo"),  # a height in volts is not one
        ([("HeightTrace", ""), ("PhaseTrace", "")], "HeightTrace"),
        ([("Height Error", "nm"), ("Z-Axis", "m")], "Z-Axis"),
    ],
)
def test_a_height_is_known_by_name_and_unit(named, expected):
    assert choose_channel(Path("a"), channels(*named), None)[0].name == expected


def test_no_channel_is_guessed():
    with pytest.raises(lf.ConfigurationError, match="several channels of heights; choose"):
        choose_channel(Path("a"), channels(("Channel 1", "nm"), ("Channel 2", "nm")), None)
    with pytest.raises(lf.ConfigurationError, match="no channel of heights; choose"):
        choose_channel(Path("a"), channels(("Channel 1", "V"), ("Phase", "nm")), None)


def test_options_of_a_matrix_are_refused_where_the_file_states_them():
    with pytest.raises(lf.ConfigurationError, match="--unit is for a matrix"):
        read_height_map(FILES / "wsxm.stp", unit="nm")


def test_a_name_need_not_tell_the_format(tmp_path):
    (tmp_path / "map.dat").write_bytes((FILES / "wsxm.top").read_bytes())
    assert read_height_map(tmp_path / "map.dat").channel == "Topography"


@pytest.mark.slow
@pytest.mark.parametrize("name", [*READERS, "map.jpk", "germanium.ibw", "germanium.gwy"])
def test_damage_gives_a_map_or_one_line(name, tmp_path):
    whole = FILES / name
    if name not in READERS:
        whole = tmp_path / name
        if name == "map.jpk":
            jpk(whole, surface())
        else:
            whole.write_bytes(EXAMPLES[name])
    content, intact = whole.read_bytes(), read_height_map(whole)
    header_size = len(content) - 2 * 40 * 48 if 6000 < len(content) < 100_000 else 600
    path, rng = tmp_path / f"damaged{whole.suffix}", np.random.default_rng(1)
    read = read_damaged(read_height_map, path, content, rng, header_size)
    assert len(read) < 190
    for found, how in read:
        assert not np.isinf(found.height).any()
        if how == "cut":  # what is left over is all there was
            assert np.array_equal(found.height, intact.height, equal_nan=True)


def test_missing_heights_do_not_count():
    height = surface((96, 96))
    clean = roughness(HeightMap("a", height, 1e-6, 1e-6), mask="none")
    holed = height.copy()
    holed[10:14, 20:50] = np.nan
    holed[60:63, 5:9] = np.nan
    found = roughness(HeightMap("a", holed, 1e-6, 1e-6))
    everywhere = found.parameters_all["rms_height"].value
    assert everywhere == pytest.approx(1e9 * height[~np.isnan(holed)].std(), rel=2e-3)
    assert found.parameters["rms_height"].value == pytest.approx(
        clean.parameters["rms_height"].value, rel=0.02
    )
    assert found.holes[np.isnan(holed)].all()
    assert found.summary()["missing_fraction"] == pytest.approx(132 / 96**2)
    assert any("132 pixels (1.4 %) have no height" in text for text in found.warnings)
    record = to_dataset([found])
    assert np.array_equal(np.isnan(record.height_0), np.isnan(holed))
    assert (record.mask_0.values[np.isnan(holed)] == 2).all()


def test_pixels_need_not_be_square():
    """Every fourth row of a map is the same surface with pixels a quarter as wide as long."""
    noise = np.random.default_rng(5).normal(size=(256, 256))
    wave = np.fft.fftfreq(256)
    kept = np.exp(-2e3 * (wave[:, None] ** 2 + wave**2))
    fine = 1e-8 * np.real(np.fft.ifft2(np.fft.fft2(noise) * kept))[:192, :192]
    square = roughness(HeightMap("a", fine, 1e-6, 1e-6), mask="none")
    oblong = HeightMap("a", fine[::4], 1e-6, 1e-6)
    assert oblong.pixel_aspect == 0.25
    found = roughness(oblong, mask="none")
    assert found.lost == pytest.approx(square.lost, rel=0.1)
    assert found.patches == pytest.approx(square.patches, rel=0.15)
    assert any("0.25 times as wide as long" in text for text in found.warnings)


def test_marks_of_a_matrix_are_those_of_tables(tmp_path):
    path = tmp_path / "m.txt"
    path.write_text("1.234,5\t2,0\n3,25\t4,0", encoding="utf-8")
    assert read_number_matrix(path, "heights").values.tolist() == [[1234.5, 2.0], [3.25, 4.0]]
    path.write_text("# decimal: comma\n1,469\t2,345\n3,210\tnan", encoding="utf-8")
    found = read_number_matrix(path, "heights").values
    np.testing.assert_array_equal(found, [[1.469, 2.345], [3.21, np.nan]])


def test_a_matrix_in_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    heights = np.random.default_rng(1).normal(0.0, 5.0, (20, 24)).round(3)
    book = openpyxl.Workbook()
    for row in heights.tolist():
        book.active.append(row)
    book.save(tmp_path / "map.xlsx")
    found = read_height_map(tmp_path / "map.xlsx", size=1e-6, unit="nm")
    assert not found.notes
    assert found.height == pytest.approx(1e-9 * heights)
    book.create_sheet("other").append([1, 2])
    book.save(tmp_path / "map.xlsx")
    with pytest.raises(lf.ConfigurationError, match=r"several sheets, .*#other; keep that of the"):
        read_height_map(tmp_path / "map.xlsx", size=1e-6, unit="nm")


def test_a_matrix_below_a_heading_with_numbered_rows(tmp_path):
    path = tmp_path / "m.csv"
    path.write_text("Emissivity;0,95\n\n;0;1;2\n0;20,5;20,25;1\n1;21;22;23\n2;-0,5;1;1e3\n",
                    encoding="utf-8")  # fmt: skip
    found = read_number_matrix(path, "temperatures")
    assert found.values.tolist() == [[20.5, 20.25, 1.0], [21.0, 22.0, 23.0], [-0.5, 1.0, 1000.0]]
    assert found.above[0] == "Emissivity;0,95"
    assert "the first column, 0 to 2, is an axis" in found.notes[0]


SIDE = 64
PLACES = 10.0 * np.arange(SIDE) / (SIDE - 1)  # [µm]


def table_text(matrix, corner="", row=None, column=None):
    """A matrix with axes as Origin, Mountains and Surfer write them."""
    lines = [] if row is None else [[corner] * (column is not None) + [f"{x:.4f}" for x in row]]
    for number, heights in enumerate(matrix):
        place = [] if column is None else [f"{column[number]:.4f}"]
        lines.append(place + [f"{one:.5f}" for one in heights])
    return "\n".join("\t".join(line) for line in lines) + "\n"


@pytest.mark.parametrize("scale", [1.0, 1e3, -1.0])
@pytest.mark.parametrize("axes", ["both", "row", "column", "blank corner", "named corner"])
def test_axes_are_no_heights(tmp_path, axes, scale):
    heights = np.random.default_rng(2).normal(0.0, 2.7, (SIDE, SIDE))
    corner = {"both": "0", "named corner": "y \\ x"}.get(axes, "")
    row = None if axes == "column" else scale * PLACES
    column = None if axes == "row" else scale * PLACES
    path = tmp_path / "map.txt"
    path.write_text(table_text(heights, corner, row, column), encoding="utf-8")
    found = read_height_map(path, size=10e-6, unit="nm")
    assert found.height == pytest.approx(1e-9 * heights, abs=1e-14)
    assert "is an axis and is left out" in found.notes[0]


@pytest.mark.parametrize("noise", [0.0, 1e-3, 1.0])
def test_a_tilted_map_has_no_axes(tmp_path, noise):
    """Each of its rows rises as evenly as the first."""
    heights = np.add.outer(3.0 * np.arange(SIDE), 5.0 * np.arange(SIDE))
    heights = heights + noise * np.random.default_rng(3).normal(size=heights.shape)
    path = tmp_path / "map.txt"
    path.write_text(table_text(heights), encoding="utf-8")
    assert read_number_matrix(path, "heights").values.shape == (SIDE, SIDE)


@pytest.mark.parametrize(
    ("header", "stated"),
    [("", {"size": 10e-6, "unit": "nm"}), ("x [um]\ty [um]\tz [nm]\n", {})],
)
def test_a_list_of_places_is_a_map(tmp_path, header, stated):
    heights = np.random.default_rng(4).normal(0.0, 2.7, (32, SIDE))
    lines = [f"{10 * j / SIDE:.6f}\t{20 * i / SIDE:.6f}\t{heights[i, j]:.5f}"
             for i in range(32) for j in range(SIDE)]  # fmt: skip
    path = tmp_path / "map.xyz"
    path.write_text(header + "\n".join(reversed(lines)) + "\n", encoding="utf-8")
    found = read_height_map(path, **stated)
    assert found.height == pytest.approx(1e-9 * heights, abs=1e-14)
    assert (found.width, found.length) == pytest.approx((10e-6, 10e-6), rel=1e-6)
    path.write_text("\n".join(lines[:-5]) + "\n", encoding="utf-8")
    with pytest.raises(lf.ConfigurationError, match="no full grid of 64 x 32 places"):
        read_height_map(path, size=10e-6, unit="nm")


@pytest.mark.parametrize(
    ("words", "sides"),
    [
        (("Channel", "Width", "Height", "Value units"), ("10.00", "5.00")),
        (("Kanal", "Breite", "Höhe", "Werteinheiten"), ("10.00", "5.00")),
        (("Canal ", "Largeur ", "Hauteur ", "Unités des valeurs "), ("10,00", "5,00")),
    ],
)
def test_gwyddion_writes_its_header_in_the_users_language(tmp_path, words, sides):
    said = ("Topographie", *(f"{side} µm" for side in sides), "m")
    head = "".join(f"# {word}: {text}\n" for word, text in zip(words, said, strict=True))
    heights = surface((20, 40))
    body = "\n".join("\t".join(f"{one:.9e}" for one in row) for row in heights)
    (tmp_path / "map.txt").write_text(head + body + "\n", encoding="utf-8")
    found = read_height_map(tmp_path / "map.txt")
    assert found.channel == "Topographie"
    assert (found.width, found.length) == pytest.approx((10e-6, 5e-6))
    assert found.height == pytest.approx(heights, abs=1e-14)


def test_channels_of_one_name_are_listed_as_they_are_chosen(tmp_path, monkeypatch):
    twice = [Channel("Height", "m", SHAPE, 1e-6, 1e-6, lambda at=at: np.full(SHAPE, at))
             for at in (1.0, 2.0)]  # fmt: skip
    monkeypatch.setattr(
        "lightflyer.lab.readers.height_map.find_format",
        lambda *_: Format("twins", lambda _: True, lambda _: twice),
    )
    path = tmp_path / "map.xyz"
    path.write_text("twins", encoding="utf-8")
    names = [one.name for one in list_channels(path)]
    assert names == ["Height", "Height (2)"]
    assert choose_channel(path, twice, names[1])[0].read()[0, 0] == 2.0


def test_a_size_that_is_not_the_files(tmp_path):
    path = tmp_path / "map.txt"
    rows = "\n".join("\t".join(f"{one:.6g}" for one in row) for row in 1e9 * surface((20, 20)))
    head = "# Channel: z\n# Width: 5 µm\n# Height: 5 µm\n# Value units: nm\n"
    path.write_text(head + rows + "\n", encoding="utf-8")
    found = read_height_map(path, size=5e-3)
    assert found.width == 5e-3
    assert "its width is 5000 µm as stated by --size; the file says 5 µm" in found.notes
    assert not read_height_map(path).notes
    assert not read_height_map(path, size=5e-6).notes  # told as another size
