"""Words that the commands of levitation points share."""

import math


def open_interval_text(low: float, high: float) -> str:
    """An interval of a positive number in words; zero and infinity are open ends."""
    if math.isinf(high):
        return f"above {low:.4g}" if low > 0.0 else "unknown"
    return f"{low:.4g} to {high:.4g}" if low > 0.0 else f"below {high:.4g}"
