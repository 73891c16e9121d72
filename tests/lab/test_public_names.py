import pkgutil
from pathlib import Path

import lightflyer.lab


def test_every_public_name_can_be_used():
    stub = Path(lightflyer.lab.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    listed = [line.rpartition(" as ")[2] for line in stub.splitlines()]
    assert "fit_tac" in listed
    assert sorted(listed) == sorted(lightflyer.lab.__all__)
    for name in listed:
        assert getattr(lightflyer.lab, name) is not None


def test_no_public_name_is_a_module_too():
    modules = {
        module.name.rpartition(".")[2]
        for module in pkgutil.walk_packages(lightflyer.lab.__path__, "lightflyer.lab.")
    }
    assert {"surface", "tac"} <= modules
    assert not modules & set(lightflyer.lab.__all__)
