/* main.c - Gives bodies, orbits and states of any numbers to the functions of tvi_bodies.h: what is refused has a text
 * and changes nothing, what is accepted is finite, and the elements of a state are never refused as elements.
 * `fuzz_bodies SEED COUNT` tries others; make check-sanitizers tries a million. */
#include "problems/random.h"
#include "tvi_bodies.h"

#include <float.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIALS = 100000, ELEMENTS = sizeof(tvi_orbit) / sizeof(double), MOST = TVI_MAX_DIMENSION, RECORDED = 8 };

static uint64_t bits;

static long trial;
static void insist(bool good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_bodies: trial %ld: %s\n", trial, what);
    abort();
}

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

static double any_bits(void)
{
    const uint64_t high = (uint64_t)whole(&bits, 1 << 30) << 34,
                   word = high ^ (uint64_t)whole(&bits, 1 << 30) << 17 ^ (uint64_t)whole(&bits, 1 << 17);
    double number;
    memcpy(&number, &word, sizeof number);
    return number;
}

/* A plain number, one that is special, or one with any bits; the last two one time in `rare`. */
static double any_number(int rare)
{
    static const double special[] = {NAN,    INFINITY, -INFINITY,         0,        -0.0,   1,     -1,
                                     5e-324, DBL_MIN,  DBL_MAX,           -DBL_MAX, 1e-200, 1e200, 0.5,
                                     2,      1e-160,   3.141592653589793, 1e16};
    const int kind = whole(&bits, 2 * rare);
    if (kind == 0) return any_bits();
    if (kind == 1) return special[whole(&bits, sizeof special / sizeof *special)];
    return number_of(&bits) * 4 - 1;
}

static int any_count(void)
{
    static const int special[] = {0, -1, INT_MAX, INT_MIN, -1431655765, -1431655760, 1431655766, MOST, MOST / 3 + 1};
    const int kind = whole(&bits, 4);
    if (kind == 0) return special[whole(&bits, sizeof special / sizeof *special)];
    return kind == 1 ? (int)((unsigned)whole(&bits, 1 << 16) << 16) ^ whole(&bits, 1 << 16)
                     : 1 + whole(&bits, RECORDED);
}

