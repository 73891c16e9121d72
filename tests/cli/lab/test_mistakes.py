"""One line for each mistake in files and options, and nothing written."""

import shlex

import pytest

VANE = "--diameter '12 cm' --hot '419 ± 2 K' --cold '394 ± 2 K'"
CURVE = f"{VANE} --pressures '0.01 Pa, 10 Pa'"
MAP = "map.txt --unit nm --size 1um"
HOT = "--hotplate '150 °C' --lower '50 °C' --upper '130 °C'"
GIVEN = f"{HOT} --ambient '22 °C'"
BOTH = "--top tac-top.txt --bottom tac-bottom.txt"
LIGHT = "pressure [Pa],irradiance [W/m^2]\n"
HEATER = "pressure [Pa],heater_power [W],heater_temperature [K],ambient_temperature [K]\n"
RUN = HEATER + "1,1,320,295\n"
EITHER = "give either the files of one surface, or those of both faces"

FILES = {
    "map.txt": "\n".join(" ".join(str((i * j) % 7) for i in range(20)) for j in range(20)),
    "image.jpg": "",
    "meter.csv": "",
}
# by measurement: arguments, what is said, and the content of raw.csv
CASES = {
    "force": [
        (f"{VANE} --pressures '2 Pa, 1 Pa'", "write two that increase"),
        (f"{CURVE} --tac-hot 0.9", "either --tac, or both --tac-hot and --tac-cold"),
        (CURVE.replace("12 cm", "12"), '"12" has no unit'),
    ],
    "ftir": [
        ("missing.jdx", "missing.jdx: cannot be read"),
        ("film.jdx --update a.toml", "upper bound"),
        ("film.jdx --band '900 cm^-1'", "has no width"),
        ("film.jdx --band '9000 ± 400 cm^-1'", "no data in the band"),
        ("film.jdx --band '900 ± 1400 cm^-1'", "reaches below zero"),
        ("film.jdx --temperatures ''", '--temperatures "" has no quantity in it'),
        ("film-reflectance.csv", "shows reflectance, not transmittance"),
    ],
    "levitation": [
        ("raw.csv", "raw.csv:2: raw has 1 point", LIGHT + "1,2\n"),
        ("raw.csv", "raw.csv:1: the column irradiance is missing", "pressure [Pa]\n1\n"),
        ("raw.csv --span 3", "span = 3 is not between", LIGHT + "1,2\n"),
        ("raw.csv --calibrate", "--flyer", LIGHT + "1,2\n"),
        ("raw.csv --step '2 Pa'", "--step: ", LIGHT + "1,2\n"),
        ("raw.csv --step '1 kW/m^2'",
         "step = 1000 W/m^2 is not smaller than the least irradiance, 900 W/m^2",
         LIGHT + "".join(f"{p},900\n" for p in range(1, 10))),
        ("raw.csv --update a.toml", "--calibrate", LIGHT + "1,2\n"),
    ],
    "roughness": [
        ("map.txt", 'map.txt: its heights have no unit; state it by --unit "nm"'),
        ("map.txt --unit nm", 'map.txt: has no width; state it by --size "10 um"'),
        ("map.txt --unit nm --size -1um", '--size: "-1um" is not positive'),
        (f"{MAP} --flatten rows --flatten-order 2", "flatten_order = 2"),
    ],
    "tac": [
        ("raw.csv", "raw.csv: is empty", ""),
        ("raw.csv", "raw.csv:2: has 1 usable row;", RUN),
        ("raw.csv", "raw.csv: its pressures do not determine", HEATER + "1,0.05,320,295\n" * 9),
        ("raw.csv", "raw.csv:2: heater_power = -0.05 W is not pos", HEATER + "1,-0.05,320,295\n"),
        ("raw.csv", "raw.csv:2: the heater at 290.00 K is not warmer", HEATER + "1,1,290,295\n"),
        ("raw.csv", "raw.csv: has a header but no rows", HEATER.replace("pressure", "Größe")),
        ("raw.csv", "raw.csv: needs the column heater_temp", "pressure [Pa],power [W]\n1,2\n"),
        ("raw.csv --update none.toml --face top", "", RUN),
        ("raw.csv --gauge-accuracy 5", 'per cent are written "5 %"', RUN),
        ("raw.csv '--power-accuracy=-1 %'", "--power-accuracy = -0.01 is not", RUN),
        ("raw.csv --wall '9 cm' --reading printed", "--wall is for", RUN),
        ("--top tac-top.txt", EITHER),
        ("tac-top.txt --bottom tac-bottom.txt", EITHER),
        ("", EITHER),
        ("tac-top.txt --other-face 0.8", "--other-face"),
        (f"{BOTH} --other-face 0.8±0.9", '--other-face "0.8±0.9" is not known by its ±'),
        ("--top tac-top.txt --bottom tac-top.txt", "has the same data as tac-top.txt"),
        (f"{BOTH} --update flyer.toml --face top",
         "--face is for runs of one surface; with --top and --bottom both are written"),
    ],
    "thermography": [
        ("", "give a file, or also --hotplate, --lower"),
        (f"{GIVEN} --hotplate-emissivity '0.2 ± 0.3'", "is not known"),
        ("image.jpg", "an image needs --regions"),
        (f"{HOT} --ambient '160 °C'", "ambient_temperature = 433.15 must be between 200 and 400 K"),
        (GIVEN.replace("150", "20"), "hotplate_temperature is not above ambient_temp"),
        (f"--light-meter {GIVEN}", "--light-meter needs a file"),
        (GIVEN.replace("50 °C' --upper '130", "60 °C' --upper '146"), "is impossible"),
        (GIVEN.replace("'50 °C", "'170 °C"), "is not above lower_temperature"),
        (f"{GIVEN} --band '5 um'", "is not a band"),
        (f"{GIVEN} --accuracy '200 K'", "without meaning"),
        (f"{GIVEN} --film-temperature '145 °C'", "too close to the hotplate's"),
        ("meter.csv --light-meter --band '8-14 um'", "takes no temperatures"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "arguments", "says", "raw"),
    [
        (name, *case[:2], (case[2:] or (None,))[0])
        for name, cases in CASES.items()
        for case in cases
    ],
)
def test_one_line_for_each_mistake(folder, examples, lab_refuses, name, arguments, says, raw):
    if name in ("ftir", "tac") and raw is None:
        examples(name)
    for file, text in (FILES if raw is None else {"raw.csv": raw}).items():
        (folder / file).write_text(text, encoding="utf-8")
    assert says in lab_refuses(name, *shlex.split(arguments), "--out", "o")
    assert not (folder / "o").exists()
