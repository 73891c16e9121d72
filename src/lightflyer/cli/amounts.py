"""Large numbers as people say them."""

_SCALE = 1000.0
_PREFIXES = ("", "thousand", "million", "billion", "trillion")
_SYMBOLS = ("", "k", "M", "G", "T", "P")
_SECONDS = (("years", 31557600.0), ("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0))


def in_words(number: float) -> str:
    """A large number in words, to three digits.

    Examples
    --------
    >>> in_words(2.5e6)
    '2.5 million'
    """
    power = 0
    while number >= _SCALE and power < len(_PREFIXES) - 1:
        number, power = number / _SCALE, power + 1
    return f"{number:.3g} {_PREFIXES[power]}".rstrip()


def with_prefix(number: float, unit: str) -> str:
    """A large amount with a decimal prefix before its unit, to three digits.

    Examples
    --------
    >>> with_prefix(5.2e9, "B")
    '5.2 GB'
    """
    power = 0
    while number >= _SCALE and power < len(_SYMBOLS) - 1:
        number, power = number / _SCALE, power + 1
    return f"{number:.3g} {_SYMBOLS[power]}{unit}"


def duration(seconds: float) -> str:
    """A time in the largest unit of which there are two.

    Examples
    --------
    >>> duration(7500.0)
    '2 hours'
    """
    for name, length in _SECONDS:
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {name}"
    return f"{seconds:.0f} seconds"
