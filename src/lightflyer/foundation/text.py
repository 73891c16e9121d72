"""Reading a user's text file, with one line for each way it can fail."""

from pathlib import Path

from lightflyer.foundation.errors import ConfigurationError


def read_text(path: Path) -> str:
    """Text of a UTF-8 file, with or without a byte-order mark.

    Parameters
    ----------
    path : Path

    Returns
    -------
    str

    Raises
    ------
    ConfigurationError
        If the file cannot be read or is not text.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        line = 1 + error.object[: error.start].count(b"\n")
        raise ConfigurationError(f"{path}:{line}: is not a text file (UTF-8)") from None
