"""What a sweep did."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SweepReport:
    """What a sweep into a folder or a file did."""

    designs: int  # Designs of the study
    found: int  # Designs that were already computed
    # Chunks that were computed before and had to be again; none where results are reduced
    damaged: int
    computed: int  # Designs computed now
    not_converged: int  # Designs of the study whose results are NaN because a root-find failed
    seconds: float  # From the first chunk to the last
