/* motions.c - Implements motions.h. */
#include "motions.h"

#include <check.h>
#include <math.h>
#include <string.h>

/* ---- The motions ------------------------------------------------------------------------------------------------- */

static jet spring(const setting *s, const jet x[], jet t)
{
    (void)t;
    return jet_mul(0.5, jet_dot(x, x, s->n));
}

static jet morse(const setting *s, const jet x[], jet t)
{
    (void)s, (void)t;
    return jet_mul(0.5, jet_sqr(jet_sub(1, jet_exp(jet_neg(x[0])))));
}

static jet pendulum(const setting *s, const jet x[], jet t)
{
    (void)s, (void)t;
    return jet_neg(jet_cos(x[0]));
}

/* Walls and neighbours at the distance 1 + d: sum (1/(1 + d) + d), whose terms cancel in the force. */
static jet poles(const setting *s, const jet x[], jet t)
{
    (void)t;
    jet sum = jet_const(0);
    for (int i = 0; i <= s->n; i++) {
        const jet d = i == 0 ? x[0] : i == s->n ? jet_neg(x[i - 1]) : jet_sub(x[i], x[i - 1]);
        sum = jet_add(sum, jet_add(jet_div(1, jet_add(1, d)), d));
    }
    return sum;
}

/* Springs between neighbours, hard ones to the ground, and a force that oscillates with the frequency 1.7. */
static void driven(const setting *s, const jet x[], jet t, jet F[])
{
    for (int i = 0; i < s->n; i++) {
        const jet next = i + 1 < s->n ? x[i + 1] : jet_const(0), last = i > 0 ? x[i - 1] : jet_const(0);
        const jet bend = jet_sub(jet_add(next, last), jet_mul(2, x[i]));
        F[i] = jet_sub(jet_mul(0.375, bend), jet_mul(x[i], jet_add(1, jet_sqr(x[i]))));
    }
    F[0] = jet_add(F[0], jet_mul(s->amplitude, jet_cos(jet_mul(1.7, t))));
}

/* sum_i x_i^2/2 + x_i x_(i+1)/8 + x_i^2 x_(i+1)/16. */
static jet coupled(const setting *s, const jet x[])
{
    jet sum = jet_mul(0.5, jet_dot(x, x, s->n));
    for (int i = 0; i + 1 < s->n; i++)
        sum = jet_add(sum, jet_mul(jet_mul(x[i], x[i + 1]), jet_add(0.125, jet_mul(0.0625, x[i]))));
    return sum;
}

/* sum_i (1 + x_i/10) r_i^2/2. */
static jet uneven(const setting *s, const jet x[], const jet r[])
{
    jet sum = jet_const(0);
    for (int i = 0; i < s->n; i++) sum = jet_add(sum, jet_mul(jet_add(0.5, jet_mul(0.05, x[i])), jet_sqr(r[i])));
    return sum;
}

static jet uneven_hamiltonian(const setting *s, const jet x[], const jet p[], jet t)
{
    (void)t;
    return jet_add(uneven(s, x, p), coupled(s, x));
}

static jet uneven_lagrangian(const setting *s, const jet x[], const jet v[], jet t)
{
    (void)t;
    return jet_sub(uneven(s, x, v), coupled(s, x));
}

/* Turns with the frequency 1, and a force that depends on time; H_pp = 0. */
static jet turning(const setting *s, const jet x[], const jet p[], jet t)
{
    const jet bend = jet_mul(jet_mul(0.125, jet_sin(jet_mul(0.5, t))), jet_mul(jet_sqr(x[0]), x[1]));
    (void)s;
    return jet_add(jet_sub(jet_mul(x[0], p[1]), jet_mul(x[1], p[0])), bend);
}

/* A wheel whose inertia depends on a spring: x_0^2/2 + p_0^2/2 + (1 + x_0/4) p_1^2/2, which does not have x_1. */
static jet wheel_and_spring(const setting *s, const jet x[], const jet p[], jet t)
{
    (void)s, (void)t;
    const jet spring = jet_mul(0.5, jet_add(jet_sqr(x[0]), jet_sqr(p[0])));
    return jet_add(spring, jet_mul(jet_add(0.5, jet_mul(0.125, x[0])), jet_sqr(p[1])));
}

