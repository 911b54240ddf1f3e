/* rigid.c - Records the constraints and the gravity of rigid bodies and their joints, and converts their states
 * (include/tvi_rigid.h, docs/rigid.md). A body is its centre and its directors, of which the kinetic energy is a sum of
 * squares: E_k |d_k'|^2 / 2 each, so that masses are constant, and points of the body are linear in the coordinates,
 * but for the director that a plate leaves out. */
#include "system/rigid.h"

#include <float.h>
#include <math.h>

/* [1] The director of an axis is left out if its E is at most this part of the largest moment of inertia. */
#define RIGID_LEAST_E (16 * DBL_EPSILON)

/* ---- Bodies and their coordinates -------------------------------------------------------------------------------- */

/* Sets what the coordinates of a body are, which begin where those of the body before end. */
static void set_next_layout(const tvi_rigid *r, int body, rigid_layout *layout)
{
    const double *I = r->body[body].inertia, least = RIGID_LEAST_E * fmax(I[0], fmax(I[1], I[2]));
    layout->start = layout->end;
    layout->end += r->axes;
    layout->count = 0;
    for (int k = 0; k < 3; k++) {
        const double E = (I[(k + 1) % 3] + I[(k + 2) % 3] - I[k]) / 2;
        layout->E[k] = r->axes == 2 ? (k == 0 ? I[2] : 0) : E > least ? E : 0;
        layout->at[k] = layout->E[k] > 0 ? layout->end : -1;
        layout->end += layout->E[k] > 0 ? r->axes : 0;
        layout->count += layout->E[k] > 0;
    }
}

rigid_layout tvi_rigid_layout(const tvi_rigid *r, int body)
{
    rigid_layout layout = {0};
    for (int b = 0; b <= body; b++) set_next_layout(r, b, &layout);
    return layout;
}

bool tvi_rigid_has_axis(const tvi_rigid *r, int body, int k)
{
    rigid_layout alone = {0};
    if (body == TVI_WORLD) return true;
    set_next_layout(r, body, &alone);
    return alone.at[k] >= 0 || alone.count > (r->axes == 3);
}

static tvi_rigid_body make_body(double mass, double E0, double E1, double E2)
{
    return (tvi_rigid_body){mass, {mass * (E1 + E2), mass * (E2 + E0), mass * (E0 + E1)}};
}
tvi_rigid_body tvi_rigid_sphere(double mass, double radius)
{
    const double E = radius * radius / 5;
    return make_body(mass, E, E, E);
}
tvi_rigid_body tvi_rigid_box(double mass, double a, double b, double c)
{
    return make_body(mass, a * a / 12, b * b / 12, c * c / 12);
}
tvi_rigid_body tvi_rigid_cylinder(double mass, double radius, double height)
{
    return make_body(mass, radius * radius / 4, radius * radius / 4, height * height / 12);
}
tvi_rigid_body tvi_rigid_disc(double mass, double radius) { return tvi_rigid_cylinder(mass, radius, 0); }
tvi_rigid_body tvi_rigid_rod(double mass, double length) { return tvi_rigid_box(mass, length, 0, 0); }

/* ---- What is refused --------------------------------------------------------------------------------------------- */

/* What a joint asks for, in the order of its constraints. */
enum { SAME_POINT = 1, ON_LINE = 2, PARALLEL = 4, DISTANCE = 8, PERPENDICULAR = 16 };

static int parts_of(const tvi_rigid *r, const tvi_joint *joint)
{
    static const int parts[] = {[TVI_BALL] = SAME_POINT, [TVI_HINGE] = SAME_POINT | PARALLEL,
                                [TVI_GUIDE] = ON_LINE,   [TVI_SLIDER] = ON_LINE | PARALLEL,
                                [TVI_ROD] = DISTANCE,    [TVI_CROSS] = PERPENDICULAR};
    return r->axes == 2 && joint->kind == TVI_HINGE ? SAME_POINT : parts[joint->kind];
}

