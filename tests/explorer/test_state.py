import copy
import json
import re
from typing import ClassVar, Literal

import pytest

import lightflyer as lf
from lightflyer.config.flyer_file import FlyerFile
from lightflyer.core.quantity import Length, Quantity
from lightflyer.core.units import Measured
from lightflyer.explorer import server
from lightflyer.explorer.editing import slider, sliders, switch_alternative
from lightflyer.explorer.grammar import BASES, grammar, quantity_text, templates
from lightflyer.explorer.maps import Choices, payload_map
from lightflyer.explorer.state import (
    View,
    Workplace,
    from_url,
    plain,
    require_document,
    to_toml,
    to_url,
)

DOCUMENTS = {name: plain(template.document) for name, template in templates().items()}


def read(document):
    """The flyer file that a document is, without building what it describes."""
    return FlyerFile.model_validate(document)


@pytest.mark.parametrize("name", DOCUMENTS)
def test_address_and_file_hold_the_whole_design(name, workplace, write):
    document = DOCUMENTS[name]
    view = View(document, "75 km", (DOCUMENTS["earth"], document))
    assert from_url(to_url(view)) == view
    path = write(to_toml(document), "flyer.toml")
    if "mission" in document:
        written, own = lf.mission.read_mission_file(path), workplace.mission(document)
        assert written.mission == own.mission
        assert written.design == own.design
    else:
        assert lf.read_flyer_file(path) == read(document)


def test_file_keeps_every_digit_of_what_was_typed(workplace, write):
    document = copy.deepcopy(DOCUMENTS["earth"])
    document["flyer"]["diameter"] = "2.3456789012345678 ± 0.01 cm"
    document["film"] |= {"absorptance": "0.7512345678901234", "tac_bottom": ""}
    document["film"]["tac_bottom"] = "9.1e-1"
    path = write(to_toml(document), "flyer.toml")
    file = lf.read_flyer_file(path)
    assert file.flyer.diameter == pytest.approx((0.023456789012345678, 1e-4), rel=1e-15)
    assert (file.film.absorptance.value, file.film.tac_bottom.value) == (0.7512345678901234, 0.91)
    assert workplace.design(document).file == file


WRONG_ADDRESSES = {
    "words": "consists of key=value",
    "a.b=%ff": "consists of key=value",
    "flyer=3": "belongs to no section",
    "flyer.x=2&flyer.x=3": "given twice",
    "flyer.x.y=1&flyer.x=2": "given twice",
    "flyer.x=2&flyer.x.y=1": "a value and a section at once",
    "pin={": "not valid JSON",
    "pin=[]": "a table of sections",
    "film.layers=[": "not valid JSON",
    "other.key=1": "[other] is not a section",
    "flyer." + "a." * 20 + "b=1": "sections within each other",
    "flyer.<b>=1": "cannot be a key",
    "film.layers=" + "[" * 50_000: "",
    "flyer.x=" + "1" * 300_000: "more than",
    "&".join(["pin={}"] * 5): "more than 4 designs",
}


@pytest.mark.parametrize(("address", "words"), WRONG_ADDRESSES.items(), ids=range(15))
def test_wrong_address_is_one_line(address, words):
    with pytest.raises(lf.ConfigurationError) as caught:
        from_url(address)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def layered(**changes):
    """The design of layers, with another film."""
    return DOCUMENTS["layers"] | {"film": DOCUMENTS["layers"]["film"] | changes}


@pytest.mark.parametrize("before", ["", " ", "\t", "\u00a0", " \n\u3000"])
@pytest.mark.parametrize("name", ["/etc/hostname.csv", "../secret.csv", "~/x.csv", "C:\\x.csv"])
def test_page_names_no_files_elsewhere(name, before, workplace):
    with pytest.raises(lf.ConfigurationError, match="outside the folder"):
        workplace.design(layered(spectrum=before + name))


