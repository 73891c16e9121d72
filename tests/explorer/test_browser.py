"""The page in a real browser: one server and one browser for all tests."""

import json
import re
import time
from urllib.parse import quote

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands import explore
from lightflyer.explorer.state import View, to_url

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")

DIAMETER = "#field-flyer\\.diameter"
SLIDER = '[data-row="flyer.diameter"] input[type=range]'
PATIENCE = 60_000  # ms: the first of a kind compiles, on a machine that may be busy


@pytest.fixture(scope="module")
def opened(browser, site):
    """A page, and what it asked for and said while the tests went on."""
    page = browser.new_page(viewport={"width": 1300, "height": 900})
    page.set_default_timeout(PATIENCE)
    page.asked, page.said = [], []
    page.on("request", lambda request: page.asked.append(request.url))
    page.on("console", lambda one: page.said.append(f"{one.type}: {one.text}"))
    page.on("pageerror", lambda error: page.said.append(f"error: {error}"))
    page.on("dialog", lambda dialog: (page.said.append("error: a dialog"), dialog.dismiss()))
    page.goto(site.address)
    page.wait_for_selector("body[data-banded]")
    yield page
    page.close()


@pytest.fixture
def page(opened, workplace):
    """The page with the first design."""
    start(opened)
    return opened


def start(page, address=""):
    """Open an address in the page, and wait until nothing moves any more."""
    page.evaluate("text => explorer.open({url: text})", address)
    settled(page)


def until(page, expression, argument=None):
    """Wait for an expression; Playwright's own way is one that the page's policy forbids."""
    end = time.monotonic() + PATIENCE / 1000
    while not page.evaluate(expression, argument):
        assert time.monotonic() < end, expression
        time.sleep(0.02)


def settled(page):
    """Wait until nothing moves any more."""
    until(
        page,
        "document.body.dataset.settled == explorer.version || explorer.wrong && !explorer.asking",
    )


def type_into(page, field, text):
    page.fill(field, text)
    settled(page)


def test_figures_follow_a_slider(page):
    page.focus(SLIDER)
    page.evaluate("performance.clearMeasures()")
    before = page.input_value(DIAMETER)
    for _ in range(4):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(50)
    settled(page)
    assert page.input_value(DIAMETER) != before
    assert page.evaluate("performance.getEntriesByName('redraw').length") > 0


def test_page_shows_what_python_computes(page):
    type_into(page, DIAMETER, "2.34567 cm")
    type_into(page, "#field-film\\.tac_bottom", "0.91")
    page.click("#tab-files")
    names = {}
    exec(page.inner_text("#python").replace("print(prediction.summary())", ""), names)
    own = names["prediction"].summary()
    own.pop("uncertainty")  # which the page computes beside, and shows as bands
    shown = page.evaluate("explorer.summary")
    assert shown == json.loads(json.dumps(own))  # closer than 1e-9: the same
    assert f"{own['verdict']['best']['payload_mg']:.4g} mg" in page.inner_text("#readings")
    curve = page.evaluate("[...explorer.figures.data.get('payload').sources.curve.payload]")
    assert max(curve) == pytest.approx(1e6 * max(names["prediction"].table["payload"]), rel=1e-9)


def test_downloads_come_as_files(page, tmp_path):
    type_into(page, DIAMETER, "2.5 cm")
    page.click("#tab-files")
    with page.expect_download() as waiting:
        page.click("text=Flyer file (TOML)")
    waiting.value.save_as(tmp_path / "flyer.toml")
    assert lf.read_flyer_file(tmp_path / "flyer.toml").flyer.diameter.value == 0.025
    with page.expect_download() as waiting:
        page.click("[aria-label='What it carries as SVG']")
    assert waiting.value.suggested_filename == "lightflyer-payload.svg"


def test_address_holds_the_design(page, browser, site):
    type_into(page, DIAMETER, "3.3 cm")
    type_into(page, "#at", "76 km")
    until(
        page, "location.hash.includes('flyer.diameter=3.3+cm') && location.hash.includes('76+km')"
    )
    address = page.url
    page.evaluate("location.hash = '#flyer.shape=disk'")
    page.wait_for_selector("#mistakes:not([hidden])")
    page.evaluate("text => { location.hash = text }", address.partition("#")[2])
    page.wait_for_selector("#mistakes", state="hidden")
    assert (page.input_value(DIAMETER), page.input_value("#at")) == ("3.3 cm", "76 km")


