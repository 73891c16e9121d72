"""Names of the last release serve for one more, with a warning."""

import operator

import pytest

import lightflyer as lf


@pytest.mark.parametrize(("old", "new"), lf.RENAMED.items())
def test_old_names_warn_and_serve(old, new):
    with pytest.warns(FutureWarning, match=rf"lightflyer\.{old} is now lightflyer\.{new}"):
        found = getattr(lf, old)
    assert found is operator.attrgetter(new)(lf)
    assert old not in dir(lf)


def test_other_names_are_none():
    with pytest.raises(AttributeError, match="flihgt"):
        _ = lf.flihgt


def test_predict_moved_and_serves_where_it_was():
    with pytest.warns(FutureWarning, match=r"is now lightflyer\.predict"):
        assert lf.prediction.predict is lf.predict
