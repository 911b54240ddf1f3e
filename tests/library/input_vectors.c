/* input_vectors.c - Tests functions that read or set a component beyond the end of a vector: for every callback and
 * each of its vectors the function is refused, and the text names the component. */
#include "input.h"

#include <stdio.h>

enum { MIN_PADDING = 8, MAX_DIMENSION = 9 };

/* The component that a function reads or sets: number `index` of its first (0) or second (1) vector, or of the force
 * that it sets (2). */
typedef struct {
    int vector, index, n;
} access;

/* A system that is regular, plus the component that is read. */
static jet read_component(const access *a, const jet first[], const jet second[])
{
    return a->vector == 0 ? first[a->index] : a->vector == 1 ? second[a->index] : jet_const(0);
}

static void set_force(const access *a, const jet first[], const jet second[], jet force[])
{
    for (int i = 0; i < a->n; i++) force[i] = jet_neg(first[i]);
    if (a->vector == 2) force[a->index] = first[0];
    else force[0] = read_component(a, first, second);
}

static jet oscillator(const access *a, const jet first[], const jet second[])
{
    const jet half = jet_mul(0.5, jet_add(jet_dot(first, first, a->n), jet_dot(second, second, a->n)));
    return jet_add(half, read_component(a, first, second));
}

static void force(const jet q[], jet t, jet f[], void *ctx)
{
    (void)t;
    set_force(ctx, q, NULL, f);
}

static void drive(const jet q[], const jet v[], jet t, jet f[], void *ctx)
{
    (void)t;
    set_force(ctx, q, v, f);
}

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t;
    return oscillator(ctx, q, q);
}

static jet function(const jet q[], const jet v_or_p[], jet t, void *ctx)
{
    (void)t;
    return oscillator(ctx, q, v_or_p);
}

static jet scale(const jet q[], const jet p[], jet t, void *ctx) { return jet_exp(function(q, p, t, ctx)); }

/* ---- The callbacks ----------------------------------------------------------------------------------------------- */

typedef tvi_status make_fn(tvi_system **out, access *a);

static tvi_status make_force(tvi_system **out, access *a) { return tvi_system_force(out, a->n, NULL, force, a); }

static tvi_status make_potential(tvi_system **out, access *a)
{
    return tvi_system_potential(out, a->n, NULL, potential, a);
}

static tvi_status make_lagrangian(tvi_system **out, access *a) { return tvi_system_lagrangian(out, a->n, function, a); }

static tvi_status make_hamiltonian(tvi_system **out, access *a)
{
    return tvi_system_hamiltonian(out, a->n, function, a);
}

/* Changes a base that reads nothing beyond its end. */
static tvi_status change(tvi_system **out, access *a, make_fn *make_base, bool is_driven)
{
    tvi_system *base;
    access sound = {.n = a->n};
    ck_assert_int_eq(make_base(&base, &sound), TVI_OK);
    const tvi_status status =
        is_driven ? tvi_system_driven(out, base, drive, a) : tvi_system_rescaled(out, base, scale, a);
    tvi_system_free(base);
    return status;
}

static tvi_status drive_potential(tvi_system **out, access *a) { return change(out, a, make_potential, true); }
static tvi_status drive_lagrangian(tvi_system **out, access *a) { return change(out, a, make_lagrangian, true); }
static tvi_status drive_hamiltonian(tvi_system **out, access *a) { return change(out, a, make_hamiltonian, true); }
static tvi_status rescale_potential(tvi_system **out, access *a) { return change(out, a, make_potential, false); }
static tvi_status rescale_hamiltonian(tvi_system **out, access *a) { return change(out, a, make_hamiltonian, false); }

/* An event makes no system: one is made where the event is. */
static tvi_status make_event(tvi_system **out, access *a)
{
    tvi_event *event = (tvi_event *)out;
    *out = NULL;
    const tvi_status status = tvi_event_create(&event, a->n, TVI_EITHER, false, function, a);
    if (status != TVI_OK) ck_assert_ptr_null(event);
    tvi_event_free(event);
    return status != TVI_OK ? status : make_potential(out, &(access){.n = a->n});
}

static const struct {
    const char *name;
    make_fn *make;
    const char *vectors; /* as texts call them: of two vectors, and f for the force that it sets */
} callbacks[] = {
    {"force", make_force, "q f"},
    {"potential", make_potential, "q"},
    {"Lagrangian", make_lagrangian, "qv"},
    {"Hamiltonian", make_hamiltonian, "qp"},
    {"driven potential", drive_potential, "qvf"},
    {"driven Lagrangian", drive_lagrangian, "qvf"},
    {"driven Hamiltonian", drive_hamiltonian, "qvf"},
    {"g of a potential", rescale_potential, "qp"},
    {"g of a Hamiltonian", rescale_hamiltonian, "qp"},
    {"event", make_event, "qp"},
};
enum { CALLBACKS = sizeof callbacks / sizeof *callbacks };

static void expect_access(int callback, access a)
{
    char what[96], culprit[32];
    const char vector = callbacks[callback].vectors[a.vector];
    tvi_system *system = NOT_NULL;
    if (vector == 'f') (void)snprintf(culprit, sizeof culprit, "force[%d]", a.index);
    else (void)snprintf(culprit, sizeof culprit, "%c[%d]", vector, a.index);
    (void)snprintf(what, sizeof what, "%s, n = %d: %s", callbacks[callback].name, a.n, culprit);
    const bool is_beyond = a.index >= a.n;
    expect_refusal(what, callbacks[callback].make(&system, &a), is_beyond ? TVI_EINVAL : TVI_OK,
                   is_beyond ? culprit : "");
    ck_assert_msg((system != NULL) == !is_beyond, "%s", what);
    tvi_system_free(system);
}

/* The last component, which is there; the first one beyond the end; and the last one of the padding. */
START_TEST(components_beyond_the_end)
{
    for (int n = 1; n <= MAX_DIMENSION; n++) {
        const int indices[] = {n - 1, n, n + 1, n + (n > MIN_PADDING ? n : MIN_PADDING) - 1};
        for (int vector = 0; callbacks[_i].vectors[vector]; vector++)
            for (int i = 0; i < 4 && callbacks[_i].vectors[vector] != ' '; i++)
                expect_access(_i, (access){.vector = vector, .index = indices[i], .n = n});
    }
}
END_TEST

/* A product with 0 and a sum of too many components are refused, too. */
static jet zero_times(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_dot(q, q, 2), jet_mul(0, q[2]));
}

static jet long_dot(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, q, 3);
}

START_TEST(however_they_are_used)
{
    static tvi_potential_fn *const uses[] = {zero_times, long_dot};
    tvi_system *system = NOT_NULL;
    refused("potential is made of a component beyond the last one: q[2]",
            tvi_system_potential(&system, 2, NULL, uses[_i], NULL), TVI_EINVAL);
    ck_assert_ptr_null(system);
}
END_TEST

TCase *tcase_vectors(void)
{
    TCase *tcase = tcase_create("vectors");
    tcase_add_loop_test(tcase, components_beyond_the_end, 0, CALLBACKS);
    tcase_add_loop_test(tcase, however_they_are_used, 0, 2);
    return tcase;
}