/* |p - A|^2/2 + |x|^2/8, A = (1 + x0/4) (-x1, x0)/2. */
static jet magnetic(const setting *s, const jet x[], const jet p[], jet t)
{
    const jet b = jet_add(0.5, jet_mul(0.125, x[0]));
    const jet v[2] = {jet_add(p[0], jet_mul(b, x[1])), jet_sub(p[1], jet_mul(b, x[0]))};
    (void)t;
    return jet_add(jet_mul(0.5, jet_dot(v, v, s->n)), jet_mul(0.125, jet_dot(x, x, s->n)));
}

/* Two pendulums, rods and bodies of 1 and 3/4, 5/8. */
static jet double_pendulum(const setting *s, const jet x[], const jet v[], jet t)
{
    const double m1 = 1, m2 = 0.625, l2 = 0.75;
    const jet cross = jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(x[0], x[1])));
    const jet kinetic = jet_add(jet_mul((m1 + m2) / 2, jet_sqr(v[0])), jet_mul(m2 * l2 * l2 / 2, jet_sqr(v[1])));
    (void)s, (void)t;
    return jet_add(jet_add(kinetic, jet_mul(m2 * l2, cross)),
                   jet_add(jet_mul(m1 + m2, jet_cos(x[0])), jet_mul(m2 * l2, jet_cos(x[1]))));
}

/* L4 of two bodies of 1 - mu and mu at distance 1, in the frame that turns with them. x = q - (1/2 - mu, sqrt(3)/2),
 * and the momenta less those of the equilibrium, (-sqrt(3)/2, 1/2 - mu). */
static jet fourth_point(const setting *s, const jet x[], const jet p[], jet t)
{
    const double mu = 0.0078125, at[2] = {0.5 - mu, 0.86602540378443864676};
    const jet q[2] = {jet_add(x[0], at[0]), jet_add(x[1], at[1])}, P[2] = {jet_sub(p[0], at[1]), jet_add(p[1], at[0])};
    const jet y2 = jet_sqr(q[1]);
    const jet far = jet_add(jet_sqr(jet_add(q[0], mu)), y2), near = jet_add(jet_sqr(jet_sub(q[0], 1 - mu)), y2);
    const jet pull = jet_add(jet_mul(1 - mu, jet_pow(far, -0.5)), jet_mul(mu, jet_pow(near, -0.5)));
    const jet turn = jet_sub(jet_mul(q[1], P[0]), jet_mul(q[0], P[1]));
    (void)s, (void)t;
    return jet_sub(jet_add(jet_mul(0.5, jet_dot(P, P, 2)), turn), pull);
}

static const double planet_mass[3] = {1, 0.0009765625, 0.00048828125};

/* Two planets and their star in space: -sum k m_i m_j / r, k in the units of the frame. */
static jet gravity(const setting *s, const jet q[], jet t)
{
    const frame *f = s->frame;
    jet sum = jet_const(0);
    (void)t;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int axis = 0; axis < 3; axis++) {
                const int a = 3 * i + axis, b = 3 * j + axis;
                d[axis] = f->exchanged ? jet_sub(q[8 - a], q[8 - b]) : jet_sub(q[a], q[b]);
            }
            const double k = f->mass * f->length * f->length * f->length / (f->time * f->time);
            sum = jet_sub(sum, jet_mul(k * planet_mass[i] * planet_mass[j], jet_pow(jet_dot(d, d, 3), -0.5)));
        }
    return sum;
}

static const double planets[] = {
    0,
    0,
    0,
    1,
    0,
    0,
    0,
    -1.5,
    0.125, /* x */
    0,
    0,
    0,
    0,
    0.0009765625,
    0.0001220703125,
    0.0003662109375,
    0,
    0, /* p */
};

