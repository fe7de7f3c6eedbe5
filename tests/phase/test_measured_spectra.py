"""Measured spectra: read as they were written, in any unit; what can't be used is refused."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import octsim
from octsim.base.errors import ConfigError, DatasetError, FileError
from octsim.config.processing import Processing
from octsim.phase.measured_spectra import even, read_spectra

WAVELENGTH = np.linspace(650, 900, 1024)  # nm, as a spectrometer has it
PHASES = np.array([0.3, -2.0, 1.1])


def spectra_at(wavenumber: NDArray[np.float64]) -> xr.DataArray:
    k_mid = np.pi / 0.65 + np.pi / 0.9
    angle = 2 * 1.95 * (wavenumber - k_mid) + PHASES[:, np.newaxis]
    return xr.DataArray(1000 * (2 + np.cos(angle)), dims=("time", "at"))


BY_WAVELENGTH = spectra_at(2000 * np.pi / WAVELENGTH).values


def write_csv(
    path: Path, head: str, *columns: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> Path:
    rows = "\n".join(",".join(f"{float(v)!r}" for v in row) for row in zip(*columns, strict=True))
    path.write_text(f"{head}\n{rows}\n", encoding="utf-8")
    return path


def test_csv_of_wavelengths_is_read_and_its_phases_found(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "s.csv", "wavelength (nm),a,b,c", WAVELENGTH, *BY_WAVELENGTH)
    measured = read_spectra(path)
    assert measured.intensity.shape == (3, 1024)
    assert np.ptp(np.diff(measured.wavenumber)) < 1e-12
    exact = spectra_at(measured.wavenumber).values
    assert np.abs(measured.intensity - exact).max() < 1e-6 * exact.max()
    found = octsim.phase_of(path)
    assert np.abs(found.phase - PHASES).max() < 1e-6
    assert np.abs(found.depth - 1.95).max() < 1e-6


def test_units_and_order_make_no_difference(tmp_path: Path) -> None:
    nm = read_spectra(
        write_csv(tmp_path / "nm.csv", "wavelength (nm),i", WAVELENGTH, BY_WAVELENGTH[0])
    )
    k, one = 2000 * np.pi / WAVELENGTH, BY_WAVELENGTH[0]
    same = {
        "um": write_csv(
            tmp_path / "u.csv", "Wavelength [um],i", WAVELENGTH / 1e3, BY_WAVELENGTH[0]
        ),
        "k": write_csv(tmp_path / "k.csv", "wavenumber (1/um),i", k, one),
        "rad": write_csv(tmp_path / "r.csv", "wavenumber (nm-1),i", k / 1e3, one),
    }
    for path in same.values():
        other = read_spectra(path)
        assert np.allclose(other.wavenumber, nm.wavenumber, rtol=1e-12)
        assert np.allclose(other.intensity, nm.intensity, rtol=1e-9)


def test_netcdf_and_datasets_are_read(tmp_path: Path) -> None:
    dataset = xr.Dataset(
        {"intensity": (("wavelength", "time"), BY_WAVELENGTH.T)},
        {"wavelength": ("wavelength", WAVELENGTH, {"units": "nm"})},
    )
    dataset.to_netcdf(tmp_path / "s.nc")
    for source in (dataset, tmp_path / "s.nc", str(tmp_path / "s.nc")):
        assert np.abs(octsim.phase_of(source).phase - PHASES).max() < 1e-6


def test_a_run_s_own_spectra_can_be_measured_ones() -> None:
    config = octsim.load_config({
        "tracing": {"preset": "draft"},
        "sweep": {"diameters": {"num": 15}, "focus": {"slope": 0.58, "intercept": "64 nm"}},
    })  # fmt: skip
    spectra = octsim.spectra(config, octsim.detections(config))
    measured = read_spectra(spectra)
    assert np.array_equal(measured.intensity, spectra["intensity"].values)
    depth = octsim.phase_of(spectra).depth
    assert np.abs(depth / 1.39 - spectra["diameter"].values).max() < 0.01


def test_the_spline_is_better_than_shape_preserving_interpolation() -> None:
    from scipy.interpolate import PchipInterpolator

    k = np.pi * 2000 / WAVELENGTH[::8]
    spectra = spectra_at(k).values
    found = even(k, spectra, "s")
    exact = spectra_at(found.wavenumber).values
    pchip = PchipInterpolator(k[::-1], spectra[:, ::-1], axis=1)(found.wavenumber)
    spline_off, pchip_off = (np.abs(one - exact).max() for one in (found.intensity, pchip))
    assert spline_off < 0.05 * pchip_off
    # of sixth order: half the spacing, a 64th of the error in the middle
    half = np.pi * 2000 / WAVELENGTH[::4]
    finer = even(half, spectra_at(half).values, "s")
    inside = slice(20, -20)
    off = np.abs(finer.intensity - spectra_at(finer.wavenumber).values)[:, inside].max()
    coarse = np.abs(found.intensity - exact)[:, inside].max()
    assert 40 < coarse / off < 100


def test_even_samples_are_left_as_they_are() -> None:
    k = np.linspace(7, 9.7, 100)
    spectra = np.random.default_rng(0).random((2, 100))
    assert np.array_equal(even(k, spectra, "s").intensity, spectra)
    assert np.array_equal(even(k[::-1], spectra[:, ::-1], "s").intensity, spectra)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty; write a first column headed"),
        ("lambda,i\n1,2\n", "the header is 'lambda,i'; write a first column headed"),
        ("wavelength (nm)\n1\n", "the header is 'wavelength"),
        (f"spectrum{99 * ',650'}\n", f"the header is 'spectrum{12 * ',650'},...'; write"),
        ("wavelength (kg),i\n1,2\n", "wavelength has the unit 'kg'; give one such as nm"),
        ("wavenumber (um),i\n1,2\n", "wavenumber has the unit 'um'; give one such as 1/um"),
        ("wavelength (nm),i\n1,2\n2,x\n", "row 3: i of sample 2 is 'x'; give a number"),
        ("wavelength (nm),i\n1,2\n2\n", "row 3: '2' given, 1 cell by ','; write 2"),
        ("wavelength (nm),i\n1,2\n2,3\n", "2 samples given; give 8 or more"),
        ("wavelength (nm),i\n# dark\n1,\n", "row 3: i is '', which is no value; give one"),
        ("wavelength (nm),i\n1,2\n2,9.97e36\n", "row 3: i is '9.97e36', which is no value"),
        ("wavelength (nm),i\n1,2\n2,-9999\n", "row 3: i is '-9999', which is no value"),
        ("wavelength (nm),i\n1,2\n2,2\n# x\n2,3\n", "row 5: wavelength (nm) goes from 2 to 2"),
        ("wavelength (um),i\n" + "".join(f"{n},1\n" for n in range(650, 670)), "not those of a"),
        ("wavelength (nm),i\n1,inf\n", "row 2: i is 'inf', which is no value"),
        ("wavelength (nm),i\n1,2,3\n", "row 2: '1,2,3' given, 3 cells by ','; write 2"),
        ("wavelength (nm);i\n1,5;2\n", "'1,5'; write a decimal point, not a comma"),
        ("wavelength (nm),i,\n1,2,3\n", "row 2: '3' stands in column 3, which has no heading"),
        ("wavelength (nm),i,i\n1,2,3\n", "2 columns are headed 'i'; give each its own name"),
        ("wavelength (nm),i,Wavelength (nm),j\n1,2,1,3\n", "'Wavelength (nm)' is of no spectrum"),
        ("wavelength (nm),i,i_std\n1,2,1\n", "'i_std' is of no spectrum"),
        (
            "wavelength (km),i\n" + "".join(f"{n},1\n" for n in range(650, 670)),
            "not those of a spectrometer",
        ),
    ],
)
def test_a_csv_that_holds_no_spectra_is_refused(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DatasetError) as error:
        read_spectra(path)
    assert str(error.value).startswith(str(path))
    assert message in str(error.value)


def test_values_that_can_t_be_used_are_refused() -> None:
    k, spectra = np.linspace(7, 9.7, 20), np.ones((2, 20))
    twice = np.sort(np.append(k[:-1], k[3]))
    with pytest.raises(DatasetError, match=r"out of order, or twice, at 7\.42632"):
        even(twice, spectra, "s")
    spectra[1, 4] = np.nan
    with pytest.raises(DatasetError, match="1 values of intensity are not numbers, the first in"):
        even(k, spectra, "s")
    for first in (-1.0, 0.0):
        with pytest.raises(DatasetError, match="is not a positive number"):
            even(k - k[0] + first, np.ones((2, 20)), "s")


@pytest.mark.parametrize(
    ("shortest", "longest", "said"),
    [(0.051, 99.0, ""), (0.049, 0.9, "wavelengths from 0.049 to 0.9 um given, not those of a"),
     (0.65, 101.0, "wavelengths from 0.65 to 101 um given, not those of a spectrometer")],
)  # fmt: skip
def test_wavelengths_are_those_of_a_spectrometer_from_50_nm_to_100_um(
    shortest: float, longest: float, said: str
) -> None:
    k = np.linspace(2 * np.pi / longest, 2 * np.pi / shortest, 20)
    if not said:
        assert even(k, np.ones((2, 20)), "s").intensity.shape == (2, 20)
        return
    with pytest.raises(DatasetError, match=f"^s: {said}"):
        even(k, np.ones((2, 20)), "s")


def test_what_is_not_there_or_not_named_so_is_said(tmp_path: Path) -> None:
    for name in ("none.csv", "none.nc"):
        with pytest.raises(FileError, match="can't be read"):
            read_spectra(tmp_path / name)
    with pytest.raises(DatasetError, match="no variable intensity over a coordinate"):
        read_spectra(xr.Dataset({"counts": ("wavelength", WAVELENGTH)}))
    cube = xr.Dataset(
        {"intensity": (("x", "y", "wavelength"), np.ones((2, 2, 9)))},
        {"wavelength": ("wavelength", WAVELENGTH[:9], {"units": "nm"})},
    )
    with pytest.raises(DatasetError, match="ndarray given; give a file's name, or a Dataset as"):
        octsim.phase_of(np.ones((3, 100)))  # type: ignore[arg-type]
    with pytest.raises(DatasetError, match="give one besides wavelength, or none"):
        read_spectra(cube)


def test_a_processing_that_measured_spectra_can_t_have_is_refused() -> None:
    dataset = xr.Dataset(
        {"intensity": (("time", "wavelength"), BY_WAVELENGTH)},
        {"wavelength": ("wavelength", WAVELENGTH, {"units": "nm"})},
    )
    with pytest.raises(ConfigError, match=r"processing\.depth: 'nominal' given, but measured"):
        octsim.phase_of(dataset, Processing(estimator="sinusoid"))
    with pytest.raises(ConfigError, match="compares with modelled spectra"):
        octsim.phase_of(dataset, Processing(estimator="maximum_likelihood"))
    nominal = octsim.phase_of(dataset, Processing(estimator="sinusoid"), nominal_depth=1.95)
    assert np.abs(nominal.phase - PHASES).max() < 1e-6


def test_a_wavenumber_that_most_mean_otherwise_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "spectra.csv"
    file.write_text("wavenumber (1/cm),a\n11000,1\n11500,2\n12000,1\n", encoding="utf-8")
    with pytest.raises(DatasetError, match="by which most mean 1/λ; here it is 2π/λ"):
        read_spectra(file)
    rows = "".join(f"{7 + 0.1 * number},1\n" for number in range(20))
    file.write_text(f"wavenumber (rad/um),a\n{rows}", encoding="utf-8")
    assert read_spectra(file).wavenumber[0] == 7


def test_values_that_stand_for_none_are_refused_in_any_form(tmp_path: Path) -> None:
    axis = {"wavelength": ("wavelength", WAVELENGTH, {"units": "nm"})}
    spectra = BY_WAVELENGTH.copy()
    spectra[1, 5] = 9.969209968386869e36
    dataset = xr.Dataset({"intensity": (("time", "wavelength"), spectra)}, axis)
    with pytest.raises(DatasetError, match=r"1 values .* spectrum 1, 9\.96921e\+36 at"):
        read_spectra(dataset)
    with netCDF4.Dataset(tmp_path / "s.nc", "w") as out:
        out.createDimension("time", 3)
        out.createDimension("wavelength", 1024)
        out.createVariable("wavelength", "f8", "wavelength")[:] = WAVELENGTH
        out["wavelength"].units = "nm"
        counts = out.createVariable("intensity", "i4", ("time", "wavelength"))
        counts[:2] = BY_WAVELENGTH[:2].round()  # the third is never written
    with pytest.raises(DatasetError, match=r"1024 values .* spectrum 2, nan at"):
        read_spectra(tmp_path / "s.nc")


def test_csv_may_have_other_separators_notes_and_an_empty_column(tmp_path: Path) -> None:
    plain = "wavelength (nm),a,b\n" + "".join(f"{650 + t},{t + 1},{t * t}\n" for t in range(30))
    expected = octsim.read_spectra(_written(tmp_path / "p.csv", plain))
    forms = {
        "semicolons": plain.replace(",", ";"),
        "tabs": plain.replace(",", "\t"),
        "notes": "# of Monday\n" + plain.replace("655,", "# light on\n655,"),
        "savetxt": f"# {plain}",
        "empty": plain.replace("\n", ",\n") + ",,,\n",
        "spelt": plain.replace("wavelength (nm)", '"Wavelength/nm"'),
        "windows": "\ufeff" + plain.replace("\n", "\r\n"),
    }
    for name, text in forms.items():
        found = octsim.read_spectra(_written(tmp_path / f"{name}.csv", text))
        assert np.array_equal(found.intensity, expected.intensity), name
        assert np.array_equal(found.wavenumber, expected.wavenumber), name


def _written(path: Path, text: str) -> Path:
    path.write_bytes(text.encode())
    return path
