"""Emissivity from apparent temperatures, absorptivity from a light meter."""

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.quantities import difference, share
from lightflyer.lab import options

if TYPE_CHECKING:
    from lightflyer.lab.result import Outcome


@options.measurement(
    image_unit="regions", image_zero="image_unit", image_emissivity="regions",
    image_reflected="regions", face="update",
)  # fmt: skip
def thermography(
    file: Path | None = None,
    /,
    *,
    light_meter: bool = False,
    band: str | None = None,
    columns: str | None = None,
    hotplate: options.MeasuredKelvins = None,
    lower: options.MeasuredKelvins = None,
    upper: options.MeasuredKelvins = None,
    ambient: options.MeasuredKelvins = None,
    hotplate_emissivity: options.KnownNumber = None,
    film_temperature: options.MeasuredKelvins = None,
    regions: str | None = None,
    image_unit: str | None = None,
    image_zero: str | None = None,
    image_emissivity: options.Number = None,
    image_reflected: options.Kelvins = None,
    accuracy: str | None = None,
    draws: int = 100_000,
    seed: int = 0,
    update: Path | None = None,  # noqa: ARG001  (written by the command)
    face: options.Face = "both",
) -> "Outcome":
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
    update
        Flyer file to write the emissivity (the absorptance for a light meter) into.
    face
        Face of that film.
    """
    from lightflyer.config.update import emittance_keys
    from lightflyer.lab.result import Outcome, figures_by
    from lightflyer.lab.thermography import data, thermal_image
    from lightflyer.lab.thermography.data import UNCOOLED, parse_band
    from lightflyer.lab.thermography.reduction import reduce_readings, to_dataset

    texts = {"hotplate": hotplate, "lower": lower, "upper": upper, "ambient": ambient}
    given = {f"{name}_temperature": one for name, one in texts.items() if one is not None}
    if light_meter and (given or band or hotplate_emissivity or film_temperature or file is None):
        raise ConfigurationError("--light-meter needs a file and takes no temperatures and no band")
    stated = None
    if accuracy is not None:
        read: Any = share if light_meter else difference
        stated = read("--accuracy", accuracy, *([] if light_meter else ["K"]))
    scene, image, areas = None, None, thermal_image.parse_regions(regions or "")
    said: list[str] = []
    if not light_meter:
        camera = UNCOOLED if band is None else parse_band(band)
        try:
            scene = data.Scene(camera, hotplate_emissivity or data.BLACK, film_temperature)
        except ParameterError as error:
            raise ConfigurationError(f"--{str(error).replace('_', '-', 1)}") from None
        if regions and file is None:
            raise ConfigurationError("--regions is for an image; give its file")
    if scene and file is not None and (regions or thermal_image.is_thermal_image(file)):
        if regions is None:
            raise ConfigurationError(
                f'{file}: an image needs --regions "hotplate=10:40,20:60; ..."'
            )
        parse = thermal_image.parse_scale
        scale = None if image_unit is None else parse(image_unit, image_zero)
        image = thermal_image.read_thermal_image(
            file,
            scale=scale,
            emissivity=image_emissivity,
            reflected_temperature=image_reflected,
        )
        kelvin = image.temperature
        seen = thermal_image.region_temperatures(kelvin, areas, image.source)
        given = data.with_accuracy(seen, stated) | given
        said += thermal_image.region_warnings(kelvin, areas)
        said += data.accuracy_warnings(data.THERMAL, stated)
    tables = []
    if file is None or image is not None:
        readings = data.given_readings(given, data.THERMAL, accuracy=stated, scene=scene)
    else:
        readings, table = data.read_readings(
            file, data.LIGHT if light_meter else data.THERMAL, columns=columns, given=given,
            accuracy=stated, scene=scene,
        )  # fmt: skip
        tables = [table]
    if image is not None:
        ambient_read = given["ambient_temperature"].value
        said = [*thermal_image.setting_warnings(image, ambient_read), *said, *readings.warnings]
        readings = dataclasses.replace(readings, warnings=tuple(dict.fromkeys(said)))
    result = reduce_readings(readings, draws=draws, seed=seed)
    keys = emittance_keys(face)
    if light_meter:
        names = {"top": ["absorptance"], "bottom": ["absorptance_bottom"]}
        both = ["absorptance", "absorptance_bottom"]
        keys = [("film", key) for key in names.get(face, both)]

    files = [] if file is None else [file]
    return Outcome(
        result.summary() | ({} if image is None else {"image": image.summary()}),
        to_dataset(result, [str(one) for one in files]),
        [
            *result.finding(),
            *([] if image is None else [image.description]), *result.parts(),
        ],
        read=tables,
        warnings=result.warnings,
        figures=figures_by("thermography.figures:thermography_figures", result, image, areas),
        values=dict.fromkeys(keys, result.emissivity),
        origin=f"thermography, {result.meaning}",
        sources=files,
    )  # fmt: skip
