/* The full ray tree of a cylinder over a plane, as fast as C can: one ray at a time, and in lanes.
 *
 * Both use what is conserved, so that a segment costs a few products:
 * - A ray's momentum is k = n v, and dr = k dtau with tau = integral of ds / n. No normal has a y
 *   component, so p = ky never changes: y = p tau, and all else happens in the plane (x, z).
 * - At a surface the momentum q along the normal changes by qt^2 = qi^2 + nt^2 - ni^2 (Snell). It is
 *   |kz| on the plane; on the cylinder q^2 = n^2 - p^2 - L^2, all lengths being in its radii.
 * - The angular momentum L = x kz - z kx about the axis changes at the plane only: 2 zc kx - L.
 * - All chords of a ray in the cylinder are alike. The rays that leave it are the reflected ray,
 *   turned by the same angle from each to the next.
 * - Squares of amplitudes are carried, with the amplitude's sign; only detection takes roots.
 * Beyond the critical angle qt = 0 gives r = 1 by itself. Segments that end are counted, not made.
 *
 * gcc -O3 -march=native -fno-math-errno (sqrt then is one instruction); nothing else is relaxed.
 */
#include <math.h>
#include <stdint.h>
#ifdef __AVX__
#include <immintrin.h>
#endif

typedef struct { /* as in trees.py; lengths in um */
    double n_glass, n_water, n_neuron, plane, cylinder_x, cylinder_z, radius;
    double focus, objective_radius, focus_distance, detector_radius, magnification, focal_length;
    double min_amplitude;
    int64_t max_intersections;
} Setting;

typedef struct { /* lengths in radii of the cylinder, heights above the plane */
    double glass, water, neuron;           /* squares of the refractive indices */
    double sign_glass, sign_neuron;        /* of r, coming from water */
    double cx, zc, radius, focus, drop;    /* drop: height of the objective */
    double objective, detector, magnification, focal_length; /* the first two squared */
    double faint;                          /* least square of the amplitude */
    int max;
    const double *launched;
    int64_t capacity, detected, segments, *ray;
    double *amplitude, *path;
} Tree;

static double squared(double x) { return x * x; }

static Tree plant(const Setting *s, const double *launched, int64_t capacity, int64_t *ray,
                  double *amplitude, double *path)
{
    const double unit = 1 / s->radius, focus = (s->focus - s->plane) * unit;
    return (Tree){
        .glass = squared(s->n_glass), .water = squared(s->n_water), .neuron = squared(s->n_neuron),
        .sign_glass = s->n_glass > s->n_water ? -1 : 1,
        .sign_neuron = s->n_neuron > s->n_water ? -1 : 1,
        .cx = s->cylinder_x * unit, .zc = (s->cylinder_z - s->plane) * unit, .radius = s->radius,
        .focus = focus, .drop = focus - s->focus_distance * unit,
        .objective = squared(s->objective_radius * (1 + 1e-12) * unit),
        .detector = squared(s->detector_radius * unit),
        .magnification = s->magnification, .focal_length = s->focal_length,
        .faint = squared(s->min_amplitude), .max = (int)s->max_intersections,
        .launched = launched, .capacity = capacity, .ray = ray, .amplitude = amplitude,
        .path = path,
    };
}

/* A ray down from (x, p tau) on the plane, with momentum q downwards, that passes the detector's
 * image: note it if it passes the objective too. */
static __attribute__((noinline)) void detect(Tree *t, double x, double kx, double q, double tau,
                                             double path, double A, double p, int64_t ray)
{
    const double s = 1 / q, X = x - t->focus * kx * s, Y = p * (tau - t->focus * s);
    const double rho2 = X * X + Y * Y;
    if (!(squared(x - t->drop * kx * s) + squared(p * (tau - t->drop * s)) <= t->objective))
        return;
    const int64_t i = t->detected++;
    if (i >= t->capacity)
        return;
    const double r2 = rho2 * t->radius * t->radius, f = t->focal_length;
    t->ray[i] = ray;
    t->amplitude[i] = t->launched[ray] * copysign(sqrt(fabs(A)), A) * (1 - rho2 / t->detector);
    t->path[i] = (path - t->glass * t->focus * s) * t->radius
               + t->magnification * r2 / (sqrt(f * f + r2) + f);
}

/* Squares of r (with its sign) and of t / qi, by Fresnel for unpolarised light, from indices
 * squared; written once for numbers and for lanes. */
#define FRESNEL(type, ni2, nt2, sign, qi, qt, r, g) \
    do { \
        const type a_ = (qi) + (qt), b_ = (nt2) * (qi) + (ni2) * (qt), over_ = 1 / (a_ * b_); \
        const type s_ = ((qi) - (qt)) * b_ * over_, p_ = ((nt2) * (qi) - (ni2) * (qt)) * a_ * over_; \
        (r) = 0.5 * (sign) * (s_ * s_ + p_ * p_); \
        (g) = 2 * over_ * over_ * (b_ * b_ + (ni2) * (nt2) * (a_ * a_)); \
    } while (0)

/* ---------------------------------------------------------------- one ray at a time */

typedef struct {
    double p, in_water, in_neuron, per_water, per_neuron; /* n^2 - p^2 and their inverses */
    int64_t ray;
} Ray;

