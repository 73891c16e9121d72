import numpy as np
import pytest
from scipy import ndimage, stats

import lightflyer as lf
from lightflyer.lab.readers.height_map import HeightMap, read_height_map
from lightflyer.lab.surface.heights import find_particles, flatten_rows, level
from lightflyer.lab.surface.reduction import roughness, summary, surface_parameters
from lightflyer.lab.synthetic.spectra import random_surface, roughness_files, with_particles

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
    assert found.masked_fraction == 0.0
    tilted = level(height, order=1)
    assert surface_parameters(tilted)[0] > 1e-10  # a plane leaves the bow


def test_particles_do_not_count():
    # fine enough that the places under the particles do not matter: they hide 3 % of the surface
    rng = np.random.default_rng(0)
    clean = random_surface(rng, pixels=400)
    y, x = np.mgrid[-1:1:400j, -1:1:400j]
    bowed = 4e-7 * x - 3e-7 * y + 1e-7 * x**2
    found = roughness(of(with_particles(clean, rng, 12) + bowed))
    assert found.parameters["rms_height"].value == pytest.approx(34.8, abs=0.5)
    assert found.parameters_all["rms_height"].value > 38.0
    low, high = found.parameters["rms_height"].interval
    assert low < 34.8 < high
    assert 0.01 < found.masked_fraction < 0.06


def test_mask_is_where_the_particle_is(rng):
    clean = random_surface(rng)
    dirty = clean.copy()
    dirty[100:110, 50:70] += 1e-6
    _, mask, holes = find_particles(dirty)
    assert mask[100:110, 50:70].all()
    assert holes.mean() < 3e-3
    outside = mask.copy()
    outside[90:120, 40:80] = False
    assert outside.mean() < 5e-3


def filtered_noise(seed, width, skewness=0.0, pixels=256):
    """Surface of unit variance, of an area wider than the map; gamma-distributed if skewed."""
    wide = pixels + int(10 * width)
    noise = np.random.default_rng(seed).normal(size=(wide, wide))
    normal = ndimage.gaussian_filter(noise, width, mode="wrap")[:pixels, :pixels]
    normal *= 2.0 * np.sqrt(np.pi) * width
    if not skewness:
        return normal
    shape = 4.0 / skewness**2
    return (stats.gamma.isf(stats.norm.sf(normal), shape) - shape) / np.sqrt(shape)


@pytest.mark.parametrize("skewness", [0.97, 1.33, 2.2, -1.33])
@pytest.mark.parametrize("width", [3.0, 10.0])
def test_mask_leaves_a_skewed_surface(skewness, width):
    # a threshold in deviations of what is left of the surface eats its way into the longer tail
    height = np.sign(skewness) * 71.2e-9 * filtered_noise(0, width, abs(skewness), 200)
    found = roughness(of(height))
    rms = found.parameters["rms_height"].value
    assert rms == pytest.approx(1e9 * level(height).std(), rel=0.01)
    assert found.masked_fraction < 0.005


def test_particles_on_a_skewed_surface_are_masked():
    clean = 34.8e-9 * filtered_noise(0, 10.0, 1.0)
    found = roughness(of(with_particles(clean, np.random.default_rng(1), 10)))
    assert found.parameters["rms_height"].value == pytest.approx(1e9 * level(clean).std(), rel=0.03)
    assert found.parameters_all["rms_height"].value > 1.1 * 1e9 * level(clean).std()


@pytest.mark.parametrize("count", [2, 5])
@pytest.mark.parametrize("depth", [-3e-6, 3e-6])
def test_lost_pixels_do_not_count(count, depth, rng):
    height = random_surface(rng, pixels=128)
    places = rng.integers(5, 122, (2, count))
    height[tuple(places)] = depth
    found = roughness(of(height))
    assert found.parameters["rms_height"].value == pytest.approx(34.8, rel=0.01)
    assert found.parameters_all["rms_height"].value > 36.0
    marked = found.holes if depth < 0.0 else found.particles
    assert marked[tuple(places)].all()
    assert found.masked_fraction < 0.01


def test_without_a_mask_all_of_the_map_counts(rng):
    height = with_particles(random_surface(rng, pixels=128), rng, 9)
    found = roughness(of(height), mask="none")
    assert found.masked_fraction == 0.0
    assert found.parameters == found.parameters_all


def test_flattened_rows_have_no_steps(rng):
    clean = with_particles(random_surface(rng, pixels=128), rng, 6)
    lines = 60e-9 * rng.normal(size=128)
    slopes = 2e-10 * rng.normal(size=128)
    shifted = clean + lines[:, None]
    tilted = shifted + slopes[:, None] * np.arange(128)
    truth = roughness(of(clean)).parameters["rms_height"].value
    raw = roughness(of(shifted))
    assert any("--flatten rows" in text for text in raw.warnings)
    assert raw.parameters["rms_height"].value > 1.3 * truth
    flat = roughness(of(shifted), flatten="rows")
    assert flat.parameters["rms_height"].value == pytest.approx(truth, rel=0.05)
    assert not any("--flatten rows" in text for text in flat.warnings)
    both = roughness(of(tilted), flatten="rows", flatten_order=1)
    assert both.parameters["rms_height"].value == pytest.approx(truth, rel=0.07)
    steps = np.median(np.diff(flatten_rows(tilted, 1), axis=0), axis=1)
    assert np.abs(steps).max() < 1e-15


