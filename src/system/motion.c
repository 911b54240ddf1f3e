/* motion.c - Converts states of rigid bodies between the centre and directors and places, quaternions and angular
 * velocities (include/tvi_rigid.h, docs/rigid.md). */
#include "system/refuse.h"
#include "system/rigid.h"

#include <math.h>
#include <string.h>

/* [1] Products of directors of a state differ from 0 or 1 by at most this. */
#define RIGID_NEAR 1e-3

static void add_cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Sets x to the vector whose components along the axes D are X. */
static void set_turned(double D[3][3], const double X[3], double x[3])
{
    for (int i = 0; i < 3; i++) x[i] = X[0] * D[0][i] + X[1] * D[1][i] + X[2] * D[2][i];
}

/* ---- Quaternions ------------------------------------------------------------------------------------------------- */

/* Makes the length 1, and w >= 0. Returns false if it is 0, which becomes no rotation. */
static bool normalise(double quaternion[4])
{
    const double *u = quaternion;
    const double length = copysign(hypot(hypot(u[0], u[1]), hypot(u[2], u[3])), u[0]);
    for (int i = 0; i < 4; i++) quaternion[i] = length != 0 ? quaternion[i] / length : i == 0;
    return length != 0;
}

void tvi_rigid_turn(const double axis[3], double angle, double quaternion[4])
{
    const double length = hypot(hypot(axis[0], axis[1]), axis[2]), part = sin(angle / 2) / length;
    quaternion[0] = cos(angle / 2);
    for (int i = 0; i < 3; i++) quaternion[i + 1] = part * axis[i];
}

/* Sets D[k] to the axis k of a body in space, of a quaternion of length 1. */
static void set_axes(const double quaternion[4], double D[3][3])
{
    const double w = quaternion[0], *u = quaternion + 1;
    for (int k = 0; k < 3; k++) {
        double once[3] = {0}, e[3] = {0};
        e[k] = 1;
        add_cross(u, e, once);
        for (int i = 0; i < 3; i++) D[k][i] = e[i] + 2 * w * once[i];
        for (int i = 0; i < 3; i++) once[i] *= 2;
        add_cross(u, once, D[k]);
    }
}

/* Finds the quaternion of axes, from the largest of the four squares. */
static void set_quaternion(double D[3][3], double quaternion[4])
{
    const double trace = D[0][0] + D[1][1] + D[2][2];
    int k = 0;
    for (int i = 1; i < 3; i++)
        if (D[i][i] > D[k][k]) k = i;
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    if (trace >= D[k][k]) {
        quaternion[0] = 1 + trace;
        for (int i = 0; i < 3; i++) quaternion[i + 1] = D[(i + 1) % 3][(i + 2) % 3] - D[(i + 2) % 3][(i + 1) % 3];
    } else {
        quaternion[0] = D[u][v] - D[v][u];
        quaternion[k + 1] = 1 + 2 * D[k][k] - trace;
        quaternion[u + 1] = D[k][u] + D[u][k];
        quaternion[v + 1] = D[k][v] + D[v][k];
    }
    (void)normalise(quaternion);
}

/* Finds the least rotation that turns axis k to d. */
static void set_least_rotation(int k, const double d[3], double quaternion[4])
{
    double e[3] = {0};
    e[k] = 1;
    memset(quaternion, 0, 4 * sizeof *quaternion);
    add_cross(e, d, quaternion + 1);
    quaternion[0] = d[k] > 0 ? 1 + d[k] : dot(quaternion + 1, quaternion + 1) / (1 - d[k]);
    if (!normalise(quaternion)) quaternion[0] = 0, quaternion[(k + 1) % 3 + 1] = 1; /* half a turn about another axis */
}

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* Refuses numbers of a motion that are not finite, or not in the plane. */
static tvi_status refuse_numbers(const tvi_rigid *r, const char *name, int count, const double x[], int in_plane)
{
    for (int i = 0; i < count; i++) {
        if (!isfinite(x[i])) return jet_refuse(TVI_ENONFINITE, "%s[%d] = %g is not finite", name, i, x[i]);
        if (r->axes == 2 && x[i] != 0 && !(in_plane >> i & 1))
            return jet_refuse(TVI_EINVAL, "%s[%d] = %g is not in the plane", name, i, x[i]);
    }
    return TVI_OK;
}

