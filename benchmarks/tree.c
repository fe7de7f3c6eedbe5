/* The full ray tree of a cylinder over a plane, as fast as C can: one ray at a time, and in lanes.
 *
 * Both use what is conserved, so that a segment costs a few products:
 * - A ray's momentum is k = n v, and dr = k dtau with tau = integral of ds / n. No normal has a y
 *   component, so p = ky never changes: y = p tau, and all else happens in the plane (x, z).
 * - At a surface the momentum q along its normal becomes qt^2 = qi^2 + nt^2 - ni^2 (Snell). q is
 *   |kz| on the plane; on the cylinder q^2 = n^2 - p^2 - L^2, all lengths being in its radii.
 * - The angular momentum L = x kz - z kx about the axis changes at the plane only: 2 zc kx - L.
 * - All chords of a ray in the cylinder are alike. The rays that leave it are the reflected ray,
 *   turned by the same angle from each to the next.
 * - Squares of amplitudes are carried, with the amplitude's sign; only detection takes roots.
 * Beyond the critical angle qt = 0 gives r = 1 by itself. Segments that end are counted, not made.
 *
 * gcc -O3 -march=native -fno-math-errno: a root is one instruction; no arithmetic is relaxed.
 */
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __AVX__
#include <immintrin.h>
#endif

typedef struct { /* made by trees.py; lengths in radii of the cylinder, heights from the plane */
    double n_glass, glass, water, neuron;  /* an index, and squares of all three */
    double sign_glass, sign_neuron;        /* of r, coming from water */
    double cx, zc, radius, focus, drop;    /* the axis; the radius in um; drop: the objective */
    double objective, detector;            /* squares of their radii */
    double magnification, focal_length;    /* the latter in um */
    double faint;                          /* least square of the amplitude, relative */
    int64_t max, rays;
    const double *vx, *vy, *vz, *launched;
    int64_t capacity, detected, segments;  /* detected may exceed capacity: the rest is lost */
    int64_t *ray;
    double *amplitude, *path;              /* path in um */
} Tree;

static double squared(double x) { return x * x; }
static double root_of(double x) { return sqrt(x > 0 ? x : 0); }

/* Fresnel for unpolarised light: r^2 with the sign of r, and t^2 / qi^2, from squared indices. */
#define FRESNEL(type, ni2, nt2, sign, qi, qt, r, T) \
    do { \
        const type a_ = qi + qt, b_ = nt2 * qi + ni2 * qt, over_ = 1 / (a_ * b_); \
        const type s_ = b_ * over_, p_ = a_ * over_; /* one over either denominator */ \
        const type rs_ = (qi - qt) * s_, rp_ = (nt2 * qi - ni2 * qt) * p_; \
        r = (0.5 * (sign)) * (rs_ * rs_ + rp_ * rp_); \
        T = 2 * (s_ * s_ + (ni2 * nt2) * (p_ * p_)); \
    } while (0)

/* A ray down from (x, p tau) on the plane, with momentum q downwards, that passes the detector's
 * image: noted if it passes the objective too. */
static __attribute__((noinline)) void detect(Tree *t, double x, double kx, double q, double tau,
                                             double path, double A, double p, int64_t ray)
{
    const double s = 1 / q, f = t->focal_length;
    if (!(squared(x - t->drop * kx * s) + squared(p * (tau - t->drop * s)) <= t->objective)) return;
    const int64_t i = t->detected++;
    if (i >= t->capacity) return;
    const double rho2 = squared(x - t->focus * kx * s) + squared(p * (tau - t->focus * s));
    const double um2 = rho2 * t->radius * t->radius;
    t->ray[i] = ray;
    t->amplitude[i] = t->launched[ray] * copysign(sqrt(fabs(A)), A) * (1 - rho2 / t->detector);
    t->path[i] = (path - t->glass * t->focus * s) * t->radius
               + t->magnification * um2 / (sqrt(f * f + um2) + f);
}

/* ---------------------------------------------------------------- one ray at a time */

typedef struct { double p, water, per_water, per_neuron; int64_t number; } Ray; /* n^2 - p^2 */

/* Does a ray pass the detector's image? All times q g, so that nothing is divided. */
static int seen(const Tree *t, double p, double xq, double tauq, double kx, double q, double g)
{
    const double X = xq * g - t->focus * q * kx, Y = p * (tauq * g - t->focus * q);
    return X * X + Y * Y < t->detector * squared(q * g);
}

static void rise(Tree *t, const Ray *ray, double kx, double kz, double L, double z, double tau,
                 double path, double A, int64_t met);