/* The number of constraints of a joint. */
static int joint_constraints(const tvi_rigid *r, const tvi_joint *joint)
{
    const int parts = parts_of(r, joint), lines = r->axes - 1;
    return (parts & SAME_POINT ? r->axes : 0) + (parts & ON_LINE ? lines : 0) + (parts & PARALLEL ? lines : 0) +
           !!(parts & (DISTANCE | PERPENDICULAR));
}

static tvi_status refuse_body(const tvi_rigid *r, int b)
{
    const tvi_rigid_body *body = &r->body[b];
    if (!isfinite(body->mass)) return jet_refuse(TVI_ENONFINITE, "body[%d].mass = %g is not finite", b, body->mass);
    if (body->mass <= 0) return jet_refuse(TVI_EINVAL, "body[%d].mass = %g is not positive", b, body->mass);
    for (int k = r->axes == 2 ? 2 : 0; k < 3; k++) {
        const double one = body->inertia[k], others = body->inertia[(k + 1) % 3] + body->inertia[(k + 2) % 3];
        if (!isfinite(one)) return jet_refuse(TVI_ENONFINITE, "body[%d].inertia[%d] = %g is not finite", b, k, one);
        if (one < 0) return jet_refuse(TVI_EINVAL, "body[%d].inertia[%d] = %g is negative", b, k, one);
        if (r->axes == 3 && one - others > 2 * RIGID_LEAST_E * one)
            return jet_refuse(TVI_EINVAL, "body[%d].inertia[%d] = %g is more than the sum of the other two, %g", b, k,
                              one, others);
    }
    return TVI_OK;
}

/* Refuses a vector of joint k that is not finite, is off a line, or, of an axis, is 0. */
static tvi_status refuse_vector(const tvi_rigid *r, int k, const char *name, const double X[], int body, bool is_axis)
{
    double size = 0;
    for (int i = 0; i < r->axes; i++) {
        if (!isfinite(X[i])) return jet_refuse(TVI_ENONFINITE, "joint[%d].%s[%d] = %g is not finite", k, name, i, X[i]);
        if (X[i] != 0 && !tvi_rigid_has_axis(r, body, i))
            return jet_refuse(TVI_EINVAL, "joint[%d].%s[%d] = %g is off body %d, a line or a point", k, name, i, X[i],
                              body);
        size = fmax(size, fabs(X[i]));
    }
    return size > 0 || !is_axis ? TVI_OK : jet_refuse(TVI_EINVAL, "joint[%d].%s has the length 0", k, name);
}

static tvi_status refuse_vectors(const tvi_rigid *r, int k)
{
    const tvi_joint *joint = &r->joint[k];
    const int parts = parts_of(r, joint), has_point = parts != PERPENDICULAR, along = parts & (PARALLEL | ON_LINE);
    tvi_status status = TVI_OK;
    if (has_point) status = refuse_vector(r, k, "point", joint->point, joint->body, false);
    if (status == TVI_OK && has_point)
        status = refuse_vector(r, k, "other_point", joint->other_point, joint->other, false);
    if (status == TVI_OK && parts & (PARALLEL | PERPENDICULAR))
        status = refuse_vector(r, k, "axis", joint->axis, joint->body, true);
    if (status == TVI_OK && (along || parts & PERPENDICULAR))
        status = refuse_vector(r, k, "other_axis", joint->other_axis, joint->other, true);
    for (int i = 0; i < r->axes && status == TVI_OK && along; i++)
        if (!tvi_rigid_has_axis(r, joint->other, i))
            return jet_refuse(TVI_EINVAL, "joint[%d].other = %d, a line or a point, knows no direction across an axis",
                              k, joint->other);
    return status;
}

