import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

import lightflyer as lf
from lightflyer.lab.height_map import HeightMap, read_height_map
from lightflyer.lab.surface import (
    find_particles,
    level,
    roughness,
    summary,
    surface_parameters,
)
from lightflyer.lab.synthetic.surface import (
    igor_wave,
    random_surface,
    roughness_files,
    with_particles,
)

SIDE = 10e-6


def of(height):
    return HeightMap("synthetic", height, SIDE, SIDE)


def test_parameters_of_an_independent_package():
    y, x = np.mgrid[0:96, 0:128].astype(float)
    z = 20 * np.sin(0.37 * x + 0.11 * y) + 35 * np.cos(0.05 * x * y / 7) ** 3
    z += 12 * np.exp(np.sin(0.21 * y))
    # Sq, Sa, Ssk and Sku that surfalize 0.19.2 gives for this map
    independent = [25.981873685403425, 21.009209860910698, 0.04801005119334642, 2.656267056301951]
    np.testing.assert_allclose(surface_parameters(z), independent, rtol=1e-6)
    assert surface_parameters(z)[2] == pytest.approx(stats.skew(z.ravel()))
    assert surface_parameters(z)[3] == pytest.approx(stats.kurtosis(z.ravel(), fisher=False))


def test_a_tilted_bowed_plane_is_flat():
    y, x = np.mgrid[0:80, 0:120]
    height = 1e-6 + 3e-9 * x - 5e-9 * y + 2e-11 * x**2 + 3e-11 * x * y - 1e-11 * y**2
    found = roughness(of(height))
    assert found.parameters["rms_height"].value < 1e-9  # nm, of a map 1 µm high
    assert found.masked_fraction.value == 0.0
    tilted = level(height, order=1)
    assert surface_parameters(tilted)[0] > 1e-10  # a plane leaves the bow


@pytest.mark.parametrize("seed", range(4))
def test_particles_do_not_count(seed):
    # fine enough that the places under the particles do not matter: they hide 3 % of the surface
    rng = np.random.default_rng(seed)
    clean = random_surface(rng, pixels=800)
    y, x = np.mgrid[-1:1:800j, -1:1:800j]
    bowed = 4e-7 * x - 3e-7 * y + 1e-7 * x**2
    found = roughness(of(with_particles(clean, rng, 12) + bowed))
    assert found.parameters["rms_height"].value == pytest.approx(34.8, abs=0.2)
    assert found.parameters_all["rms_height"].value > 38.0
    low, high = found.parameters["rms_height"].interval
    assert low < 34.8 < high
    assert 0.01 < found.masked_fraction.value < 0.06
    # a surface without particles is not cut
    untouched = roughness(of(clean))
    assert untouched.masked_fraction.value < 1e-3


def test_mask_is_where_the_particle_is(rng):
    clean = random_surface(rng)
    dirty = clean.copy()
    dirty[100:110, 50:70] += 1e-6
    _, mask = find_particles(dirty)
    assert mask[100:110, 50:70].all()
    outside = mask.copy()
    outside[90:120, 40:80] = False
    assert not outside.any()


def test_units_and_scales(rng):
    one = roughness(of(random_surface(rng)))
    ten = roughness(of(10.0 * one.source.height))
    value = one.parameters["rms_height"].value
    assert value == pytest.approx(1e9 * one.height.std(), rel=1e-9)
    assert ten.parameters["rms_height"].value == pytest.approx(10.0 * value)
    assert ten.parameters["kurtosis"].value == pytest.approx(one.parameters["kurtosis"].value)
    assert one.summary()["rms_height"]["unit"] == "nm"


def test_intervals_cover_another_place():
    # interval of one quarter of a wide surface against the rms height of all of it
    inside, count = 0, 40
    for seed in range(count):
        wide = random_surface(np.random.default_rng(seed), pixels=256)
        found = roughness(of(wide[:128, :128]), order=0)
        low, high = found.parameters["rms_height"].interval
        inside += low <= 34.8 <= high
    assert 0.85 <= inside / count <= 1.0


def test_many_particles_are_warned_of(rng):
    with pytest.warns(lf.ParameterWarning, match="is masked as particles"):
        roughness(of(with_particles(random_surface(rng), rng, 60)))