/* From the cylinder, at height z, through water: away, or down to the plane. */
static inline void leave(Tree *t, const Ray *ray, double kx, double kz, double L, double z,
                         double tau, double path, double A, int64_t met)
{
    t->segments++;
    if (kz >= 0 || met == t->max) return;
    const double q = -kz, g2 = q * q + (t->glass - t->water), g = root_of(g2);
    const double xq = t->zc * kx - L + t->cx * q, tauq = tau * q + z, up = 2 * t->zc * kx - L;
    const int hits = up * up < ray->water && met + 1 < t->max;
    const int down = seen(t, ray->p, xq, tauq, kx, q, g);
    if (!hits && !down && t->faint == 0) { /* nearly all */
        t->segments += g2 < 0 ? 1 : 2;
        return;
    }
    double r, T;
    FRESNEL(double, t->water, t->glass, t->sign_glass, q, g, r, T);
    T *= q * q;
    if (g2 >= 0 && !(fabs(A * T) < t->faint)) {
        t->segments++;
        const double then = path + t->water * z / q;
        if (down) detect(t, xq / q, kx, g, tauq / q, then, A * T, ray->p, ray->number);
    }
    if (fabs(A * r) < t->faint) return;
    if (hits) rise(t, ray, kx, q, up, z, tau, path, A * r, met + 1);
    else t->segments++;
}

/* Up from the plane (and before, down to it from height z), and all that leaves the cylinder. */
static void rise(Tree *t, const Ray *ray, double kx, double kz, double L, double z, double tau,
                 double path, double A, int64_t met)
{
    t->segments++;
    const double q2 = ray->water - L * L, n2 = q2 + (t->neuron - t->water);
    if (!(q2 > 0) || met++ == t->max) return;
    const double q = sqrt(q2), n = root_of(n2), per_water = ray->per_water;
    const double nx = (L * kz - q * kx) * per_water, nz = -(q * kz + L * kx) * per_water;
    const double s = (z + t->zc + nz) / kz;
    double r, T;
    FRESNEL(double, t->water, t->neuron, t->sign_neuron, q, n, r, T);
    tau += s, path += t->water * s, kx += 2 * q * nx, kz += 2 * q * nz;
    if (!(fabs(A * r) < t->faint)) leave(t, ray, kx, kz, L, t->zc + nz, tau, path, A * r, met);
    A *= q2 * T;
    if (n2 < 0 || fabs(A) < t->faint) return;
    const double out = n2 * T, chord = 2 * n * ray->per_neuron, cosine = 1 - n * chord;
    const double sine = L * chord, zx = -L * per_water, zz = q * per_water;
    for (;;) {
        t->segments++;
        if (met++ == t->max) return;
        if (met == t->max && t->faint == 0) { /* both of the next end */
            t->segments += 2;
            return;
        }
        const double was = kx;
        kx = kx * cosine - kz * sine, kz = was * sine + kz * cosine;
        tau += chord, path += t->neuron * chord;
        if (!(fabs(A * out) < t->faint))
            leave(t, ray, kx, kz, L, t->zc + zx * kx + zz * kz, tau, path, A * out, met);
        A *= -r;
        if (fabs(A) < t->faint) return;
    }
}

void trace_scalar(Tree *t)
{
    for (int64_t j = 0; j < t->rays; j++) {
        const double kx = t->n_glass * t->vx[j], p = t->n_glass * t->vy[j];
        const double q = t->n_glass * t->vz[j], tau = -t->focus / q, x = tau * kx;
        const double u2 = q * q + (t->water - t->glass), u = root_of(u2);
        t->segments++;
        if (t->max == 0) continue;
        double r, T;
        FRESNEL(double, t->glass, t->water, -t->sign_glass, q, u, r, T);
        T *= q * q;
        if (!(fabs(r) < t->faint)) {
            t->segments++;
            if (seen(t, p, x * q, tau * q, kx, q, q))
                detect(t, x, kx, q, tau, t->glass * tau, r, p, j);
        }
        const double water = t->water - p * p, neuron = t->neuron - p * p;
        const Ray ray = {p, water, 1 / water, 1 / neuron, j};
        const double L = (x - t->cx) * u + t->zc * kx;
        if (u2 >= 0 && !(T < t->faint)) rise(t, &ray, kx, u, L, 0, tau, t->glass * tau, T, 1);
    }
}

/* ---------------------------------------------------------------- rays in lanes */

#ifdef __AVX512F__
enum { W = 8, ROOM = 4 * W, LEVELS = 64 };
#else
enum { W = 4, ROOM = 4 * W, LEVELS = 64 };
#endif
typedef double lanes __attribute__((vector_size(8 * W)));
typedef double unaligned __attribute__((vector_size(8 * W), aligned(8)));
typedef unsigned mask; /* a bit a lane */
typedef struct { lanes kx, q, L, z, tau, path, A, p, ray; } Packet;
enum { FIELDS = sizeof(Packet) / sizeof(lanes) };
#define INLINE static inline __attribute__((always_inline))