/* Refuses a body, and a point of it. */
static tvi_status refuse_point(const tvi_rigid *r, int body, const double point[3])
{
    tvi_status status = refuse_numbers(r, "point", 3, point, 3);
    for (int k = 0; k < r->axes && status == TVI_OK; k++)
        if (point[k] != 0 && !tvi_rigid_has_axis(r, body, k))
            status = jet_refuse(TVI_EINVAL, "point[%d] = %g is off body %d, a line or a point", k, point[k], body);
    return status;
}

static tvi_status refuse_arguments(const tvi_rigid *r, int body, const tvi_rigid_motion *motion, const void *q,
                                   const void *p)
{
    const tvi_status status = tvi_rigid_check(r);
    if (status != TVI_OK) return status;
    if (!motion || !q || !p)
        return tvi_refuse_first_null_pointer(3, (const void *const[]){motion, q, p},
                                             (const char *const[]){"motion", "q", "p"});
    if (body < 0 || body >= r->bodies)
        return jet_refuse(TVI_EINVAL, "body = %d is not from 0 to %d", body, r->bodies - 1);
    return refuse_point(r, body, motion->point);
}

tvi_status tvi_rigid_state(const tvi_rigid *r, int body, const tvi_rigid_motion *motion, double q[], double p[])
{
    double unit[4], D[3][3], omega[3], arm[3], v[3] = {0};
    tvi_status status = refuse_arguments(r, body, motion, q, p);
    if (status == TVI_OK) status = refuse_numbers(r, "place", 3, motion->place, 3);
    if (status == TVI_OK) status = refuse_numbers(r, "velocity", 3, motion->velocity, 3);
    if (status == TVI_OK) status = refuse_numbers(r, "quaternion", 4, motion->quaternion, 9);
    if (status == TVI_OK) status = refuse_numbers(r, "omega", 3, motion->omega, 4);
    if (status != TVI_OK) return status;
    const rigid_layout layout = tvi_rigid_layout(r, body);
    memcpy(unit, motion->quaternion, sizeof unit);
    (void)normalise(unit);
    set_axes(unit, D);
    set_turned(D, motion->omega, omega);
    set_turned(D, motion->point, arm);
    add_cross(arm, omega, v);
    for (int i = 0; i < r->axes; i++) {
        q[layout.start + i] = motion->place[i] - arm[i];
        p[layout.start + i] = r->body[body].mass * (motion->velocity[i] + v[i]);
    }
    for (int k = 0; k < 3; k++) {
        double turning[3] = {0};
        add_cross(omega, D[k], turning);
        for (int i = 0; i < r->axes && layout.at[k] >= 0; i++) {
            q[layout.at[k] + i] = D[k][i];
            p[layout.at[k] + i] = layout.E[k] * turning[i];
        }
    }
    return TVI_OK;
}

/* The coordinates of a body alone. */
typedef struct {
    tvi_rigid rigid;
    jet q[12];
} body_alone;

static void set_alone(body_alone *alone, const tvi_rigid *r, int body, const double q[])
{
    const rigid_layout layout = tvi_rigid_layout(r, body);
    alone->rigid = (tvi_rigid){.bodies = 1, .axes = r->axes, .body = &r->body[body]};
    for (int i = layout.start; i < layout.end; i++) alone->q[i - layout.start] = jet_const(q[i]);
}

/* Refuses axes that are not perpendicular unit vectors. */
static tvi_status refuse_axes(int body, double D[3][3])
{
    double third[3] = {0};
    for (int k = 0; k < 3; k++)
        for (int l = 0; l <= k; l++)
            if (!(fabs(dot(D[k], D[l]) - (k == l)) <= RIGID_NEAR))
                return jet_refuse(TVI_EINVAL, "the directors %d and %d of body %d have the product %g", l, k, body,
                                  dot(D[k], D[l]));
    add_cross(D[0], D[1], third);
    return dot(third, D[2]) > 0 ? TVI_OK : jet_refuse(TVI_EINVAL, "the directors of body %d are left-handed", body);
}