def test_several_maps_are_averaged(rng):
    maps = [roughness(of(random_surface(rng, rms_height=height * 1e-9))) for height in (30.0, 40.0)]
    found = summary(maps)
    assert found["rms_height"]["value"] == pytest.approx(35.0, rel=1e-3)


def write(tmp_path, content, name="map.txt"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_formats_agree(tmp_path, rng):
    height = random_surface(rng, pixels=32) + 1e-6
    igor = read_height_map(write(tmp_path, igor_wave(height, SIDE, "note"), "map.ibw"))
    np.testing.assert_allclose(igor.height, height, rtol=1e-6)
    assert igor.channel == "HeightRetrace"
    assert (igor.width, igor.length) == pytest.approx((SIDE, SIDE))
    assert not read_height_map(tmp_path / "map.ibw", channel="amplituderetrace").height.any()
    for delimiter, comma in ((",", False), ("\t", True), (" ", False), (";", True)):
        text = "\n".join(delimiter.join(f"{1e9 * v:.6f}" for v in row) for row in height)
        text = text.replace(".", ",") if comma else text
        found = read_height_map(write(tmp_path, text), size=SIDE, unit="nm")
        np.testing.assert_allclose(found.height, height, rtol=1e-6)
    with pytest.raises(lf.ConfigurationError, match="choose one by --channel: HeightRetrace"):
        read_height_map(tmp_path / "map.ibw", channel="phase")


def test_example_files_are_read(tmp_path):
    for name, content in roughness_files(1).items():
        found = read_height_map(write(tmp_path, content, name))
        assert found.height.shape == (256, 256)
        assert (found.width, found.length) == pytest.approx((SIDE, SIDE))
        assert 34.0 < roughness(found).parameters["rms_height"].value < 36.0


NOTHING = "\n".join(["nan " * 20] * 20)
ROWS = "\n".join(["1 2 3 4"] * 4)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("m.txt", "", "is empty"),
        ("m.txt", b"\x00\xff\xfe", "is not a text file"),
        ("m.txt", ROWS, "heights have no unit"),
        ("m.txt", "# Value units: m\n" + ROWS, "has no width"),
        ("m.txt", "# Value units: W\n# Width: 1 um\n" + ROWS, "wrong kind"),
        ("m.txt", "# Value units: m\n# Width: 1 um\n" + ROWS, "has 4 x 4 pixels"),
        ("m.txt", ROWS + "\n1 2 x 4", ':5: "x" is not a number'),
        ("m.txt", ROWS + "\n1 2 3", ":5: has 3 heights, the first row has 4"),
        (
            "m.txt",
            "# Value units: m\n# Width: 1 um\n" + "\n".join(["nan " * 20] * 20),
            "400 of its",
        ),
        ("m.ibw", b"", "cannot be read as an Igor wave"),
        ("m.ibw", b"\x05\x00" + b"\x7f" * 500, "cannot be read as an Igor wave"),
        ("m.gwy", b"", "is not a Gwyddion file"),
        ("m.gwy", b"GWYPGwyContainer\x00\xff\xff", "cannot be read as Gwyddion"),
    ],
)
def test_one_clear_line_for_each_mistake(tmp_path, name, content, says):
    path = write(tmp_path, content, name)
    with pytest.raises(lf.ConfigurationError) as error:
        read_height_map(path)
    message = str(error.value)
    assert message.startswith(str(path))
    assert says in message
    assert "\n" not in message


SMALL = np.arange(400.0).reshape(20, 20) * 1e-9
IGOR = igor_wave(SMALL, SIDE, "note")
GWYDDION = roughness_files(0)["germanium.gwy"]


@settings(max_examples=120, deadline=None)
@given(data=st.data())
def test_no_map_gives_a_traceback(tmp_path_factory, data):
    name, whole = data.draw(st.sampled_from([("m.ibw", IGOR), ("m.gwy", GWYDDION)]))
    content = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, min(len(content), 600) - 1))
        content[at : at + data.draw(st.integers(0, 4))] = data.draw(st.binary(max_size=4))
    path = tmp_path_factory.mktemp("fuzz") / name
    path.write_bytes(content[: data.draw(st.sampled_from([len(content), 300, 600]))])
    try:
        found = read_height_map(path)
    except lf.ConfigurationError as error:
        said = str(error)
        assert said.startswith(str(path))
        assert "\n" not in said
        return
    assert np.isfinite(found.height).all()
