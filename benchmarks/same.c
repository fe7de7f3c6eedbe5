/* The ray tree in C with octsim's own arithmetic, in three dimensions, for the scene of a cylinder
 * over a plane: what the same work costs in C. `tree.c` shows what the scene's symmetries allow. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#define LANES 64
#define WAITING 128

typedef struct {
    double n[3];                  /* glass, water, neuron */
    double zc, radius;            /* the cylinder's axis and radius */
    double focus, objective, objective_radius, detector_radius, magnification, focal_length;
    double min_amplitude;
    int64_t max_intersections, rays;
    const double *vx, *vy, *vz, *launched;
    int64_t *ray;                 /* out, with room for `room` detections */
    double *amplitude, *path;
    int64_t room, detected, segments;
} Tree;

/* A departure is the side of a surface that light leaves from; one face can follow each. */
enum { LAUNCH, PLANE_DOWN, PLANE_UP, CYLINDER_IN, CYLINDER_OUT };
enum { FROM_BELOW, FROM_ABOVE, FROM_INSIDE, FROM_OUTSIDE };
static const int next_face[] = {FROM_BELOW, -1, FROM_OUTSIDE, FROM_INSIDE, FROM_ABOVE};
static const int incident[] = {0, 1, 2, 1}, beyond[] = {1, 0, 1, 2};
static const int reflected[] = {PLANE_DOWN, PLANE_UP, CYLINDER_IN, CYLINDER_OUT};
static const int transmitted[] = {PLANE_UP, PLANE_DOWN, CYLINDER_OUT, CYLINDER_IN};

static inline void meet(const Tree *t, int face, double x, double z, double vx, double vz,
                        double *distance, double *cos_i)
{
    double to_x = -x, to_z = t->zc - z, squared = vx * vx + vz * vz;
    double middle = to_x * vx + to_z * vz;
    switch (face) {
    case FROM_BELOW:
    case FROM_ABOVE:
        *distance = (vz < 0) == (face == FROM_ABOVE) && vz != 0 ? -z / vz : INFINITY;
        *cos_i = fabs(vz);
        break;
    case FROM_INSIDE:
        *distance = middle > 0 ? 2 * middle / squared : INFINITY;
        *cos_i = middle / t->radius;
        break;
    default: {
        double across = sqrt(squared), offset = (to_x * vz - to_z * vx) / across;
        double h_squared = (t->radius - offset) * (t->radius + offset);
        double h = sqrt(h_squared > 0 ? h_squared : 0);
        *distance = middle > 0 && h_squared > 0 ? (middle / across - h) / across : INFINITY;
        *cos_i = h * across / t->radius;
    }
    }
}

static inline double coefficients(double n_i, double n_t, double cos_i, double *cos_t, double *t)
{
    double eta = n_i / n_t, squared = (1 - eta) * (1 + eta) + eta * eta * cos_i * cos_i;
    double root = sqrt(squared > 0 ? squared : 0);
    double p = 1 / (n_t * cos_i + n_i * root), s = 1 / (n_i * cos_i + n_t * root);
    double rp = (n_t * cos_i - n_i * root) * p, rs = (n_i * cos_i - n_t * root) * s;
    double tp = 2 * n_i * cos_i * p, ts = 2 * n_i * cos_i * s;
    double r = sqrt(0.5 * (rp * rp + rs * rs));
    *t = sqrt(0.5 * (tp * tp + ts * ts));
    *cos_t = squared >= 0 ? root : -1;
    return squared >= 0 ? (n_t > n_i ? -r : r) : 1;
}