SHOWS = "document.getElementById('field-flyer.diameter').value === '{}'".format


def step_to(page, diameter):
    """A move that is a step of the history."""
    page.fill(DIAMETER, diameter)
    until(page, f"location.hash.includes('flyer.diameter={diameter.replace(' ', '+')}')")
    settled(page)


def test_a_move_is_undone_by_button_and_browser(page):
    until(page, "location.hash.includes('flyer.diameter=2+cm')")  # a step of its own
    step_to(page, "3 cm")
    step_to(page, "4 cm")
    page.click("#undo")
    until(page, SHOWS("3 cm"))
    settled(page)
    assert "flyer.diameter=3+cm" in page.url
    page.go_back()
    until(page, SHOWS("2 cm"))
    settled(page)
    for diameter in ("3 cm", "4 cm"):  # and one after an undone one
        step_to(page, diameter)
        page.click("#undo")
        until(page, SHOWS("2 cm"))
        settled(page)


DELAY = """() => {
  globalThis.fetchAtOnce = fetch;
  globalThis.fetch = async (path, ...rest) => {
    await new Promise((go) => setTimeout(go, path.endsWith("open") ? 900 : 300));
    return fetchAtOnce(path, ...rest);
  };
}"""


def test_late_answers_leave_the_history_alone(page):
    until(page, "location.hash.includes('flyer.diameter=2+cm')")
    step_to(page, "3 cm")
    page.evaluate(DELAY)
    page.fill(DIAMETER, "4 cm")  # no step yet when the page goes back
    page.go_back()
    until(page, SHOWS("2 cm"))
    settled(page)
    page.evaluate("void (globalThis.fetch = fetchAtOnce)")  # a function would be called
    page.go_forward()
    until(page, SHOWS("3 cm"))
    settled(page)


def test_an_address_holds_what_is_looked_at(page):
    page.click("#tab-sensitivity")
    until(page, "location.hash.endsWith('&looks=sensitivity')")
    address = page.url.partition("#")[2]
    start(page, address)
    assert page.get_attribute("#tab-sensitivity", "aria-selected") == "true"
    assert page.is_hidden("#mistakes")


def test_wrong_address_is_one_visible_line(page):
    start(page, "flyer.x.y=1&flyer.x=2")
    assert page.is_visible("#mistakes")
    assert len(page.inner_text("#mistakes").splitlines()) == 1
    assert page.input_value(DIAMETER) == "2 cm"


def test_mistake_is_told_beside_its_field_and_figures_stay(page):
    page.fill(DIAMETER, "2 xm")
    page.wait_for_selector(f"{DIAMETER}[aria-invalid=true]")
    assert 'unit "xm" is unknown' in page.inner_text("#wrong-flyer\\.diameter")
    assert "Fix the marked field" in page.inner_text("#status")
    type_into(page, DIAMETER, "2 cm")
    assert not page.is_visible("#mistakes")


def test_click_on_the_map_goes_there(page):
    page.click("#tab-map")
    until(page, "explorer.tabs.fresh.get('map') === explorer.version")
    box = page.locator("[data-figure=map] .plot").bounding_box()
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    until(page, "document.getElementById('at').value")
    settled(page)
    size, place = page.input_value(DIAMETER), page.input_value("#at")
    assert re.fullmatch(r"[\d.]+ cm", size)
    assert size != "2 cm"
    assert re.fullmatch(r"[67]\d(\.\d+)? km", place)
    until(page, "explorer.tabs.fresh.get('map') === explorer.version")
    page.click("#to-optimum")
    settled(page)
    assert page.input_value("#at") != place


