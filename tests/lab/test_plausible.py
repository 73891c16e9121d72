"""Numbers that are unlikely, or do not fit what is stated, are told, and written on demand only."""

import numpy as np
import pytest

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab.record import Doubt, joint_warnings, require_no_doubt
from lightflyer.lab.thermography.data import LIGHT, THERMAL, read_readings
from lightflyer.lab.thermography.reduction import reduce_readings


def reduce(folder, method, header, *rows):
    path = folder / "readings.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return reduce_readings(read_readings(path, method)[0])


def doubts(found):
    return [one for one in found.warnings if isinstance(one, Doubt)]


METER = "incident [{}],reflected [W],transmitted [W],dark [W]"


def test_a_unit_of_its_own_in_each_column(tmp_path):
    """By hand: (0.2717 - 0.0121)/(1.7323 - 0.0121) = 0.1509 and 0.1712/1.7202 = 0.0995."""
    row = "1732.3,0.2717,0.1833,0.0121"
    right = reduce(tmp_path, LIGHT, METER.format("mW"), row)
    assert right.emissivity.value == pytest.approx(1 - 0.2596 / 1.7202 - 0.1712 / 1.7202)
    assert not doubts(right)
    (doubt,) = doubts(reduce(tmp_path, LIGHT, METER.format("W"), row))
    assert "absorptivity 0.9998 is unlikely" in doubt
    assert "is it in mW and they in W?" in doubt


def test_what_is_in_doubt_is_written_on_demand_only(tmp_path):
    warnings = joint_warnings([("a.csv", ["plain"]), ("b.csv", [Doubt("off")])])
    with pytest.raises(ConfigurationError, match=r"b\.csv: off; --insist writes it all the same"):
        require_no_doubt(tmp_path / "flyer.toml", warnings, insist=False)
    require_no_doubt(tmp_path / "flyer.toml", warnings, insist=True)
    require_no_doubt(tmp_path / "flyer.toml", ["plain"], insist=False)


def test_a_meter_may_read_below_zero_in_the_dark(tmp_path):
    head = METER.format("W")
    found = reduce(tmp_path, LIGHT, head, "1.7323,0.2717,0.1833,-0.0003")
    assert found.emissivity.value == pytest.approx(1 - (0.2720 + 0.1836) / 1.7326)
    with pytest.raises(ConfigurationError, match="is its sign right"):
        reduce(tmp_path, LIGHT, head, "1.7323,0.2717,0.1833,-0.5")


CAMERA = (
    "hotplate_temperature [C],lower_temperature [C],upper_temperature [C],ambient_temperature [C]"
)


def test_surroundings_that_were_not_logged(tmp_path):
    assert not doubts(reduce(tmp_path, THERMAL, CAMERA, "150,60,55,22"))
    (doubt,) = doubts(reduce(tmp_path, THERMAL, CAMERA, "150,60,55,0", "150,60,55,0"))
    assert "0 °C is what loggers write where no sensor is connected" in doubt


def test_an_emissivity_of_nothing_is_in_doubt(tmp_path):
    """Lower and upper together show all of the hotplate."""
    found = reduce(tmp_path, THERMAL, CAMERA, "150,99,99,22")
    assert any("emissivity" in one and "is unlikely" in one for one in doubts(found))


def test_rows_farther_apart_than_their_accuracy(tmp_path):
    rows = [f"150,{lower},55,22" for lower in (45, 60, 100, 110)]
    assert "varies by" in doubts(reduce(tmp_path, THERMAL, CAMERA, *rows))[0]
    rng = np.random.default_rng(1)
    rows = [f"150,{60 + rng.normal():.2f},55,22" for _ in range(4)]
    assert not doubts(reduce(tmp_path, THERMAL, CAMERA, *rows))
