r"""The field of a cylinder in shells among stacks of planes, by dense rules.

As `dense_waves`, of which it has rules and the linear system; nothing of scheme fullwave's is used.
Shells by one linear system of all boundary conditions, planes by products of the matrices of
layers (Born & Wolf, ch. 1.6) for s and p light, that which goes to and fro around the cylinder by
elimination for each plane wave.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from dense_waves import _RIGHT, Beam, Dense, Rules, _clenshaw_curtis, _contour_end, outgoing
from numpy.typing import NDArray
from scipy.special import h1vp, hankel1, jv, jvp

Array = NDArray[Any]


class Layered(NamedTuple):
    """A cylinder among planes; lengths in µm. Layers are pairs of index and thickness."""

    n_glass: float
    n_water: float
    n_neuron: complex
    gap: float
    diameter: float
    offset: float = 0.0
    shells: tuple[tuple[complex, float], ...] = ()
    """Outside in."""
    films: tuple[tuple[complex, float], ...] = ()
    """From glass to water."""
    room: float = math.inf
    """Thickness of the water."""
    above: tuple[tuple[complex, float], ...] = ()
    """Beyond the water; the last one without end."""

    @property
    def height(self) -> float:
        """Of the axis over the highest plane below it, µm."""
        return self.gap + self.diameter / 2


def coated_matrices(scene: Layered, k: float, along: float, waves: int) -> Array:
    """Return the scattering matrices of orders −M … M, (2M + 1, 2, 2), from all conditions."""
    indices = [scene.n_water, *(n for n, _ in scene.shells), scene.n_neuron]
    radii = [scene.diameter / 2]
    for _, thickness in scene.shells:
        radii.append(radii[-1] - thickness)
    return np.stack([_coated(indices, radii, k, along, m) for m in range(-waves, waves + 1)])


def _coated(indices: list[complex], radii: list[float], k: float, along: float, m: int) -> Array:
    """Solve for the waves in every region at once; unknown are outgoing ones around it."""
    number = len(radii)
    # H around; J and H in shells; J within: of E and H each
    size = 4 * number
    matrix, right = np.zeros((size, size), complex), np.zeros((size, 2), complex)
    for surface, radius in enumerate(radii):
        rows = slice(4 * surface, 4 * surface + 4)
        for side in (0, 1):
            region = surface + side
            kappa = np.emath.sqrt(indices[region] ** 2 - along**2)
            x = k * radius * kappa
            at_one = k * radii[max(region - 1, 0)] * kappa  # a size that a function is relative to
            waves = {"j": (jv(m, x), jvp(m, x), jv(m, at_one)),
                     "h": (hankel1(m, x), h1vp(m, x), hankel1(m, at_one))}  # fmt: skip
            for name, (value, slope, scale) in waves.items():
                if name == "h" and region == number:
                    continue
                skew = 1j * along * m / (k * radius * kappa**2)
                n2 = indices[region] ** 2
                block = np.array([
                    [value, 0], [0, value], [skew * value, slope / kappa],
                    [-n2 * slope / kappa, skew * value],
                ])  # fmt: skip
                if region == 0 and name == "j":
                    right[rows] -= block
                    continue
                column = 0 if region == 0 else 2 + 4 * (region - 1) + (2 if name == "h" else 0)
                own = 1.0 if region == 0 else scale
                matrix[rows, column : column + 2] += (1 if side == 0 else -1) * block / own
    scale = np.abs(matrix).max(axis=0)
    return np.asarray((np.linalg.solve(matrix / scale, right) / scale[:, np.newaxis])[:2])


def layer_matrices(
    indices: list[complex], thickness: list[float], squared: Array, k: float
) -> tuple[Array, Array, Array, Array]:
    """Return r_s, r_p (of H), t_s and t_p of a stack by the product of its layers' matrices."""
    normals = [np.sqrt(n**2 - squared + 0j) for n in indices]
    found = []
    for kind in (0, 1):
        admittance = [z if kind == 0 else z / n**2 for z, n in zip(normals, indices, strict=True)]
        # tangential field and its partner, from the far side back
        field, partner = np.ones_like(normals[-1]), admittance[-1]
        scale = np.ones_like(field)
        inner = zip(normals[1:-1], admittance[1:-1], thickness, strict=True)
        for z, q, d in reversed(list(inner)):
            # all over e^{−ikzd}, which overflows where light decays
            once = np.exp(1j * k * z * d)
            cos, sin = (1 + once**2) / 2, (1 - once**2) / 2  # and −i sin
            field, partner = cos * field + sin / q * partner, cos * partner + sin * q * field
            scale = scale * once
        first = admittance[0]
        found.append(((first * field - partner) / (first * field + partner),
                      2 * first * scale / (first * field + partner)))  # fmt: skip
    (r_s, t_s), (r_p, t_p) = found
    return r_s, r_p, t_s, t_p


def _stack_below(scene: Layered, squared: Array, k: float) -> tuple[Array, ...]:
    films = scene.films[::-1]
    indices = [scene.n_water, *(n for n, _ in films), scene.n_glass]
    return layer_matrices(indices, [d for _, d in films], squared, k)[:2]


