/* ensemble.c - Runs ensembles on three threads, under the thread sanitizer: steps, events, tangents, states, results
 * the same to the last bit as on one, and on as many as can be started. Observers of members that ask what a running
 * ensemble refuses race with no thread. */
#include "tvi.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { MEMBERS = 50, N = 2, ROWS = 2 * N, STEPS = 20, MOST = 3 };

/* ---- Threads that cannot be started ------------------------------------------------------------------------------ */

static int started_count, most_threads = MOST; /* those that a run may start, less one */

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *ctx);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *ctx);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *ctx)
{
    if (started_count % MOST >= most_threads - 1) return EAGAIN;
    started_count++;
    return __real_pthread_create(thread, attributes, run, ctx);
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet cubic = jet_sub(jet_mul(jet_sqr(q[0]), q[1]), jet_div(jet_pow(q[1], 3), 3));
    return jet_add(jet_mul(0.5, jet_dot(q, q, N)), cubic);
}

static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

typedef struct {
    double t[MEMBERS], q[N * MEMBERS], p[N * MEMBERS], D[ROWS * MEMBERS];
    tvi_status status[MEMBERS];
    double last[MEMBERS]; /* event */
    int told;
} result;

static int note(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    result *r = ctx;
    (void)which, (void)q, (void)p;
    r->last[member] = t;
    r->told++; /* one call at a time */
    return 0;
}

/* What is refused while the ensemble runs. */
static tvi_ensemble *asked;
static int not_refused;

static int ask(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    tvi_stats stats;
    (void)t, (void)q, (void)p, (void)ctx;
    if (member % 10 != 0 || which != 3) return 0;
    tvi_ensemble_reset(asked);
    not_refused += tvi_ensemble_stats(asked, &stats) != TVI_EINVAL;
    return 0;
}

static tvi_status go(tvi_ensemble *ensemble, const tvi_event *const events[], result *r)
{
    const tvi_ensemble_plan plans[] = {
        {.h = 0.25, .steps = STEPS, .events = events, .event_count = 1, .on_event = note, .ctx = r},
        {.h = 0.25, .steps = STEPS, .D = r->D, .columns = 1},
        {.h = 0.25, .t_end = 15, .has_t_end = true},
        {.h = 0.25, .steps = STEPS, .at_step = ask},
    };
    size_t size;
    tvi_status status = tvi_ensemble_integrate(ensemble, 0.25, STEPS, r->t, r->q, r->p, r->status, NULL, NULL);
    asked = ensemble;
    for (int k = 0; k < 4 && status == TVI_OK; k++) {
        started_count = 0;
        status = tvi_ensemble_run(ensemble, &plans[k], r->t, r->q, r->p, r->status);
    }
    if (status == TVI_OK) status = tvi_ensemble_last(ensemble, r->t, r->q, r->p, r->status);
    return status == TVI_OK ? tvi_ensemble_member_to_text(ensemble, 0, r->t, r->q, r->p, NULL, &size) : status;
}

static tvi_status run(const tvi_system *system, const char *name, int order, int threads, result *r)
{
    tvi_options options;
    tvi_ensemble *ensemble = NULL;
    tvi_event *event = NULL;
    memset(r, 0, sizeof *r);
    for (int m = 0; m < MEMBERS; m++) r->q[m] = 0.2 * (m + 1) / MEMBERS, r->p[MEMBERS + m] = 0.3, r->D[m] = 1;
    tvi_status status = tvi_options_named(name, order, &options);
    if (status == TVI_OK) status = tvi_event_create(&event, N, TVI_EITHER, false, crossing, NULL);
    if (status == TVI_OK) status = tvi_ensemble_create(&ensemble, system, &options, MEMBERS, threads);
    if (status == TVI_OK) status = go(ensemble, (const tvi_event *const[]){event}, r);
    tvi_ensemble_free(ensemble);
    tvi_event_free(event);
    return status;
}

int main(void)
{
    static const struct {
        const char *name;
        int order;
    } methods[] = {{"galerkin", 16}, {"taylor", 12}, {"stormer-verlet", 2}, {"midpoint", 8}};
    static result one, several;
    tvi_system *system;
    int wrong = 0, threads = 0;
    if (tvi_system_potential(&system, N, NULL, potential, NULL) != TVI_OK) return 1;
    for (int k = 0; k < 4; k++) {
        wrong += run(system, methods[k].name, methods[k].order, 1, &one) != TVI_OK;
        for (most_threads = 1; most_threads <= MOST; most_threads++) {
            wrong += run(system, methods[k].name, methods[k].order, MOST, &several) != TVI_OK;
            wrong += one.told < MEMBERS || memcmp(&one, &several, sizeof one) != 0;
            wrong += started_count != most_threads - 1;
            threads += started_count;
        }
    }
    tvi_system_free(system);
    printf("%d threads, %d members: %d wrong, %d not refused\n", threads, MEMBERS, wrong, not_refused);
    return wrong != 0 || not_refused != 0;
}