static tvi_status refuse_joint(const tvi_rigid *r, int k)
{
    const tvi_joint *joint = &r->joint[k];
    if ((int)joint->kind < TVI_BALL || joint->kind > TVI_CROSS)
        return jet_refuse(TVI_EINVAL, "joint[%d].kind = %d is not a kind of joint", k, (int)joint->kind);
    for (int i = 0; i < 2; i++) {
        const int body = i ? joint->other : joint->body;
        if (body < TVI_WORLD || body >= r->bodies)
            return jet_refuse(TVI_EINVAL, "joint[%d].%s = %d is not from 0 to %d, or TVI_WORLD", k,
                              i ? "other" : "body", body, r->bodies - 1);
    }
    if (joint->body == joint->other)
        return jet_refuse(TVI_EINVAL, "joint[%d] is of body %d with itself; the world is TVI_WORLD", k, joint->body);
    if (joint->kind == TVI_ROD && !isfinite(joint->length))
        return jet_refuse(TVI_ENONFINITE, "joint[%d].length = %g is not finite", k, joint->length);
    if (joint->kind == TVI_ROD && joint->length <= 0)
        return jet_refuse(TVI_EINVAL, "joint[%d].length = %g is not positive", k, joint->length);
    return refuse_vectors(r, k);
}

tvi_status tvi_rigid_check(const tvi_rigid *r)
{
    if (!r) return jet_refuse(TVI_EINVAL, "r is NULL");
    if (r->axes != 2 && r->axes != 3) return jet_refuse(TVI_EINVAL, "axes = %d is not 2 or 3", r->axes);
    if (r->bodies < 1 || r->bodies > TVI_MAX_DIMENSION / r->axes)
        return jet_refuse(TVI_EINVAL, "bodies = %d is not from 1 to %d", r->bodies, TVI_MAX_DIMENSION / r->axes);
    if (r->joints < 0) return jet_refuse(TVI_EINVAL, "joints = %d is negative", r->joints);
    if (!r->body || (r->joints && !r->joint)) return jet_refuse(TVI_EINVAL, "%s is NULL", r->body ? "joint" : "body");
    for (int k = 0; k < 3; k++)
        if (!isfinite(r->gravity[k]))
            return jet_refuse(TVI_ENONFINITE, "gravity[%d] = %g is not finite", k, r->gravity[k]);
    tvi_status status = TVI_OK;
    for (int b = 0; b < r->bodies && status == TVI_OK; b++) status = refuse_body(r, b);
    for (int k = 0; k < r->joints && status == TVI_OK; k++) status = refuse_joint(r, k);
    if (status != TVI_OK) return status;
    const int n = tvi_rigid_layout(r, r->bodies - 1).end;
    return n <= TVI_MAX_DIMENSION ? TVI_OK
                                  : jet_refuse(TVI_EINVAL, "n = %d coordinates are more than %d", n, TVI_MAX_DIMENSION);
}

static bool has_body(const tvi_rigid *r, int body)
{
    return tvi_rigid_check(r) == TVI_OK && body >= 0 && body < r->bodies;
}

/* ---- Functions of jets ------------------------------------------------------------------------------------------- */

static jet_vector vector_of(int axes, const jet x[])
{
    jet_vector v = {{jet_const(0), jet_const(0), jet_const(0)}};
    for (int i = 0; i < axes; i++) v.x[i] = x[i];
    return v;
}

static jet_vector add_multiple(jet_vector a, jet factor, jet_vector b)
{
    for (int i = 0; i < 3; i++) a.x[i] = jet_add(a.x[i], jet_mul(factor, b.x[i]));
    return a;
}

static jet_vector cross(jet_vector a, jet_vector b)
{
    jet_vector out;
    for (int i = 0; i < 3; i++) {
        const int u = (i + 1) % 3, w = (i + 2) % 3;
        out.x[i] = jet_sub(jet_mul(a.x[u], b.x[w]), jet_mul(a.x[w], b.x[u]));
    }
    return out;
}

static jet dot(jet_vector a, jet_vector b) { return jet_dot(a.x, b.x, 3); }