/* Sets D and the quaternion of a body. */
static tvi_status find_axes(const tvi_rigid *r, int body, const double q[], double D[3][3], double quaternion[4])
{
    const rigid_layout layout = tvi_rigid_layout(r, body);
    body_alone alone;
    set_alone(&alone, r, body, q);
    memset(quaternion, 0, 4 * sizeof *quaternion);
    quaternion[0] = 1;
    for (int k = 0; k < 3 && layout.count == 1 && r->axes == 3; k++)
        if (layout.at[k] >= 0) set_least_rotation(k, q + layout.at[k], quaternion);
    set_axes(quaternion, D);
    for (int k = 0; k < 3 && layout.count > 0; k++)
        for (int i = 0; i < 3 && tvi_rigid_has_axis(r, body, k); i++)
            D[k][i] = tvi_rigid_director(&alone.rigid, alone.q, 0, k).x[i].number;
    const tvi_status status = refuse_axes(body, D);
    if (status == TVI_OK) set_quaternion(D, quaternion);
    return status;
}

tvi_status tvi_rigid_of(const tvi_rigid *r, int body, const double q[], const double p[], tvi_rigid_motion *motion)
{
    double D[3][3], quaternion[4], sum[3] = {0}, omega[3], arm[3], v[3] = {0};
    tvi_status status = refuse_arguments(r, body, motion, q, p);
    if (status != TVI_OK) return status;
    const rigid_layout layout = tvi_rigid_layout(r, body);
    for (int i = layout.start; i < layout.end; i++)
        if (!isfinite(q[i]) || !isfinite(p[i]))
            return jet_refuse(TVI_ENONFINITE, "%s[%d] is not finite", isfinite(q[i]) ? "p" : "q", i);
    status = find_axes(r, body, q, D, quaternion);
    if (status != TVI_OK) return status;
    for (int k = 0; k < 3; k++) {
        double turning[3] = {0};
        for (int i = 0; i < r->axes && layout.at[k] >= 0; i++) turning[i] = p[layout.at[k] + i] / layout.E[k];
        add_cross(D[k], turning, sum); /* It is 0 for a director that is left out. */
    }
    for (int k = 0; k < 3; k++) {
        const int turning = rigid_turning(&layout, k);
        motion->omega[k] = turning ? dot(D[k], sum) / turning : 0;
    }
    set_turned(D, motion->omega, omega);
    set_turned(D, motion->point, arm);
    add_cross(omega, arm, v);
    memcpy(motion->quaternion, quaternion, sizeof quaternion);
    memset(motion->place, 0, sizeof motion->place);
    memset(motion->velocity, 0, sizeof motion->velocity);
    for (int i = 0; i < r->axes; i++) {
        motion->place[i] = q[layout.start + i] + arm[i];
        motion->velocity[i] = p[layout.start + i] / r->body[body].mass + v[i];
    }
    return TVI_OK;
}

void tvi_rigid_place(const tvi_rigid *r, const double q[], int body, const double X[], double x[])
{
    body_alone alone;
    jet place[3];
    if (tvi_rigid_check(r) != TVI_OK || body < 0 || body >= r->bodies) return;
    set_alone(&alone, r, body, q);
    tvi_rigid_point(&alone.rigid, alone.q, 0, X, place);
    for (int i = 0; i < r->axes; i++) x[i] = place[i].number;
}

void tvi_rigid_angular_momentum(const tvi_rigid *r, const double q[], const double p[], double L[3])
{
    if (tvi_rigid_check(r) != TVI_OK) return;
    const int n = tvi_rigid_dimension(r);
    L[0] = L[1] = L[2] = 0;
    for (int at = 0; at < n; at += r->axes) {
        double x[3] = {0}, of_x[3] = {0};
        memcpy(x, q + at, (size_t)r->axes * sizeof *x);
        memcpy(of_x, p + at, (size_t)r->axes * sizeof *x);
        add_cross(x, of_x, L);
    }
}
