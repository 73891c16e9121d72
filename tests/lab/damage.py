"""Damage to files of instruments."""

import lightflyer as lf


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


def read_damaged(read, path, content, rng, near, times=200):
    """What is read of damaged files, and their damages; others are refused in one line."""
    found = []
    for _ in range(times):
        bad, how = damaged(content, rng, near)
        path.write_bytes(bad)
        try:
            found.append((read(path), how))
        except lf.ConfigurationError as error:
            said = str(error)
            assert said.startswith(str(path)), said
            assert "\n" not in said
    return found
