"""The folder in which compiled code is kept for later processes."""

import os
from pathlib import Path

SETTING = "LIGHTFLYER_CACHE"  # Environment variable: ``off``, or the folder to keep code in
PRIVATE = 0o700  # Mode of the folder: nobody else reads or writes there


def cache_folder() -> Path | None:
    """Folder of what is kept, which need not exist yet; None where the user wants none."""
    setting = os.environ.get(SETTING, "")
    if setting.lower() == "off":
        return None
    if setting:
        return Path(setting)
    import platformdirs

    return Path(platformdirs.user_cache_dir("lightflyer"))


def make_private(folder: Path) -> bool:
    """Make a folder of the cache for this user alone; whether it is that."""
    for path in (folder.parent, folder):
        path.mkdir(parents=True, exist_ok=True, mode=PRIVATE)
    return is_private(folder)


def is_private(path: Path) -> bool:
    """Whether nobody but this user can have written here."""
    facts = path.stat()
    return not hasattr(os, "getuid") or (facts.st_uid == os.getuid() and not facts.st_mode & 0o022)
