"""The part of the config on the spectrum: its band, its samples and its source."""

from math import pi
from typing import TYPE_CHECKING, Annotated, NamedTuple

from pydantic import Field, ValidationInfo, field_validator, model_validator

from octsim.config.fields import Section, Wavelength
from octsim.config.fields import key as _key
from octsim.config.pixels import PixelPolynomial, PixelsConfig, PixelTable, inside, within
from octsim.config.source import SourceConfig, source_of
from octsim.optics.band import wavenumbers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Recorded(NamedTuple):
    """What a spectrometer records."""

    intensity: "NDArray[np.float64]"
    """(K,)."""
    brightest: float
    """The source's largest power there; 1 of a flat one."""


class Wavelengths(Section):
    """The band, in vacuum."""

    min: Wavelength = _key("650 nm", "shortest wavelength")
    max: Wavelength = _key("900 nm", "longest wavelength")


class Spectrum(Section):
    """The spectrum of the source and the samples taken of it."""

    wavelength: Wavelengths = Wavelengths()
    samples: Annotated[int, Field(ge=2, le=1_000_000)] = _key(
        1000, "wavenumbers, evenly spaced, both ends included"
    )
    source: SourceConfig = _key(
        "flat",
        "its power at each wavelength: flat, {gaussian: {centre: 840 nm, fwhm: 50 nm}}, or a CSV "
        "file of wavelength and power",
    )
    pixels: PixelsConfig = _key(
        None,
        "of the spectrometer: lab, which is measured.axis, {wavelength: calib.csv} or {polynomial: "
        "[c0, c1, c2]}; each sees the mean over its width, and there are as many samples",
    )

    @field_validator("pixels")
    @classmethod
    def _pixels_of_the_band(
        cls, given: PixelTable | PixelPolynomial | None, info: ValidationInfo
    ) -> PixelTable | PixelPolynomial | None:
        band = info.data.get("wavelength")
        return given if given is None or band is None else within(given, band)

    @model_validator(mode="after")
    def _as_many_samples_as_pixels(self) -> "Spectrum":
        if self.pixels is None:
            return self
        return self.model_copy(update={"samples": self._in_the_band().size})

    def _in_the_band(self) -> "NDArray[np.float64]":
        """Return the wavelengths of the pixels in the band, rising, µm."""
        return inside(self._middles, self.wavelength)

    @property
    def _middles(self) -> "NDArray[np.float64]":
        assert isinstance(self.pixels, PixelTable), "a checked config has no other"
        return self.pixels.middles

    def wavenumbers(self) -> "NDArray[np.float64]":
        """Return the wavenumbers 2π/λ, evenly spaced and increasing, shape (K,), 1/µm.

        Between the ends of the band, or the middles of its outermost pixels.
        """
        if self.pixels is None:
            return wavenumbers(self.wavelength.min, self.wavelength.max, self.samples)
        middles = self._in_the_band()
        return wavenumbers(middles[0], middles[-1], self.samples)

    @property
    def plain(self) -> bool:
        """Whether what is recorded is the intensity itself."""
        return self.source == "flat" and self.pixels is None

    def recorded(
        self, intensity: "NDArray[np.float64]", wavenumber: "NDArray[np.float64]"
    ) -> Recorded:
        """Return what a spectrometer records of intensities (K,) of a flat source.

        Times the source's power, and as a mean over each pixel, at wavenumbers (K,), 1/µm.
        """
        source = source_of(self.source)
        lit, brightest = intensity, 1.0
        if source is not None:
            power = source.power(wavenumber)
            lit, brightest = intensity * power, float(power.max())
        if self.pixels is None:
            return Recorded(lit, brightest)
        import numpy as np  # here, as reading a config takes half as long without

        from octsim.optics.pixels import pixel_means

        middle = 2 * np.pi / self._middles[::-1]
        width = np.interp(wavenumber, middle, np.gradient(middle))
        return Recorded(pixel_means(lit, wavenumber, width), brightest)

    def power(self) -> "NDArray[np.float64] | None":
        """Return the source's power at the wavenumbers, over its largest, (K,); None of a flat one.

        It is that of each sample, as a spectrometer counts: no factor dλ/dk is applied.
        """
        source = source_of(self.source)
        return None if source is None else source.power(self.wavenumbers())

    @property
    def middle(self) -> float:
        """Wavenumber in the middle of the band, 1/µm."""
        band = self.wavelength
        return (2 * pi / band.max + 2 * pi / band.min) / 2
