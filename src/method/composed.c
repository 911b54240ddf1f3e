/* composed.c - Makes a step of a composition: half a step of a method, then half a step of its adjoint. The
 * composition is symmetric for every method (docs/method.md, section 4). It is the stepper (stepper.h) for options
 * with compose_adjoint. */
#include "method/method.h"

#include <math.h>

/* The memory of the stepper for compositions. */
typedef struct {
    int n;
    tvi_options half_options[2]; /* The options of the first half (the method), and of the second half (its adjoint). */
    const tvi_stepper *half_stepper[2];
    void *half_work[2];                   /* The memory of the steppers of both halves. */
    tvi_run_state state_between_halves;   /* The state at the end of the first half of the step. */
    tvi_increments first_half_increments; /* The increments of the first half of the step. */
} composed_stepper;

/* Allocates the vectors of a state and of the increments of a step, with n components each. */
static void allocate_state_and_increments(tvi_arena *arena, int n, tvi_run_state *state, tvi_increments *increments)
{
    tvi_arena_allocate_each(arena, (size_t)n,
                            (double **[]){&state->q, &state->q_low, &state->p, &state->p_low, &increments->dq,
                                          &increments->dp, &increments->dq_low, &increments->dp_low, NULL});
}

static void *allocate_composed_work(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    composed_stepper *allocated = tvi_arena_allocate(arena, sizeof *allocated);
    composed_stepper composition = {.n = system->n, .half_options = {*options, tvi_adjoint_options(options)}};
    allocate_state_and_increments(arena, system->n, &composition.state_between_halves,
                                  &composition.first_half_increments);
    for (int half = 0; half < 2; half++) {
        composition.half_options[half].compose_adjoint = false;
        /* The steppers of the halves keep pointers to their options, which are therefore copied into the arena. */
        if (allocated) allocated->half_options[half] = composition.half_options[half];
        composition.half_stepper[half] = tvi_choose_stepper(&composition.half_options[half], system);
        composition.half_work[half] = composition.half_stepper[half]->allocate(
            arena, system, allocated ? &allocated->half_options[half] : &composition.half_options[half]);
    }
    if (allocated) *allocated = composition;
    return allocated;
}

static void set_tables_of_halves(void *work)
{
    composed_stepper *composition = work;
    for (int half = 0; half < 2; half++) composition->half_stepper[half]->set_tables(composition->half_work[half]);
}

/* Computes (sum, sum_low) = (x, x_low) + (increment, increment_low) by compensated summation. */
static void add_increments_compensated(int n, const double x[], const double x_low[], const double increment[],
                                       const double increment_low[], double sum[], double sum_low[])
{
    for (int i = 0; i < n; i++) {
        sum_low[i] = x_low[i];
        sum[i] = tvi_add_compensated(x[i], &sum_low[i], increment[i], increment_low[i]);
    }
}

static tvi_status step_both_halves(void *work, double h, const tvi_step_origin *origin,
                                   const tvi_increments *increments, tvi_stats *stats)
{
    composed_stepper *composition = work;
    const tvi_increments *half = &composition->first_half_increments;
    const tvi_run_state *middle = &composition->state_between_halves;
    const int n = composition->n;
    tvi_status status = composition->half_stepper[0]->step(composition->half_work[0], h / 2, origin, half, stats);
    if (status != TVI_OK) return status;
    const double first_tail = stats->tail;
    add_increments_compensated(n, origin->q, origin->q_low, half->dq, half->dq_low, middle->q, middle->q_low);
    add_increments_compensated(n, origin->p, origin->p_low, half->dp, half->dp_low, middle->p, middle->p_low);
    tvi_step_origin second_origin = {origin->t, origin->t_low, middle->q, middle->q_low, middle->p, middle->p_low};
    second_origin.t = tvi_add_compensated(origin->t, &second_origin.t_low, h / 2, 0);
    status = composition->half_stepper[1]->step(composition->half_work[1], h / 2, &second_origin, increments, stats);
    stats->tail = fmax(stats->tail, first_tail);
    add_increments_compensated(n, increments->dq, increments->dq_low, half->dq, half->dq_low, increments->dq,
                               increments->dq_low);
    add_increments_compensated(n, increments->dp, increments->dp_low, half->dp, half->dp_low, increments->dp,
                               increments->dp_low);
    return status;
}

static void interpolate_within_half(void *work, double theta, double dq[], double dp[])
{
    composed_stepper *composition = work;
    const int half = theta > 0.5;
    composition->half_stepper[half]->interpolate(composition->half_work[half], 2 * theta - half, dq, dp);
    if (half == 0) return;
    for (int i = 0; i < composition->n; i++) {
        dq[i] += composition->first_half_increments.dq[i];
        dp[i] += composition->first_half_increments.dp[i];
    }
}

/* Lists the tapes that generated code needs for one half. The adjoint runs the same tapes. */
static tvi_tapes_of_steps list_tapes_of_half(const tvi_system *system, const tvi_options *options)
{
    tvi_options half = *options;
    half.compose_adjoint = false;
    return tvi_choose_stepper(&half, system)->list_tapes(system, &half);
}

static bool are_histories_valid(const void *work)
{
    const composed_stepper *composition = work;
    for (int half = 0; half < 2; half++)
        if (composition->half_stepper[half]->is_history_valid &&
            !composition->half_stepper[half]->is_history_valid(composition->half_work[half]))
            return false;
    return true;
}

const tvi_stepper tvi_stepper_composed = {.allocate = allocate_composed_work,
                                          .set_tables = set_tables_of_halves,
                                          .step = step_both_halves,
                                          .interpolate = interpolate_within_half,
                                          .is_history_valid = are_histories_valid,
                                          .list_tapes = list_tapes_of_half};