def test_links_within_the_folder_lead_nowhere_else(tmp_path):
    secret, folder = tmp_path / "secret", tmp_path / "folder"
    secret.mkdir()
    folder.mkdir()
    (secret / "x.csv").write_text("user,password\n", encoding="utf-8")
    (folder / "within").symlink_to(secret)
    place = Workplace(folder, "flyer.toml", DOCUMENTS["layers"])
    with pytest.raises(lf.ConfigurationError, match="outside the folder"):
        place.design(layered(spectrum="within/x.csv"))


def test_number_of_layers_is_limited():
    with pytest.raises(lf.ConfigurationError, match="at most 40 layers here"):
        require_document(layered(layers=[{"material": "Al", "thickness": "50 nm"}] * 400))


def test_files_that_the_opened_file_names_may_be_anywhere(tmp_path):
    spectrum = tmp_path / "elsewhere" / "lamp.csv"
    spectrum.parent.mkdir()
    rows = "\n".join(f"{wavelength}, 1" for wavelength in range(400, 701, 50))
    spectrum.write_text(f"wavelength [nm], irradiance [W/m^2/nm]\n{rows}\n", encoding="utf-8")
    document = layered(spectrum=str(spectrum), layers=[{"material": "Al", "thickness": "50 nm"}])
    path = tmp_path / "home" / "flyer.toml"
    path.parent.mkdir()
    path.write_text(to_toml(document), encoding="utf-8")
    workplace = Workplace.of_file(path)
    assert workplace.initial["film"]["spectrum"] == str(spectrum)
    with pytest.raises(lf.ConfigurationError, match="outside the folder"):
        workplace.design({**document, "payload": {"reserve": "../0"}})


def test_command_serves_the_file_and_says_where(write, prints, monkeypatch):
    served = []

    def serve(workplace, port, opened):
        served.append((workplace, port))
        opened(f"http://127.0.0.1:{port}/")

    monkeypatch.setattr(server, "serve", serve)
    path = write(to_toml(DOCUMENTS["mission"]), "mine.toml")
    assert "http://127.0.0.1:8123/" in prints("explore", path, "--no-browser", "--port", "8123")
    ((workplace, port),) = served
    assert (workplace.initial["mission"]["altitude"], port) == ("75 km", 8123)


def test_wrong_file_ends_the_command_with_its_line(write, refuses):
    path = write('[flyer]\ndiameter = "2 xm"\n', "flyer.toml")
    (line,) = refuses("explore", path, "--no-browser").splitlines()
    assert line.startswith(f'lightflyer: error: {path}:2: flyer.diameter: "2 xm"')


def test_a_new_flyer_appears_with_its_fields(workplace):
    class SquareSection(lf.flyer.FlyerSection):
        """``[flyer]``: a square."""

        flyer_type: ClassVar[type] = lf.Disk
        shape: Literal["tile"]
        side: Length
        rounded: bool = False

        def build(self, film, incidence):
            return lf.Disk(film, 0.5 * self.side.value)

    try:
        described = grammar()
        base = next(part["base"] for part in described["parts"] if part["name"] == "flyer")
        fields = described["sections"][described["bases"][base]["tile"]]["fields"]
        by_name = {field["name"]: field for field in fields}
        assert by_name["side"] == {
            "name": "side", "label": "side", "words": "", "required": True, "kind": "number",
            "unit": "m", "range": "positive", "default": "",
        }  # fmt: skip
        assert by_name["rounded"]["choices"] == ["true", "false"]
        chosen = switch_alternative(workplace.initial, "flyer", "tile")
        with pytest.raises(lf.ConfigurationError, match=r"\[flyer\] needs side"):
            workplace.design(chosen)
        chosen["flyer"]["side"] = "3 cm"
        assert workplace.design(chosen).setup.flyer.radius == pytest.approx(0.015)
        assert workplace.design(from_url(to_url(View(chosen))).document).file.flyer.shape
    finally:
        del lf.flyer.FlyerSection.alternatives["tile"]  # no part of the package


CHOICES = [(name, tag) for name, base in BASES.items() for tag in base.alternatives]


