"""``lightflyer lab thermography``: emissivity from temperatures, absorptivity from light."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import Insist, deliver, read_parts, read_summary, updater
from lightflyer.cli.options import Json, Seed, Whole, only_with
from lightflyer.cli.quantities import difference, exact, known, quantity, share
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.core.units import Measured
    from lightflyer.lab.thermography.data import Readings, Scene
    from lightflyer.lab.thermography.reduction import RadiativeProperties
    from lightflyer.lab.thermography.thermal_image import ThermalImage


@only_with(
    image_unit="regions", image_zero="image_unit", image_emissivity="regions",
    image_reflected="regions", face="update", insist="update",
)  # fmt: skip
def thermography_command(
    file: Path | None = None,
    /,
    *,
    light_meter: Annotated[bool, Parameter(negative=())] = False,
    band: str | None = None,
    columns: str | None = None,
    hotplate: str | None = None,
    lower: str | None = None,
    upper: str | None = None,
    ambient: str | None = None,
    hotplate_emissivity: str | None = None,
    film_temperature: str | None = None,
    regions: str | None = None,
    image_unit: str | None = None,
    image_zero: str | None = None,
    image_emissivity: str | None = None,
    image_reflected: str | None = None,
    accuracy: str | None = None,
    draws: Whole = 100_000,
    seed: Seed = 0,
    out: Path | None = None,
    update: Path | None = None,
    insist: Insist = False,
    face: Literal["top", "bottom", "both"] = "both",
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Find reflectance, transmittance and emissivity from apparent temperatures.

    Parameters
    ----------
    file
        Table with the columns hotplate_temperature, lower_temperature, upper_temperature and
        ambient_temperature, one measurement per row; or, with --regions, an image: FLIR's
        radiometric .jpg or .fff, a radiometric .tiff, or a matrix of temperatures in a text file.
        Without a file, the options --hotplate, --lower, --upper and --ambient give the
        temperatures.
    light_meter
        The columns are incident, reflected, transmitted and dark, readings of a light meter in
        any one unit, which give the visible absorptivity.
    band
        Camera's band, such as "8-14 um", or the file of its spectral response with the columns
        wavelength and response, or "total" for the paper's T⁴. Assumed to be "7.5-14 um" where it
        is not stated.
    columns
        Columns in the order of the file, in place of a header.
    hotplate
        Apparent temperature of the hotplate, such as "150 ± 0.5 °C", where the file has no such
        column.
    lower
        Apparent temperature of the film's lower side.
    upper
        Apparent temperature of the film's upper side.
    ambient
        Temperature of the surroundings.
    hotplate_emissivity
        Emissivity of the hotplate in the camera's band, such as "0.95 ± 0.02", where its
        temperature is its own and not an apparent one.
    film_temperature
        The film's own temperature, such as "30 ± 5 °C"; that of the surroundings where it is not
        stated.
    regions
        Regions of an image, rows and then columns: "hotplate=10:40,20:60; upper=50:80,20:60".
    image_unit
        Unit of the numbers of a .tiff or a text file that does not state it, such as "°C", or
        "0.01 K" for hundredths of a kelvin.
    image_zero
        Temperature of the number zero, such as "-100 °C", where it is not that of the unit.
    image_emissivity
        Emissivity for the temperatures of a FLIR image, in place of the one that the camera was
        set to; 1 for apparent temperatures.
    image_reflected
        Temperature of the radiation that the scene reflects, in place of the camera's setting.
    accuracy
        Standard uncertainty of each reading that states none, such as "0.5 K", less what all
        readings share; of a light meter relative to its reading, such as "0.5 %". Default: limits
        of 2 K or 2 % of the reading in °C, of a light meter 2 %, divided by √3, assumed.
    draws
        Number of Monte Carlo draws.
    seed
        Seed of the draws.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    update
        Flyer file to write the emissivity (the absorptance for a light meter) into.
    insist
        Have --update write also what is in doubt: of a wrong unit, not determined, or of data that
        do not fit or not cover it.
    face
        Face of that film.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.lab.thermography import reduction as thermography
    from lightflyer.lab.thermography.text import finding_parts

    texts = {"hotplate": hotplate, "lower": lower, "upper": upper, "ambient": ambient}
    given = {f"{name}_temperature": one for name, one in _quantities(texts, "K").items()}
    if light_meter and (given or band or hotplate_emissivity or film_temperature or file is None):
        raise ConfigurationError("--light-meter needs a file and takes no temperatures and no band")
    own = _accuracy(accuracy, light_meter=light_meter)
    image = None
    if light_meter:
        readings, tables = _meter_readings(file, columns, own)
    else:
        scene = _scene(band, hotplate_emissivity, film_temperature)
        settings = image_unit, image_zero, image_emissivity, image_reflected
        image = _image(file, regions, settings)
        readings, tables = (
            _table_readings(file, columns, given, own, scene)
            if image is None
            else (_image_readings(image, regions, given, own, scene), [])
        )
    result = thermography.reduce_readings(readings, draws=draws, seed=seed)
    document = result.summary() | {"read": read_summary(tables)}
    if image is not None:
        document["image"] = image.summary()
    files = [] if file is None else [file]
    values = _values(result, face, light_meter=light_meter)

    def draw() -> "dict[str, Figure]":
        from lightflyer.lab.thermography.figures import thermography_figures
        from lightflyer.lab.thermography.thermal_image import parse_regions

        return thermography_figures(result, image, parse_regions(regions or ""))

    about = [] if image is None else [image.description]
    deliver(
        "thermography", document, thermography.to_dataset(result, [str(f) for f in files]), draw,
        [*finding_parts(result), *read_parts(tables), *about, *result.text_parts()],
        out=out, figures=figures, json_output=json_output,
        update=updater(update, values, f"thermography, {result.meaning}", files, insist=insist,
                       warnings=result.warnings),
    )  # fmt: skip


def _quantities(texts: dict[str, str | None], unit: str) -> "dict[str, Measured]":
    return {
        name: quantity(f"--{name}", text, unit) for name, text in texts.items() if text is not None
    }


def _accuracy(text: str | None, *, light_meter: bool) -> float | None:
    if text is None:
        return None
    if light_meter:
        return share("--accuracy", text)
    value = difference("--accuracy", text, "K")
    if value < 0.0:
        raise ConfigurationError(f'--accuracy: "{text}" is negative')
    return value


def _scene(band: str | None, emissivity: str | None, film: str | None) -> "Scene":
    from lightflyer.core.errors import ParameterError
    from lightflyer.lab.thermography.camera import UNCOOLED, parse_band
    from lightflyer.lab.thermography.data import BLACK, Scene

    camera = UNCOOLED if band is None else parse_band(band)
    own = BLACK if emissivity is None else known("--hotplate-emissivity", emissivity, "")
    warmth = None if film is None else quantity("--film-temperature", film, "K")
    try:
        return Scene(camera, own, warmth)
    except ParameterError as error:
        raise ConfigurationError(f"--{str(error).replace('_', '-', 1)}") from None


def _meter_readings(
    file: Any, columns: str | None, accuracy: float | None
) -> "tuple[Readings, list]":
    from lightflyer.lab.thermography.data import LIGHT, read_readings

    readings, table = read_readings(file, LIGHT, columns=columns, accuracy=accuracy)
    return readings, [table]


def _table_readings(
    file: Path | None, columns: str | None, given: "dict[str, Measured]",
    accuracy: float | None, scene: "Scene",
) -> "tuple[Readings, list]":  # fmt: skip
    from lightflyer.lab.thermography.data import THERMAL, given_readings, read_readings

    if file is None:
        return given_readings(given, THERMAL, accuracy=accuracy, scene=scene), []
    readings, table = read_readings(
        file, THERMAL, columns=columns, given=given, accuracy=accuracy, scene=scene
    )
    return readings, [table]


def _image(
    file: Path | None, regions: str | None, settings: tuple[str | None, ...]
) -> "ThermalImage | None":
    """The image that the options name, if they name one."""
    from lightflyer.lab.thermography.images.scaled import parse_scale
    from lightflyer.lab.thermography.thermal_image import (
        is_thermal_image,
        parse_regions,
        read_thermal_image,
    )

    if file is None or not (regions or is_thermal_image(file)):
        if regions:
            raise ConfigurationError("--regions is for an image; give its file")
        return None
    if regions is None:
        raise ConfigurationError(f'{file}: an image needs --regions "hotplate=10:40,20:60; ..."')
    parse_regions(regions)
    unit, zero, emissivity, reflected = settings
    own, behind = (
        None if text is None else exact(option, text, of)
        for option, text, of in (
            ("--image-emissivity", emissivity, ""),
            ("--image-reflected", reflected, "K"),
        )
    )
    scale = None if unit is None else parse_scale(unit, zero)
    return read_thermal_image(file, scale=scale, emissivity=own, reflected_temperature=behind)


def _image_readings(
    image: "ThermalImage", regions: str | None, given: "dict[str, Measured]",
    accuracy: float | None, scene: "Scene",
) -> "Readings":  # fmt: skip
    import dataclasses

    from lightflyer.lab.thermography.data import (
        THERMAL,
        accuracy_warnings,
        given_readings,
        with_accuracy,
    )
    from lightflyer.lab.thermography.thermal_image import (
        parse_regions,
        region_temperatures,
        region_warnings,
        setting_warnings,
    )

    rectangles = parse_regions(regions or "")
    kelvin = image.temperature
    found = with_accuracy(region_temperatures(kelvin, rectangles, image.source), accuracy) | given
    readings = given_readings(found, THERMAL, accuracy=accuracy, scene=scene)
    said = (
        *setting_warnings(image, found["ambient_temperature"].value),
        *region_warnings(kelvin, rectangles),
        *accuracy_warnings(THERMAL, accuracy),
        *readings.warnings,
    )
    return dataclasses.replace(readings, warnings=tuple(dict.fromkeys(said)))


def _values(
    result: "RadiativeProperties", face: Literal["top", "bottom", "both"], *, light_meter: bool
) -> dict[tuple[str, str], Any]:
    from lightflyer.config.update import emittance_keys

    if not light_meter:
        return dict.fromkeys(emittance_keys(face), result.emissivity)
    keys = {"top": ["absorptance"], "bottom": ["absorptance_bottom"]}
    both = [*keys["top"], *keys["bottom"]]
    return {("film", key): result.emissivity for key in keys.get(face, both)}
