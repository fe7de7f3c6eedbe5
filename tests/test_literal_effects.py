"""The literal tracer of effects against the thesis's literal tracer, and against closed forms."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import reference
from literal_effects import Setup, intensity
from literal_effects_lens import lp01, noll, zernike
from numpy.typing import NDArray

Array = NDArray[Any]
# each wavenumber is done anew, so that three are as sharp as many
BAND = np.linspace(2 * np.pi / 0.9, 2 * np.pi / 0.65, 3)
MIRROR = Setup(neuron=1.33, focus=0.0)  # the bare plane, in the focus


@cache
def of_the_thesis() -> Array:
    return intensity(Setup(), BAND)


def rings(number: int) -> Array:
    """Return rings of four points of the unit disk, the radii even in area."""
    radius = 0.99 * np.sqrt((np.arange(number) + 0.5) / number)
    turn = np.linspace(0, 2 * np.pi, 5)[:4] + np.arange(number)[:, np.newaxis]
    return (
        np.stack([np.cos(turn), np.sin(turn)], axis=-1).reshape(-1, 2)
        * np.repeat(radius, 4)[:, np.newaxis]
    )


def of_plane(setup: Setup, disk: Array) -> tuple[Array, Array, Array, Array]:
    """Return sin and cos of the angles in glass, and r_s and r_p of the plane."""
    sine_rim = setup.numerical_aperture / 1.52
    tangent = np.hypot(*disk.T) * sine_rim / np.sqrt(1 - sine_rim**2)
    cosine = 1 / np.sqrt(1 + tangent**2)
    sine = tangent * cosine
    in_water = np.emath.sqrt(1 - (1.52 / 1.33 * sine) ** 2)
    r_s = (1.52 * cosine - 1.33 * in_water) / (1.52 * cosine + 1.33 * in_water)
    r_p = (1.33 * cosine - 1.52 * in_water) / (1.33 * cosine + 1.52 * in_water)
    return sine, cosine, r_s, r_p


@pytest.mark.parametrize(
    ("diameter", "focus", "gap", "intersections"),
    [(1.4, 0.877, 0.005, 11), (2.0, 2.5, 0.3, 11), (1.0, -0.2, 0.0, 5), (1.4, 0.877, 0.005, 0)],
)
def test_with_all_effects_off_it_is_the_thesis(
    diameter: float, focus: float, gap: float, intersections: int
) -> None:
    setup = Setup(diameter=diameter, focus=focus, gap=gap, max_intersections=intersections)
    detections = reference.trace(
        reference.Scene(diameter=diameter, gap=gap),
        reference.Instrument(),
        reference.Settings(setup.rays, intersections),
        focus,
    )
    expected = reference.spectrum(detections, BAND)
    assert np.max(np.abs(intensity(setup, BAND) - expected)) <= 1e-12 * np.max(expected)


OFF: list[dict[str, Any]] = [
    {"polarisation": None, "zernike": {8: 0.0, 11: 0.0}},
    {"zernike": {11: 0.0}, "zernike_rays": "phase"},
    {"pupil": ("gaussian", 1e9)},
    {"pupil": ("fibre", 0.0)},
    {"focal_shift": (0.755, 0.0, 0.0)},
    {"waist": 0.0},
    {"waist": 0.0, "waist_wavelength": 0.755},
    {"reference": (0.0, 9.0)},
    {"attenuation": {"glass": 0.0, "water": 0.0}},
    {"glass": 1.52 + 0j, "water": lambda wavelength: 1.33 + 0 * wavelength},
]


@pytest.mark.parametrize("effect", OFF, ids=lambda given: ", ".join(given))
def test_an_effect_of_no_size_changes_nothing(effect: dict[str, Any]) -> None:
    assert intensity(Setup(**effect), BAND) == pytest.approx(of_the_thesis(), rel=1e-11)


def test_indices_and_focus_are_those_of_each_wavenumber() -> None:
    dispersive = Setup(
        glass=lambda w: 1.51 + 0.004 / w**2,
        water=lambda w: 1.32 + 0.003 / w**2,
        neuron=lambda w: 1.38 + 0.004 / w**2,
        focal_shift=(0.755, 0.4, 0.1),
        x=0.03,
    )
    for k, value in zip(BAND, intensity(dispersive, BAND), strict=True):
        w = 2 * np.pi / k
        alike = Setup(
            glass=1.51 + 0.004 / w**2,
            water=1.32 + 0.003 / w**2,
            neuron=1.38 + 0.004 / w**2,
            focus=0.877 + 0.4 * (w - 0.755) + 0.1 * (w - 0.755) ** 2,
            x=0.03,
        )
        assert value == pytest.approx(intensity(alike, np.array([k]))[0], rel=1e-12)


# Absorption --------------------------------------------------
def test_glass_absorbs_by_beer_and_lambert() -> None:
    clear, mu = Setup(rays=1), 1e-3
    there_and_back = 2 * (clear.focus_distance - clear.focus)
    expected = intensity(clear, BAND) * np.exp(-mu * there_and_back)
    dark = replace(clear, attenuation={"glass": mu})
    assert intensity(dark, BAND) == pytest.approx(expected, rel=1e-12)
    absorbing = replace(clear, glass=lambda wavelength: 1.52 + 1j * mu * wavelength / (4 * np.pi))
    assert intensity(absorbing, BAND) == pytest.approx(expected, rel=1e-12)


def test_slanted_light_goes_further_through_glass() -> None:
    disk = rings(50)
    *_, cosine, r_s, r_p = of_plane(MIRROR, disk)
    field = np.mean(np.sqrt((r_s**2 + r_p**2) / 2) * np.exp(-1e-3 * 300 / cosine))
    dark = replace(MIRROR, attenuation={"glass": 1e-3})
    assert intensity(dark, BAND, disk) == pytest.approx(field**2, rel=1e-12)


def test_water_and_neuron_dim_only_what_goes_through_them() -> None:
    """One ray, five meetings: the plane, the near side once and twice, the far side."""
    setup = Setup(rays=1, max_intersections=5, attenuation={"water": 3.0, "neuron": 0.2})
    plane, near, far = (1.52 - 1.33) / 2.85, (1.33 - 1.39) / 2.72, (1.39 - 1.33) / 2.72
    through_plane = 4 * 1.52 * 1.33 / 2.85**2
    through_near = 4 * 1.33 * 1.39 / 2.72**2
    amplitude = np.array(
        [plane, through_plane * near, -through_plane * near**2 * plane,
         through_plane * through_near * far]
    )  # fmt: skip
    water, neuron = np.array([0, 0.01, 0.02, 0.01]), np.array([0, 0, 0, 2.8])
    amplitude *= np.exp(-(3.0 * water + 0.2 * neuron) / 2)
    path = 1.33 * water + 1.39 * neuron
    expected = np.abs(np.exp(1j * np.outer(BAND, path)) @ amplitude) ** 2
    assert intensity(setup, BAND) == pytest.approx(expected, rel=1e-11)


# Reference arm -----------------------------------------------
@pytest.mark.parametrize("polarisation", [None, (None, None), ((1.0, 0.0), None)])
def test_without_a_scene_the_reference_arm_is_all_there_is(polarisation: Any) -> None:
    empty = Setup(water=1.52, neuron=1.52, reference=(0.004, 9.0), polarisation=polarisation)
    assert intensity(empty, BAND) == pytest.approx(0.004**2, rel=1e-12)


def test_a_mirror_and_the_reference_arm_beat_by_twice_the_length() -> None:
    r = (1.52 - 1.33) / 2.85
    expected = r**2 + 0.01**2 + 2 * r * 0.01 * np.cos(2 * BAND * 9.0)
    beating = replace(MIRROR, rays=1, reference=(0.01, 9.0))
    assert intensity(beating, BAND) == pytest.approx(expected, rel=1e-10)


# Pupil and apodisation ---------------------------------------
def test_pupils_weigh_the_launched_light() -> None:
    disk = rings(60)
    sine, _, r_s, r_p = of_plane(MIRROR, disk)
    r = np.sqrt((r_s**2 + r_p**2) / 2)
    gaussian = np.mean(r * np.exp(-((1.52 * sine / 1.2 / 0.7) ** 2))) ** 2
    of_gaussian = replace(MIRROR, pupil=("gaussian", 0.7))
    assert intensity(of_gaussian, BAND, disk) == pytest.approx(gaussian, rel=1e-11)
    mode = np.exp(-((BAND[:, np.newaxis] * 2.5 * 1.52 * sine / 40) ** 2))
    of_fibre = replace(MIRROR, pupil=("fibre", 5.0))
    expected = np.mean(r * mode, axis=1) ** 2
    assert intensity(of_fibre, BAND, disk) == pytest.approx(expected, rel=1e-11)


def test_apodisation_cancels_for_a_mirror_in_the_focus_and_not_for_a_cylinder() -> None:
    aplanatic = replace(MIRROR, apodisation="aplanatic")
    assert intensity(aplanatic, BAND) == pytest.approx(intensity(MIRROR, BAND), rel=1e-12)
    changed = intensity(Setup(apodisation="aplanatic"), BAND) / intensity(Setup(), BAND)
    assert 1e-4 < np.max(np.abs(changed - 1)) < 0.1


# Zernike terms -----------------------------------------------
def test_zernike_terms_are_orthonormal_and_in_nolls_order() -> None:
    orders = [noll(j) for j in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 22, 37)]
    assert orders == [
        (0, 0), (1, 1), (1, -1), (2, 0), (2, -2), (2, 2), (3, -1), (3, 1), (3, -3), (3, 3),
        (4, 0), (6, 0), (8, 0),
    ]  # fmt: skip
    node, weight = np.polynomial.legendre.leggauss(20)
    turn = 2 * np.pi * np.arange(40) / 40
    radius = np.sqrt((node + 1) / 2)[:, np.newaxis]
    p = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1).reshape(-1, 2)
    values = np.array([zernike(j, p)[0] for j in range(1, 38)])
    products = (values * np.repeat(weight / 80, 40)) @ values.T
    assert products == pytest.approx(np.eye(37), abs=1e-12)
    for j in range(1, 38):
        for axis, step in enumerate(1e-5 * np.eye(2)):
            rise = (zernike(j, p + step)[0] - zernike(j, p - step)[0]) / 2e-5
            assert zernike(j, p)[1][:, axis] == pytest.approx(rise, abs=1e-6)


@pytest.mark.parametrize(("rays", "differs"), [("normal", (0.0, 1e-5)), ("phase", (0.05, 1.0))])
def test_the_even_zernike_terms_of_a_focus_shift_are_that_shift(
    rays: Any, differs: tuple[float, float]
) -> None:
    aperture, dz = 0.3, 0.1
    node, weight = np.polynomial.legendre.leggauss(40)
    square = (node + 1) / 2
    wavefront = -dz * 1.52 * np.sqrt(1 - square * (aperture / 1.52) ** 2)
    p = np.stack([np.sqrt(square), np.zeros(40)], axis=1)
    terms = {
        j: float(np.sum(weight / 2 * wavefront * zernike(j, p)[0])) for j in (1, 4, 11, 22, 37)
    }
    setup = Setup(numerical_aperture=aperture, rays=300)
    moved = intensity(replace(setup, focus=0.877 + dz), BAND)
    error = intensity(replace(setup, zernike=terms, zernike_rays=rays), BAND) - moved
    least, most = differs
    assert least <= np.max(np.abs(error)) / np.max(moved) <= most


def test_a_mirror_in_the_focus_undoes_coma_and_doubles_spherical_aberration() -> None:
    disk = 0.9 * rings(60)
    seen = intensity(MIRROR, BAND, disk)
    comatic = replace(MIRROR, zernike={7: 0.004, 8: 0.01, 10: 0.003})
    assert intensity(comatic, BAND, disk) == pytest.approx(seen, rel=1e-11)
    spherical = replace(MIRROR, zernike={11: 0.004})
    sine, _, r_s, r_p = of_plane(MIRROR, disk)
    rho = 1.52 * sine / 1.2
    wavefront = 0.004 * np.sqrt(5) * (6 * rho**4 - 6 * rho**2 + 1)
    slope = 0.004 * np.sqrt(5) * (24 * rho**3 - 12 * rho)
    at = 2 * slope / 1.2
    path = 2 * (wavefront - rho * slope) + seen_by_lens(at)
    weight = np.sqrt((r_s**2 + r_p**2) / 2) * np.maximum(0, 1 - (at / 0.11) ** 2)
    expected = np.abs(np.mean(weight * np.exp(1j * np.outer(BAND, path)), axis=1)) ** 2
    assert intensity(spherical, BAND, disk) == pytest.approx(expected, rel=1e-10)


def seen_by_lens(rho: Array) -> Array:
    f = 300 * 20 / 21
    return 20 * (np.sqrt(f**2 + rho**2) - f)


# Rulings -----------------------------------------------------
@pytest.mark.parametrize("wavelength", ["each", 0.755])
def test_rulings_meet_a_mirror_in_the_focus_off_the_axis(wavelength: Any) -> None:
    disk = rings(60)
    setup = replace(MIRROR, waist=0.09, waist_wavelength=wavelength)
    sine, cosine, r_s, r_p = of_plane(MIRROR, disk)
    expected = []
    for k in BAND:
        z_r = np.pi * 1.52 * 0.09**2 / (2 * np.pi / k if wavelength == "each" else wavelength)
        rho = z_r * sine / cosine
        weight = np.sqrt((r_s**2 + r_p**2) / 2) * np.maximum(0, 1 - (rho / 0.11) ** 2)
        expected.append(np.abs(np.mean(weight * np.exp(1j * k * seen_by_lens(rho)))) ** 2)
    assert intensity(setup, BAND, disk) == pytest.approx(expected, rel=1e-11)
    diffraction = replace(setup, waist="diffraction")
    each = replace(setup, waist=0.755 / (np.pi * 1.2))
    if wavelength != "each":
        assert intensity(diffraction, BAND, disk) == pytest.approx(
            intensity(each, BAND, disk), rel=1e-12
        )


@pytest.mark.parametrize("effect", [{}, {"zernike": {11: 0.01}}, {"polarisation": (None, None)}])
def test_rulings_leave_a_mirrored_scene_mirrored(effect: dict[str, Any]) -> None:
    disk = 0.99 * rings(75) + [0.004, 0.003]
    setup = Setup(waist="diffraction", x=0.05, **effect)
    seen = intensity(setup, BAND, disk)
    across, along = disk * [-1, 1], disk * [1, -1]
    assert intensity(replace(setup, x=-0.05), BAND, across) == pytest.approx(seen, rel=1e-9)
    assert intensity(setup, BAND, along) == pytest.approx(seen, rel=1e-9)


# Falloff -----------------------------------------------------
@pytest.mark.parametrize(
    "falloff", ["top_hat", "cosine", ("gaussian", None), ("gaussian", 3.0), ("fibre", 0.13)]
)
def test_every_falloff_is_one_on_the_axis(falloff: Any) -> None:
    expected = intensity(Setup(rays=1), BAND)
    assert intensity(Setup(rays=1, falloff=falloff), BAND) == pytest.approx(expected, rel=1e-12)
    assert np.max(np.abs(intensity(Setup(falloff=falloff), BAND) - of_the_thesis())) > 0


def test_the_fibres_mode_solves_its_equation() -> None:
    k, core, aperture = 8.0, 2.2, 0.13
    r = np.linspace(0.02, 8.0, 400)
    r = r[np.abs(r - core) > 0.01]
    h = 1e-3
    mode = lp01(k, core, aperture, r)
    up, down = lp01(k, core, aperture, r + h), lp01(k, core, aperture, r - h)
    curved = (up - 2 * mode + down) / h**2 + (up - down) / (2 * h * r)
    beta = curved / mode + np.where(r < core, (k * aperture) ** 2, 0.0)  # (W / core)^2 everywhere
    assert np.ptp(beta) < 1e-4
    assert beta[0] > 0
    beside = lp01(k, core, aperture, core + np.array([-2e-6, -1e-6, 1e-6, 2e-6]))
    assert np.diff(beside)[0] == pytest.approx(np.diff(beside)[2], rel=1e-4)
    assert lp01(k, core, aperture, np.zeros(1))[0] == 1.0


# Polarisation ------------------------------------------------
@pytest.mark.parametrize("aperture", [1.2, 1.45])
@pytest.mark.parametrize("height", [0.0, 0.3])
def test_a_bare_plane_returns_the_mean_of_both_polarisations(
    aperture: float, height: float
) -> None:
    disk = rings(200)
    plane = replace(
        MIRROR, numerical_aperture=aperture, focus=height, core_diameter=2000, falloff="top_hat"
    )
    sine, cosine, r_s, r_p = of_plane(plane, disk)
    path = -2 * 1.52 * height / cosine + seen_by_lens(2 * height * sine / cosine)
    expected = np.abs(np.mean((r_s - r_p) / 2 * np.exp(1j * np.outer(BAND, path)), axis=1)) ** 2
    for state in (None, (1.0, 0.0), (0.6, 0.8), (0.5**0.5, 0.5**0.5 * 1j)):
        polarised = replace(plane, polarisation=(state, None))
        assert intensity(polarised, BAND, disk) == pytest.approx(expected, rel=1e-9)
    crossed = replace(plane, polarisation=((0.6, 0.8), 90 + np.degrees(np.arctan2(0.8, 0.6))))
    assert np.max(intensity(crossed, BAND, disk)) < 1e-20


def test_on_the_glass_the_thesiss_split_returns_too_much() -> None:
    k = np.array([8.0])
    for aperture, share in ((1.2, 0.379), (1.45, 0.0166)):
        split = Setup(numerical_aperture=aperture, neuron=1.33, focus=0.0, rays=3000)
        polarised = replace(split, polarisation=(None, None))
        ratio = intensity(polarised, k) / intensity(split, k)
        assert ratio[0] == pytest.approx(share, rel=5e-3)


def test_at_low_aperture_polarisation_does_not_matter() -> None:
    off = []
    for aperture in (0.2, 0.1, 0.05):
        setup = Setup(numerical_aperture=aperture)
        split = intensity(setup, BAND)
        for state in (None, (1.0, 0.0), (0.6, 0.8j)):
            polarised = intensity(replace(setup, polarisation=(state, None)), BAND)
            off.append(np.max(np.abs(polarised - split)) / np.max(split))
    assert max(off[6:]) < 1e-3
    assert max(off[6:]) < max(off[3:6]) / 3 < max(off[:3]) / 9


def test_unpolarised_light_is_the_mean_of_any_two_orthogonal_states() -> None:
    setup = Setup(polarisation=(None, 20.0), x=0.03)
    seen = intensity(setup, BAND)
    h = 0.5**0.5
    for one, other in (((1, 0), (0, 1)), ((0.6, 0.8), (-0.8, 0.6)), ((h, h * 1j), (h, -h * 1j))):
        both = [intensity(replace(setup, polarisation=(e, 20.0)), BAND) for e in (one, other)]
        assert np.mean(both, axis=0) == pytest.approx(seen, rel=1e-12)
    parts = [intensity(replace(setup, polarisation=(None, a)), BAND) for a in (20.0, 110.0)]
    whole = intensity(replace(setup, polarisation=(None, None)), BAND)
    assert np.sum(parts, axis=0) == pytest.approx(whole, rel=1e-12)