@pytest.mark.parametrize(("name", "tag"), CHOICES)
def test_every_alternative_can_be_chosen(name, tag, workplace):
    chosen = switch_alternative(workplace.initial, name, tag)
    kind = BASES[name].alternatives[tag]
    suits = name != "force" or issubclass(lf.Disk, kind.model_type.flyers)
    if suits:
        assert getattr(read(chosen), name).tag() == tag
    else:
        with pytest.raises(ValueError, match="is not for shape"):
            read(chosen)


def test_switching_keeps_what_a_kind_shares_with_the_one_before(workplace):
    document = copy.deepcopy(workplace.initial)
    document["environment"] |= {"albedo": 0.4, "irradiance": "1000 W/m^2"}
    other = switch_alternative(document, "environment", "earth nrlmsis")["environment"]
    assert (other["albedo"], other["atmosphere"]) == (0.4, "nrlmsis")
    mars = switch_alternative(document, "environment", "mars")["environment"]
    assert mars["irradiance"] != "1000 W/m^2"  # Earth's light is not that of Mars
    with pytest.raises(lf.ConfigurationError, match="no alternative"):
        switch_alternative(document, "flyer", "saucer")


@pytest.mark.parametrize("name", [name for name in DOCUMENTS if name != "mission"])
def test_ends_of_sliders_are_allowed(name):
    document = DOCUMENTS[name]
    design = read(document).design()
    found = sliders(design, document)
    assert len(found) > 8
    for part, section in design.file.parts().items():
        for inner, quantity, value in section.numbers():
            one = found.get(f"{part}.{inner}")
            if one is None:
                assert value is None
                continue
            assert one.low <= one.value <= one.high, inner
            unit = re.search(r"[A-Za-zµ°].*$|$", one.text)[0]
            for end in (one.low, one.high):
                assert quantity.read(f"{end!r} {unit}".strip()).uncertainty is None
            assert quantity.read(f"{one.value!r} {unit}".strip()).value == pytest.approx(
                value.value
            )


def test_sliders_of_lengths_and_shares():
    length = slider("2 ± 0.1 cm", Measured(0.02), Quantity("m", 0.0, open_below=True))
    assert length[:4] == (2.0, 0.2, 20.0, True)
    assert slider("0.75", Measured(0.75), Quantity("", 0.0, 1.0))[:4] == (0.75, 0.0, 1.0, False)


def test_sliders_of_offset_units_reach_what_is_possible():
    kelvin = Quantity("K", 0.0, open_below=True, sizes=(1.0, 5e3))
    warm = slider("20 °C", Measured(293.15), kelvin)
    assert (warm.value, warm.low, warm.high) == (20.0, -40.0, 40.0)
    assert quantity_text(Measured(1361.0, 2.0), Quantity("W/m^2")) == "1361 ± 2 W/m^2"


def test_grammar_is_plain_json():
    described = grammar()
    assert json.loads(json.dumps(described)) == described


@pytest.mark.parametrize(
    ("name", "changes", "unit"),
    [
        ("balloon", {"diameter": "5 m", "payload": "0 kg"}, ""),
        ("balloon", {"diameter": "40 m", "payload": "10 kg"}, ""),
        ("particle", {}, "pg"),
    ],
)
def test_other_kinds_have_a_map(name, changes, unit, workplace):
    document = DOCUMENTS[name] | {"flyer": DOCUMENTS[name]["flyer"] | changes}
    found = payload_map(workplace, document, Choices("flyer.diameter"))
    assert found["words"].startswith("Largest payload: ")
    assert unit in found["words"]


def test_a_map_ends_where_no_flyer_can_be_built(workplace):
    found = payload_map(workplace, DOCUMENTS["hollow"], Choices("flyer.size"))
    outlet = 8.0  # cm, of the template
    assert min(found["sources"]["cells"]["x"]) == pytest.approx(outlet, rel=1e-5)
    assert max(found["sources"]["cells"]["x"]) == pytest.approx(50.0)
    (reason,) = (text for text in found["warnings"] if "no flyer can be built" in text)
    assert reason.endswith("the outlet must be smaller than the sphere")
    assert found["words"].endswith("at the end of the map: beyond none can be built.")