def _stack_above(scene: Layered, squared: Array, k: float) -> tuple[Array, ...]:
    if not scene.above:
        return np.zeros_like(squared + 0j), np.zeros_like(squared + 0j)
    indices = [scene.n_water, *(n for n, _ in scene.above)]
    return layer_matrices(indices, [d for _, d in scene.above[:-1]], squared, k)[:2]


def _turned(c: Array, s: Array, z: Array, n: float) -> Array:
    """Return the matrix from (E of s, H of p) light to (E_y, H_y), (2, 2, ...)."""
    return np.stack([np.stack([c, z * s / n**2]), np.stack([-z * s, c])])


def _up_and_down(scene: Layered, k: float, squared: Array, here: Array) -> Array:
    """Return what is sent (down, up) → what comes (up, down), of s and p: (2, 2, 2, ...)."""
    below = np.exp(2j * k * here * scene.height)
    found = []
    for r_b, r_a in zip(_stack_below(scene, squared, k), _stack_above(scene, squared, k),
                        strict=True):  # fmt: skip
        b = r_b * below
        a = r_a * np.exp(2j * k * here * (scene.room - scene.height)) if scene.above else 0 * b
        # U = b (d + D), D = a (u + U)
        one = np.ones_like(b)
        system = np.moveaxis(np.array([[one, -b], [-a, one]]), (0, 1), (-2, -1))
        sent = np.moveaxis(np.array([[b, 0 * b], [0 * a, a]]), (0, 1), (-2, -1))
        found.append(np.moveaxis(np.linalg.solve(system, sent), (-2, -1), (0, 1)))
    return np.stack(found)


def between_matrices(scene: Layered, k: float, along: float, waves: int, nodes: int) -> Array:
    """Return R, (2, 2M + 1, 2, 2M + 1), from outgoing waves to those that planes return."""
    n = scene.n_water
    kappa = math.sqrt(n**2 - along**2)
    heights = [scene.height] + ([scene.room - scene.height] if scene.above else [])
    end = max(_contour_end(waves, k * kappa * height) for height in heights)
    tau, step = np.linspace(-end, end, 2 * nodes, retstep=True)
    beta = _RIGHT * np.tanh(tau) - 1j * tau
    weight = step * (_RIGHT / np.cosh(tau) ** 2 - 1j) / np.pi
    sx, here = kappa * np.sin(beta), kappa * np.cos(beta)
    rho = np.sqrt(sx**2 + along**2)
    c, s = sx / rho, along / rho
    to = _up_and_down(scene, k, rho**2, here)
    up, down = _turned(c, s, here, n), _turned(c, s, -here, n)
    order = np.arange(-waves, waves + 1)
    signs = np.where(order % 2, -1.0, 1.0)[:, np.newaxis]
    turn = np.exp(1j * order[:, np.newaxis] * beta)
    back = np.exp(-1j * order[:, np.newaxis] * beta)
    # of those sent down and up, and of those that come up and down
    sent = ((down, signs * turn), (up, back))
    come = ((up, turn), (down, signs * back))
    found = np.zeros((2, order.size, 2, order.size), complex)
    for i, (basis_to, waves_to) in enumerate(come):
        for j, (basis_of, waves_of) in enumerate(sent):
            inverse = np.moveaxis(
                np.linalg.inv(np.moveaxis(basis_of, (0, 1), (-2, -1))), (-2, -1), (0, 1)
            )
            turned = np.einsum("aqb,qb,qcb->acb", basis_to, to[:, i, j], inverse)
            for a in (0, 1):
                for b in (0, 1):
                    found[a, :, b] += (waves_to * (weight * turned[a, b])) @ waves_of.T
    return found


def waves_of_light(
    scene: Layered, beam: Beam, k: float, along: float, waves: int, across: int
) -> Array:
    """Return regular waves (2 polarisations, 2 components, 2M + 1) that the pupil sends."""
    u, weight = _clenshaw_curtis(across)
    reach = np.sqrt(beam.aperture**2 - along**2)
    sx = reach * u
    rho = np.hypot(sx, along)
    c, s = sx / rho, along / rho
    n = scene.n_water
    z_glass, z = np.sqrt(scene.n_glass**2 - rho**2), np.sqrt(n**2 - rho**2)
    indices = [scene.n_glass, *(m for m, _ in scene.films), n]
    t_s, t_p = layer_matrices(indices, [d for _, d in scene.films], rho**2, k)[2:]
    cosine = z_glass / scene.n_glass
    size = beam.pupil.amplitude(rho, beam.aperture, k) / np.sqrt(cosine) * weight * reach
    size = size * np.exp(1j * k * (sx * scene.offset - z_glass * beam.focus))
    order = np.arange(-waves, waves + 1)
    turn = np.exp(1j * order * np.arcsin(sx / np.sqrt(n**2 - along**2))[:, np.newaxis])
    back = np.where(order % 2, -1.0, 1.0) / turn
    found = []
    r_b, r_a = _stack_below(scene, rho**2, k), _stack_above(scene, rho**2, k)
    for radial, azimuthal in ((c, -s), (s, c)):
        total = np.zeros((2, order.size), complex)
        light = t_s * azimuthal, t_p * radial * scene.n_glass
        ups, downs = [], []
        for sent, below, above in zip(light, r_b, r_a, strict=True):
            whole = np.exp(2j * k * z * scene.room) if scene.above else 0.0
            up = sent / (1 - below * above * whole)
            ups.append(up * np.exp(1j * k * z * scene.height))
            if scene.above:
                far = np.exp(1j * k * z * (2 * scene.room - scene.height))
                downs.append(up * above * far)
        total += np.einsum("aqb,qb->ab", _turned(c, s, z, n), np.stack(ups) * size) @ turn
        if downs:
            total += np.einsum("aqb,qb->ab", _turned(c, s, -z, n), np.stack(downs) * size) @ back
        found.append(total)
    return np.stack(found)


