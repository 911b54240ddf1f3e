/* chaos.c - Makes a run with a tangent vector, and sums up how it grows: the Lyapunov exponent and MEGNO (tvi_chaos.h).
 * Each step adds to the sums, since a logarithm costs next to nothing beside a step: steps that are left out at the
 * start, where the length changes most, would change MEGNO of all times. */
#include "integrator/columns.h"
#include "run/run.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "tvi_chaos.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [bits] D is brought back to length 1 where it has grown or shrunk by so many. The history of lifted steps begins anew
 * then, which is seldom: a vector grows so in 69 times 1 / lambda. A step may lengthen it by 2^900 more. */
#define SCALED_FROM 100

/* A run, the plan of the user, and the vector. */
typedef struct {
    tvi_chaos *chaos;
    const tvi_run_plan *plan;
    const tvi_system *system;
    double *D, *own_D; /* own_D is freed with the run; NULL if D is the user's */
    double logarithm;  /* of the length of D after the last step */
} chaos_run;

static void free_own_vector(chaos_run *run) { free(run->own_D); }

/* Returns the mass of a coordinate, or 1 where momenta have none. */
static double find_mass(const tvi_system *system, int i)
{
    return system->form == TVI_SEPARABLE || system->has_masses ? system->mass[i] : 1;
}

/* Returns the sum of the squares of (dq, dv), of all numbers times a power of two. */
static double sum_squares(const tvi_system *system, const double D[], double power)
{
    const int n = system->n;
    double square = 0;
    for (int i = 0; i < n; i++) square += (D[i] * power) * (D[i] * power);
    for (int i = 0; i < n; i++) {
        const double dv = D[n + i] / find_mass(system, i) * power;
        square += dv * dv;
    }
    return square;
}

/* A power of two in D is one in its length, also where squares overflow or vanish. */
static double find_length(const tvi_system *system, const double D[])
{
    const double square = sum_squares(system, D, 1), power = square < 1 ? 0x1p500 : 0x1p-500;
    if (square > 0x1p-900 && square < 0x1p900) return sqrt(square);
    return sqrt(sum_squares(system, D, power)) / power;
}

/* Sets D to the vector that tvi_chaos.h describes. Multiples of the golden ratio are spread evenly over [0, 1), however
 * many there are, and no two are equal (Weyl). */
static void set_first_vector(const tvi_system *system, const double p[], double D[])
{
    const double golden = (1 + sqrt(5)) / 2;
    const bool is_at_rest = tvi_largest_magnitude(system->n, p, 1) == 0;
    for (int i = 0; i < system->n; i++) {
        const double multiple = (i + 1) / golden, component = 2 * (multiple - floor(multiple)) - 1;
        if (is_at_rest) D[i] = component;
        else D[system->n + i] = component * find_mass(system, i);
    }
}

/* Adds the last step, or the part of it that ended the run, at the time t. The sum of Y is an integral of the logarithm
 * by trapezia, and so is the mean of Y. A run that stands still at t adds nothing, and one that is back at the start
 * has undone its sums and begins anew. */
static void add_step(chaos_run *run, double t)
{
    tvi_chaos *c = run->chaos;
    const double before = c->time, time = fabs(t - c->t_start), length = find_length(run->system, run->D);
    if (time == before) return;
    const double logarithm = log(length), added = logarithm - run->logarithm;
    if (time == 0) {
        *c = (tvi_chaos){.t_start = c->t_start, .size = c->size};
        run->logarithm = logarithm;
        return;
    }
    const double y = (c->y * before + added * (before + time)) / time;
    c->megno = (c->megno * before + (c->y + y) / 2 * (time - before)) / time;
    c->y = y;
    c->growth += added;
    c->lyapunov = c->growth / time;
    c->time = time;
    c->steps++;
    run->logarithm = logarithm;
    if (fabs(logarithm) < SCALED_FROM * log(2) || !isfinite(logarithm)) return;
    const int rows = 2 * run->system->n + tvi_system_parameters(run->system), exponent = -ilogb(length);
    for (int i = 0; i < rows; i++) run->D[i] = ldexp(run->D[i], exponent);
    run->logarithm = log(find_length(run->system, run->D));
}

