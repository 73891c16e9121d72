"""Sweeps on chosen devices; several of them are simulated in a process of its own."""

import json
import os
import subprocess
import sys

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.sweeps.devices import find_devices

DEVICES = 4

PROGRAM = """
import json, sys
import jax, numpy as np
import lightflyer as lf
from lightflyer.flight.design import as_design
from lightflyer.sweeps.evaluation import Evaluator, _kernel
from lightflyer.sweeps.study import make_study

film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
disk = lf.Disk(film, radius=0.01)
over = {"altitude": {"from": "20 km", "to": "90 km", "points": 7},
        "flyer.radius": {"from": "1 mm", "to": "5 cm", "points": 11}}
design = as_design(disk, lf.lu2023_earth(), lf.Lu2023())
study = make_study(design, over, ("lift_over_weight", "temperature"))
found = []
for device in (None, "cpu"):
    evaluate = Evaluator(study, device)
    evaluate.batch = 30  # neither a divisor of the designs nor a multiple of the devices
    outputs, failures = evaluate(0, study.size)
    found.append({name: column.tolist() for name, column in outputs.items()} | {"bad": failures})
kernel = _kernel(study.design, study.outputs, tuple(study.fixed.items()), "cpu")
json.dump({"found": found, "parts": kernel.parts}, sys.stdout)
"""


def test_several_devices_find_what_one_does():
    flags = f"{os.environ.get('XLA_FLAGS', '')} --xla_force_host_platform_device_count={DEVICES}"
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"XLA_FLAGS": flags},
    )
    answer = json.loads(run.stdout)
    assert answer["parts"] == DEVICES
    one, several = answer["found"]
    assert one["bad"] == several["bad"] == 0
    for name, column in one.items():
        np.testing.assert_allclose(several[name], column, rtol=1e-12)
        assert np.unique(np.abs(column)).size > 1 or name == "bad"


@pytest.mark.skipif(jax.default_backend() == "gpu", reason="there is a GPU")
def test_a_gpu_that_is_not_there_is_one_line_and_nothing_is_written(tmp_path):
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    made = lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023()
    out = tmp_path / "out.zarr"
    with pytest.raises(ConfigurationError, match=r'device gpu: .*install "jax\[cuda13\]"') as error:
        lf.sweep(*made, over={"altitude": ["70 km"]}, out=out, device="gpu")
    assert "\n" not in str(error.value)
    assert not out.exists()


def test_an_unknown_device_names_those_there_are():
    with pytest.raises(ConfigurationError, match="device tpu: is not one of cpu, gpu"):
        find_devices("tpu")