def dense_scene(scene: Layered, beam: Beam, k: NDArray[np.float64], wanted: float = 1e-9) -> Dense:
    """Return the detected field (2, K) at wavenumbers (K,), 1/µm, by ever denser rules."""
    rules = first_rules(scene, beam, float(k.max()))
    field = field_by(scene, beam, k, rules)
    for _ in range(4):
        rules = rules.denser()
        coarse, field = field, field_by(scene, beam, k, rules)
        error = float(np.abs(field - coarse).max())
        if error <= wanted:
            break
    return Dense(field, error)


def first_rules(scene: Layered, beam: Beam, k: float) -> Rules:
    """Return how dense to begin."""
    largest = max(abs(n) for n in (scene.n_water, scene.n_neuron, *(n for n, _ in scene.shells)))
    size, sine = k * scene.diameter / 2 * largest, beam.aperture
    glass, water = (n - math.sqrt(n**2 - sine**2) for n in (scene.n_glass, scene.n_water))
    far = 2 * scene.room if scene.above else scene.height
    layers = sum(d for _, d in (*scene.films, *scene.above[:-1]))
    spread = k * (far * water + abs(beam.focus * glass) + abs(scene.offset * sine) + 2 * layers)
    return Rules(
        8, math.ceil(40 + size + spread), math.ceil(28 + 0.8 * size + spread),
        math.ceil(80 + 2.5 * size + (3 * k * scene.room if scene.above else 0)),
        math.ceil(60 + 2 * spread),
    )  # fmt: skip


def field_by(scene: Layered, beam: Beam, k: NDArray[np.float64], rules: Rules) -> Array:
    """Return the field (2, K) by given rules."""
    sine, measure = _clenshaw_curtis(rules.radial)
    rho = beam.aperture * np.sqrt((sine + 1) / 2)
    measure = measure * beam.aperture**2 / 4
    layers = [*scene.films, (scene.n_water, scene.room), *scene.above]
    indices = [scene.n_glass, *(n for n, _ in layers)]
    found = np.empty((2, k.size), np.complex128)
    for i, one in enumerate(k.tolist()):
        weight = beam.pupil.amplitude(rho, beam.aperture, one) ** 2 * measure
        r_s, r_p, *_ = layer_matrices(indices, [d for _, d in layers[:-1]], rho**2, one)
        phase = np.exp(-2j * one * beam.focus * np.sqrt(scene.n_glass**2 - rho**2))
        planes = (weight * (r_s - r_p) / 2 * phase).sum() / weight.sum()
        whole = 4 * np.pi * scene.n_glass * weight.sum()
        found[:, i] = planes + _of_cylinder(scene, beam, one, rules) / whole
    return found


def _of_cylinder(scene: Layered, beam: Beam, k: float, rules: Rules) -> Array:
    x, weight = _clenshaw_curtis(2 * rules.along)
    half = np.arange(rules.along, 2 * rules.along)
    angle = np.pi / 2 * x[half]
    angle[0] = 0
    weight = weight[half] * beam.aperture * np.pi / 2 * np.cos(angle)
    weight[1:] *= 2
    total = np.zeros(2, np.complex128)
    largest = max(abs(n) for n in (scene.n_water, scene.n_neuron, *(n for n, _ in scene.shells)))
    for one, share in zip((beam.aperture * np.sin(angle)).tolist(), weight.tolist(), strict=True):
        size = k * scene.diameter / 2 * math.sqrt(largest**2 - one**2)
        waves = math.ceil(size + 4.5 * size ** (1 / 3)) + rules.waves
        t = coated_matrices(scene, k, one, waves)
        r = between_matrices(scene, k, one, waves, rules.contour)
        a = waves_of_light(scene, beam, k, one, waves, rules.across)
        detected = waves_of_light(scene, beam, k, -one, waves, rules.across)[..., ::-1]
        b = outgoing(a, t, r)
        signs = np.where(np.arange(-waves, waves + 1) % 2, -1.0, 1.0)
        overlap = scene.n_water**2 * detected[:, 0] * b[:, 0] - detected[:, 1] * b[:, 1]
        total += (overlap * signs).sum(-1) * share * 2 / (np.pi * (scene.n_water**2 - one**2))
    return total