/* ---- Observers, which call those of the user --------------------------------------------------------------------- */

static int see_step(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    chaos_run *run = ctx;
    add_step(run, t);
    return run->plan->at_step ? run->plan->at_step(member, which, t, q, p, run->plan->ctx) : 0;
}

static int tell_user_of_time(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    const tvi_run_plan *plan = ((const chaos_run *)ctx)->plan;
    return plan->at_time(member, which, t, q, p, plan->ctx);
}

static int tell_user_of_event(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    const tvi_run_plan *plan = ((const chaos_run *)ctx)->plan;
    return plan->on_event(member, which, t, q, p, plan->ctx);
}

static int tell_user_of_members(long step, int members, const double t[], const double q[], const double p[],
                                const tvi_status status[], void *ctx)
{
    const tvi_run_plan *plan = ((const chaos_run *)ctx)->plan;
    return plan->observer(step, members, t, q, p, status, plan->ctx);
}

/* ---- The run ----------------------------------------------------------------------------------------------------- */

static tvi_status check(const tvi_integrator *it, const tvi_run_plan *plan, const tvi_chaos *chaos)
{
    if (!chaos) return jet_refuse(TVI_EINVAL, "chaos is NULL");
    if (chaos->size != 0 && chaos->size != sizeof *chaos)
        return jet_refuse(TVI_EINVAL, "size is not that of a tvi_chaos of this version");
    const tvi_status status = tvi_plan_check(it, plan);
    if (status != TVI_OK || !plan->D || plan->columns == 1) return status;
    return jet_refuse(TVI_EINVAL, "D has %d columns, and chaos is that of one: without D it has a vector of its own",
                      plan->columns);
}

/* Finds the vector from which the run goes on, or makes one. */
static tvi_status provide_vector(chaos_run *run, double t, const double p[])
{
    const int rows = 2 * run->system->n + tvi_system_parameters(run->system);
    tvi_chaos *c = run->chaos;
    run->D = run->plan->D ? run->plan->D : (run->own_D = calloc((size_t)rows, sizeof *run->own_D));
    if (!run->D) return jet_explain_out_of_memory(TVI_ENOMEM);
    if (tvi_largest_magnitude(rows, run->D, 1) == 0) set_first_vector(run->system, p, run->D);
    if (run->own_D || c->steps == 0) *c = (tvi_chaos){.t_start = t, .size = c->size};
    run->logarithm = log(find_length(run->system, run->D));
    return run->logarithm == -INFINITY ? jet_refuse(TVI_EINVAL, "D has no length: dq and dp are 0") : TVI_OK;
}

tvi_status tvi_run_chaos(tvi_integrator *it, const tvi_run_plan *plan, tvi_chaos *chaos, double *t, double q[],
                         double p[])
{
    if (!it || !t || !q || !p) return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1}, "");
    tvi_status status = check(it, plan, chaos);
    if (status != TVI_OK) return status;
    __attribute__((cleanup(free_own_vector))) chaos_run run = {.chaos = chaos, .plan = plan, .system = it->system};
    status = provide_vector(&run, *t, p);
    if (status != TVI_OK) return status;
    tvi_run_plan seen = *plan;
    seen.D = run.D;
    seen.columns = 1;
    seen.columns_at_once = tvi_at_once_serves(it);
    seen.at_step = see_step;
    seen.at_time = plan->at_time ? tell_user_of_time : NULL;
    seen.on_event = plan->on_event ? tell_user_of_event : NULL;
    seen.observer = plan->observer ? tell_user_of_members : NULL;
    seen.ctx = &run;
    status = tvi_run(it, &seen, t, q, p);
    if (status == TVI_ESTOPPED) add_step(&run, *t); /* An event that ends a run is no step to an observer. */
    return status;
}
