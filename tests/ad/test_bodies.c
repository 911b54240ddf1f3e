/* test_bodies.c - Tests generated values of the forces of many bodies: operations alone, inlined or in a function of
 * their own, and runs as they are. Cases of the suite "emit". */
#include "emit.h"
#include "library.h"
#include "record.h"
#include "suites.h"
#include "problems/thorough.h"

#include <dlfcn.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BODIES = 40, MOST_LANES = 64 };

/* At the second ones values are of registers, of which there are several sizes where these are no multiple of eight. */
static const struct {
    int bodies, lanes[2];
} cases[] = {{3, {8, 64}}, {3, {4, 20}}, {8, {12, 64}}, {20, {8, 20}}};
enum { CASES = sizeof cases / sizeof *cases };

/* By the gradient of the potential, with masses 1 + i / 8. */
static recording record_forces(int bodies)
{
    jet_graph *graph = jet_graph_create(3 * bodies);
    jet V = jet_const(0), force[3 * MOST_BODIES];
    for (int i = 0; i < bodies; i++)
        for (int j = 0; j < i; j++) {
            jet square = jet_const(0);
            for (int k = 0; k < 3; k++) {
                const jet d = jet_sub(jet_graph_input(graph, 3 * i + k), jet_graph_input(graph, 3 * j + k));
                square = jet_add(square, jet_sqr(d));
            }
            V = jet_add(V, jet_mul((1 + i / 8.0) * (1 + j / 8.0), jet_pow(square, -0.5)));
        }
    ck_assert(jet_record_gradient(graph, V, 3 * bodies, force));
    return record_close(graph, 3 * bodies, force, JET_TAPE_VALUES);
}

static void set_places(int bodies, int lanes, double x[])
{
    for (int i = 0; i < 3 * bodies; i++)
        for (int lane = 0; lane < lanes; lane++) x[i * lanes + lane] = 3 * sin(1 + 1.7 * i) + 0.01 * lane;
}

START_TEST(forces_are_those_of_the_tape)
{
    static double x[3 * MOST_BODIES * MOST_LANES], want[sizeof x / sizeof *x], got[sizeof x / sizeof *x],
        size[sizeof x / sizeof *x];
    const int bodies = cases[_i].bodies, *lanes = cases[_i].lanes;
    recording r = record_forces(bodies);
    jet_text text = {0};
    jet_sweeps own;
    jet_emit_rule_source(&text);
    jet_emit_tape(&text, r.tape,
                  &(jet_emission_request){.name_prefix = "V", .value_lane_counts = {lanes[0], lanes[1]}});
    jet_text_append(&text, "extern const jet_sweeps *const sweeps;\nconst jet_sweeps *const sweeps = &V_sweeps;\n");
    library code = library_make(&text, "-O1 -march=native");
    const jet_sweeps *const *sweeps = dlsym(code.handle, "sweeps");
    for (int k = 0; k < 2; k++) {
        set_places(bodies, lanes[k], x);
        r.tape->sweeps = r.tape->interpreter_sweeps;
        ck_assert(run_values(&r, lanes[k], x, want));
        run_sizes(&r, lanes[k], x, size);
        r.tape->sweeps = jet_merge_sweeps(&own, r.tape->interpreter_sweeps, *sweeps);
        ck_assert(run_values(&r, lanes[k], x, got));
        for (int i = 0; i < 3 * bodies * lanes[k]; i++)
            ck_assert_double_le(fabs(got[i] - want[i]), 8 * DBL_EPSILON * size[i]);
        for (int coordinate = 0; coordinate < 3; coordinate++) /* the last two bodies meet in the last lane */
            x[(3 * bodies - 3 + coordinate) * lanes[k] + lanes[k] - 1] =
                x[(3 * bodies - 6 + coordinate) * lanes[k] + lanes[k] - 1];
        ck_assert(!run_values(&r, lanes[k], x, got));
    }
    library_remove(&code);
    recording_free(&r);
}
END_TEST

/* How many operations and calls the text for so many bodies has, beside what it has for none: what compilers take time
 * for. */
static int calls_for(int bodies)
{
    recording r = record_forces(bodies);
    jet_text text = {0};
    int calls = 0;
    jet_emit_tape(&text, r.tape, &(jet_emission_request){.name_prefix = "V", .value_lane_counts = {8, 64}});
    for (const char *at = text.data; (at = strstr(at, "(V, ")); at++) calls++;
    free(text.data);
    recording_free(&r);
    return calls;
}

START_TEST(the_text_is_bounded)
{
    if (is_plain()) return;
    int most = 0;
    for (int bodies = 2; bodies <= 20; bodies += 2) {
        const int calls = calls_for(bodies);
        most = calls > most ? calls : most;
    }
    ck_assert_int_ge(most, 500); /* operations alone */
    ck_assert_int_le(most, 850);
    ck_assert_int_le(calls_for(20), 40);
    ck_assert_int_le(calls_for(MOST_BODIES), 80);
}
END_TEST

void add_bodies(Suite *suite)
{
    TCase *tests = add_case(suite, "many bodies");
    tcase_add_loop_test(tests, forces_are_those_of_the_tape, 0, CASES);
    tcase_add_test(tests, the_text_is_bounded);
}
