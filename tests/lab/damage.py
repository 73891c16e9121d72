"""Damage to binary files of instruments."""


def damaged(content, rng, near):
    """Bytes within the first ones replaced, zeroed, put in or taken out, or the end cut off."""
    at, size = int(rng.integers(min(len(content), near))), int(rng.integers(1, 9))
    before, after, noise = content[:at], content[at + size :], rng.bytes(size)
    kinds = {
        "cut": content[: int(rng.integers(len(content)))],
        "replaced": before + noise + after,
        "zeroed": before + bytes(size) + after,
        "put in": before + noise + content[at:],
        "taken out": before + after,
    }
    how = list(kinds)[int(rng.integers(len(kinds)))]
    return kinds[how], how
