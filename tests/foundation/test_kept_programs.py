"""Programs that a later process finds without tracing: the same answers, and never a stale one."""

import equinox as eqx
import jax
import numpy as np
import pytest

from lightflyer.foundation import kept_programs
from lightflyer.foundation.precision import float64


@pytest.fixture
def folder(tmp_path):
    before = jax.config.jax_compilation_cache_dir
    jax.config.update("jax_compilation_cache_dir", str(tmp_path))
    yield tmp_path / "whole"
    jax.config.update("jax_compilation_cache_dir", before)


class Traced:
    """A function that counts how often it is traced."""

    def __init__(self, factor=2.0, module="lightflyer.here"):
        self.count = 0

        def product(pair, power):
            self.count += 1
            return {"value": factor * pair[0] ** power, "sum": pair[0] + pair[1]}

        product.__module__, product.__qualname__ = module, "product"
        self.program = kept_programs.KeptProgram(product, _compile)

    def __call__(self, first, second=1.0, power=3.0):
        with float64():
            found = self.program.find(((np.float64(first), np.float64(second)), np.float64(power)))
            return None if found is None else jax.tree.map(np.asarray, found())


def _compile(function, leaves):
    return jax.jit(function).lower(leaves).compile()


def test_a_second_process_finds_the_program_without_tracing_it(folder):
    first, second = Traced(), Traced()
    one, other = first(1.5), second(1.5)
    assert (first.count, second.count) == (1, 0)
    assert one == other == {"value": 2.0 * 1.5**3, "sum": 2.5}
    assert second(0.1)["value"] == pytest.approx(2.0 * 0.1**3, rel=1e-15)  # not the first answer


def test_another_shape_is_another_program(folder):
    Traced()(1.5)
    later = Traced()
    np.testing.assert_allclose(later([1.0, 2.0])["value"], [2.0, 16.0])
    assert later.count == 1


def test_a_change_of_the_package_is_another_program(folder, monkeypatch):
    Traced(factor=2.0)(1.0)
    monkeypatch.setattr(kept_programs, "_versions", lambda: b"after an upgrade")
    assert Traced(factor=5.0)(1.0)["value"] == 5.0


def test_what_an_upgrade_changes_is_in_the_versions():
    versions = kept_programs._versions().decode()
    for part in (jax.__version__, np.__version__, "kept_programs.py", "kinetic.csv"):
        assert part in versions


def test_a_damaged_file_is_compiled_anew(folder):
    Traced()(1.5)
    (path,) = folder.glob("*.program")
    path.write_bytes(path.read_bytes()[:1000])
    later = Traced()
    assert later(1.5)["sum"] == 2.5
    assert later.count == 1
    again = Traced()
    assert again(1.5)["sum"] == 2.5
    assert again.count == 0


class Elsewhere(eqx.Module):
    number: jax.Array
    power: int = eqx.field(static=True)


def test_code_that_is_not_the_packages_is_never_kept(folder):
    assert Traced(module="somebody.elses")(1.5) is None
    program = Traced().program
    assert program.find((Elsewhere(np.ones(2), 2), np.float64(1.0))) is None
    assert not folder.exists()


def test_nothing_is_kept_without_a_folder():
    assert Traced()(1.5) is None


def test_the_least_used_go_first(folder, monkeypatch):
    Traced()(1.5)
    (old,) = folder.glob("*.program")
    monkeypatch.setattr(kept_programs, "LARGEST", int(1.5 * old.stat().st_size))
    Traced()([1.0, 2.0])
    (left,) = folder.glob("*.program")
    assert left != old