def test_accuracy_of_the_heights_is_in_the_interval(rng):
    one = of(random_surface(rng, pixels=128))
    width = {}
    for accuracy in (0.0, 0.02, 0.10):
        low, high = (
            roughness(one, mask="none", height_accuracy=accuracy).parameters["rms_height"].interval
        )
        width[accuracy] = (high - low) / 34.8
    assert width[0.10] == pytest.approx(np.hypot(width[0.0], 2 * 1.96 * 0.10), rel=0.05)
    maps = [
        roughness(of(random_surface(rng, pixels=128)), mask="none", height_accuracy=0.10)
        for _ in range(3)
    ]
    low, high = summary(maps)["rms_height"]["interval_95"]
    assert high - low > 34.8 * 2 * 1.96 * 0.10 * 0.95  # common to all maps


def test_few_patches_and_levelling_are_said():
    found = roughness(of(34.8e-9 * filtered_noise(3, 25.0)))
    assert any("levelling took about" in text for text in found.warnings)
    low, high = found.parameters["rms_height"].interval
    assert low < 34.8 < high
    assert high / low > 1.5
    assert summary([found])["warnings"] == list(found.warnings)


def test_a_cut_or_skewed_surface_is_said():
    height = np.minimum(filtered_noise(0, 3.0, pixels=128), 1.0) * 1e-8
    assert any("exactly the highest" in text for text in roughness(of(height)).warnings)
    skewed = roughness(of(1e-8 * filtered_noise(0, 3.0, 2.0)))
    assert any("is skewed" in text for text in skewed.warnings)


@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (1e3, True), (1e-3, True)])
def test_heights_of_a_wrong_unit_are_doubted(rng, factor, said):
    found = roughness(of(factor * 2e-8 * rng.normal(size=(64, 64))))
    assert any("check --size and --unit" in text for text in found.warnings) == said
    with pytest.raises(lf.ConfigurationError, match="synthetic: all heights are equal"):
        roughness(of(np.full((40, 40), 1e-6)))


def test_units_and_scales(rng):
    one = roughness(of(random_surface(rng, pixels=128)))
    ten = roughness(of(10.0 * one.source.height))
    value = one.parameters["rms_height"].value
    assert value == pytest.approx(1e9 * one.height[~one.mask].std(), rel=1e-9)
    assert ten.parameters["rms_height"].value == pytest.approx(10.0 * value)
    assert ten.parameters["kurtosis"].value == pytest.approx(one.parameters["kurtosis"].value)
    assert one.summary()["rms_height"]["unit"] == "nm"


def test_what_levelling_takes_is_given_back():
    """A third of the power of so long waves; on average it is known, and in every interval."""
    powers, whole, above = [], [], 0
    for seed in range(25):
        height = 10e-9 * filtered_noise(seed, 12.0, pixels=128)
        found = roughness(of(height), mask="none", height_accuracy=0.0)
        rms = found.parameters["rms_height"]
        powers.append((rms.value / 10.0) ** 2)
        whole.append(powers[-1] * (1.0 + found.lost))
        above += rms.interval[1] < 10.0
    assert np.mean(powers) < 0.7
    assert np.mean(whole) == pytest.approx(1.0, abs=0.15)
    assert above <= 3


def test_many_particles_are_warned_of(rng):
    found = roughness(of(with_particles(random_surface(rng, pixels=128), rng, 60)))
    assert any("of the map is masked" in text for text in found.warnings)


def test_a_mask_given_may_leave_out_nothing_but_not_most(rng):
    height = random_surface(rng, pixels=128)
    mask = np.zeros(height.shape, bool)
    assert any("mask given is empty" in text for text in roughness(of(height), mask=mask).warnings)
    with pytest.raises(lf.ConfigurationError, match="leaves out more than 90% of the map"):
        roughness(of(height), mask=~mask)


def test_several_maps_are_averaged(rng):
    maps = [
        roughness(of(random_surface(rng, pixels=128, rms_height=height * 1e-9)))
        for height in (30.0, 40.0)
    ]
    found = summary(maps)
    assert found["rms_height"]["value"] == pytest.approx(35.0, rel=1e-2)
    # Student's factor for two maps
    ends = np.log([one.parameters["rms_height"].interval for one in maps]).mean(axis=1)
    accuracy = max(one.height_accuracy for one in maps)
    half = np.hypot(stats.t.ppf(0.975, 1) * ends.std(ddof=1) / np.sqrt(2.0), 1.96 * accuracy)
    expected = np.exp(ends.mean() + half * np.array([-1.0, 1.0]))
    assert found["rms_height"]["interval_95"] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("width", [10.0, 25.0])
def test_intervals_are_of_the_surface_of_which_a_map_is_a_part(width):
    """Unlevelled, wider than the map; intervals by tiles of the map held 69 and 18 % of these."""
    errors = []
    for seed in range(12):
        found = roughness(of(34.8e-9 * filtered_noise(seed, width)), mask="none",
                          height_accuracy=0.0)  # fmt: skip
        low, high = np.log(found.parameters["rms_height"].interval)
        errors.append(1.96 * (2.0 * np.log(34.8) - low - high) / (high - low))
    assert np.sqrt(np.mean(np.square(errors))) < 1.6


def test_example_files_are_read(write):
    for name, content in roughness_files(1).items():
        found = read_height_map(write(content, name))
        assert found.height.shape == (256, 256)
        assert (found.width, found.length) == pytest.approx((SIDE, SIDE))
        assert surface_parameters(level(found.height))[0] > 34e-9  # with its particles
