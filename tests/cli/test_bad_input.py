"""What people get wrong: one line each, which says where, what, and what is allowed."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import lightflyer as lf
from lightflyer import cli
from lightflyer.cli.commands.init import templates
from lightflyer.force.free_molecular import FreeMolecular
from lightflyer.statics.balance import require_converged

TEXTS = {kind: template.read() for kind, template in templates().items()}
OF_PYTHON = re.compile(
    r"Traceback|instance of|\btuple\b|NoneType|pydantic|\bdict\b|\bstr\b|\bint\b|\bfloat\b|"
    r"valid string|validation|should be|<class|__|Error\b|\bTrue\b|\bFalse\b|\bNone\b"
)


def require_one_line(result, place=None):
    code, text, errors = result
    assert code == 2
    assert text == ""
    assert errors.startswith("lightflyer: error: ")
    assert errors.count("\n") == 1, errors
    assert not OF_PYTHON.search(errors), errors
    if place is not None:
        assert re.match(rf"lightflyer: error: \S*{place}: ", errors), errors
    return errors


D = 'diameter = "2 cm"'
A = 'areal_density = "1.0 g/m^2"'
B = "absorptance = 0.75"
GE = 'material = "Ge", thickness = "20 ± 2 nm"'
FLYERS = [
    ("earth", D, "diameter = 2 cm", r'texts need quotes: diameter = "2 cm"'),
    ("earth", D, 'diameter = "2 kg"', "of the wrong kind; give one that converts to m"),
    ("earth", D, "diameter = 2", 'has no unit; write "2 cm"'),
    ("earth", D, 'diameter = "-2 cm"', "must be positive"),
    ("earth", D, 'diameter = "2 cm', "a text is not closed by quotes"),
    ("earth", D, 'diameter "2 cm"', "expected '=' after a key"),
    ("earth", D, f"{D}\n{D}", "diameter is given twice; remove one of the two$"),
    ("earth", B, f"{B}\n{B}", "absorptance is given twice; remove one of the two$"),
    ("earth", B, "absorptance = 0,75", "a point before decimals, and nothing between thousands$"),
    ("earth", D, "diameter = 2,5 cm", "a point before decimals.* quotes around a number with a"),
    ("earth", D, 'radius = "1 cm"', r'did you mean "diameter", twice the radius\?$'),
    ("earth", B, "absorptivity = 0.75", r'did you mean "absorptance"\?$'),
    ("earth", '"520 K"', '"520 ± 5 K"', "highest_temperature takes no ±: it is a limit"),
    ("earth", "[force]", '[environment.wind]\nwest = "60 m/s"\n[force]',
     r'did you mean "east" with the other sign\?$'),
    ("earth", D, f"{D}\nwings = 2", r"wings is not a key of \[flyer\]"),
    ("earth", "[flyer]", "[flier]", 'did you mean "flyer"'),
    ("earth", "[flyer]", "[flyer", "is not valid TOML"),
    ("earth", "[flyer]", "[[flyer]]", "is not a section"),
    ("earth", "[film]", "[flyer]", r"cannot declare \[flyer\] twice"),
    ("earth", 'shape = "disk"', 'shape = "saucer"', "choose from .*disk"),
    ("earth", 'model = "kinetic"', 'model = "lu2022"', "is unknown; choose from"),
    ("earth", 'model = "kinetic"', 'model = "kinetic"\nforce_error = "5 %"', "not in per cent"),
    ("earth", 'model = "kinetic"', 'model = "schafer2025"', 'is not for shape = "disk"'),
    ("earth", 'model = "kinetic"', 'model = "kinetic"\nc_fm = 0.4', 'belongs to model = "lu2023"'),
    ("earth", "[force]", '[force]\nwall = "maxwell"\nwall_error = 1', "it is for unknown or acc"),
    ("earth", A, 'areal_density = "1.0 g/m2 ± 3 %"', '"%" is of the wrong kind'),
    ("earth", B, "absorptance = 75", 'between 0 and 1; per cent are written "75 %"'),
    ("earth", "tac_top = 0.8", "tac_top = 0", "between 0 .excluded. and 1.3"),
    ("earth", "tac_top = 0.8", "", r"\[film\] needs tac_top"),
    ("earth", "emittance = 0.08", "emittance = 0.08\nemittance_top = 0.1", "not both"),
    ("earth", "emittance = 0.08", "", "give emittance, or both"),
    ("earth", "emittance = 0.08", "emittance = 1.4", "film.emittance = 1.4: must be between 0"),
    ("earth", '"us1976"', '"us1967"', "choose from us1976"),
    ("earth", '"us1976"', '"nrlmsis"', "needs date, latitude, longitude, f107 and ap"),
    ("earth", "# altitude_min = ", 'altitude_min = "140 km"\naltitude_max = ', "must be below"),
    ("earth", '# altitude_min = "40 km"', 'altitude_min = "4000 km"', "between 0 and 1000 km"),
    ("chamber", "[force]", '[force]\nreading = "said"', "choose from reported, printed"),
    ("earth", '"520 K"', '"-300 °C"', "must be above absolute zero"),
    ("earth", "[film]", "[film]\nlayers = []", "needs at least 1 entry"),
    ("earth", "[film]", '[film]\nlayers = "Ge"', "is not a list"),
    ("earth", "[film]\n", "[film]\n\0", "is not valid TOML"),
    ("chamber", '"293 K"', '"1e6 K"', "must be at most"),
    ("layers", GE, 'material = "Gee", thickness = "20 nm"', "did you mean Ge"),
    ("layers", GE, 'material = "Ge"', "needs thickness"),
    ("layers", GE, 'material = "Ge", thicknes = "20 nm"', 'did you mean "thickness"'),
    ("layers", GE, 'thickness = "20 nm"', "give one of material"),
    ("layers", GE, 'material = "no.csv", thickness = "20 nm"', "cannot be read: No such file"),
    ("layers", GE, 'material = 3, thickness = "20 nm"', "is not a text in quotes"),
    ("layers", 'spectrum = "AM0"', 'spectrum = "none.csv"', "cannot be read"),
    ("sandwich", "[flyer.top]", "[flyer.topp]", 'did you mean "top"'),
    ("ligaments", '"100 nm"', '"100 um"', "no room for their walls"),
    ("balloon", "[flyer]", '[flyer]\nenvelope = "paper"', "envelope is not a key"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "old", "new", "message"), FLYERS)
def test_a_mistake_in_a_flyer_file(run, write, kind, old, new, message):
    path = write(TEXTS[kind], "flyer.toml", (old, new))
    errors = require_one_line(run("predict", path), place=r"flyer\.toml(:\d+)?")
    assert re.search(message, errors), errors


OUTPUTS = (
    '["usable", "covered", "temperature", "lift_over_weight", "relative_payload", '
    '"levitation_irradiance"]'
)
BEST = 'maximise = "payload"'
SHARE = '"0.75 ± 0.02"'
STUDIES = [
    ("sweep", '"flyer.toml"', "3", "is not a text in quotes"),
    ("sweep", "points = 40", 'points = "40"', "whole number of at least 2"),
    ("sweep", "[0.06, 0.08, 0.12]", '"many"', "is not a number"),
    ("sweep", OUTPUTS, "[]", "names no output; choose from"),
    ("sweep", OUTPUTS, "3", "is not a list"),
    ("optimise", BEST, f'{BEST}\nminimise = "payload"', "is an objective already"),
    ("optimise", BEST, f"{BEST}\nstarts = 0", "must be at least 1"),
    ("optimise", BEST, f'{BEST}\nbeyond_range = "yes"', "is not true or false"),
    ("optimise", '"390 K"', "390", 'has no unit; write "390 K"'),
    ("optimise", "temperature = {", "temperture = {", 'did you mean "temperature"'),
    ("optimise", "[optimise.over]", "[optimise.ovr]", 'did you mean "over"'),
    ("sensitivity", '["payload", "temperature"]', '"nothing"', "is not an output"),
    ("sensitivity", "points = 1024", "points = 1000000000", "must be at most 262144"),
    ("sensitivity", SHARE, '"0.75 ± 0"', "is not uncertain"),
    ("sensitivity", SHARE, '{ distribution = "cauchy" }', "choose from normal, uniform"),
    ("sensitivity", SHARE, '{ distribution = "normal" }', "needs mean, standard_deviation"),
]


@pytest.mark.parametrize(("kind", "old", "new", "message"), STUDIES)
def test_a_mistake_in_a_study(run, write, tmp_path, kind, old, new, message):
    write(TEXTS["earth"], "flyer.toml")
    path = write(TEXTS[kind], "study.toml", (old, new))
    more = ("--out", tmp_path / "r.zarr") if kind == "sweep" else ()
    errors = require_one_line(run(kind, path, *more), place=r"study\.toml(:\d+)?")
    assert re.search(message, errors), errors
    assert not (tmp_path / "r.zarr").exists()


KINETIC = "kinetic --kn 1 --tac-top 0.8 --tac-bottom 0.9"
COMMANDS = [
    ("predict", r"predict needs FLYER_FILE \(TOML file .*see lightflyer predict --help"),
    ("predict flyer.toml --at", r"--at needs a value \(altitudes such as"),
    ("map x.zarr", r"map needs --x \(field of the horizontal axis, .* and --value \(output, such"),
    ("predict nothere.toml", "nothere.toml: cannot be read: No such file"),
    ("predict folder", "folder: cannot be read: Is a directory"),
    ("predict empty.toml", "is empty; 'lightflyer init' writes an example"),
    ("predict binary.toml", "is not text in UTF-8"),
    ("predict latin.toml", "latin.toml:1: is not text in UTF-8"),
    ("predict points.csv", "points.csv:6: is not valid TOML"),
    ("predict study.toml", "is a study file: run it with sweep"),
    ("fly study.toml", "is a study file: run it with sweep"),
    ("predict mission.toml", "is a mission file: run it with fly or spread"),
    ("predict flyer.toml --at 70", "--at: .* has no unit"),
    ("predict flyer.toml --at 70kg", "of the wrong kind"),
    ("predict flyer.toml --at 2000km", "--at: altitude 2000km must be between"),
    ("predict flyer.toml --at , --out o", "--at"),
    ("predict flyer.toml --samples -3", "--samples. Must be >= 0"),
    ("predict flyer.toml --samples 1000000000", "--samples. Must be <= 1000000"),
    ("predict flyer.toml --samples 1 --out o", "give at least 100 for a 95 % band, or 0"),
    ("predict flyer.toml --csv", "add --out FOLDER"),
    ("predict flyer.toml --out o --format gif", "choose from png, svg, pdf"),
    ("predict flyer.toml --out o --dpi 5", "from 30 to 1200"),
    ("predict flyer.toml --out o --style x", "nor a style sheet"),
    ("predict flyer.toml more.toml", "unexpected argument more.toml"),
    ("predict flyer.toml --bogus", "Unknown option: --bogus"),
    ("compare flyer.toml", "takes 2 to 9 flyers"),
    ("compare flyer.toml chamber.toml", "is described over altitude and chamber over pressure"),
    ("compare flyer.toml flyer.toml --altitudes 50km", "write a range"),
    ("film flyer.toml", "needs a section .film. with layers"),
    ("film layers.toml --at 550", 'write "550 nm"'),
    ("calibrate points.csv --free c_fn", 'did you mean "c_fm"'),
    ("calibrate points.csv --flyer flyer.toml", "levitation points need a chamber"),
    ("calibrate points.csv --pressure-accuracy 5", 'per cent are written "5 %"'),
    ("calibrate points.csv --pressure-accuracy 0.5", '"0.5 %", a share of it "50 %"'),
    ("calibrate points.csv --pressure-accuracy 5Pa", "--pressure-accuracy: "),
    ("calibrate points.csv --irradiance-accuracy 150%", "= 1.5 is not between 0 and 1"),
    ("calibrate points.csv --step 90kW/m^2 --out o", "is not smaller than the least irradiance"),
    ("calibrate points.csv --free irradiance", "irradiance has no effect on the light that lifts"),
    ("calibrate points.csv --free c_fm,density --out o", "density is not a number of the design"),
    ("calibrate points.csv --columns a,b", "has no row"),
    ("calibrate one.csv", "1 point cannot determine 2 parameters"),
    ("sweep study.toml", r"sweep needs --out \(folder for the results"),
    ("sweep flyer.toml --out r", "is a flyer file: a study file names one"),
    ("sweep study.toml --out r --workers 0", "at least 1"),
    ("sweep study.toml --out points.csv", "is not a sweep; choose another folder"),
    ("sweep optimise.toml --out r", "needs a section .sweep."),
    ("map nothere.zarr --x diameter --value payload", "does not exist"),
    ("optimise study.toml", "needs a section .optimise."),
    ("optimise optimise.toml --write flyer.toml", "choose another name"),
    ("optimise optimise.toml --write nowhere/best.toml", "there is no folder nowhere"),
    ("sensitivity study.toml", "needs a section .sensitivity."),
    ("kinetic --kn 0 --tac-top 0.8 --tac-bottom 0.9", "--kn = 0 is not between 0.03 and 100"),
    ("kinetic --kn 1 --tac-top 1.8 --tac-bottom 0.9", "--tac-top = 1.8 is not between 0"),
    ("kinetic --kn 1", r"kinetic needs --tac-top \(.* and --tac-bottom \("),
    (f"{KINETIC} --gas xenon", 'Choose from: "monatomic", "diatomic"'),
    (f"{KINETIC} --boundary 1", "is not at least 1.5"),
    (f"{KINETIC} --temperature-ratio 2 --top-temperature 1", "--top-temperature"),
    (f"{KINETIC} --top-temperature inf", "--top-temperature = inf is not a finite number"),
    (f"{KINETIC} --top-temperature-ratio 2", "--top-temperature-ratio needs --temperature-ratio"),
    (f"{KINETIC} --open-fraction 1 --out o", "--open-fraction = 1 is not between 0 and 0.999"),
    (f"{KINETIC} --wall rough", "rough"),
    (f"{KINETIC} --tangential-accommodation 0.9", "--tangential-accommodation"),
    (f"{KINETIC} --wall cercignani-lampis --tangential-accommodation 0.2", "no wall has tac_top"),
    (f"{KINETIC} --floor 2 --lid 3", "--lid needs --side; alone it does nothing"),
    (f"{KINETIC} --floor-temperature 0.1", "--floor-temperature needs --floor"),
    (f"{KINETIC} --floor 0.01 --lid 3 --side 3", "--floor = 0.01 is not at least 0.1"),
    (f"{KINETIC} --floor 2 --lid 3 --side 3 --boundary 4", "--boundary cannot be combined with"),
    (f"{KINETIC} --floor 2 --lid 3 --side 3 --reservoir roof", 'Choose from: "floor", "lid"'),
    (f"{KINETIC} --radiation 0.1", "radiation belongs to film"),
    (f"{KINETIC} --temperature-ratio 9", "is not between 0.5 and 3.5"),
    ("init flyer.toml", "already exists; --force overwrites it"),
    ("init x.toml --kind rocket", "is unknown; choose from earth"),
    ("init nowhere/x.toml", "cannot be written: No such file"),
    ("lab example magic", 'Choose from: "force", "ftir", "levitation"'),
    ("lab tac points.csv", "needs the column heater_power"),
    ("lab ftir points.csv", "has no known column"),
    ("lab levitation points.csv --update flyer.toml", "--update needs --calibrate"),
    ("lab roughness points.csv", "is not a number"),
    ("lab roughness matrix.txt --size 1um --channel Height", "has no effect"),
    ("bogus", 'Unknown command "bogus"'),
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Files that the commands below are given."""
    made = tmp_path_factory.mktemp("bad")
    names = {"flyer.toml": "earth", "study.toml": "sweep", "points.csv": "points"}
    names |= {f"{kind}.toml": kind for kind in ("chamber", "layers", "optimise", "mission")}
    for name, kind in names.items():
        (made / name).write_text(TEXTS[kind], encoding="utf-8")
    (made / "one.csv").write_text("\n".join(TEXTS["points"].splitlines()[:7]), encoding="utf-8")
    (made / "latin.toml").write_bytes("# µ\n".encode("latin-1"))
    (made / "binary.toml").write_bytes(b"\xff\xfe\x00binary")
    (made / "empty.toml").touch()
    (made / "blank.toml").write_text("  \n")
    (made / "matrix.txt").write_text("\n".join(["1 2 3 4 5 6 7 8 9"] * 9))
    (made / "folder").mkdir()
    return made


