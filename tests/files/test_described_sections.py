"""Sections whose keys follow from the fields of the class they describe."""

import dataclasses
import re
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Literal

import pydantic
import pytest

import lightflyer as lf
import lightflyer.config.flyer_file  # it knows all flyers and force models
from lightflyer.array.records import Module, field
from lightflyer.budget.payload import CellsSection, ItemSection, LinkSection, PayloadSection
from lightflyer.core.quantity import Checked, Length, StandardErrors, quantities_of, quantity_of
from lightflyer.core.units import Measured
from lightflyer.files.section import DIAMETER, Section, Spelling
from lightflyer.film.layer_section import (
    CauchySection,
    DrudeSection,
    LorentzSection,
    TaucLorentzSection,
)
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.film.properties import MeasuredFilmSection

DOCS = Path(__file__).parents[2] / "docs"
TEMPLATES = Path(lf.__file__).parent / "data"


def shorter_than_wide(length, radius):
    return "length exceeds the diameter" if length > 2.0 * radius else None


class Tube(Checked):
    contradiction: ClassVar = staticmethod(shorter_than_wide)

    radius: Length
    length: Length = 0.1
    share: float = 0.5
    end: Literal["open", "closed"] = field(static=True, default="open")
    lined: bool = field(static=True, default=False)
    error: StandardErrors | None = None
    inner: Length | None = None
    hidden: Length = 1.0
    part: Module | None = None


class TubeSection(Section, of=Tube):
    spelled: ClassVar[Mapping[str, Spelling]] = {"radius": DIAMETER}
    left_out: ClassVar[tuple[str, ...]] = ("hidden",)
    first_keys: ClassVar[tuple[str, ...]] = ("length",)

    note: str = ""


def test_keys_units_and_defaults_are_those_of_the_class():
    expected = ["length", "note", "diameter", "share", "end", "lined", "error", "inner"]
    assert list(TubeSection.model_fields) == expected
    assert TubeSection.quantity("diameter") == quantities_of(Tube)["radius"]
    assert TubeSection.quantity("share").unit == ""
    assert TubeSection.quantity("end") is None
    section = TubeSection(diameter="20 cm")
    assert section.length == Measured(0.1)
    assert section.error == Measured(0.0, 1.0)  # an object has none
    assert section.inner is None
    assert Tube(1.0).error is None
    assert section.make() == Tube(radius=0.1, error=0.0)
    assert TubeSection(diameter="2 m", end="closed", inner="1 mm").make() == Tube(
        1.0, end="closed", error=0.0, inner=1e-3
    )
    assert section.make(radius=3.0).radius == 3.0


def test_ranges_and_choices_are_those_of_the_class():
    for bad in ({"diameter": "-1 m"}, {"end": "ajar"}, {"lined": "maybe"}, {"hidden": "1 m"}):
        with pytest.raises(pydantic.ValidationError):
            TubeSection(**{"diameter": "20 cm", **bad})
    with pytest.raises(pydantic.ValidationError, match="diameter"):
        TubeSection()


def test_numbers_of_objects_and_files_contradict_each_other_alike():
    text = "length exceeds the diameter"
    with pytest.raises(lf.ParameterError, match=text):
        Tube(0.01)
    with pytest.raises((pydantic.ValidationError, lf.ConfigurationError), match=text):
        TubeSection(diameter="2 cm")


def test_a_section_of_no_class_says_what_it_needs():
    class Bare(Section):
        pass

    with pytest.raises(TypeError, match="needs a build"):
        Bare().make()


DESCRIBED = [
    *(
        kind
        for base in (lf.flyer.FlyerSection, lf.force.ForceSection)
        for kind in base.alternatives.values()
        if kind.__module__.startswith("lightflyer.")
    ),
    *(ItemSection, CellsSection, LinkSection, PayloadSection),
    *(CauchySection, DrudeSection, LorentzSection, TaucLorentzSection),
]


@pytest.mark.parametrize("section", DESCRIBED, ids=lambda section: section.__name__)
def test_each_number_of_the_package_has_its_key(section):
    """With the unit and the range of the class, also where the section declares it by hand."""
    for one in dataclasses.fields(section.describes):
        quantity = quantity_of(one.type)
        if quantity is None or one.name in section.left_out:
            continue
        key, _ = section.spelled.get(one.name, Spelling(one.name))
        assert section.quantity(key) == quantity, key


@pytest.mark.parametrize("section", [MeasuredFilmSection, LayeredFilmSection])
def test_numbers_of_films_have_the_ranges_of_the_properties(section):
    """Their keys are declared by hand: which of them a file must have depends on its layers."""
    for name, quantity in quantities_of(lf.FilmProperties).items():
        assert section.quantity(name) == quantity, name


def test_pages_or_templates_explain_every_key():
    paths = [*DOCS.glob("*.md"), *TEMPLATES.glob("flyer-*.toml")]
    pages = "".join(path.read_text("utf-8") for path in paths)
    kinds = [*DESCRIBED, MeasuredFilmSection, LayeredFilmSection]
    keys = {key for kind in kinds for key in kind.model_fields}
    assert not {key for key in keys if not re.search(rf"\b{key}\b", pages)}
