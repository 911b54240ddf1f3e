/* bodies.c - Records the gravity of bodies and its time scale, and computes masses, momenta, the centre of mass and the
 * angular momentum of bodies (include/tvi_bodies.h, docs/bodies.md). */
#include "refusal.h"
#include "system/system.h"
#include "tvi_bodies.h"

/* ---- Which bodies are refused ------------------------------------------------------------------------------------ */

/* This is the mass of body i, or what stands for 0. */
static double mass_of(const tvi_bodies *b, int i)
{
    double most = 0;
    for (int j = 0; j < b->bodies && b->mass[i] == 0; j++) most = fmax(most, b->mass[j]);
    return b->mass[i] == 0 ? TVI_TEST_MASS * most : b->mass[i];
}

static tvi_status refuse_counts(const tvi_bodies *b)
{
    if (!b) return jet_refuse(TVI_EINVAL, "b is NULL");
    if (b->axes < 1 || b->axes > 3) return jet_refuse(TVI_EINVAL, "axes = %d is not from 1 to 3", b->axes);
    if (b->bodies < 1 || b->bodies > TVI_MAX_DIMENSION / b->axes)
        return jet_refuse(TVI_EINVAL, "bodies = %d is not from 1 to %d, with axes = %d", b->bodies,
                          TVI_MAX_DIMENSION / b->axes, b->axes);
    return b->mass ? TVI_OK : jet_refuse(TVI_EINVAL, "mass is NULL");
}

static tvi_status refuse_masses(const tvi_bodies *b)
{
    double most = 0;
    for (int i = 0; i < b->bodies; i++) {
        if (!isfinite(b->mass[i])) return jet_refuse(TVI_ENONFINITE, "mass[%d] = %g is not finite", i, b->mass[i]);
        if (b->mass[i] < 0) return jet_refuse(TVI_EINVAL, "mass[%d] = %g is negative", i, b->mass[i]);
        most = fmax(most, b->mass[i]);
    }
    if (most == 0) return jet_refuse(TVI_EINVAL, "all masses are 0: at least one body has a mass");
    for (int i = 0; i < b->bodies && TVI_TEST_MASS * most == 0; i++)
        if (b->mass[i] == 0)
            return jet_refuse(TVI_EINVAL, "mass[%d] = 0 stands for %g of the largest mass, %g: choose a smaller unit",
                              i, TVI_TEST_MASS, most);
    return TVI_OK;
}

static tvi_status refuse_nonfinite_members(const tvi_bodies *b)
{
    const struct {
        const char *name;
        double value;
    } members[] = {{"G", b->G},
                   {"softening", b->softening},
                   {"J2", b->J2},
                   {"radius", b->radius},
                   {"pole[0]", b->pole[0]},
                   {"pole[1]", b->pole[1]},
                   {"pole[2]", b->pole[2]},
                   {"sharpness", b->sharpness}};
    for (size_t k = 0; k < sizeof members / sizeof *members; k++)
        if (!isfinite(members[k].value))
            return jet_refuse(TVI_ENONFINITE, "%s = %g is not finite", members[k].name, members[k].value);
    return TVI_OK;
}

tvi_status tvi_bodies_check(const tvi_bodies *b)
{
    tvi_status status = refuse_counts(b);
    if (status == TVI_OK) status = refuse_masses(b);
    if (status == TVI_OK) status = refuse_nonfinite_members(b);
    if (status != TVI_OK) return status;
    if (b->J2 != 0 && !(b->radius > 0))
        return jet_refuse(TVI_EINVAL, "J2 = %g needs the radius of the oblate body, and radius = %g is not positive",
                          b->J2, b->radius);
    if (b->J2 != 0 && (b->oblate < 0 || b->oblate >= b->bodies))
        return jet_refuse(TVI_EINVAL, "oblate = %d is not from 0 to %d", b->oblate, b->bodies - 1);
    if (b->sharpness < 0) return jet_refuse(TVI_EINVAL, "sharpness = %g is negative", b->sharpness);
    return TVI_OK;
}

/* This is n, or 0 for counts that are refused. */
static int count_of(const tvi_bodies *b) { return refuse_counts(b) == TVI_OK ? b->bodies * b->axes : 0; }

/* ---- Functions of jets ------------------------------------------------------------------------------------------- */

static double G_of(const tvi_bodies *b) { return b->G == 0 ? 1 : b->G; }

/* For k = 0 it records the potential of two bodies, strength = G m_i m_j; otherwise their term of g, strength =
 * G (m_i + m_j). */
static jet pair(const tvi_bodies *b, double k, double strength, bool bulges, const jet x[], const jet y[])
{
    const double *n = b->pole, length = hypot(hypot(n[0], n[1]), n[2]);
    jet d[3], z = jet_const(0);
    for (int i = 0; i < b->axes; i++) d[i] = jet_sub(x[i], y[i]);
    const jet square = jet_add(jet_dot(d, d, b->axes), b->softening * b->softening);
    if (k != 0) return jet_mul(pow(strength, k / 3), jet_pow(square, -k / 2));
    const jet V = jet_mul(-strength, jet_pow(square, -0.5));
    if (!bulges || b->J2 == 0) return V;
    for (int i = 0; i < b->axes; i++) z = jet_add(z, jet_mul(length > 0 ? n[i] / length : i == 2, d[i]));
    const jet bulge = jet_sub(jet_mul(3, jet_mul(jet_sqr(z), jet_pow(square, -2.5))), jet_pow(square, -1.5));
    return jet_add(V, jet_mul(0.5 * strength * b->J2 * b->radius * b->radius, bulge));
}