INLINE mask less(lanes a, lanes b)
{
#ifdef __AVX512F__
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#elif defined __AVX__
    return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ));
#else
    mask m = 0;
    for (int i = 0; i < W; i++) m |= (mask)(a[i] < b[i]) << i;
    return m;
#endif
}

INLINE lanes root(lanes a) /* of negative numbers 0 */
{
#ifdef __AVX512F__
    return (lanes)_mm512_sqrt_pd(_mm512_max_pd((__m512d)a, (__m512d)(lanes){0}));
#else
    for (int i = 0; i < W; i++) a[i] = root_of(a[i]);
    return a;
#endif
}

INLINE void squeeze(double *to, lanes a, mask m) /* the lanes of a mask, without gaps */
{
#ifdef __AVX512F__
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd(m, (__m512d)a));
#else
    for (int i = 0; i < W; to += m >> i++ & 1) *to = a[i];
#endif
}

INLINE lanes load(const double *at) { return (lanes)*(const unaligned *)at; }
INLINE lanes all(double a) { return a - (lanes){0}; }
INLINE mask fainter(const Tree *t, lanes A) { return less(A * A, all(t->faint * t->faint)); }

INLINE void detect_lanes(Tree *t, mask on, lanes x, lanes kx, lanes q, lanes tau, lanes path,
                         lanes A, lanes p, lanes ray)
{
    for (; on; on &= on - 1) {
        const int i = __builtin_ctz(on);
        detect(t, x[i], kx[i], q[i], tau[i], path[i], A[i], p[i], (int64_t)ray[i]);
    }
}

/* Rays going up that will meet the cylinder, by how often they met anything. Lanes of a packet end
 * here and there; what is left closes up in these queues, until there are full packets again. The
 * deepest queue that has one goes first, so that none outgrows its room. */
typedef struct {
    Tree t;
    uint64_t ready; /* bit m: queue m was nearly full, and still holds a packet */
    struct { double of[FIELDS][ROOM]; int64_t length; } queue[LEVELS];
} Forest;

INLINE void leave_lanes(Forest *f, const Packet *from, lanes kx, lanes kz, lanes z, lanes tau,
                        lanes path, lanes A, lanes water, mask on, int64_t met)
{
    Tree *t = &f->t;
    if (t->faint > 0) on &= ~fainter(t, A);
    t->segments += __builtin_popcount(on);
    on &= less(kz, all(0));
    if (!on || met++ == t->max) return;
    const lanes q = -kz, g2 = q * q + (t->glass - t->water), g = root(g2);
    lanes r = {0}, T = {0};
    mask down = on & ~less(g2, all(0));
    if (t->faint > 0) {
        FRESNEL(lanes, t->water, t->glass, t->sign_glass, q, g, r, T);
        down &= ~fainter(t, A * q * q * T);
        on &= ~fainter(t, A * r);
    }
    t->segments += __builtin_popcount(down) + __builtin_popcount(on);
    const lanes xq = t->zc * kx - from->L + t->cx * q, tauq = tau * q + z, fq = t->focus * q;
    const lanes X = xq * g - fq * kx, Y = from->p * (tauq * g - fq), qg = q * g;
    down &= less(X * X + Y * Y, t->detector * (qg * qg));
    if (__builtin_expect(down, 0)) {
        FRESNEL(lanes, t->water, t->glass, t->sign_glass, q, g, r, T);
        detect_lanes(t, down, xq / q, kx, g, tauq / q, path + t->water * (z / q), A * q * q * T,
                     from->p, from->ray);
    }
    const lanes L = 2 * t->zc * kx - from->L;
    on &= less(L * L, water);
    if (!on || met == t->max) return;
    const lanes fields[FIELDS] = {kx, q, L, z, tau, path, A, from->p, from->ray};
    const int64_t length = f->queue[met].length;
    for (int i = 0; i < FIELDS; i++) squeeze(f->queue[met].of[i] + length, fields[i], on);
    f->queue[met].length += __builtin_popcount(on);
    if (f->queue[met].length > ROOM - W) f->ready |= 1ull << met;
}

