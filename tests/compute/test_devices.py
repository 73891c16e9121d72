"""Sweeps on chosen devices; several of them are simulated in a process of its own."""

import json
import os
import subprocess
import sys

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.compute.evaluation import find_devices
from lightflyer.core.errors import ConfigurationError

DEVICES = 4

PROGRAM = """
import json, sys
import jax, numpy as np
import lightflyer as lf
from lightflyer.config.designs import as_design
from lightflyer.compute.evaluation import Evaluator
from lightflyer.study.study import make_study

film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
disk = lf.Disk(film, radius=0.01)
over = {"altitude": {"from": "20 km", "to": "90 km", "points": 7},
        "flyer.radius": {"from": "1 mm", "to": "5 cm", "points": 11}}
design = as_design(disk, lf.lu2023_earth(), lf.Lu2023())
study = make_study(design, over, ("lift_over_weight", "temperature"))
found = []
for device in (None, "cpu"):  # by NumPy, and by XLA on all of them
    evaluate = Evaluator(study, device)
    evaluate.batch = 30  # neither a divisor of the designs nor a multiple of the devices
    outputs, failures = evaluate(0, study.size)
    found.append({name: column.tolist() for name, column in outputs.items()} | {"bad": failures})
json.dump({"found": found, "parts": evaluate._kernel().parts}, sys.stdout)
"""


def on_several(program):
    """What a program prints as JSON in a process with several simulated devices."""
    flags = f"{os.environ.get('XLA_FLAGS', '')} --xla_force_host_platform_device_count={DEVICES}"
    run = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env=os.environ | {"XLA_FLAGS": flags},
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def test_several_devices_find_what_numpy_does():
    answer = on_several(PROGRAM)
    assert answer["parts"] == DEVICES
    here, several = answer["found"]
    assert here["bad"] == several["bad"] == 0
    for name, column in here.items():
        np.testing.assert_allclose(several[name], column, rtol=1e-9)
        assert np.unique(np.abs(column)).size > 1 or name == "bad"


@pytest.mark.skipif(jax.default_backend() == "gpu", reason="there is a GPU")
def test_a_gpu_that_is_not_there_is_one_line_and_nothing_is_written(tmp_path, film):
    made = lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023()
    out = tmp_path / "out.zarr"
    with pytest.raises(ConfigurationError, match=r'device gpu: .*install "jax\[cuda13\]"') as error:
        lf.sweep(*made, over={"altitude": ["70 km"]}, out=out, device="gpu")
    assert "\n" not in str(error.value)
    assert not out.exists()


def test_an_unknown_device_names_those_there_are():
    with pytest.raises(ConfigurationError, match="device tpu: is not one of cpu, gpu"):
        find_devices("tpu")


def test_a_sweep_on_gpus_is_that_of_processors(monkeypatch, film):
    """With processors in the place of GPUs."""
    made = lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023()
    over = {"altitude": {"from": "60 km", "to": "90 km", "points": 31}}
    asked = {"over": over, "outputs": ("payload", "temperature")}
    here = lf.sweep(*made, **asked)
    processors = jax.local_devices(backend="cpu")
    monkeypatch.setattr(jax, "local_devices", lambda backend: processors)
    there = lf.sweep(*made, **asked, device="gpu")
    assert there.attrs["not_converged"] == 0
    np.testing.assert_allclose(there.payload, here.payload, 1e-8)
    np.testing.assert_allclose(there.temperature, here.temperature, 1e-10)
