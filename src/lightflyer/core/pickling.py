"""Sending objects to other processes, those of classes from a script or notebook included."""

import pickle
from typing import Any


def dumps(value: Any) -> bytes:
    """Pickle an object; :func:`pickle.loads` reads it wherever lightflyer is installed."""
    try:
        import cloudpickle
    except ImportError:
        return pickle.dumps(value)
    found: bytes = cloudpickle.dumps(value)
    return found
