"""The calculator in a browser, under a strict policy and without a network."""

import re
import shutil
import tomllib

import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates

model = pytest.importorskip("calculator.model")
from calculator.page import html  # noqa: E402

playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
expect = playwright.expect

pytestmark = pytest.mark.snippets

SITE = "http://calculator.test/"
POLICY = "default-src 'none'; script-src 'self'; style-src 'self'"
SCRIPTS = [f"calculator-{name}.js" for name in ("model-disk", "core", "bands", "figures", "view")]
PAGE = (
    '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>t</title>'
    '<meta name="viewport" content="width=device-width">'
    '<link rel="stylesheet" href="calculator.css">{scripts}</head><body>{body}</body></html>'
)
FLAGS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync")
KINDS = {".js": "text/javascript", ".css": "text/css", "": "text/html"}
TIMED = """() => {
  window.times = [];
  const next = requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (update) =>
    next((time) => {
      const start = performance.now();
      update(time);
      window.times.push(performance.now() - start);
    });
}"""
SLOWEST = 1.0  # seconds a move, on a machine that does other things: far above what it takes


@pytest.fixture(scope="module")
def browser():
    found = shutil.which("chromium") or shutil.which("google-chrome")
    if found is None:
        pytest.skip("Chromium is not installed: the calculator's page is not tried")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=found, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def files(calculator_files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("page") / "site"
    shutil.copytree(calculator_files, folder)
    scripts = "".join(f'<script defer src="{name}"></script>' for name in SCRIPTS)
    page = PAGE.format(scripts=scripts, body=html())
    (folder / "index.html").write_text(page, encoding="utf-8")
    below = PAGE.format(scripts=scripts, body="<br>" * 200 + html())
    (folder / "below.html").write_text(below, encoding="utf-8")
    return folder


@pytest.fixture
def page(browser, files):
    """The page, served with a policy that allows no inline script or style; it has to be quiet."""
    context = browser.new_context(viewport={"width": 360, "height": 700})
    opened, said = context.new_page(), []
    opened.on("console", lambda message: said.append(message.text))
    opened.on("pageerror", lambda error: said.append(str(error)))

    def answer(route):
        path = files / (route.request.url.removeprefix(SITE) or "index.html")
        if not path.is_file():  # such as the icon that a browser asks for
            route.fulfill(status=204)
            return
        kind = KINDS.get(path.suffix, KINDS[""])
        headers = {"Content-Security-Policy": POLICY, "Content-Type": f"{kind}; charset=utf-8"}
        route.fulfill(body=path.read_text(encoding="utf-8"), headers=headers)

    context.route(f"{SITE}**", answer)
    opened.goto(SITE)
    expect(opened.locator("#lf-verdict")).not_to_be_empty()
    for group in opened.locator(".lf-controls summary").all()[1:]:  # closed on a phone
        group.click()
    yield opened
    assert said == []
    context.close()


@pytest.fixture(scope="module")
def at_first():
    """Irradiance to levitate and band of the disk of ``init``, as the page shows them."""
    file = lf.FlyerFile(**tomllib.loads(templates()["laden"].read()))
    found = lf.predict(file, at=[76e3])
    low, high = found.bands[0]
    light = float(found.at["levitation_irradiance"][0])
    return f"{light:.4g} W/m²", f"from {low / 1e3:.1f} km to {high / 1e3:.1f} km"


def _value(page, name):
    return page.locator(f"#lf-value-{name}")


def test_it_starts_with_the_disk_of_init_and_fits_a_phone(page, at_first):
    expect(_value(page, "levitation_irradiance")).to_have_text(at_first[0])
    expect(page.locator("#lf-verdict")).to_contain_text("Levitates at 76 km, and carries up to")
    expect(page.locator("#lf-verdict")).to_have_attribute("data-state", "unsure")
    assert page.locator("html").evaluate("(html) => html.scrollWidth") <= 360
    page.uncheck("#lf-bands")
    expect(page.locator("#lf-bands-from")).to_have_text("off: central values only")
    expect(page.locator("#lf-verdict")).to_have_attribute("data-state", "unsure")
    words = page.get_attribute("#lf-curve", "aria-label")
    assert at_first[1] in words
    assert (
        "Released, it rests at 79.5 km and 502 K; its film withstands 520 K and survives." in words
    )


def test_the_disk_of_the_paper_is_one_click_away(page):
    page.click(".lf-another a")
    expect(page.locator("#lf-verdict")).to_contain_text("Levitates at 80 km, but its film melts")
    expect(page.locator("#lf-flyer-diameter-box")).to_have_value("2")


def test_keys_move_a_slider_and_results_follow(page, at_first):
    page.focus("#lf-film-absorptance")
    page.keyboard.press("ArrowLeft")
    expect(_value(page, "levitation_irradiance")).not_to_have_text(at_first[0])
    expect(page.locator("#lf-film-absorptance-box")).to_have_value("0.74")
    expect(page.locator("#lf-spoken")).to_contain_text("Levitates at 76 km")
    page.click("#lf-reset")
    expect(_value(page, "levitation_irradiance")).to_have_text(at_first[0])


BAD = {
    "<img src=x onerror=alert(1)>": "must be a number; results are for 0.75",
    "": "must be a number",
    "1.5": "must be at most 1;",
    "-0.1": "must be at least 0;",
    "1e999": "must be a number",
    "0.7 ± ": "must have a positive number after its ±",
    "0.7 ± 0.1 ± 0.1": "must have a positive number after its ±",
}


def test_bad_input_is_told_beside_its_box(page, at_first):
    box, told = page.locator("#lf-film-absorptance-box"), page.locator("#lf-film-absorptance-error")
    for text, said in BAD.items():
        box.fill(text)
        expect(told).to_contain_text(said)
        expect(box).to_have_attribute("aria-invalid", "true")
        expect(_value(page, "levitation_irradiance")).to_have_text(at_first[0])
    box.fill("0.75")
    expect(told).to_be_empty()
    page.locator("#lf-altitude-box").fill("76 ± 1")
    expect(page.locator("#lf-altitude-error")).to_contain_text("takes no ±")


def test_the_address_holds_the_design(page):
    page.select_option("#lf-model", "lu2023")
    page.fill("#lf-flyer-diameter-box", "5")
    expect(page).to_have_url(re.compile("#design:model=lu2023&flyer.diameter=5$"))
    shown = _value(page, "payload").text_content()
    page.reload()
    expect(_value(page, "payload")).to_have_text(shown)
    page.click("#lf-reset")
    expect(page).to_have_url(SITE)


def test_a_design_is_in_sight_where_the_calculator_is_far_down(page):
    page.goto(f"{SITE}below.html")
    expect(page.locator("#lf-flyer-diameter-box")).not_to_be_in_viewport()
    page.goto("about:blank")
    page.goto(f"{SITE}below.html#design:flyer.diameter=5")
    expect(page.locator("#lf-flyer-diameter-box")).to_be_in_viewport()


def test_what_an_address_must_not_hold_is_left_out_and_said(page):
    page.goto("about:blank")
    page.goto(
        f"{SITE}#design:altitude=75&film.absorptance=7&<img src=x onerror=alert(1)>=1&model=x"
    )
    told = page.locator("#lf-link-error")
    expect(told).to_contain_text("absorptance for sunlight must be at most 1")
    expect(told).to_contain_text('"model=x"')
    expect(page.locator("#lf-altitude-box")).to_have_value("75")
    expect(page.locator("#lf-film-absorptance-box")).to_have_value("0.75")


def test_a_move_is_undone_and_one_number_reset(page, at_first):
    expect(page.locator("#lf-undo")).to_be_disabled()
    page.fill("#lf-flyer-diameter-box", "1")
    expect(page.locator("#lf-undo")).to_be_enabled()
    page.fill("#lf-altitude-box", "75")
    expect(page).to_have_url(re.compile("altitude=75"))
    page.click("#lf-undo")
    expect(page.locator("#lf-altitude-box")).to_have_value("76")
    expect(page.locator("#lf-flyer-diameter-box")).to_have_value("1")
    page.click("#lf-flyer-diameter-reset")
    expect(page.locator("#lf-flyer-diameter-reset")).to_be_hidden()
    expect(_value(page, "levitation_irradiance")).to_have_text(at_first[0])


def test_a_slider_plays_until_it_is_stopped(page):
    play, box = page.locator("#lf-altitude-play"), page.locator("#lf-altitude-box")
    play.click()
    expect(play).to_have_attribute("aria-pressed", "true")
    expect(box).not_to_have_value("76")
    play.click()
    stopped = box.input_value()
    page.wait_for_timeout(200)
    expect(box).to_have_value(stopped)


def test_a_published_flyer_is_a_start(page):
    page.select_option("#lf-preset", label="Lu2023: Germanium disk of 3 cm")
    expect(page.locator("#lf-flyer-diameter-box")).to_have_value("3")
    expect(page.locator("#lf-film-areal_density-box")).to_have_value("0.99 ± 0.05")
    expect(page.locator("#lf-link-error")).to_be_empty()


def test_bands_follow_and_a_reader_switches_them_off(page):
    band, verdict = page.locator("#lf-band-payload"), page.locator("#lf-verdict")
    expect(band).to_have_text(re.compile(r"^0\.\d+ to 0\.\d+$"))
    expect(verdict).to_contain_text(re.compile(r"mg \(0.*in \d\d % of 500 samples"))
    expect(page.locator("#lf-bands-from")).to_have_text(
        "500 samples of the force model's own errors"
    )
    assert page.get_attribute(".lf-spread", "d").endswith("Z")
    page.uncheck("#lf-bands")
    expect(band).to_be_empty()
    expect(verdict).not_to_contain_text("samples")
    assert page.get_attribute(".lf-spread", "d") == ""
    expect(page).to_have_url(re.compile("#design:bands=off$"))
    page.select_option("#lf-model", "free-molecular")
    page.check("#lf-bands")
    expect(page.locator("#lf-bands-from")).to_contain_text("nothing has a ±")


def test_a_number_takes_a_plus_minus_and_keeps_it(page):
    box, band = page.locator("#lf-film-tac_bottom-box"), page.locator("#lf-band-payload")
    page.select_option("#lf-model", "free-molecular")
    expect(page.locator("#lf-bands-from")).to_contain_text("nothing has a ±")
    expect(page.locator("#lf-verdict")).to_have_attribute("data-state", "flies")
    expect(band).to_be_empty()
    box.fill("0.9 +/- 0.03")
    expect(band).not_to_be_empty()
    shown = band.text_content()
    expect(page.locator("#lf-bands-from")).to_contain_text("(TAC), bottom")
    expect(page).to_have_url(re.compile(r"film.tac_bottom=0.9\+-0.03$"))
    page.reload()
    expect(box).to_have_value("0.9 ± 0.03")
    expect(band).to_have_text(shown)
    with page.expect_download() as waiting:
        page.click("#lf-download")
    text = waiting.value.path().read_text(encoding="utf-8")
    assert tomllib.loads(text)["film"]["tac_bottom"] == "0.9 ± 0.03"
    page.locator(".lf-controls summary").nth(1).click()
    page.click("#lf-film-tac_bottom-reset")
    expect(band).to_be_empty()
    expect(box).to_have_value("0.9")


def test_what_is_beyond_a_range_is_said(page):
    page.select_option("#lf-model", "lu2023")
    page.fill("#lf-flyer-diameter-box", "10")
    expect(page.locator("#lf-warnings")).to_contain_text("fitted to disks of 2 to 4 cm")


def test_the_download_is_what_is_shown(page):
    page.select_option("#lf-model", "kinetic")
    page.fill("#lf-flyer-diameter-box", "0,7")
    with page.expect_download() as waiting:
        page.click("#lf-download")
    content = tomllib.loads(waiting.value.path().read_text(encoding="utf-8"))
    assert content["flyer"]["diameter"] == "0.7 cm"
    assert content["force"] == {"model": "kinetic"}


def test_a_click_on_the_map_goes_there_and_a_move_is_quick(page):
    page.locator("html").evaluate(TIMED)
    page.locator("#lf-map-axes").click(position={"x": 150, "y": 100})
    expect(page.locator("#lf-flyer-diameter-box")).not_to_have_value("0.5")
    diameter, altitude = (page.input_value(f"#lf-{n}-box") for n in ("flyer-diameter", "altitude"))
    assert 0.1 < float(diameter) < 20.0
    assert 20.0 < float(altitude) < 120.0
    page.focus("#lf-film-emittance_top")
    for _ in range(8):
        page.keyboard.press("ArrowRight")
    times = sorted(page.locator("html").evaluate("() => window.times"))
    assert times[len(times) // 2] < SLOWEST * 1e3


def test_it_works_from_a_folder(browser, files, at_first):
    asked = []
    page = browser.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.goto((files / "index.html").as_uri())
    expect(_value(page, "levitation_irradiance")).to_have_text(at_first[0])
    assert all(re.match("file:|data:", url) for url in asked)
    page.close()


def test_sliders_and_figure_are_on_one_screen(page):
    """As wide as the theme leaves it at 1280 × 800, below the page's title and a line of words."""
    page.set_viewport_size({"width": 850, "height": 800})
    page.wait_for_function("document.querySelector('#lf-verdict').textContent")
    for part in ("#lf-curve", "#lf-flyer-diameter", "#lf-film-tac_bottom"):
        box = page.locator(part).bounding_box()
        assert box["y"] + box["height"] < 800 - 135, part
    kinds = page.locator(".lf-kinds-nav")
    rows = {round(one.bounding_box()["y"]) for one in kinds.locator("a").all()}
    assert len(rows) == 1
