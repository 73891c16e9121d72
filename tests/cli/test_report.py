"""``--report``: one page of everything that a command prints and draws."""

import base64
import contextlib
import hashlib
import io
import re
from html.parser import HTMLParser

import pytest

from lightflyer.cli import main
from lightflyer.files import page
from lightflyer.files.result_text import unwrap, wrap

HEADER = "sample,pressure [Pa],irradiance [W/m^2]\n"
CURVE = ((1.5, 2500), (2, 2000), (3, 1600), (4, 1500), (5, 1550), (6, 1700), (8, 2100), (12, 2900))

PAYLOADS = [
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    '"><svg onload=alert(1)>',
    "'-alert(1)-'",
    "</pre><iframe src=javascript:alert(1)>",
    "<a href=javascript:alert(1)>x</a>",
    "&lt;script&gt;alert(1)&lt;/script&gt;",
    "</title><script>alert(1)</script>",
    "--><b>bold</b>",
    "<style>*{display:none}</style>",
]

ALLOWED = {
    *("html", "head", "meta", "title", "style", "body", "main", "h1", "h2", "h3", "p", "pre"),
    *("div", "table", "caption", "thead", "tbody", "tr", "th", "td", "figure", "img", "figcaption"),
}


class Elements(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.texts = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.texts.append(data)


def written(path, *names):
    """A file of points of each of the samples."""
    quoted = ['"' + name.replace('"', '""') + '"' for name in names or ("Ge",)]
    rows = (  # no two samples have the same points
        f"{name},{x:g},{y + number:g}\n" for number, name in enumerate(quoted) for x, y in CURVE
    )
    path.write_text(HEADER + "".join(rows), encoding="utf-8")
    return path


@pytest.fixture
def points(tmp_path):
    return lambda *names: written(tmp_path / "points.csv", *names)


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """Points, what the command prints of them, and its page, in a folder of their own."""
    folder = tmp_path_factory.mktemp("report")
    path, target = written(folder / "points.csv"), folder / "report.html"
    with contextlib.redirect_stdout(io.StringIO()) as shown, pytest.raises(SystemExit) as end:
        main(["lab", "levitation", str(path), "--report", str(target)])
    assert not end.value.code
    return path, shown.getvalue(), target


def test_the_page_says_what_the_terminal_says(reported):
    path, printed, target = reported
    assert printed.splitlines()[-1] == f"wrote {target}"
    found = Elements(target.read_text(encoding="utf-8"))
    text = " ".join(" ".join(found.texts).split())
    for line in printed.splitlines()[:-1]:
        assert all(word in text for word in line.split())
    assert hashlib.sha256(path.read_bytes()).hexdigest() in text
    assert found.texts.count("Lab levitation: points") == 2  # in the window and on the page
    assert path.read_text(encoding="utf-8").strip() in "".join(found.texts)
    assert set(found.tags) <= ALLOWED
    assert {path.name for path in target.parent.iterdir()} == {"points.csv", "report.html"}


def test_the_page_opens_with_what_was_found(run, points, tmp_path):
    target = tmp_path / "report.html"
    run("lab", "levitation", points("thin", "thick"), "--report", target)
    whole = target.read_text(encoding="utf-8")
    opening = whole[whole.index("</h1>") : whole.index("<figure>")]
    assert "thin needs the least light of 2 samples, 1" in opening
    assert whole.index("<figure>") < whole.index("thin needs 0.1 % less light than thick")
    assert whole.index("read 16 rows") < whole.index("<h2>Numbers") < whole.index("<h2>How it was")


@pytest.mark.parametrize(
    ("measurement", "arguments", "opening"),
    [
        ("tac", ("tac-reduced.txt",), "TAC α 0.7"),
        ("thermography", ("thermal.csv", "--band", "7.5-14 um"), "reflectance 0.1"),
        ("ftir", ("film.csv",), "emissivity at most 0.1"),
        ("roughness", ("germanium.txt",), "rms height Sq 34."),
    ],
)
def test_reports_of_the_lab_open_with_what_was_measured(
    run, tmp_path, monkeypatch, measurement, arguments, opening
):
    monkeypatch.chdir(tmp_path)
    run("lab", "example", measurement)
    assert run("lab", measurement, *arguments, "--report", "report.html")[0] == 0
    whole = (tmp_path / "report.html").read_text(encoding="utf-8")
    _, _, first = whole.partition('<div class="verdict">\n<p>')
    assert first.startswith(opening)


def test_letters_of_figures_do_not_shrink_on_a_phone(reported):
    whole = reported[2].read_text(encoding="utf-8")
    (width, source), *others = re.findall(r'<img [^>]*width="(\d+)" src="([^"]+)"', whole)
    assert not others
    drawing = base64.b64decode(source.partition(";base64,")[2]).decode()
    across = float(re.search(r'viewBox="0 0 ([\d.]+)', drawing)[1])
    letters = [float(size) for size in re.findall(r"font(?:-size)?: (?:\d+ )?([\d.]+)px", drawing)]
    assert min(letters) * int(width) / across > 11.0
    assert ".scroll img { max-width: none; }" in whole


def test_a_page_made_again_names_its_inputs_and_not_itself(run, points, tmp_path):
    path, target = points().rename(tmp_path / "germanium.csv"), tmp_path / "report.html"
    target.write_text("old")
    assert run("lab", "levitation", path, "--report", target)[0] == 0
    texts = Elements(target.read_text(encoding="utf-8")).texts
    assert "Lab levitation: germanium" in texts
    assert "germanium.csv" in texts
    assert "report.html" not in texts


def test_the_figure_is_within_the_page_and_says_what_it_shows(reported):
    whole = reported[2].read_text(encoding="utf-8")
    (source,) = re.findall(r'src="([^"]+)"', whole)
    kind, _, data = source.partition(";base64,")
    assert kind == "data:image/svg+xml"
    assert b"<svg" in base64.b64decode(data)
    assert 'alt="irradiance to levitate [kW/m²]' in whole


def test_nothing_that_a_file_contains_becomes_markup(prints, points, tmp_path):
    target = tmp_path / "report.html"
    prints("lab", "levitation", points(*PAYLOADS), "--report", target)
    found = Elements(target.read_text(encoding="utf-8"))
    assert set(found.tags) <= ALLOWED
    assert not any(name.startswith("on") for name, _ in found.attributes)
    for payload in PAYLOADS:
        assert sum(payload in text for text in found.texts) >= 1


def test_a_page_runs_and_fetches_nothing():
    whole = page.page("title", [page.paragraph("text")])
    assert "default-src 'none'" in whole
    assert "script" not in whole
    assert "http:" not in whole
    assert "https:" not in whole


def test_warnings_and_json_are_on_the_page(prints, points, reported, tmp_path):
    target = tmp_path / "report.html"
    assert prints("lab", "levitation", points(), "--json", "--report", target).startswith("{")
    text = "".join(Elements(target.read_text(encoding="utf-8")).texts)
    assert '"warnings"' in text
    assert '<p class="warning">warning: ' in reported[2].read_text(encoding="utf-8")


def test_a_command_that_fails_writes_no_page(prints, refuses, points, tmp_path):
    path, target = points(), tmp_path / "report.html"
    path.write_text(path.read_text().replace("1500", "-1500"), encoding="utf-8")
    refuses("lab", "levitation", path, "--columns", "speed", "--report", target)
    assert not target.exists()
    assert "report.html" not in prints("lab", "levitation", points())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("report.toml", 'the page is HTML; name it "report.html"'),
        ("nowhere/report.html", "its folder does not exist"),
        ("folder.html", "is a folder"),
    ],
)
def test_a_page_that_cannot_be_written_is_refused_before_the_work(
    refuses, points, tmp_path, name, message
):
    (tmp_path / "folder.html").mkdir()
    assert message in refuses("lab", "levitation", points(), "--report", tmp_path / name)


def test_lines_that_a_terminal_breaks_are_whole_again(rng):
    for _ in range(200):
        words = ["x" * length for length in rng.integers(1, 14, rng.integers(1, 60))]
        assert unwrap(wrap(" ".join(words))) == [" ".join(words)]
    assert unwrap("It flies.\nIts film survives.") == ["It flies.", "Its film survives."]
