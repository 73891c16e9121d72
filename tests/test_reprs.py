"""Whatever a session shows of a public record is short."""

import dataclasses
import enum
import inspect

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer import cli
from lightflyer.array.records import Module, ShortRepr
from lightflyer.files.result_text import PrintedResult
from lightflyer.files.section import Section

LONGEST = 500  # characters
ROOMS = [getattr(lf, name) for name in lf.__all__ if inspect.ismodule(getattr(lf, name))]
SHORT = (Module, PrintedResult, ShortRepr, Section, enum.Enum, BaseException)


def public_classes():
    every = (getattr(room, name) for room in [lf, *ROOMS] for name in getattr(room, "__all__", ()))
    return sorted({one for one in every if inspect.isclass(one)}, key=lambda kind: kind.__name__)


def is_short(kind):
    """By one of a few ways to show itself, which are tried below, or by plain fields."""
    if issubclass(kind, tuple):
        known = inspect.get_annotations(kind, eval_str=False).values()
        plain = all("Array" not in str(one) and "ndarray" not in str(one) for one in known)
        return plain or "short_repr" in kind.__repr__.__code__.co_names
    if issubclass(kind, Module | PrintedResult | ShortRepr):
        bases = [base for base in kind.__mro__ if "__repr__" in vars(base)]
        return bases[0].__module__.startswith("lightflyer")
    return issubclass(kind, SHORT) or "__repr__" in vars(kind) or kind.__repr__ is object.__repr__


def test_every_public_class_shows_itself_shortly():
    kinds = public_classes()
    assert len(kinds) > 150
    assert [kind.__name__ for kind in kinds if not is_short(kind)] == []
    generated = [kind for kind in kinds if dataclasses.is_dataclass(kind)]
    assert all(kind.__repr__.__module__.startswith("lightflyer") for kind in generated)


def test_large_records_are_told_by_their_ends(rng, film):
    disk = lf.Disk(film, radius=np.linspace(1e-3, 2e-2, 500))
    assert "radius=<float64 (500,), 0.001 to 0.02>" in repr(disk)
    places = {"altitude": np.linspace(6e4, 8e4, 20), "latitude": np.linspace(-60.0, 60.0, 40)}
    east = xr.DataArray(rng.normal(size=(20, 40)), places, attrs={"units": "m/s"})
    east["altitude"].attrs["units"] = "m"
    wind = lf.environment.GriddedWind(xr.Dataset({"u": east, "v": east}))
    heights = lf.lab.HeightMap("x.ibw", rng.normal(size=(512, 512)), 1e-5, 1e-5)
    earth = lf.Earth(wind=wind)
    light = lf.equilibrium(disk, earth.state(72e3), lf.Lu2023())
    for record in (disk, wind, heights, earth, lf.Setup(disk, earth, lf.Kinetic())):
        assert len(repr(record)) < LONGEST
        assert repr(record).startswith(f"{type(record).__name__}(")
    assert len(repr(light)) < 4 * LONGEST


@pytest.mark.parametrize(
    "kind", ["earth", "layers", "sandwich", "balloon", "hollow", "plate", "particle"]
)
def test_flyer_files_and_what_they_describe(kind, tmp_path):
    path = tmp_path / "flyer.toml"
    with pytest.raises(SystemExit, match="0"):
        cli.main(["init", str(path), "--kind", kind])
    file = lf.read_flyer_file(path)
    assert len(repr(file)) < 4 * LONGEST
    setup = file.build()
    for record in (setup, setup.flyer, setup.environment, setup.model, *file.parts().values()):
        assert len(repr(record)) < 2 * LONGEST


def test_only_what_is_not_usual_is_shown():
    assert repr(lf.Kinetic()) == "Kinetic()"
    assert repr(lf.Kinetic(wall="maxwell")) == "Kinetic(wall='maxwell')"
    assert repr(lf.Measured(0.9, 0.03)) == "Measured(value=0.9, uncertainty=0.03)"
