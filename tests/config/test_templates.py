"""The files that ``lightflyer init`` writes, with every change that their comments invite."""

import pkgutil
import re

import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import read_flyer_file
from lightflyer.environment.radiation import EARTH_ALBEDO, EARTH_INFRARED

TEMPLATES = {kind: template.read() for kind, template in templates().items() if template.is_flyer}
OPTION = re.compile(r"^# (\w+ = .*)$", re.M)
CHOICE = re.compile(
    r'^(?:# )?(?P<key>\w+) = (?P<value>"[^"]*") +# (?:or|.*; or) (?P<others>.*)$', re.M
)
OTHER_FILE = "see  lightflyer init"
MODEL = re.compile(r'^model = "[^"]*"', re.M)
OF_MODEL = re.compile(r'^# Optional, of model "([\w-]+)" only.*\n(?: *# .*\n)*', re.M)
NRLMSIS = re.compile(r"(?<=nrlmsis\" all of these but f107a:\n)(?:# .*\n)+")


def invited():
    """Texts of templates with one change each, and a name for it."""
    for kind, text in TEMPLATES.items():
        for match in OPTION.finditer(text):
            yield f"{kind}: {match[1].split(' ')[0]}", uncommented(text, match)
        for match in CHOICE.finditer(text):
            if OTHER_FILE in match["others"]:
                continue
            for other in re.findall(r'"[^"]*"', match["others"].split(":")[0]):
                line = f"{match['key']} = {other}\n"
                changed = text[: match.start()] + line + text[match.end() :]
                fitting = with_group(changed, other)
                if other == '"three points"':  # they lie on a circle
                    fitting = fitting.replace("# hanging_radius", "hanging_radius")
                yield f"{kind}: {match['key']} {other}", of_its_model(fitting, text, match)


def uncommented(text, match):
    """A key that is written out where its group needs no others, else the group."""
    group = NRLMSIS.search(text)
    if group and group.start() <= match.start() < group.end():
        text = text.replace('atmosphere = "us1976"', 'atmosphere = "nrlmsis"')
        return with_group(text, '"nrlmsis"')
    changed = text[: match.start()] + match[1] + text[match.end() :]
    return of_its_model(changed, text, match)


def of_its_model(changed, text, match):
    """With the force model that a key belongs to, where it stands among the keys of one."""
    for group in OF_MODEL.finditer(text):
        if group.start() <= match.start() < group.end():
            return MODEL.sub(f'model = "{group[1]}"', changed)
    return changed


def with_group(text, value):
    if value != '"nrlmsis"':
        return text
    return NRLMSIS.sub(lambda group: re.sub("^# ", "", group[0], flags=re.M), text)


INVITED = dict(invited())


def test_the_search_for_invitations_finds_them():
    expected = {
        'earth: model "lu2023"', 'earth: model "free-molecular-linear"', "earth: c_fm",
        'earth: wall "accommodated"',
        'earth: atmosphere "nrlmsis"', 'earth: atmosphere "lu2023"', 'earth: gas "us1976-air"',
        'earth: reading "printed"', "earth: altitude_min", "earth: date", "chamber: infrared_top",
        "chamber: radius", 'chamber: model "kinetic"', 'sandwich: atmosphere "nrlmsis"',
    }  # fmt: skip
    assert not expected - set(INVITED)


@pytest.mark.slow
@pytest.mark.parametrize("name", INVITED)
def test_templates_run_with_every_change_that_their_comments_invite(name, write):
    path = write(INVITED[name], "flyer.toml")
    setup = read_flyer_file(path).build()
    where = setup.environment.coordinate
    middle = (where.searched[0] * where.searched[1]) ** 0.5 if where.logarithmic else 72e3
    state = setup.environment.state(middle)
    assert state.pressure > 0.0
    if "model" in name:
        assert abs(float(lf.lift(setup.flyer, state, setup.model))) > 0.0


@pytest.mark.parametrize("kind", ["earth", "sandwich"])
def test_earths_light_is_the_same_in_templates_files_and_python(kind, write):
    path = write(TEMPLATES[kind], "flyer.toml")
    written = read_flyer_file(path).build().environment
    light = ("irradiance", "incidence", "albedo", "infrared_top", "infrared_bottom")
    bare = "\n".join(
        line for line in TEMPLATES[kind].splitlines() if line.split(" ")[0] not in light
    )
    path.write_text(bare, encoding="utf-8")
    left_out = read_flyer_file(path).build().environment
    assert written.assumptions() == left_out.assumptions() == lf.Earth().assumptions()
    assert lf.Earth().radiation.albedo == EARTH_ALBEDO
    assert lf.Earth().radiation.infrared_below == EARTH_INFRARED


@pytest.mark.parametrize(
    ("key", "kind"),
    [('atmosphere = "us1976"\nf107 = 150', "earth"), ('radius = "15 cm"', "chamber")],
)
def test_a_key_of_another_choice_is_refused_by_naming_that_choice(write, key, kind):
    path = write(TEMPLATES["earth"], "flyer.toml", ('atmosphere = "us1976"', key))
    name = key.splitlines()[-1].split(" ")[0]
    message = rf':\d+: environment.{name} belongs to kind = "{kind}"; remove it'
    with pytest.raises(lf.ConfigurationError, match=message):
        read_flyer_file(path)


OF_SECTIONS_IN_COMMENTS = (
    *("of =", "quantile =", "method", "points", "seed"),
    *("best =", "designs =", "fronts =", "distributions ="),
)


@pytest.mark.parametrize(
    ("kind", "read"),
    [
        ("sweep", "lightflyer.study.study:read_study"),
        ("optimise", "lightflyer.search:read_problem"),
        ("sensitivity", "lightflyer.search:read_sensitivity_study"),
    ],
)
def test_studies_can_be_read_beside_the_flyer_file(kind, read, tmp_path, write):
    (tmp_path / "flyer.toml").write_text(TEMPLATES["earth"], encoding="utf-8")
    text = templates()[kind].read()
    path = write(text, "study.toml")
    found = pkgutil.resolve_name(read)(path)
    assert found.design.setup.flyer.describe()
    for match in re.finditer(r"^# ((?:\w+|\"[^\"]+\") = [^#]*?)(?: +#.*)?$", text, re.M):
        if match[1].startswith(OF_SECTIONS_IN_COMMENTS):
            continue
        path.write_text(text.replace(match[0], match[1]), encoding="utf-8")
        pkgutil.resolve_name(read)(path)
    for match in re.finditer(r"^# \[sampling\].*(?:\n# .*)+", text, re.M):
        path.write_text(text.replace(match[0], match[0].replace("# ", "", 1).replace("\n# ", "\n")),
                        encoding="utf-8")  # fmt: skip
        pkgutil.resolve_name(read)(path)