static bool are_finite(int count, const double x[])
{
    for (int i = 0; i < count; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

static bool is_refusal(tvi_status status) { return status == TVI_EINVAL || status == TVI_ENONFINITE; }

/* ---- Orbits ------------------------------------------------------------------------------------------------------ */

/* Returns whether they were accepted. */
static bool try_elements(const tvi_orbit *orbit, double mu, double state[6])
{
    double before[6];
    memset(state, 0x5a, sizeof before);
    memcpy(before, state, sizeof before);
    const tvi_status status = tvi_orbit_state(orbit, mu, state, state + 3);
    if (status == TVI_OK) {
        insist(are_finite(6, state), "a state that is not finite");
        return true;
    }
    insist(is_refusal(status) && *tvi_last_error(), "elements: no refusal or no text");
    insist(!memcmp(before, state, sizeof before), "a refused state is written");
    return false;
}

static long double length(const long double x[3]) { return sqrtl(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]); }

/* Insists that two states are the same, to 1e-12 of the condition of tests/bodies/test_orbits.c. */
static void insist_same(const tvi_orbit *o, double mu, const double state[6], const double again[6])
{
    long double x[2][3], d[2][3], norm[2];
    for (int i = 0; i < 6; i++) x[i / 3][i % 3] = state[i], d[i / 3][i % 3] = (long double)again[i] - state[i];
    for (int k = 0; k < 2; k++) norm[k] = length(x[k]);
    const long double own = 2 + fabs(o->i) + fabs(o->node) + fabs(o->pericentre), way = 2.5L * fabs(o->time);
    insist(length(d[0]) <= 1e-12L * (own * norm[0] + way * norm[1]), "another place");
    insist(length(d[1]) <= 1e-12L * (own * norm[1] + way * mu / norm[0] / norm[0]), "another velocity");
}

static bool try_state(double mu, const double state[6])
{
    tvi_orbit orbit, before;
    double again[6];
    memset(&orbit, 0x5a, sizeof orbit);
    before = orbit;
    const tvi_status status = tvi_orbit_of(mu, state, state + 3, &orbit);
    if (status != TVI_OK) {
        insist((is_refusal(status) || status == TVI_EDOMAIN) && *tvi_last_error(), "a state: no refusal or no text");
        insist(!memcmp(&before, &orbit, sizeof before), "refused elements are written");
        return false;
    }
    insist(are_finite(ELEMENTS - 1, &orbit.q) && !isnan(orbit.a), "elements that are not finite");
    insist(orbit.q > 0 && orbit.e >= 0 && orbit.i >= 0, "elements out of range");
    const tvi_status back = tvi_orbit_state(&orbit, mu, again, again + 3);
    insist(back == TVI_OK || back == TVI_ENONFINITE, "elements of a state are refused");
    if (back == TVI_OK) insist_same(&orbit, mu, state, again);
    return true;
}

static bool try_orbit(void)
{
    const int rare = 1 << whole(&bits, 6);
    double value[ELEMENTS], state[6], mu = any_number(rare);
    tvi_orbit orbit;
    for (int i = 0; i < ELEMENTS; i++) value[i] = whole(&bits, 3) ? any_number(rare) : 0;
    memcpy(&orbit, value, sizeof orbit);
    if (whole(&bits, 2)) orbit.a = orbit.f = orbit.M = orbit.mean_longitude = orbit.longitude_of_pericentre = 0;
    if (!try_elements(&orbit, mu, state)) return false;
    (void)try_state(mu, state);
    return true;
}

static bool try_any_state(void)
{
    const int rare = 1 << whole(&bits, 6);
    double state[6], mu = any_number(rare), unit[] = {1, 1};
    for (int k = 0; k < 2 && whole(&bits, 2); k++) unit[k] = pow(10, 600 * number_of(&bits) - 300);
    for (int i = 0; i < 6; i++) state[i] = any_number(rare) * unit[i / 3];
    return try_state(mu, state);
}

/* ---- Bodies ------------------------------------------------------------------------------------------------------ */

static double mass[MOST], q[MOST], p[MOST];

static void try_functions(const tvi_bodies *b, bool are_counts_good)
{
    double *const numbers = malloc(MOST * sizeof *numbers), x[3] = {7, 7, 7}, v[3] = {7, 7, 7}, L[3] = {7, 7, 7};
    for (int i = 0; i < MOST; i++) numbers[i] = 7;
    tvi_bodies_masses(b, numbers);
    tvi_bodies_momenta(b, numbers, numbers);
    tvi_bodies_velocities(b, numbers, numbers);
    tvi_bodies_centre(b, q, p, x, v);
    tvi_bodies_angular_momentum(b, q, p, L);
    tvi_bodies_to_centre(b, numbers, numbers);
    for (int i = are_counts_good ? b->bodies * b->axes : 0; i < MOST; i++)
        insist(numbers[i] == 7, "numbers beyond those of the bodies are written");
    insist(are_counts_good || (x[0] == 7 && v[0] == 7 && L[0] == 7), "sums of no bodies are written");
    free(numbers);
}

static bool try_bodies(void)
{
    const int rare = 1 << whole(&bits, 8), axes = whole(&bits, 4) ? 1 + whole(&bits, 3) : any_count();
    tvi_bodies b = {.bodies = any_count(), .axes = axes, .mass = whole(&bits, 16) ? mass : NULL};
    tvi_system *system = NULL;
    for (int i = 0; i < RECORDED; i++) mass[i] = fabs(any_number(rare)) * (whole(&bits, 4 * rare) ? 1 : -1);
    double *const members[] = {&b.G, &b.softening, &b.J2, &b.radius, b.pole, b.pole + 1, b.pole + 2, &b.sharpness};
    for (size_t k = 0; k < sizeof members / sizeof *members; k++)
        if (whole(&bits, 2)) *members[k] = any_number(rare);
    b.oblate = whole(&bits, 4) ? whole(&bits, 4) : any_count();
    const tvi_status status = tvi_bodies_check(&b);
    insist(status == TVI_OK || (is_refusal(status) && *tvi_last_error()), "bodies: no refusal or no text");
    const bool are_counts_good = b.mass && axes >= 1 && axes <= 3 && b.bodies >= 1 && b.bodies <= MOST / axes;
    insist(status != TVI_OK || are_counts_good, "counts out of range are accepted");
    if (whole(&bits, 64) == 0) try_functions(&b, are_counts_good);
    if (status == TVI_OK && (b.bodies > RECORDED || whole(&bits, 16))) return true;
    const tvi_status made = tvi_bodies_system(&system, &b);
    insist(made == TVI_OK || (!system && *tvi_last_error()), "a system that is refused, and made or without a text");
    insist(status == TVI_OK || made == status, "tvi_bodies_system accepts what tvi_bodies_check refuses");
    insist(made != TVI_OK || tvi_system_dimension(system) == b.bodies * axes, "a wrong dimension");
    tvi_system_free(system);
    return made == TVI_OK;
}

int main(int argc, char *argv[])
{
    static bool (*const ways[])(void) = {try_orbit, try_any_state, try_bodies};
    enum { WAYS = sizeof ways / sizeof *ways };
    const long count = argc > 2 ? strtol(argv[2], NULL, 10) : TRIALS;
    long accepted[WAYS] = {0};
    bits = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    for (int i = 0; i < MOST; i++) mass[i] = 1, q[i] = i, p[i] = 1;
    for (trial = 0; trial < count; trial++) accepted[trial % WAYS] += ways[trial % WAYS]();
    printf("accepted: %ld of %ld elements, %ld states, %ld bodies\n", accepted[0], count / WAYS, accepted[1],
           accepted[2]);
    for (int k = 0; k < WAYS; k++) insist(accepted[k] > count / WAYS / 20, "hardly anything is accepted");
    return EXIT_SUCCESS;
}