def test_designs_are_pinned_and_differences_highlighted(page):
    page.click("#pin")
    type_into(page, DIAMETER, "3 cm")
    until(page, "document.body.dataset.pinned == 1")
    differing = page.locator("#pins-table td.differs").all_inner_texts()
    assert "2 cm" in differing
    assert page.evaluate("explorer.figures.data.get('payload').sources.pins.xs.length") == 1
    until(page, "location.hash.includes('pin=')")
    page.click("[aria-label='Remove pin 1']")
    until(page, "document.body.dataset.pinned == 0")


def test_points_are_overlaid_and_removed(page, points_file):
    page.set_input_files("#points-file", str(points_file))
    page.wait_for_selector("#points-clear:not([hidden])")
    assert "18 points of Ge 2 cm, Ge 3 cm" in page.inner_text("#points-words")
    at_altitude = page.evaluate("explorer.figures.data.get('irradiance').sources.points.x[0]")
    page.select_option("#start", "chamber")
    until(page, "explorer.figures.data.get('irradiance')?.sources.points?.x[0] < 10")
    assert at_altitude > 50.0  # km, where the air has the pressure of 8 mTorr: 1.067 Pa
    at_pressure = page.evaluate("explorer.figures.data.get('irradiance').sources.points.x[0]")
    assert at_pressure == pytest.approx(1.0666, rel=1e-3)
    page.click("#points-clear")
    assert page.evaluate("explorer.figures.data.get('irradiance').sources.points.x.length") == 0


@pytest.mark.parametrize("field", ["#open-file", "#points-file"])
def test_large_uploads_are_refused_and_the_page_goes_on(page, field, tmp_path):
    asked, large = len(page.asked), tmp_path / "large.csv"
    with large.open("wb") as file:
        file.truncate(30 << 20)
    page.set_input_files(field, large)
    told = "#mistakes" if field == "#open-file" else "#points-words"
    until(page, "name => document.querySelector(name).innerText.includes('30.0 MiB')", told)
    assert not any("upload" in url for url in page.asked[asked:])  # refused in the browser
    type_into(page, DIAMETER, "2.2 cm")
    assert page.evaluate("explorer.wrong") is False


def test_other_kinds_of_design_show_their_fields(page):
    page.fill(DIAMETER, "2 xm")  # so that nothing is computed
    until(page, "explorer.wrong && !explorer.asking")
    page.select_option("#kind-film", "layered")
    page.wait_for_selector("#field-film\\.layers\\.0\\.material")
    page.click("[aria-label='Remove layers 4']")
    page.wait_for_selector("#field-film\\.layers\\.3\\.material", state="detached")
    assert page.evaluate("explorer.document.film.layers.length") == 3


PAYLOADS = [
    "<script>window.hit=1</script>",
    "<img src=x onerror='window.hit=1'>",
    "<svg onload='window.hit=1'>",
    "\"><iframe src='javascript:parent.hit=1'></iframe>",
    "javascript:window.hit=1",
    "${window.hit=1}{{window.hit=1}}",
    "</textarea></title></style><b onmouseover=window.hit=1 class=hit>b</b>",
    "[x](javascript:window.hit=1)<details open ontoggle=window.hit=1 class=hit>",
    "\\u003cimg src=x onerror=window.hit=1\\u003e&lt;img src=x onerror=window.hit=1&gt;",
    "<math><mi xlink:href='data:x,<script>window.hit=1</script>' class=hit>",
]


def addresses(text, document):
    """The text in every place of an address that a page shows."""
    named = {**document, "flyer": {**document["flyer"], "shape": text}}
    number = {**document, "flyer": {**document["flyer"], "diameter": text}}
    layers = {**document, "film": {"layers": [{"material": text, "thickness": "20 nm"}]}}
    pinned = {**document, "film": {**document["film"], "spectrum": text}}
    yield to_url(View(named))
    yield to_url(View(number))
    yield to_url(View(layers))
    yield to_url(View(document, at=text))
    yield to_url(
        View(document, pins=(pinned, {**document, "payload": {"items": [{"name": text}]}}))
    )
    yield f"flyer.{quote(text)}=1"
    yield f"{quote(text)}={quote(text)}"
    yield f"pin={quote(text)}"