static void detect(Tree *t, double x, double y, double z, double vx, double vy, double vz,
                   double a, double path, int64_t ray)
{
    double d = (t->objective - z) / vz, px = x + d * vx, py = y + d * vy;
    if (!(px * px + py * py <= t->objective_radius * t->objective_radius)) return;
    d = (t->focus - z) / vz, px = x + d * vx, py = y + d * vy;
    double rho = px * px + py * py, limit = t->detector_radius * t->detector_radius;
    if (!(rho < limit) || t->detected == t->room) return;
    double f = t->focal_length;
    t->ray[t->detected] = ray;
    t->amplitude[t->detected] = t->launched[ray] * a * (1 - rho / limit);
    t->path[t->detected++] = path + t->n[0] * d + t->magnification * rho / (sqrt(f * f + rho) + f);
}

typedef struct { double x, y, z, vx, vy, vz, a, path; int64_t departure, meetings; } Ray;

void same_scalar(Tree *t)
{
    Ray stack[WAITING];
    for (int64_t j = 0; j < t->rays; j++) {
        int top = 0;
        stack[0] = (Ray){0, 0, t->focus, t->vx[j], t->vy[j], t->vz[j], 1, 0, LAUNCH, 0};
        while (top >= 0) {
            Ray q = stack[top--];
            t->segments++;
            int f = next_face[q.departure];
            if (f < 0) {
                detect(t, q.x, q.y, q.z, q.vx, q.vy, q.vz, q.a, q.path, j);
                continue;
            }
            double d, ci, ct, tr, n_i = t->n[incident[f]], n_t = t->n[beyond[f]], eta = n_i / n_t;
            meet(t, f, q.x, q.z, q.vx, q.vz, &d, &ci);
            if (d == INFINITY || q.meetings == t->max_intersections) continue;
            q.x += d * q.vx, q.y += d * q.vy, q.z += d * q.vz, q.path += d * n_i, q.meetings++;
            double nx = 0, nz = f == FROM_ABOVE ? 1 : -1;
            if (f >= FROM_INSIDE) {
                double scale = (f == FROM_OUTSIDE ? 1 : -1) / t->radius;
                nx = q.x * scale, nz = (q.z - t->zc) * scale;
            }
            double r = coefficients(n_i, n_t, ci, &ct, &tr), k = eta * ci - ct;
            if (ct >= 0 && fabs(q.a * tr) >= t->min_amplitude)
                stack[++top] = (Ray){q.x, q.y, q.z, eta * q.vx + k * nx, eta * q.vy,
                                     eta * q.vz + k * nz, q.a * tr, q.path, transmitted[f],
                                     q.meetings};
            if (fabs(q.a * r) >= t->min_amplitude)
                stack[++top] = (Ray){q.x, q.y, q.z, q.vx + 2 * ci * nx, q.vy, q.vz + 2 * ci * nz,
                                     q.a * r, q.path, reflected[f], q.meetings};
        }
    }
}

typedef struct {
    double x[LANES], y[LANES], z[LANES], vx[LANES], vy[LANES], vz[LANES], a[LANES], path[LANES],
        ray[LANES];
    int64_t lanes, departure, meetings;
} Block;

static int64_t keep(Block *b, int64_t n, const double *cos_t, double faintest)
{
    int64_t k = 0;
    for (int64_t i = 0; i < n; i++) {
        if (cos_t && cos_t[i] < 0) continue;
        if (fabs(b->a[i]) < faintest) continue;
        b->x[k] = b->x[i], b->y[k] = b->y[i], b->z[k] = b->z[i], b->vx[k] = b->vx[i];
        b->vy[k] = b->vy[i], b->vz[k] = b->vz[i], b->a[k] = b->a[i], b->path[k] = b->path[i];
        b->ray[k++] = b->ray[i];
    }
    return k;
}

