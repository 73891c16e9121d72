"""Prediction of one flyer: bands, tables, figures."""

import sys
import warnings

from lightflyer.core import attach

_find, __dir__, __all__ = attach(__name__, __file__)


def __getattr__(name):  # type: ignore[no-untyped-def]
    if name == "predict":  # it goes with the next but one release
        text = "lightflyer.prediction.predict is now lightflyer.predict"
        warnings.warn(f"{text}; the old name goes with the next release", FutureWarning, 2)
        return sys.modules["lightflyer"].predict
    return _find(name)