jet_vector tvi_rigid_director(const tvi_rigid *r, const jet q[], int body, int k)
{
    jet_vector unit = vector_of(0, NULL);
    unit.x[k] = jet_const(1);
    if (body == TVI_WORLD || (r->axes == 2 && k == 2)) return unit;
    const rigid_layout layout = tvi_rigid_layout(r, body);
    if (layout.at[k] >= 0) return vector_of(r->axes, q + layout.at[k]);
    if (tvi_rigid_has_axis(r, body, k))
        return cross(tvi_rigid_director(r, q, body, (k + 1) % 3), tvi_rigid_director(r, q, body, (k + 2) % 3));
    return vector_of(r->axes, (jet[]){jet_const(NAN), jet_const(NAN), jet_const(NAN)});
}

/* The body's own vector X in space. */
static jet_vector turned(const tvi_rigid *r, const jet q[], int body, const double X[])
{
    jet_vector x = vector_of(0, NULL);
    for (int k = 0; k < r->axes; k++)
        if (X[k] != 0) x = add_multiple(x, jet_const(X[k]), tvi_rigid_director(r, q, body, k));
    return x;
}

static jet_vector centre(const tvi_rigid *r, const jet q[], int body)
{
    return body == TVI_WORLD ? vector_of(0, NULL) : vector_of(r->axes, q + tvi_rigid_layout(r, body).start);
}

/* The difference of the places of a joint's points. Places are subtracted before what is added to them. */
static jet_vector difference(const tvi_rigid *r, const jet q[], const tvi_joint *joint)
{
    const jet minus = jet_const(-1);
    const int one = joint->body, other = joint->other;
    jet_vector place = centre(r, q, one), arm = turned(r, q, one, joint->point);
    const jet_vector other_arm = turned(r, q, other, joint->other_point);
    if (one == TVI_WORLD) place = arm, arm = vector_of(0, NULL);
    if (other == TVI_WORLD) return add_multiple(add_multiple(place, minus, other_arm), jet_const(1), arm);
    return add_multiple(add_multiple(place, minus, centre(r, q, other)), jet_const(1),
                        add_multiple(arm, minus, other_arm));
}

/* Sets unit vectors perpendicular to u, of which the plane has the first one. */
static void set_normals(int axes, const double u[], double normal[2][3])
{
    const double e[3] = {u[0], u[1], axes == 3 ? u[2] : 0}, length = hypot(hypot(e[0], e[1]), e[2]);
    int least = 2;
    for (int k = 0; k < 2; k++)
        if (fabs(e[k]) < fabs(e[least])) least = k;
    const int j = (least + 1) % 3, k = (least + 2) % 3;
    const double across = hypot(e[j], e[k]);
    normal[0][least] = 0;
    normal[0][j] = -e[k] / across;
    normal[0][k] = e[j] / across;
    for (int i = 0; i < 3; i++)
        normal[1][i] = (e[(i + 1) % 3] * normal[0][(i + 2) % 3] - e[(i + 2) % 3] * normal[0][(i + 1) % 3]) / length;
}

/* Appends the products of x with the directions perpendicular to the other's axis. */
static jet *append_across(const tvi_rigid *r, const jet q[], const tvi_joint *joint, jet_vector x, jet *value)
{
    double normal[2][3];
    set_normals(r->axes, joint->other_axis, normal);
    for (int k = 0; k < r->axes - 1; k++) *value++ = dot(x, turned(r, q, joint->other, normal[k]));
    return value;
}

static jet *append_joint(const tvi_rigid *r, const jet q[], const tvi_joint *joint, jet *value)
{
    const int parts = parts_of(r, joint);
    const jet_vector zero = vector_of(0, NULL), x = parts != PERPENDICULAR ? difference(r, q, joint) : zero,
                     axis = parts & (PARALLEL | PERPENDICULAR) ? turned(r, q, joint->body, joint->axis) : zero;
    for (int i = 0; i < r->axes && parts & SAME_POINT; i++) *value++ = x.x[i];
    if (parts & ON_LINE) value = append_across(r, q, joint, x, value);
    if (parts & PARALLEL) value = append_across(r, q, joint, axis, value);
    if (parts & DISTANCE) *value++ = jet_mul(0.5, jet_sub(dot(x, x), joint->length * joint->length));
    if (parts & PERPENDICULAR) *value++ = dot(axis, turned(r, q, joint->other, joint->other_axis));
    return value;
}