void same_lanes(Tree *t)
{
    Block *waiting = malloc(WAITING * sizeof *waiting);
    double d[LANES], ci[LANES], cm[LANES], ct[LANES];
    int64_t chosen[LANES];
    for (int64_t first = 0; first < t->rays; first += LANES) {
        Block *b = waiting;
        b->lanes = t->rays - first < LANES ? t->rays - first : LANES;
        b->departure = LAUNCH, b->meetings = 0;
        for (int64_t i = 0; i < b->lanes; i++) {
            b->x[i] = b->y[i] = b->path[i] = 0, b->z[i] = t->focus, b->a[i] = 1;
            b->vx[i] = t->vx[first + i], b->vy[i] = t->vy[first + i];
            b->vz[i] = t->vz[first + i], b->ray[i] = first + i;
        }
        for (int64_t top = 0; top >= 0;) {
            b = waiting + top;
            int64_t n = b->lanes, count = 0;
            int f = next_face[b->departure];
            b->lanes = 0;
            if (n == 0) { top--; continue; }
            t->segments += n;
            if (f < 0) {
                for (int64_t i = 0; i < n; i++)
                    detect(t, b->x[i], b->y[i], b->z[i], b->vx[i], b->vy[i], b->vz[i], b->a[i],
                           b->path[i], (int64_t)b->ray[i]);
                continue;
            }
            switch (f) { /* a loop for each kind, so that each is free of branches */
#define MEET(kind) case kind: for (int64_t i = 0; i < n; i++) \
                meet(t, kind, b->x[i], b->z[i], b->vx[i], b->vz[i], d + i, ci + i); break;
            MEET(FROM_BELOW) MEET(FROM_ABOVE) MEET(FROM_INSIDE) MEET(FROM_OUTSIDE)
            }
            if (b->meetings == t->max_intersections) continue;
            for (int64_t i = 0; i < n; i++) chosen[count] = i, count += d[i] < INFINITY;
            if (count == 0) continue;
            Block *back = b + 1, *on = b + 2;
            double n_i = t->n[incident[f]], n_t = t->n[beyond[f]], eta = n_i / n_t;
            double plane = f == FROM_ABOVE ? 1 : -1;
            double scale = f < FROM_INSIDE ? 0 : (f == FROM_OUTSIDE ? 1 : -1) / t->radius;
            double up = f < FROM_INSIDE ? plane : 0;
            for (int64_t k = 0; k < count; k++) {
                int64_t i = chosen[k];
                back->x[k] = b->x[i] + d[i] * b->vx[i], back->y[k] = b->y[i] + d[i] * b->vy[i];
                back->z[k] = b->z[i] + d[i] * b->vz[i], back->path[k] = b->path[i] + d[i] * n_i;
                back->vx[k] = b->vx[i], back->vy[k] = b->vy[i], back->vz[k] = b->vz[i];
                back->a[k] = b->a[i], back->ray[k] = b->ray[i], cm[k] = ci[i];
            }
            double lost = 0;
            for (int64_t k = 0; k < count; k++) {
                double tr, r = coefficients(n_i, n_t, cm[k], ct + k, &tr);
                lost += ct[k] < 0 ? 1 : 0;
                on->a[k] = back->a[k] * tr, back->a[k] *= r;
            }
            for (int64_t k = 0; k < count; k++) {
                double nx = back->x[k] * scale, nz = (back->z[k] - t->zc) * scale + up;
                double turn = eta * cm[k] - ct[k];
                on->x[k] = back->x[k], on->y[k] = back->y[k], on->z[k] = back->z[k];
                on->path[k] = back->path[k], on->ray[k] = back->ray[k];
                on->vx[k] = eta * back->vx[k] + turn * nx, on->vy[k] = eta * back->vy[k];
                on->vz[k] = eta * back->vz[k] + turn * nz;
                back->vx[k] += 2 * cm[k] * nx, back->vz[k] += 2 * cm[k] * nz;
            }
            back->lanes = on->lanes = count;
            if (lost > 0 || t->min_amplitude > 0) on->lanes = keep(on, count, ct, t->min_amplitude);
            if (t->min_amplitude > 0) back->lanes = keep(back, count, NULL, t->min_amplitude);
            back->departure = reflected[f], on->departure = transmitted[f];
            back->meetings = on->meetings = b->meetings + 1;
            top += 2;
        }
    }
    free(waiting);
}
