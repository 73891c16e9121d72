"""Text of files as laboratories have them: UTF-8, UTF-16 or Windows-1252, any line ends."""

import codecs
import re

from lightflyer.core.errors import ConfigurationError

_MARKED = (  # UTF-32 first: its mark begins with that of UTF-16
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_LOOKED_AT = 4096  # bytes from which UTF-16 without a mark is told
_LEAST = 4  # letters
_MANY, _FEW = 0.4, 0.05  # of zeros on one side of UTF-16 in western scripts, and on the other
_LINE_END = re.compile(r"\r\n|\n|\r")
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f\x7f]")
_DOS_END = "\x1a"
_BYTE_ORDER_MARK = "\N{ZERO WIDTH NO-BREAK SPACE}"


def plain_text(content: bytes, name: str) -> str:
    """Text of the content of a file; ``name``: name of the file, for messages."""
    text = _decode(content, name).removeprefix(_BYTE_ORDER_MARK).removesuffix(_DOS_END)
    control = _CONTROL.search(text)
    if control:
        line = len(split_lines(text[: control.start() + 1]))
        what = "zero bytes" if control[0] == "\0" else f"the control character {control[0]!r}"
        raise ConfigurationError(f"{name}:{line}: is not a text file, or damaged: has {what}")
    return text


def split_lines(text: str) -> list[str]:
    """Lines of a text as an editor counts them, whatever ends them."""
    lines = _LINE_END.split(text)
    return lines[:-1] if not lines[-1] else lines


def _decode(content: bytes, name: str) -> str:
    marked = next((code for mark, code in _MARKED if content.startswith(mark)), None)
    encoding = marked or _wide(content) or "utf-8"
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = 1 + len(_LINE_END.findall(content[: error.start].decode("latin-1")))
        # a mark, or zeros, leave no other encoding
        if encoding != "utf-8" or marked:
            said = f"is not a text file, or damaged: {encoding.upper()} cannot be read"
            raise ConfigurationError(f"{name}:{line}: {said}") from None
    for one in content.splitlines():
        if one.isascii():
            continue
        try:
            one.decode("utf-8")
        except UnicodeDecodeError:
            continue
        raise ConfigurationError(
            f"{name}:{line}: is damaged: most of the file is UTF-8, this line is not"
        )
    try:
        return content.decode("cp1252")
    except UnicodeDecodeError as error:
        line = 1 + content[: error.start].count(b"\n")
        raise ConfigurationError(
            f"{name}:{line}: is not a text file (UTF-8, UTF-16 or Windows-1252)"
        ) from None


def _wide(content: bytes) -> str | None:
    """UTF-16 without a mark, by its zeros."""
    start = content[:_LOOKED_AT]
    pairs = len(start) // 2
    if pairs < _LEAST:
        return None
    first, second = start[0::2].count(0) / pairs, start[1::2].count(0) / pairs
    if second > _MANY and first < _FEW:
        return "utf-16-le"
    return "utf-16-be" if first > _MANY and second < _FEW else None