def test_text_from_anywhere_never_runs(page, workplace):
    for text in PAYLOADS:
        for address in addresses(text, workplace.initial):
            page.evaluate("text => explorer.open({url: text})", address)
        files = {
            "#open-file": ("x.toml", f"[flyer]\nshape = {json.dumps(text)}\n{text} = 1\n"),
            "#points-file": (
                "y.csv",
                f"sample, pressure [Pa], irradiance [W/m^2], {text.replace(',', ' ')}\n"
                f"{text.replace(',', ' ')}, 3, 900, 1\n",
            ),
        }
        for field, (name, content) in files.items():
            file = {"name": f"{text.replace('/', '')[:60]}{name}", "mimeType": "text/plain"}
            page.set_input_files(field, {**file, "buffer": content.encode()})
    settled(page)
    page.wait_for_timeout(200)
    start(page)
    columns = {"x": [74.0], "y": [900.0], "low": [800.0], "high": [1000.0], "sample": [PAYLOADS[1]]}
    page.evaluate(
        "columns => explorer.figures.put('irradiance', {sources: {points: columns}})", columns
    )
    box = page.locator("[data-figure=irradiance] .plot").bounding_box()
    for share in np.linspace(0.1, 0.95, 12):  # the pointer finds the point, and its name is shown
        for height in (0.5, 0.6, 0.7):
            page.mouse.move(box["x"] + share * box["width"], box["y"] + height * box["height"])
    assert page.evaluate("window.hit") is None
    assert page.evaluate("document.querySelectorAll('.hit, iframe, main img, math').length") == 0
    page.click("#points-clear", force=True) if page.is_visible("#points-clear") else None


def test_keyboard_reaches_everything(page):
    page.click("#tab-map")
    page.keyboard.press("ArrowRight")
    assert page.get_attribute("#tab-models", "aria-selected") == "true"
    page.keyboard.press("End")
    assert page.get_attribute("#tab-files", "aria-selected") == "true"
    assert page.evaluate("document.activeElement.id") == "tab-files"
    page.focus(SLIDER)
    text = page.get_attribute(SLIDER, "aria-valuetext")
    page.keyboard.press("PageUp")
    assert page.get_attribute(SLIDER, "aria-valuetext") != text
    unreachable = page.evaluate(
        "[...document.querySelectorAll('input, select, button')].filter(one => one.offsetParent"
        " && one.tabIndex < 0 && one.getAttribute('role') !== 'tab').map(one => one.id)"
    )
    assert unreachable == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessibility_by_axe(page, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    page.evaluate(f"document.documentElement.dataset.theme = '{scheme}'; explorer.figures.dress()")
    page.fill(DIAMETER, "2 xm")
    page.wait_for_selector("#mistakes:not([hidden])")
    page.click("#tab-files")
    found = axe.Axe().run(page).response
    page.evaluate("document.documentElement.dataset.theme = 'light'; explorer.figures.dress()")
    assert len(found["passes"]) > 20
    assert [(one["id"], one["nodes"][0]["target"]) for one in found["violations"]] == []


@pytest.mark.parametrize("size", [(360, 740), (1024, 768), (3840, 2160)])
def test_page_fits_phones_and_large_screens(page, size):
    width, height = size
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(150)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    small = page.evaluate(
        "[...document.querySelectorAll('.figures .plot')].map(one => one.clientWidth)"
    )
    assert min(small) > 250
    page.set_viewport_size({"width": 1300, "height": 900})


def test_nothing_was_asked_of_other_machines_and_nothing_went_wrong(page, site):
    """Last: over all that the tests above did."""
    assert len(page.asked) > 50
    others = [url for url in page.asked if not url.startswith((site.address, "blob:", "data:"))]
    assert others == []
    wrong = [text for text in page.said if not text.startswith("info")]
    assert [text for text in wrong if "422" not in text] == []


def test_the_file_for_this_user_alone_leads_to_the_page(browser, site):
    with explore._page_to(site.address) as path:
        page = browser.new_page()
        page.set_default_timeout(PATIENCE)
        page.goto(path.as_uri())
        page.wait_for_selector("body[data-banded]")
        assert page.url.startswith(site.address)
        page.close()
