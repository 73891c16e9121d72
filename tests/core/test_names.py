"""Names of the package: short help, and the nearest one to a slip."""

import operator
import pydoc

import pytest

import lightflyer as lf


@pytest.mark.parametrize(
    ("owner", "name", "says"),
    [
        (lf, "predct", "lightflyer has no predct; did you mean lightflyer.predict?"),
        (lf, "kinetc", "did you mean lightflyer.Kinetic?"),
        (lf, "Film", "lightflyer has no Film; it is lightflyer.film.Film"),
        (lf, "steady_drift", "it is lightflyer.mission.steady_drift"),
        (lf.film, "materal", "did you mean lightflyer.film.material?"),
        (lf.force, "xyzzy", "lightflyer.force has no xyzzy"),
    ],
)
def test_a_wrong_name_is_told_the_nearest(owner, name, says):
    with pytest.raises(AttributeError) as caught:
        getattr(owner, name)
    assert str(caught.value).endswith(says)


@pytest.mark.parametrize(("old", "new"), lf.RENAMED.items())
def test_names_of_the_last_release_warn_and_serve(old, new):
    with pytest.warns(FutureWarning, match=rf"lightflyer\.{old} is now lightflyer\.{new}"):
        found = getattr(lf, old)
    assert found is operator.attrgetter(new)(lf)
    assert old not in dir(lf)


def test_predict_moved_and_serves_where_it_was():
    with pytest.warns(FutureWarning, match=r"is now lightflyer\.predict"):
        assert lf.prediction.predict is lf.predict


def test_help_is_a_screen_or_two():
    text = pydoc.plain(pydoc.render_doc(lf))
    assert len(text) < 4000
    assert "lf.predict(disk, lf.Earth(), lf.Kinetic())" in text


def test_all_names_can_be_imported_at_once():
    space = {}
    exec("from lightflyer import *", space)
    assert {*lf.__all__} <= {*space}
    assert {*lf.__all__} <= {*dir(lf)}
    assert not hasattr(lf, "__wrapped__")  # as inspect asks of anything
