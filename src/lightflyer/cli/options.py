"""Options that several commands have, with what they may be."""

from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

MOST_SAMPLES = 1_000_000

Json = Annotated[bool, Parameter(name="--json", negative=())]  # Whether to print JSON
Seed = Annotated[int, Parameter(validator=Number(gte=0, lt=2**63))]  # Seed of random numbers

Samples = Annotated[int, Parameter(validator=Number(gte=0, lte=MOST_SAMPLES))]
"""Number of random samples, which take memory each."""