@pytest.mark.parametrize(("command", "message"), COMMANDS, ids=[line for line, _ in COMMANDS])
def test_a_mistake_on_the_command_line(run, folder, monkeypatch, command, message):
    monkeypatch.chdir(folder)
    before = sorted(folder.iterdir())
    errors = require_one_line(run(*command.split()))
    assert re.search(message, errors), errors
    assert sorted(folder.iterdir()) == before


def test_options_are_written_with_blanks(run, folder, monkeypatch):
    monkeypatch.chdir(folder)
    for line, message in (
        (("predict", "flyer.toml", "--at", ""), "names no altitude"),
        (("predict", "flyer.toml", "--at", "70 km;80 km"), "is not a unit"),
        (("predict", "flyer.toml", "--at", "70 km,-5 km"), "--at: altitude -5 km must be between"),
        (("predict", "flyer.toml", "--at", "75 ± 1 km"), '--at "75 ± 1 km": takes no ±'),
        (("predict", "chamber.toml", "--at", "2e9 Pa"), "must be at most 1e+07 Pa"),
        (
            ("compare", "flyer.toml", "flyer.toml", "--altitudes", "80 km to 50 km"),
            "the first must be the lower one",
        ),
        (("compare", "flyer.toml", "flyer.toml", "--altitudes", "1 to 9 km"), 'write "1 km"'),
        (("film", "layers.toml", "--at", "550 ± 5 nm"), '--at "550 ± 5 nm": takes no ±'),
        (("calibrate", "points.csv", "--free", ""), "no parameters to fit"),
        (("calibrate", "points.csv", "--free", "emittance[Ge 9 cm]"), "has no sample"),
        (("lab", "thermography", "--hotplate", "350 K"), "or also --lower, --upper"),
    ):
        assert message in require_one_line(run(*line))


