/* threads.c - Tests that two threads make ten thousand integrators one after another on one shared system, take steps
 * with them and ask the system itself. Run under the thread sanitizer; every result is the same to the last bit. */
#include "tvi.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { THREADS = 2, INTEGRATORS = 5000 }; /* for each thread */

/* A Hamiltonian that is not separable, so that the Legendre transform of the system is needed too. */
static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_mul(jet_add(jet_sqr(q[0]), 1), jet_add(jet_sqr(p[0]), 1)));
}

typedef struct {
    const tvi_system *system;
    double first[4]; /* q, p, H, v of the first integrator */
    int wrong;
} worker;

static tvi_status once(const tvi_system *system, double result[4])
{
    double t = 0, q[] = {0.3}, p[] = {0.5};
    tvi_integrator *integrator = NULL;
    tvi_options options;
    tvi_status status = tvi_options_named("poincare", 4, &options);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, &options);
    for (int i = 0; i < 2 && status == TVI_OK; i++) status = tvi_step(integrator, 0.1, &t, q, p);
    tvi_integrator_free(integrator);
    if (status == TVI_OK) status = tvi_energy(system, t, q, p, &result[2]);
    if (status == TVI_OK) status = tvi_velocity(system, t, q, p, &result[3]);
    result[0] = q[0], result[1] = p[0];
    return status;
}

static void *work(void *ctx)
{
    worker *self = ctx;
    for (int i = 0; i < INTEGRATORS; i++) {
        double result[4] = {0};
        self->wrong += once(self->system, i == 0 ? self->first : result) != TVI_OK;
        self->wrong += i > 0 && memcmp(result, self->first, sizeof result) != 0;
    }
    return NULL;
}

int main(void)
{
    tvi_system *system;
    pthread_t thread[THREADS];
    worker workers[THREADS] = {{0}};
    int wrong = 0;
    if (tvi_system_hamiltonian(&system, 1, hamiltonian, NULL) != TVI_OK) return 1;
    for (int i = 0; i < THREADS; i++) {
        workers[i].system = system;
        if (pthread_create(&thread[i], NULL, work, &workers[i]) != 0) return 1;
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        wrong += workers[i].wrong + (memcmp(workers[i].first, workers[0].first, sizeof workers[i].first) != 0);
    }
    tvi_system_free(system);
    printf("%d threads, %d integrators each: %d wrong\n", THREADS, INTEGRATORS, wrong);
    return wrong != 0;
}