static void __attribute__((noinline))
rise_lanes(Forest *f, const Packet *from, mask on, int64_t met)
{
    Tree *t = &f->t;
    const lanes L = from->L, p2 = from->p * from->p, water = t->water - p2, neuron = t->neuron - p2;
    const lanes q2 = water - L * L, n2 = q2 + (t->neuron - t->water), q = root(q2), n = root(n2);
    on &= less(all(0), q2);
    if (!on) return;
    lanes kx = from->kx, kz = from->q, A = from->A, r, T;
    FRESNEL(lanes, t->water, t->neuron, t->sign_neuron, q, n, r, T);
    const lanes both = water * neuron, over = 1 / (kz * both), per_kz = over * both;
    const lanes per_water = over * neuron * kz, per_neuron = over * water * kz;
    const lanes nx = (L * kz - q * kx) * per_water, nz = -(q * kz + L * kx) * per_water;
    const lanes s = (from->z + t->zc + nz) * per_kz;
    lanes tau = from->tau + s, path = from->path + t->water * s;
    kx += 2 * q * nx, kz += 2 * q * nz, met++;
    leave_lanes(f, from, kx, kz, t->zc + nz, tau, path, A * r, water, on, met);
    A *= q2 * T;
    on &= ~less(n2, all(0)) & ~fainter(t, A);
    const lanes out = n2 * T, chord = 2 * n * per_neuron, optical = t->neuron * chord;
    const lanes cosine = 1 - n * chord, sine = L * chord, zx = -L * per_water, zz = q * per_water;
    while (on) {
        t->segments += __builtin_popcount(on);
        if (met++ == t->max) return;
        if (met == t->max && t->faint == 0) { /* both of the next end */
            t->segments += 2 * __builtin_popcount(on);
            return;
        }
        const lanes was = kx;
        kx = kx * cosine - kz * sine, kz = was * sine + kz * cosine, tau += chord, path += optical;
        const lanes z = t->zc + zx * kx + zz * kz;
        leave_lanes(f, from, kx, kz, z, tau, path, A * out, water, on, met);
        A *= -r;
        if (t->faint > 0) on &= ~fainter(t, A);
    }
}

/* Every ray of queue m, or those of the deepest queues that are full; reflected off the plane. */
static void drain(Forest *f, int64_t m)
{
    while (f->ready || f->queue[m].length) {
        const int64_t met = f->ready ? 63 - __builtin_clzll(f->ready) : m;
        const int64_t length = f->queue[met].length, taken = length < W ? length : W;
        lanes fields[FIELDS], r, T;
        for (int i = 0; i < FIELDS; i++) fields[i] = load(f->queue[met].of[i] + length - taken);
        f->queue[met].length -= taken;
        if (f->queue[met].length < W) f->ready &= ~(1ull << met);
        Packet from;
        memcpy(&from, fields, sizeof from);
        const lanes g = root(from.q * from.q + (f->t.glass - f->t.water));
        FRESNEL(lanes, f->t.water, f->t.glass, f->t.sign_glass, from.q, g, r, T);
        (void)T, from.A *= r;
        rise_lanes(f, &from, (1u << taken) - 1, met);
    }
}

void trace_simd(Tree *tree) /* max below LEVELS */
{
    Forest forest, *f = &forest;
    Tree *t = &f->t;
    *t = *tree, f->ready = 0;
    for (int m = 0; m < LEVELS; m++) f->queue[m].length = 0;
    for (int64_t j = 0; j < t->rays; j += W) {
        const int64_t some = t->rays - j < W ? t->rays - j : W;
        double v[3][W], number[W]; /* the last packet repeats a ray where it has none */
        for (int i = 0; i < W; i++) {
            const int64_t k = i < some ? j + i : j;
            v[0][i] = t->vx[k], v[1][i] = t->vy[k], v[2][i] = t->vz[k], number[i] = (double)k;
        }
        const lanes kx = t->n_glass * load(v[0]), p = t->n_glass * load(v[1]);
        const lanes q = t->n_glass * load(v[2]), tau = -t->focus / q, x = tau * kx;
        const lanes u2 = q * q + (t->water - t->glass), u = root(u2);
        t->segments += some;
        if (t->max == 0) continue;
        lanes r, T;
        FRESNEL(lanes, t->glass, t->water, -t->sign_glass, q, u, r, T);
        T *= q * q;
        mask on = (1u << some) - 1, down = on & ~fainter(t, r);
        on &= ~less(u2, all(0)) & ~fainter(t, T);
        t->segments += __builtin_popcount(down) + __builtin_popcount(on);
        down &= less(4 * (x * x + p * p * tau * tau), all(t->detector));
        detect_lanes(t, down, x, kx, q, tau, t->glass * tau, r, p, load(number));
        const lanes L = (x - t->cx) * u + t->zc * kx;
        const Packet from = {kx, u, L, all(0), tau, t->glass * tau, T, p, load(number)};
        if (t->max > 1) rise_lanes(f, &from, on, 1);
        drain(f, 0);
    }
    for (int m = 1; m < t->max; m++) drain(f, m);
    *tree = *t;
}