const motion motions[MOTIONS] = {
    {.name = "spring", .potential = spring, .n = 1, .most = 1, .h = 0.2},
    {.name = "Morse", .potential = morse, .n = 1, .most = 1, .cancels = 1, .h = 0.2},
    {.name = "pendulum", .potential = pendulum, .n = 1, .most = 1, .h = 0.2},
    {.name = "poles", .potential = poles, .n = 1, .most = 0.25, .cancels = 1, .h = 0.0625},
    {.name = "driven", .force = driven, .n = 3, .most = 1, .h = 0.125},
    {.name = "uneven H", .hamiltonian = uneven_hamiltonian, .n = 1, .most = 1, .h = 0.2},
    {.name = "uneven L", .lagrangian = uneven_lagrangian, .n = 1, .most = 1, .h = 0.2},
    {.name = "turning", .hamiltonian = turning, .n = 2, .most = 1, .h = 0.2},
    {.name = "wheel and spring", .hamiltonian = wheel_and_spring, .n = 2, .most = 1, .h = 0.2},
    {.name = "magnetic", .hamiltonian = magnetic, .n = 2, .most = 1, .h = 0.2},
    {.name = "double pendulum", .lagrangian = double_pendulum, .n = 2, .most = 0.5, .h = 0.1},
    {.name = "fourth point", .hamiltonian = fourth_point, .n = 2, .most = 0.0625, .cancels = 1, .h = 0.125},
    {.name = "gravity", .potential = gravity, .start = planets, .n = 9, .most = 1, .h = 0.125, .raw = true},
};

const motion *motion_named(const char *name)
{
    for (int i = 0; i < MOTIONS; i++)
        if (strcmp(motions[i].name, name) == 0) return &motions[i];
    ck_abort_msg("no motion %s", name);
    return NULL;
}

/* Unequal; 1 where a Lagrangian or a Hamiltonian states its own. */
static double mass_of(const setting *s, int i)
{
    if (s->motion->potential == gravity) return planet_mass[i / 3];
    return s->motion->potential || s->motion->force ? 1 + 0.75 * (i % 3) : 1;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

const frame as_it_is = {"as it is", 0, 1, 1, 1, false};

static int place(const setting *s, int i) { return s->frame->exchanged ? s->n - 1 - i : i; }
static double energy_unit(const frame *f) { return f->mass * f->length * f->length / (f->time * f->time); }
static double momentum_unit(const frame *f) { return f->mass * f->length / f->time; }

/* x_i = (q_i - move) / unit; move 0 for velocities and momenta. */
static void own(const setting *s, const jet q[], double move, double unit, jet x[])
{
    for (int i = 0; i < s->n; i++) {
        const jet from = q[place(s, i)];
        x[i] = s->motion->raw ? q[i] : move == 0 && unit == 1 ? from : jet_mul(1 / unit, jet_sub(from, move));
    }
}

static jet own_time(const setting *s, jet t) { return s->frame->time == 1 ? t : jet_mul(1 / s->frame->time, t); }

static jet framed_potential(const jet q[], jet t, void *ctx)
{
    const setting *s = ctx;
    jet x[N_MOST];
    own(s, q, s->frame->move, s->frame->length, x);
    const jet V = s->motion->potential(s, x, own_time(s, t));
    return s->motion->raw ? V : jet_mul(energy_unit(s->frame), V);
}

static void framed_force(const jet q[], jet t, jet force[], void *ctx)
{
    const setting *s = ctx;
    jet x[N_MOST], F[N_MOST];
    own(s, q, s->frame->move, s->frame->length, x);
    s->motion->force(s, x, own_time(s, t), F);
    for (int i = 0; i < s->n; i++) force[place(s, i)] = jet_mul(energy_unit(s->frame) / s->frame->length, F[i]);
}

static jet framed_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const setting *s = ctx;
    jet x[N_MOST], u[N_MOST];
    own(s, q, s->frame->move, s->frame->length, x);
    own(s, v, 0, s->frame->length / s->frame->time, u);
    return jet_mul(energy_unit(s->frame), s->motion->lagrangian(s, x, u, own_time(s, t)));
}