/* Sums over pairs, i = 1, 2, ..., j < i, of which one has a mass, in parts that the stack has room for. */
static jet sum_over_pairs(const tvi_bodies *b, double k, const jet q[])
{
    enum { PART = 1024 };
    const double G = G_of(b);
    jet term[PART], sum = jet_const(0);
    int count = 0;
    for (int i = 1; i < b->bodies; i++)
        for (int j = 0; j < i; j++) {
            const double one = b->mass[i], other = b->mass[j];
            if (one == 0 && other == 0) continue;
            const double strength = k != 0 ? G * (one + other) : G * mass_of(b, i) * mass_of(b, j);
            if (count == PART) sum = jet_add(sum, jet_sum(term, count)), count = 0;
            term[count++] = pair(b, k, strength, i == b->oblate || j == b->oblate, q + i * b->axes, q + j * b->axes);
        }
    return jet_add(sum, jet_sum(term, count));
}

/* Tells the guard of steps (integrator/defect.c) that the inputs are places of bodies: of so many axes if they attract
 * each other, and of -axes if they are alone in a given field. */
static void tell_graph_axes_of_bodies(jet x, int axes)
{
    jet_graph *graph;
    if (!jet_find_common_graph_or_poison(1, &x, &graph).node && graph && jet_graph_axes(graph) <= 0)
        jet_graph_set_axes(graph, axes);
}

jet tvi_bodies_potential(const jet q[], jet t, void *ctx)
{
    const tvi_bodies *b = ctx;
    (void)t;
    if (tvi_bodies_check(b) != TVI_OK) return jet_const(NAN);
    tell_graph_axes_of_bodies(q[0], b->axes);
    return sum_over_pairs(b, 0, q);
}

jet tvi_bodies_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const tvi_bodies *b = ctx;
    double most = 0, sum = 0;
    (void)p, (void)t;
    if (tvi_bodies_check(b) != TVI_OK) return jet_const(NAN);
    for (int i = 0; i < b->bodies; i++) most = fmax(most, b->mass[i]), sum += b->mass[i];
    const double k = b->sharpness > 0 ? b->sharpness : most > 10 * (sum - most) ? 3 : 1;
    return jet_pow(sum_over_pairs(b, k, q), -1.5 / k);
}

jet tvi_bodies_field(const tvi_bodies *b, const jet at[], const jet x[])
{
    if (tvi_bodies_check(b) != TVI_OK) return jet_const(NAN);
    tell_graph_axes_of_bodies(x[0], -b->axes);
    jet V = jet_const(0);
    for (int i = 0; i < b->bodies; i++)
        V = jet_add(V, pair(b, 0, G_of(b) * b->mass[i], i == b->oblate, x, at + i * b->axes));
    return V;
}

jet tvi_bodies_field_scale(const tvi_bodies *b, const jet at[], const jet x[])
{
    if (tvi_bodies_check(b) != TVI_OK) return jet_const(NAN);
    const double k = b->sharpness > 0 ? b->sharpness : 3;
    jet sum = jet_const(0);
    for (int i = 0; i < b->bodies; i++)
        if (b->mass[i] != 0) sum = jet_add(sum, pair(b, k, G_of(b) * b->mass[i], false, x, at + i * b->axes));
    return jet_pow(sum, -1.5 / k);
}

tvi_status tvi_bodies_system(tvi_system **out, const tvi_bodies *b)
{
    double mass[TVI_MAX_DIMENSION];
    if (out) *out = NULL;
    const tvi_status status = tvi_bodies_check(b);
    if (status != TVI_OK) return status;
    tvi_bodies_masses(b, mass);
    return tvi_system_potential(out, b->bodies * b->axes, mass, tvi_bodies_potential, (void *)b);
}

/* ---- Functions of states ----------------------------------------------------------------------------------------- */

void tvi_bodies_masses(const tvi_bodies *b, double mass[])
{
    for (int i = 0, n = count_of(b); i < n; i++) mass[i] = mass_of(b, i / b->axes);
}

void tvi_bodies_momenta(const tvi_bodies *b, const double v[], double p[])
{
    for (int i = 0, n = count_of(b); i < n; i++) p[i] = mass_of(b, i / b->axes) * v[i];
}

void tvi_bodies_velocities(const tvi_bodies *b, const double p[], double v[])
{
    for (int i = 0, n = count_of(b); i < n; i++) v[i] = p[i] / mass_of(b, i / b->axes);
}

void tvi_bodies_centre(const tvi_bodies *b, const double q[], const double p[], double x[], double v[])
{
    double mass = 0;
    if (!count_of(b)) return;
    for (int i = 0; i < b->bodies; i++) mass += mass_of(b, i);
    for (int k = 0; k < b->axes; k++) {
        x[k] = v[k] = 0;
        for (int i = 0; i < b->bodies; i++)
            x[k] += mass_of(b, i) / mass * q[i * b->axes + k], v[k] += p[i * b->axes + k] / mass;
    }
}

void tvi_bodies_to_centre(const tvi_bodies *b, double q[], double p[])
{
    double x[3], v[3];
    tvi_bodies_centre(b, q, p, x, v);
    for (int i = 0, n = count_of(b); i < n; i++)
        q[i] -= x[i % b->axes], p[i] -= mass_of(b, i / b->axes) * v[i % b->axes];
}

void tvi_bodies_angular_momentum(const tvi_bodies *b, const double q[], const double p[], double L[3])
{
    if (!count_of(b)) return;
    L[0] = L[1] = L[2] = 0;
    for (int i = 0; i < b->bodies; i++)
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, w = (k + 2) % 3, at = i * b->axes;
            if (u < b->axes && w < b->axes) L[k] += q[at + u] * p[at + w] - q[at + w] * p[at + u];
        }
}
