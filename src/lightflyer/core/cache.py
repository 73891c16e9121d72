"""The folder in which compiled code is kept for later processes."""

import os
import stat
from pathlib import Path

SETTING = "LIGHTFLYER_CACHE"  # Environment variable: ``off``, or the folder to keep code in
PRIVATE = 0o700  # Mode of the folder: nobody else reads or writes there

refused: list[Path] = []
"""Folders in which this process keeps nothing, as others may change what is there."""


def cache_folder() -> Path | None:
    """Folder of what is kept, which need not exist yet; None where the user wants none."""
    setting = os.environ.get(SETTING, "")
    if setting.lower() == "off":
        return None
    if setting:
        return Path(setting).absolute()
    import platformdirs

    return Path(platformdirs.user_cache_dir("lightflyer"))


def keeps_code() -> bool:
    """Whether anything is kept: neither the user refuses it nor a folder that others may change."""
    return cache_folder() is not None and not refused


def open_to_others(folder: Path) -> Path | None:
    """The folder, or one above it, that another user may write into; None where nobody may."""
    if not hasattr(os, "getuid"):
        return None
    # As ssh asks of its files: whoever may write into a folder may rename what is in it, unless
    # the folder is one such as /tmp, where only owners may.
    for path in (folder, *folder.parents):
        facts = path.stat()
        owners = {os.getuid()} if path == folder else {0, os.getuid()}
        shared = facts.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        if facts.st_uid not in owners or (
            shared and (path == folder or not facts.st_mode & stat.S_ISVTX)
        ):
            return path
    return None