POINTS = [
    ("pressure [mTorr]", "pressure", 'has no unit; write "pressure [Pa]"'),
    (
        "pressure [mTorr]",
        "druck [mTorr]",
        "needed: pressure [Pa], irradiance [W/m^2]; found: sample, druck",
    ),
    ("239, 2, 60", "-1, 2, 60", "is not zero or positive"),
]


@pytest.mark.parametrize(("old", "new", "message"), POINTS)
def test_a_mistake_in_a_table(run, write, old, new, message):
    path = write(TEXTS["points"], "points.csv", (old, new))
    assert message in require_one_line(run("calibrate", path), place=r"points\.csv:\d+")


FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DISK = lf.Disk(FILM, 0.01)
OBJECTS = [
    (lambda: replace(FILM, absorptance=1.75), "absorptance = 1.75 is not between 0 and 1"),
    (lambda: lf.FilmProperties(-1.0, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9), "areal"),
    (lambda: lf.Earth(atmosphere="us1976"), "atmosphere"),
    (lambda: lf.Earth().state(-5e3), "altitude"),
    (lambda: lf.Chamber().state(-1.0), "pressure"),
    (lambda: lf.predict("nothere.toml"), "nothere.toml"),
    (lambda: lf.predict(FILM), "flyer"),
    (lambda: lf.sweep(lf.Disk(FILM, 0.01), lf.Earth(), lf.Lu2023(), over={"x": [1.0]}), "x"),
    (lambda: lf.optimise(lf.Disk(FILM, 0.01), lf.Earth(), FreeMolecular()), "over"),
    (lambda: lf.sweep(DISK, lf.Earth(), lf.Lu2023(), over=[], outputs="lift"), "over"),
    (
        lambda: lf.compare([DISK, DISK], lf.Earth(), FreeMolecular(), searched=("1 Pa", 2)),
        "searched",
    ),
    (lambda: lf.calibrate(DISK, lf.Chamber(), lf.Lu2023(), points="points.csv"), "points"),
    (lambda: lf.calibration.Points("", ["a"], {"pressure": [1.0]}), "irradiance"),
    (lambda: lf.calibration.Points("", [], {"pressure": [1.0], "irradiance": [1.0]}), "pressure"),
    (lambda: lf.film.Film(("Ge",)), "layer"),
    (lambda: lf.mission.Ensemble(members=2.5), "members"),
    (lambda: lf.lab.TacAccuracy(gauge="5 K"), "gauge"),
    (lambda: lf.lab.weighted_mean([0.8, 0.9]), "estimate"),
    (lambda: lf.fly(DISK, lf.Earth(), FreeMolecular(), release="75 km", duration="1 h"), "release"),
]


@pytest.mark.parametrize(("make", "named"), OBJECTS)
def test_a_mistake_in_python_names_the_argument(make, named):
    with pytest.raises(lf.LightflyerError) as caught:
        make()
    assert named in str(caught.value)
    assert str(caught.value).count("\n") == 0


def test_altitudes_beyond_the_atmosphere(refuses, flyer_file):
    path = flyer_file('"0 deg"', '"0 deg"\naltitude_max = "300 km"')
    assert "altitude" in refuses("predict", path, "--out", path.parent / "out")
    assert not (path.parent / "out").exists()


def test_advice_for_scripts_is_not_given_to_commands(refuses, monkeypatch):
    fails = partial(require_converged, "x", np.array([1]), np.array([1.0]))
    with pytest.raises(lf.ConvergenceError, match="or pass throw=False"):
        fails()
    monkeypatch.setattr(cli, "_require_files", lambda _: fails())
    errors = refuses("predict", "flyer.toml")
    assert "x: 1 of 1 not converged" in errors
    assert "throw" not in errors
