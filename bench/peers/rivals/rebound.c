/* rebound.c - runs integrators of REBOUND 5. This file calls REBOUND and has nothing of it: the user builds the
 * library, and `make peers REBOUND=DIR` names its folder. */
#include "peers/peer.h"

#include <rebound.h>

#include <integrator_ias15.h>
#include <integrator_saba.h>
#include <integrator_whfast.h>

#include <stdlib.h>

enum { WHFAST, WHCKL, SABA, WHFAST512, IAS15 };
static const char *const names[] = {"whfast", "whfast", "saba", "whfast512", "ias15"};

/* epsilon of IAS15, whose default is 1e-9. */
static const double tolerances[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7, 1e-9, 1e-11, 0};

/* WHFast512 takes a star and 8 planets, with G = 1. */
static const double *settings(const peer *self, const problem *p)
{
    if (self->variant == IAS15) return tolerances;
    if (self->variant == WHFAST512 && (p->bodies != 9 || p->G != 1)) return NULL;
    return p->map_steps;
}

/* If a loose tolerance lets two bodies fall into each other, the steps never end. */
static void give_up(struct reb_simulation *r)
{
    if (r->steps_done > 200000) reb_simulation_stop(r);
}

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3, of a body of mass 1. */
static void henon_heiles(struct reb_simulation *r)
{
    struct reb_particle *b = r->particles;
    b->ax -= b->x + 2 * b->x * b->y;
    b->ay -= b->y + b->x * b->x - b->y * b->y;
}

/* A body that is attracted by a mass of 1 at 0 has none itself. */
static void add_bodies(struct reb_simulation *r, const problem *p)
{
    if (p->bodies == 1) reb_simulation_add(r, (struct reb_particle){.m = 1});
    for (int i = 0; i * p->axes < p->n; i++) {
        double x[3] = {0}, v[3] = {0};
        for (int k = 0; k < p->axes; k++) x[k] = p->q[i * p->axes + k], v[k] = p->v[i * p->axes + k];
        struct reb_particle body = {.m = p->mass[i], .x = x[0], .y = x[1], .z = x[2]};
        body.vx = v[0], body.vy = v[1], body.vz = v[2];
        reb_simulation_add(r, body);
    }
}

/* WHCKL is the Wisdom-Holman map with corrector and lazy kernel (Rein, Tamayo and Brown 2019). */
static bool choose(struct reb_simulation *r, int variant, double setting)
{
    void *state = reb_simulation_set_integrator(r, names[variant]);
    if (!state) return false;
    if (variant == IAS15) ((struct reb_integrator_ias15_state *)state)->epsilon = setting, r->heartbeat = give_up;
    else r->dt = setting;
    if (variant == SABA) ((struct reb_integrator_saba_state *)state)->safe_mode = 0;
    if (variant > WHCKL) return true;
    struct reb_integrator_whfast_state *whfast = state;
    whfast->safe_mode = 0;
    whfast->corrector = 17;
    if (variant == WHCKL) whfast->kernel = REB_INTEGRATOR_WHFAST_KERNEL_LAZY;
    return true;
}

typedef struct {
    const problem *problem;
    struct reb_simulation *simulation;
} rebound_run;

static void close_run(void *run)
{
    rebound_run *r = run;
    if (r->simulation) reb_simulation_free(r->simulation);
    free(r);
}

static void *open_run(const peer *self, const problem *p, double setting)
{
    rebound_run *r = malloc(sizeof *r);
    if (!r) return NULL;
    *r = (rebound_run){p, reb_simulation_create()};
    if (r->simulation) {
        r->simulation->G = p->G;
        r->simulation->save_messages = 1; /* warnings of IAS15 with loose tolerances */
        add_bodies(r->simulation, p);
        r->simulation->exact_finish_time = self->variant != WHFAST512; /* that has no last step of its own size */
        if (p->bodies == 0) r->simulation->additional_forces = henon_heiles;
        if (choose(r->simulation, self->variant, setting)) return r;
    }
    close_run(r);
    return NULL;
}

static bool go(void *run, double q[])
{
    const rebound_run *r = run;
    struct reb_simulation *simulation = r->simulation;
    const problem *p = r->problem;
    const bool good = reb_simulation_integrate(simulation, p->t_end) == REB_STATUS_SUCCESS;
    reb_simulation_synchronize(simulation);
    const struct reb_particle *b = simulation->particles + (p->bodies == 1);
    for (int i = 0; i < p->n; i += p->axes, b++) {
        const double x[3] = {b->x, b->y, b->z};
        for (int k = 0; k < p->axes; k++) q[i + k] = x[k];
    }
    return good;
}

extern const char *reb_version_str; /* which no header of it declares */
static const char *version(void) { return reb_version_str; }

#define PEER(...)                                                                                                      \
    {                                                                                                                  \
        __VA_ARGS__, settings, open_run, go, close_run                                                                 \
    }
static const peer peers[] = {
    PEER("WHFast", WHFAST), PEER("WHCKL", WHCKL), PEER("WHFast512", WHFAST512), PEER("IAS15", IAS15), {.name = NULL}};

const peer_program peers_of_rebound = {"REBOUND", version, peers};