static int seen(const Tree *t, double p, double xq, double tauq, double kx, double q, double g)
{ /* does it pass the detector's image? all times q g, so that nothing is divided */
    const double X = xq * g - t->focus * q * kx, Y = p * (tauq * g - t->focus * q);
    return X * X + Y * Y < t->detector * (q * g) * (q * g);
}

static void rise(Tree *t, const Ray *ray, double kx, double kz, double L, double z, double tau,
                 double path, double A, int met);

/* From the cylinder, at height z, through water: away, or down to the plane. */
static inline void leave(Tree *t, const Ray *ray, double kx, double kz, double L, double z,
                         double tau, double path, double A, int met)
{
    t->segments++;
    if (kz >= 0 || met == t->max)
        return;
    const double q = -kz, g2 = q * q + (t->glass - t->water), g = sqrt(g2 > 0 ? g2 : 0);
    const double xq = t->zc * kx - L + t->cx * q, tauq = tau * q + z, up = 2 * t->zc * kx - L;
    const int hit = up * up < ray->in_water && met + 1 < t->max;
    const int down = seen(t, ray->p, xq, tauq, kx, q, g);
    if (!hit && !down && t->faint == 0) { /* nearly all end here */
        t->segments += g2 < 0 ? 1 : 2;
        return;
    }
    double r, T;
    FRESNEL(double, t->water, t->glass, t->sign_glass, q, g, r, T);
    T *= q * q;
    if (g2 >= 0 && !(fabs(A * T) < t->faint)) {
        t->segments++;
        if (down)
            detect(t, xq / q, kx, g, tauq / q, path + t->water * z / q, A * T, ray->p, ray->ray);
    }
    if (!(fabs(A * r) < t->faint)) {
        if (hit)
            rise(t, ray, kx, q, up, z, tau, path, A * r, met + 1);
        else
            t->segments++;
    }
}

/* From the plane (and, before, from height z down to it) up to the cylinder, and all the rays that
 * leave it for that. */
static void rise(Tree *t, const Ray *ray, double kx, double kz, double L, double z, double tau,
                 double path, double A, int met)
{
    t->segments++;
    const double q2 = ray->in_water - L * L;
    if (!(q2 > 0) || met == t->max)
        return;
    met++;
    const double n2 = q2 + (t->neuron - t->water), q = sqrt(q2), n = sqrt(n2 > 0 ? n2 : 0);
    const double nx = (L * kz - q * kx) * ray->per_water, nz = -(q * kz + L * kx) * ray->per_water;
    const double s = (z + t->zc + nz) / kz;
    double r, T;
    FRESNEL(double, t->water, t->neuron, t->sign_neuron, q, n, r, T);
    tau += s, path += t->water * s, kx += 2 * q * nx, kz += 2 * q * nz;
    if (!(fabs(A * r) < t->faint))
        leave(t, ray, kx, kz, L, t->zc + nz, tau, path, A * r, met);
    A *= q2 * T;
    if (n2 < 0 || fabs(A) < t->faint)
        return;
    const double out = n2 * T, chord = 2 * n * ray->per_neuron;
    const double cosine = 1 - n * chord, sine = L * chord;
    const double zx = -L * ray->per_water, zz = q * ray->per_water;
    for (;; met++) {
        t->segments++;
        if (met == t->max)
            return;
        const double was = kx;
        kx = kx * cosine - kz * sine, kz = was * sine + kz * cosine;
        tau += chord, path += t->neuron * chord;
        if (!(fabs(A * out) < t->faint))
            leave(t, ray, kx, kz, L, t->zc + zx * kx + zz * kz, tau, path, A * out, met + 1);
        A *= -r;
        if (fabs(A) < t->faint)
            return;
    }
}

int64_t trace_scalar(const Setting *s, int64_t rays, const double *vx, const double *vy,
                     const double *vz, const double *launched, int64_t capacity, int64_t *ray,
                     double *amplitude, double *path, int64_t *segments)
{
    Tree t = plant(s, launched, capacity, ray, amplitude, path);
    for (int64_t j = 0; j < rays; j++) {
        const double kx = s->n_glass * vx[j], q = s->n_glass * vz[j], p = s->n_glass * vy[j];
        const double w = t.water - p * p, n = t.neuron - p * p, over = 1 / (w * n);
        const Ray one = {p, w, n, n * over, w * over, j};
        t.segments++;
        if (t.max == 0)
            continue;
        const double u2 = q * q + (t.water - t.glass), u = sqrt(u2 > 0 ? u2 : 0);
        const double tau = -t.focus / q, x = tau * kx;
        double r, T;
        FRESNEL(double, t.glass, t.water, -t.sign_glass, q, u, r, T);
        if (!(fabs(r) < t.faint)) {
            t.segments++;
            if (seen(&t, p, x * q, tau * q, kx, q, q))
                detect(&t, x, kx, q, tau, t.glass * tau, r, p, j);
        }
        if (u2 >= 0 && !(q * q * T < t.faint))
            rise(&t, &one, kx, u, (x - t.cx) * u + t.zc * kx, 0, tau, t.glass * tau, q * q * T, 1);
    }
    *segments = t.segments;
    return t.detected;
}