/* Joints stand behind the later of their bodies. */
static bool is_later_body(const tvi_joint *joint, int body)
{
    return (joint->body > joint->other ? joint->body : joint->other) == body;
}

void tvi_rigid_constraint(const jet q[], jet t, jet value[], void *ctx)
{
    const tvi_rigid *r = ctx;
    (void)t;
    value[0] = jet_const(NAN);
    if (tvi_rigid_check(r) != TVI_OK) return;
    rigid_layout layout = {0};
    for (int b = 0; b < r->bodies; b++) {
        set_next_layout(r, b, &layout);
        const jet *d = q + layout.start + r->axes;
        for (int i = 0; i < layout.count; i++)
            for (int j = i; j < layout.count; j++) {
                const jet product = jet_dot(d + i * r->axes, d + j * r->axes, r->axes);
                *value++ = i == j ? jet_mul(0.5, jet_sub(product, 1)) : product;
            }
        for (int k = 0; k < r->joints; k++)
            if (is_later_body(&r->joint[k], b)) value = append_joint(r, q, &r->joint[k], value);
    }
}

jet tvi_rigid_potential(const jet q[], jet t, void *ctx)
{
    const tvi_rigid *r = ctx;
    jet V = jet_const(0);
    (void)t;
    if (tvi_rigid_check(r) != TVI_OK) return jet_const(NAN);
    rigid_layout layout = {0};
    for (int b = 0; b < r->bodies; b++) {
        set_next_layout(r, b, &layout);
        for (int i = 0; i < r->axes; i++) V = jet_sub(V, jet_mul(r->body[b].mass * r->gravity[i], q[layout.start + i]));
    }
    return V;
}

void tvi_rigid_point(const tvi_rigid *r, const jet q[], int body, const double X[], jet x[])
{
    if (body == TVI_WORLD ? tvi_rigid_check(r) != TVI_OK : !has_body(r, body)) return;
    const jet_vector place = add_multiple(centre(r, q, body), jet_const(1), turned(r, q, body, X));
    for (int i = 0; i < r->axes; i++) x[i] = place.x[i];
}

/* Adds a vector to the force on the director of axis k, if the body has it among its coordinates. */
static void add_force(const tvi_rigid *r, const rigid_layout *layout, int k, jet_vector F, jet force[])
{
    for (int i = 0; i < r->axes && layout->at[k] >= 0; i++)
        force[layout->at[k] + i] = jet_add(force[layout->at[k] + i], F.x[i]);
}

void tvi_rigid_force(const tvi_rigid *r, const jet q[], int body, const double X[], const jet F[], jet force[])
{
    const jet_vector zero = vector_of(0, NULL);
    if (!has_body(r, body)) return;
    const rigid_layout layout = tvi_rigid_layout(r, body);
    const jet_vector push = vector_of(r->axes, F);
    for (int i = 0; i < r->axes; i++) force[layout.start + i] = jet_add(force[layout.start + i], F[i]);
    for (int k = 0; k < r->axes; k++) {
        const int u = (k + 1) % 3, w = (k + 2) % 3;
        const jet factor = jet_const(X[k]);
        add_force(r, &layout, k, add_multiple(zero, factor, push), force);
        if (layout.at[k] >= 0 || X[k] == 0) continue;
        /* The product of two directors moves with both. */
        add_force(r, &layout, u, add_multiple(zero, factor, cross(tvi_rigid_director(r, q, body, w), push)), force);
        add_force(r, &layout, w, add_multiple(zero, factor, cross(push, tvi_rigid_director(r, q, body, u))), force);
    }
}

