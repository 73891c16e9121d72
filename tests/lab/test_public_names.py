import pkgutil

import lightflyer.lab


def test_no_public_name_is_a_module_too():
    modules = {
        module.name.rpartition(".")[2]
        for module in pkgutil.walk_packages(lightflyer.lab.__path__, "lightflyer.lab.")
    }
    assert {"surface", "tac"} <= modules
    assert not modules & set(lightflyer.lab.__all__)
