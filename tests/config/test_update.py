import tomllib

import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import read_flyer_file
from lightflyer.config.update import emittance_keys, measured_text, tac_keys, update_flyer_file
from lightflyer.lab.estimate import Estimate

VALUE = Estimate.normal(0.9031, 0.0312)


def test_keeps_comments_and_says_where_from(flyer_file):
    path = flyer_file("tac_top = 0.8\n", "tac_top = 0.8  # a face of glass\n")
    before = path.read_text(encoding="utf-8").splitlines()
    update_flyer_file(path, dict.fromkeys(tac_keys("top"), VALUE), "lab tac, one.csv")
    update_flyer_file(path, dict.fromkeys(tac_keys("top"), VALUE), "lab tac, two.csv")
    after = path.read_text(encoding="utf-8").splitlines()
    changed = [line for line in after if line not in before]
    assert len(changed) == 1
    assert changed[0].startswith('tac_top = "0.903 ± 0.031"')
    assert "a face of glass; measured: lab tac, two.csv, 20" in changed[0]
    assert "one.csv" not in changed[0]
    assert len(after) == len(before)
    read = read_flyer_file(path).film.tac_top
    assert (read.value, read.uncertainty) == (0.903, 0.031)


def test_emittance_of_one_face_splits_that_of_both(flyer_file):
    """Comment and origin go with it."""
    path = flyer_file("# per face", "# mylar too")
    update_flyer_file(path, dict.fromkeys(emittance_keys("bottom"), VALUE), "one")
    text = path.read_text(encoding="utf-8")
    film, lines = (
        tomllib.loads(text)["film"],
        {line.split(" ")[0]: line for line in text.split("\n")},
    )
    assert (film["emittance_top"], film["emittance_bottom"]) == (0.08, "0.903 ± 0.031")
    assert "emittance" not in film
    assert lines["emittance_top"].endswith("# mylar too")
    assert "# mylar too; measured: one, 20" in lines["emittance_bottom"]
    update_flyer_file(path, dict.fromkeys(emittance_keys("both"), VALUE), "two")
    assert read_flyer_file(path).film.emittance.value == 0.903
    update_flyer_file(path, dict.fromkeys(emittance_keys("bottom"), VALUE), "three")
    lines = {line.split(" ")[0]: line for line in path.read_text("utf-8").splitlines()}
    assert "# mylar too; measured: two, 20" in lines["emittance_top"]
    assert "# mylar too; measured: three, 20" in lines["emittance_bottom"]
    assert "two" not in lines["emittance_bottom"]
    update_flyer_file(path, dict.fromkeys(emittance_keys("both"), VALUE), "four")
    text = path.read_text(encoding="utf-8")
    assert '\nemittance = "0.903 ± 0.031"  # mylar too; measured: four, 20' in text


def test_impossible_value_leaves_the_file(flyer_file):
    path = flyer_file()
    before = path.read_bytes()
    with pytest.raises(lf.ConfigurationError, match=r"tac_top.*is unchanged"):
        update_flyer_file(path, {("film", "tac_top"): Estimate.normal(1.9, 0.1)}, "x")
    assert path.read_bytes() == before
    assert [file.name for file in path.parent.iterdir()] == ["flyer.toml"]


@pytest.mark.parametrize(
    ("estimate", "says"),
    [
        (Estimate.normal(0.05, 0.01), "film.tac_top = 0.05 is unlikely, 0.2 to 1.3 is usual"),
        (Estimate.normal(0.9, 0.95), "film.tac_top = 0.9 ± 0.95 is not determined"),
    ],
)
def test_what_is_unlikely_is_written_only_if_one_insists(flyer_file, estimate, says):
    path, values = flyer_file(), {("film", "tac_top"): estimate}
    before = path.read_bytes()
    with pytest.raises(lf.ConfigurationError, match=f"{says}.*--insist.*is unchanged"):
        update_flyer_file(path, values, "x")
    assert path.read_bytes() == before
    update_flyer_file(path, values, "x", insist=True)
    assert f'tac_top = "{measured_text(estimate)}"' in path.read_text(encoding="utf-8")


def test_a_file_without_a_film_is_refused_in_one_line(write):
    text = templates()["sandwich"].read()
    path = write(text, "sandwich.toml")
    with pytest.raises(lf.ConfigurationError) as caught:
        update_flyer_file(path, {("film", "tac_bottom"): VALUE}, "x")
    assert str(caught.value) == (
        f"{path}: has no section [film] to write tac_bottom into; the file is unchanged"
    )
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    ("value", "spread", "text"),
    [
        (0.5, 0.1234, "0.50 ± 0.12"),
        (4.0931, 0.00099, "4.09310 ± 0.00099"),
        (120.4, 12.2, "120 ± 12"),
    ],
)
def test_two_digits_of_the_uncertainty(value, spread, text):
    assert measured_text(Estimate.normal(value, spread)) == text
