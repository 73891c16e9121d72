"""What ``lightflyer lab tac`` writes and prints of runs of one face, and of both."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from lightflyer.files.result_text import Parts

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from lightflyer.config.update import Face
    from lightflyer.lab.estimate import Estimate
    from lightflyer.lab.tac.difference import TacDifference
    from lightflyer.lab.tac.fit import TacFit


class OneFace:
    """Runs of one surface."""

    digits = 2

    def __init__(self, fits: "Sequence[TacFit]", face: "Face | None"):
        self.fits, self.face = fits, face
        self.sides = (fits,)

    @property
    def warnings(self) -> list[str]:
        from lightflyer.lab.tac.record import warnings_of

        return warnings_of(self.fits)

    def summary(self) -> dict[str, Any]:
        from lightflyer.lab.tac.record import summary

        return summary(self.fits)

    def dataset(self, warnings: Sequence[str]) -> "xr.Dataset":
        from lightflyer.lab.tac.record import to_dataset

        return to_dataset(self.fits, warnings)

    def figures(self) -> "dict[str, Figure]":
        from lightflyer.lab.tac.figures import tac_figures

        return tac_figures(self.fits)

    def tables(self) -> dict[str, str]:
        from lightflyer.lab.tac.record import tables

        return tables(self.fits)

    @property
    def finding(self) -> str:
        from lightflyer.lab.tac.record import mean_tac

        return f"TAC α {mean_tac(self.fits)}"

    def parts(self) -> Parts:
        from lightflyer.lab.tac.record import mean_tac
        from lightflyer.lab.tac.text import errors_parts, fit_parts, runs_parts

        for fit in self.fits:
            yield from fit_parts(fit)
            yield from errors_parts(fit)
        if len(self.fits) > 1:
            yield from runs_parts(self.fits, mean_tac(self.fits))

    def values(self) -> "dict[tuple[str, str], Estimate]":
        from lightflyer.config.update import tac_keys
        from lightflyer.lab.tac.record import mean_tac

        return dict.fromkeys(tac_keys(self.face), mean_tac(self.fits)) if self.face else {}

    def about_faces(self, file: Any) -> str:
        from lightflyer.lab.tac.record import correlation_between_samples

        if self.face == "both":
            return "the same coefficient on both faces gives a flyer without force"
        film = getattr(file, "film", None)
        other = getattr(film, "tac_bottom" if self.face == "top" else "tac_top", None)
        if not getattr(other, "uncertainty", None):
            return ""
        return (
            "where both faces were measured on this bench, they share the errors of gauge and "
            f"plateau: tac_correlation = {correlation_between_samples(self.fits):.2g} says so (it "
            f"is {film.tac_correlation.value:g}), "  # type: ignore[union-attr]
            "and --top and --bottom, which fit runs of both together, know it better"
        )


class TwoFaces:
    """Runs of both faces."""

    digits = 4  # the difference of both ± must keep the uncertainty of the coefficients' difference

    def __init__(self, found: "TacDifference"):
        self.found = found
        self.sides = found.top, found.bottom
        self.warnings, self.summary = found.warnings, found.summary

    def dataset(self, warnings: Sequence[str]) -> "xr.Dataset":
        from lightflyer.lab.tac.difference_record import difference_dataset

        return difference_dataset(self.found, warnings)

    def figures(self) -> "dict[str, Figure]":
        from lightflyer.lab.tac.figures import difference_figures

        return difference_figures(self.found)

    def tables(self) -> dict[str, str]:
        from lightflyer.lab.tac.difference_record import difference_tables

        return difference_tables(self.found)

    @property
    def finding(self) -> str:
        return f"TAC α, top less bottom {self.found.difference}"

    def parts(self) -> Parts:
        from lightflyer.lab.tac.text import difference_parts

        return difference_parts(self.found)

    def values(self) -> "dict[tuple[str, str], Estimate]":
        return self.found.film_values()

    def about_faces(self, file: Any) -> str:
        del file
        return ""