void tvi_rigid_torque(const tvi_rigid *r, const jet q[], int body, const jet torque[3], jet force[])
{
    if (!has_body(r, body)) return;
    const rigid_layout layout = tvi_rigid_layout(r, body);
    jet_vector T = vector_of(3, torque), share = vector_of(0, NULL);
    /* The force torque x d_k on each director that turns about an axis works as the torque does. */
    for (int k = 0; k < 3 && layout.count > 1; k++) {
        const jet_vector axis = tvi_rigid_director(r, q, body, k);
        share = add_multiple(share, jet_mul(1.0 / rigid_turning(&layout, k), dot(axis, T)), axis);
    }
    for (int k = 0; k < 3; k++)
        if (layout.at[k] >= 0)
            add_force(r, &layout, k, cross(layout.count > 1 ? share : T, tvi_rigid_director(r, q, body, k)), force);
}

/* ---- The system -------------------------------------------------------------------------------------------------- */

/* Counts the constraints before joint `end`, or all. */
static int constraints_before(const tvi_rigid *r, int end)
{
    rigid_layout layout = {0};
    int count = 0;
    for (int b = 0; b < r->bodies; b++) {
        set_next_layout(r, b, &layout);
        count += layout.count * (layout.count + 1) / 2;
        for (int k = 0; k < r->joints; k++) {
            if (!is_later_body(&r->joint[k], b)) continue;
            if (k == end) return count;
            count += joint_constraints(r, &r->joint[k]);
        }
    }
    return count;
}

int tvi_rigid_constraints(const tvi_rigid *r) { return tvi_rigid_check(r) == TVI_OK ? constraints_before(r, -1) : 0; }

int tvi_rigid_joint(const tvi_rigid *r, int joint)
{
    return tvi_rigid_check(r) == TVI_OK && joint >= 0 && joint < r->joints ? constraints_before(r, joint) : -1;
}

int tvi_rigid_first(const tvi_rigid *r, int body) { return has_body(r, body) ? tvi_rigid_layout(r, body).start : -1; }

int tvi_rigid_dimension(const tvi_rigid *r)
{
    return tvi_rigid_check(r) == TVI_OK ? tvi_rigid_layout(r, r->bodies - 1).end : 0;
}

void tvi_rigid_masses(const tvi_rigid *r, double mass[])
{
    if (tvi_rigid_check(r) != TVI_OK) return;
    rigid_layout layout = {0};
    for (int b = 0; b < r->bodies; b++) {
        set_next_layout(r, b, &layout);
        for (int i = 0; i < r->axes; i++) {
            mass[layout.start + i] = r->body[b].mass;
            for (int k = 0; k < 3; k++)
                if (layout.at[k] >= 0) mass[layout.at[k] + i] = layout.E[k];
        }
    }
}

/* The user's potential beside that of gravity. */
typedef struct {
    const tvi_rigid *rigid;
    tvi_potential_fn *potential;
    void *ctx;
} potential_sum;

static jet record_potential_sum(const jet q[], jet t, void *ctx)
{
    const potential_sum *sum = ctx;
    const jet of_gravity = tvi_rigid_potential(q, t, (void *)sum->rigid);
    return sum->potential ? jet_add(sum->potential(q, t, sum->ctx), of_gravity) : of_gravity;
}

tvi_status tvi_rigid_system(tvi_system **out, const tvi_rigid *r, tvi_potential_fn *potential, void *ctx)
{
    double mass[TVI_MAX_DIMENSION];
    potential_sum sum = {r, potential, ctx};
    tvi_system *unconstrained;
    if (out) *out = NULL;
    tvi_status status = tvi_rigid_check(r);
    if (status != TVI_OK) return status;
    const int m = tvi_rigid_constraints(r);
    tvi_rigid_masses(r, mass);
    if (m == 0) return tvi_system_potential(out, tvi_rigid_dimension(r), mass, record_potential_sum, &sum);
    status = tvi_system_potential(&unconstrained, tvi_rigid_dimension(r), mass, record_potential_sum, &sum);
    if (status != TVI_OK) return status;
    status = tvi_system_constrained(out, unconstrained, m, tvi_rigid_constraint, (void *)r);
    tvi_system_free(unconstrained);
    return status;
}
