"""Large numbers as people say them."""

_SCALE = 1000.0
_WORDS = ("", "thousand", "million", "billion", "trillion")
_PREFIXES = ("", "k", "M", "G", "T", "P")
_SECONDS = (("years", 31557600.0), ("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0))


def _in_steps(number: float, names: tuple[str, ...]) -> str:
    power = 0
    while number >= _SCALE and power < len(names) - 1:
        number, power = number / _SCALE, power + 1
    return f"{number:.3g} {names[power]}"


def in_words(number: float) -> str:
    """A large number in words, to three digits, such as "2.5 million"."""
    return _in_steps(number, _WORDS).rstrip()


def with_prefix(number: float, unit: str) -> str:
    """A large amount to three digits with a decimal prefix before its unit, such as "5.2 GB"."""
    return _in_steps(number, _PREFIXES) + unit


def duration(seconds: float) -> str:
    """A time in the largest unit of which there are two, such as "2 hours"."""
    for name, length in _SECONDS:
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {name}"
    return f"{seconds:.0f} seconds"
