"""Take the pictures of pages in docs/images: ``make screenshots``, after the pages are built."""

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

HERE = Path(__file__).parent
IMAGES = HERE / "images"
FLAGS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync")
COLOURS = 256
COMPUTED = 240e3  # ms in which a figure of the explorer is there, on any machine


@contextmanager
def explorer() -> Iterator[str]:
    """Address of an explorer of the disk of ``lightflyer init``."""
    command = [sys.executable, "-m", "lightflyer", "explore", "--no-browser"]
    with tempfile.TemporaryDirectory() as folder:
        running = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        try:
            assert running.stdout is not None
            found = next(filter(None, (re.search(r"http://\S+", line) for line in running.stdout)))
            yield found[0]
        finally:
            running.terminate()
            running.wait()


def keep(page: Page, name: str, part: str | None = None) -> None:
    """Save what is in sight, or a part of it."""
    path = IMAGES / f"{name}.png"
    (page.locator(part) if part else page).screenshot(path=path)
    with Image.open(path) as image:
        image.convert("RGB").quantize(COLOURS).save(path, optimize=True)


def calculator(browser: Browser, built: Path) -> None:
    """The tutorial's disk, light and dark."""
    design = "#design:flyer.diameter=1&flyer.payload=0&altitude=80"
    for scheme, ending in (("light", ""), ("dark", "-dark")):
        page = browser.new_page(color_scheme=scheme, viewport={"width": 1100, "height": 900})
        page.goto(f"{(built / 'calculator.html').as_uri()}{design}")
        page.wait_for_selector("#lf-band-payload:not(:empty)", timeout=COMPUTED)
        page.add_style_tag(content="#lf-calculator{max-height:860px;overflow:hidden}")
        keep(page, f"tutorial-calculator{ending}", "#lf-calculator")
        page.close()


def explore(browser: Browser) -> None:
    """The explorer's first screen, and its map."""
    with explorer() as address:
        page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme="light")
        page.goto(address)
        page.wait_for_selector("body[data-banded]", timeout=COMPUTED)
        page.wait_for_selector("#job-map[hidden]", state="attached", timeout=COMPUTED)
        page.wait_for_timeout(3000)
        keep(page, "explorer")
        keep(page, "explorer-map", ".card.more")


def main() -> None:
    """Take all; the argument is the folder of built pages."""
    built = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "_build"
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium, args=list(FLAGS))
        calculator(browser, built.resolve())
        if "--calculator" not in sys.argv:
            explore(browser)
        browser.close()


if __name__ == "__main__":
    main()
