"""Absorbed powers of particles from files."""

import numpy as np
import pytest

from lightflyer import ConfigurationError, ParameterError
from lightflyer.film import read_absorbed_powers

HEADER = "x y z |E|^2 Ex.r Ex.i Ey.r Ey.i Ez.r Ez.i"


def grid(cells):
    """Middles of the cells of a sphere of radius 1, and their step."""
    middle = (np.arange(cells) + 0.5) * 2.0 / cells - 1.0
    points = np.stack(np.meshgrid(middle, middle, middle), axis=-1).reshape(-1, 3)
    return points[np.sum(points**2, axis=1) <= 1.0]


def write(path, points, q, header="x y z q"):
    extra = " 0 0 0 0 0 0" if "Ex" in header else ""
    rows = (
        " ".join(f"{value:.10g}" for value in (*point, one)) + extra
        for point, one in zip(points, q, strict=True)
    )
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def test_sources_linear_in_height(tmp_path):
    """With q = 1 - b z along the light, the mean of z is -b a²/5: J₁/Q = 3 b a/20."""
    points = grid(40)
    found = read_absorbed_powers(write(tmp_path / "q.txt", 3.7 * points, 1.0 - 0.6 * points[:, 2]))
    assert found.asymmetry == pytest.approx(3 * 0.6 / 20, rel=2e-3)
    # the mean of cos θ is -b a/4
    assert found.asymmetry_without_conduction == pytest.approx(3 * 0.6 / 16, rel=2e-3)
    np.testing.assert_allclose(found.sideways, 0.0, atol=1e-12)


def test_light_from_elsewhere_and_shifted_points(tmp_path):
    points = grid(20)
    q = 1.0 + 0.5 * points[:, 0]
    path = write(tmp_path / "q.txt", points + np.array([3.0, -1.0, 0.2]), q)
    along = read_absorbed_powers(path, propagation=(2.0, 0.0, 0.0))
    across = read_absorbed_powers(path)
    assert along.asymmetry == pytest.approx(-3 * 0.5 / 20, rel=0.01)
    assert across.asymmetry == pytest.approx(0.0, abs=1e-12)
    assert across.sideways[0] == pytest.approx(-along.asymmetry, rel=1e-12)


def test_light_of_two_polarisations_is_their_mean(tmp_path):
    """From files of |E|² of a field solver, whose points need not stand in one order."""
    points = grid(20)
    uneven = 0.3 * (points[:, 0] ** 2 - points[:, 1] ** 2)
    path = write(tmp_path / "IntField-Y", points, 1.0 - 0.6 * points[:, 2] + uneven, HEADER)
    turned = 1.0 - 0.2 * points[::-1, 2] - uneven[::-1]
    other = write(tmp_path / "IntField-X", points[::-1], turned, HEADER)
    for files, slope in (((path,), 0.6), ((path, other), 0.4)):
        assert read_absorbed_powers(*files).asymmetry == pytest.approx(3 * slope / 20, rel=0.01)


def test_bad_files_are_refused_in_a_line(tmp_path):
    points = grid(6)
    good = write(tmp_path / "good.txt", points, np.ones(len(points)))
    moved = points.copy()
    moved[3, 1] += 0.1
    shorter = points[:-1]
    cases = {
        "cubic grid": write(tmp_path / "1", moved, np.ones(len(points))),
        "repeats the point": write(tmp_path / "2", [*points, points[0]], np.ones(len(points) + 1)),
        "no point absorbs": write(tmp_path / "3", points, np.zeros(len(points))),
        ":2: q = -1": write(tmp_path / "4", points, np.r_[-1.0, np.ones(len(points) - 1)]),
        "q": write(tmp_path / "5", points, np.ones(len(points)), "x y z power"),
        "no rows": write(tmp_path / "6", points[:0], points[:0, 0]),
        "nothing.txt": tmp_path / "nothing.txt",
    }  # fmt: skip
    for said, path in cases.items():
        with pytest.raises(ConfigurationError, match=said) as error:
            read_absorbed_powers(path)
        assert "\n" not in str(error.value)
    other = write(tmp_path / "7", shorter, np.ones(len(shorter)))
    with pytest.raises(ConfigurationError, match="other points"):
        read_absorbed_powers(good, other)
    for direction in ((0, 0, 0), (1, 2)):
        with pytest.raises(ParameterError, match="propagation"):
            read_absorbed_powers(good, propagation=direction)
    with pytest.raises(ParameterError, match="path"):
        read_absorbed_powers()
