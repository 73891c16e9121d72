"""Types shared by the package's signatures."""

from typing import Any, TypeAlias

Numeric: TypeAlias = Any  # A number, a NumPy array or a JAX array. Arguments of one call broadcast
