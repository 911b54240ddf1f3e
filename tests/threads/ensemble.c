/* ensemble.c - Runs ensembles on three threads, under the thread sanitizer: steps, events, tangents, states, results
 * the same to the last bit as on one. The threads are POSIX threads in the place of OpenMP's, whose own library the
 * sanitizer does not see into: tvi_parallel_for is linked with --wrap. */
#include "run/parallel_for.h"
#include "tvi.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 50, N = 2, ROWS = 2 * N, STEPS = 20, MOST = 3 };

/* ---- tvi_parallel_for
 * -------------------------------------------------------------------------------------------------- */

typedef struct {
    atomic_int next;
    int count;
    tvi_parallel_body *work;
    void *ctx;
} shared;

typedef struct {
    shared *shared_work;
    int thread;
} hand;

static void *take_turns(void *ctx)
{
    const hand *h = ctx;
    for (int i;
         (i = atomic_fetch_add_explicit(&h->shared_work->next, 1, memory_order_relaxed)) < h->shared_work->count;)
        h->shared_work->work(h->shared_work->ctx, h->thread, i);
    return NULL;
}

static int most_threads; /* at once */

void __wrap_tvi_parallel_for(int threads, int count, tvi_parallel_body *work, void *ctx);
void __wrap_tvi_parallel_for(int threads, int count, tvi_parallel_body *work, void *ctx)
{
    shared shared_work = {.count = count, .work = work, .ctx = ctx};
    pthread_t thread[MOST];
    hand hands[MOST];
    for (int i = 0; i < threads; i++) {
        hands[i] = (hand){&shared_work, i};
        if (pthread_create(&thread[i], NULL, take_turns, &hands[i]) != 0) abort();
    }
    for (int i = 0; i < threads; i++) pthread_join(thread[i], NULL);
    if (threads > most_threads) most_threads = threads;
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

static tvi_status go(tvi_ensemble *ensemble, const tvi_event *const events[], result *r)
{
    const tvi_ensemble_plan plans[] = {
        {.h = 0.25, .steps = STEPS, .events = events, .event_count = 1, .on_event = note, .ctx = r},
        {.h = 0.25, .steps = STEPS, .D = r->D, .columns = 1},
        {.h = 0.25, .t_end = 15},
    };
    size_t size;
    tvi_status status = tvi_ensemble_integrate(ensemble, 0.25, STEPS, r->t, r->q, r->p, r->status, NULL, NULL);
    for (int k = 0; k < 3 && status == TVI_OK; k++)
        status = tvi_ensemble_run(ensemble, &plans[k], r->t, r->q, r->p, r->status);
    return status == TVI_OK ? tvi_ensemble_save(ensemble, NULL, &size) : status;
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
    static result one, three;
    tvi_system *system;
    int wrong = 0;
    if (tvi_system_potential(&system, N, NULL, potential, NULL) != TVI_OK) return 1;
    for (int k = 0; k < 4; k++) {
        wrong += run(system, methods[k].name, methods[k].order, 1, &one) != TVI_OK;
        wrong += run(system, methods[k].name, methods[k].order, MOST, &three) != TVI_OK;
        wrong += one.told < MEMBERS || memcmp(&one, &three, sizeof one) != 0;
    }
    tvi_system_free(system);
    printf("%d threads, %d members: %d wrong\n", most_threads, MEMBERS, wrong);
    return wrong != 0 || most_threads != MOST;
}