static jet framed_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const setting *s = ctx;
    jet x[N_MOST], u[N_MOST];
    own(s, q, s->frame->move, s->frame->length, x);
    own(s, p, 0, momentum_unit(s->frame), u);
    return jet_mul(energy_unit(s->frame), s->motion->hamiltonian(s, x, u, own_time(s, t)));
}

tvi_system *system_of(setting *s)
{
    const motion *m = s->motion;
    tvi_system *system = NULL;
    double mass[N_MOST];
    for (int i = 0; i < s->n; i++) mass[place(s, i)] = s->frame->mass * mass_of(s, i);
    const tvi_status status = m->potential    ? tvi_system_potential(&system, s->n, mass, framed_potential, s)
                              : m->force      ? tvi_system_force(&system, s->n, mass, framed_force, s)
                              : m->lagrangian ? tvi_system_lagrangian(&system, s->n, framed_lagrangian, s)
                                              : tvi_system_hamiltonian(&system, s->n, framed_hamiltonian, s);
    ck_assert_msg(status == TVI_OK, "%s, %s: %s", m->name, s->frame->name, tvi_status_string(status));
    return system;
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

outcome start_of(const setting *s)
{
    outcome start = {.t = 0.25};
    for (int i = 0; i < s->n; i++) {
        const double x = (4 - 3 * i % 7) / 8.0, p = (3 - 5 * i % 8) / 8.0;
        start.x[i] = s->amplitude * (s->motion->start ? s->motion->start[i] : x);
        start.p[i] = s->amplitude * (s->motion->start ? s->motion->start[s->n + i] : p);
    }
    return start;
}

outcome run_from(const setting *s, const tvi_system *system, const tvi_options *options, double factor, long steps,
                 const outcome *from)
{
    const frame *f = s->frame;
    tvi_integrator *integrator;
    double t = f->time * from->t, q[N_MOST], p[N_MOST];
    for (int i = 0; i < s->n; i++) {
        q[place(s, i)] = f->move + f->length * from->x[i];
        p[place(s, i)] = momentum_unit(f) * from->p[i];
    }
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    outcome end = {.status = tvi_integrate(integrator, factor * s->motion->h * f->time, steps, &t, q, p, NULL, NULL)};
    end.steps = tvi_integrator_stats(integrator)->steps;
    end.t = t / f->time;
    for (int i = 0; i < s->n; i++) {
        end.x[i] = (q[place(s, i)] - f->move) / f->length;
        end.p[i] = p[place(s, i)] / momentum_unit(f);
    }
    tvi_integrator_free(integrator);
    return end;
}

double distance(const setting *s, const outcome *a, const outcome *b)
{
    double largest = 0;
    for (int i = 0; i < s->n; i++)
        largest = fmax(largest, fmax(fabs(a->x[i] - b->x[i]), fabs(a->p[i] - b->p[i]) / mass_of(s, i)));
    return largest;
}

double size_of(const setting *s, const outcome *a)
{
    const outcome zero = {0};
    return distance(s, a, &zero);
}

double growth_of(const setting *s, long steps)
{
    setting own = {s->motion, &as_it_is, s->n, s->motion->most};
    const tvi_options taylor = {.method = TVI_TAYLOR, .degree = 20};
    const double part = 0x1p-24;
    const outcome start = start_of(&own);
    outcome moved = start;
    for (int i = 0; i < s->n; i++) {
        moved.x[i] += part * (1 - i % 3);
        moved.p[i] += part * (i % 2) * mass_of(s, i);
    }
    tvi_system *system = system_of(&own);
    const outcome end = run_from(&own, system, &taylor, 1, steps, &start),
                  other = run_from(&own, system, &taylor, 1, steps, &moved);
    tvi_system_free(system);
    ck_assert(end.status == TVI_OK && other.status == TVI_OK);
    return fmax(1, distance(&own, &end, &other) / part);
}
