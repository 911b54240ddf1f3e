/* curve_batch.c - makes one step of several members of an ensemble at once, each a curve in one vector lane. Ensembles
 * call it through tvi_curve_batch (method/stepper.h). It uses the fast-path step of curve_step.h. Member m has lane m
 * in sweeps of the series, and lane node * width + m in sweeps of the field at the quadrature nodes. A member for which
 * the fast-path step fails, or that is outside of the domain, makes its step alone. */
#include "generating/curve.h"
#include "generating/curve_stepper.h"
#include "method/method.h"
#include "method/single.h"

typedef struct {
    tvi_member_stepper single_stepper;
    tvi_curve_workspace *work_of_members;
    long long *iterating_mask; /* [member_count] */
    double *dq, *dp;           /* [n][member_count] the increments of the step */
    double *tail, *residual;   /* [member_count] */
    int *pass_counts;          /* [member_count] */
} batch;

static bool is_plain_taylor_method(const tvi_options *options)
{
    return !tvi_find_method(options)->curve.correct_ends_by_generating_function;
}

/* Returns whether a batch can make the steps of a method with corrections: the method has a fast-path step, and the
 * momenta at the nodes need no iteration of their own. */
static bool can_batch_steps_with_symplectic_corrections(const tvi_system *system, const tvi_options *options)
{
    const bool is_phase_space_action = tvi_find_method(options)->curve.action == TVI_ACTION_HAMILTON;
    const bool has_field = system->form == TVI_SEPARABLE || (system->form == TVI_HAMILTONIAN && is_phase_space_action);
    return tvi_has_fast_path_step(system, options) && has_field && options->nodes == TVI_NODES_ON_CURVE &&
           options->degree > 1;
}

static int choose_batch_width(const tvi_system *system, const tvi_options *options)
{
    if (is_plain_taylor_method(options) ? system->form == TVI_LAGRANGIAN
                                        : !can_batch_steps_with_symplectic_corrections(system, options))
        return 1;
    const int orders = tvi_create_unallocated_action(system, options, 1).order_count,
              blocks = is_plain_taylor_method(options) ? 1 : 2;
    const int bytes = blocks * system->field_series->slot_count * orders * (int)sizeof(double);
    int width = BATCH_MIN_WIDTH;
    if (BATCH_MIN_WIDTH * bytes > CURVE_BATCH_MAX_BYTES_AT_MIN_WIDTH) return 1;
    while (2 * width <= BATCH_MAX_WIDTH && 2 * width * bytes <= CURVE_BATCH_MAX_BYTES) width *= 2;
    return width;
}

static void *allocate_batch(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *allocated = tvi_arena_allocate(arena, sizeof *allocated), members = {0};
    const size_t count = (size_t)width, numbers = (size_t)system->n * count;
    const tvi_stepper *stepper = tvi_find_method(options)->stepper;
    tvi_member_stepper_allocate(&members.single_stepper, arena, stepper, system, options, width,
                                options->quadrature_points + 1);
    members.work_of_members = tvi_curve_workspace_allocate(arena, system, options, width);
    members.iterating_mask = tvi_arena_allocate(arena, count * sizeof *members.iterating_mask);
    members.dq = tvi_arena_allocate_doubles(arena, numbers);
    members.dp = tvi_arena_allocate_doubles(arena, numbers);
    members.residual = tvi_arena_allocate_doubles(arena, count);
    members.tail = tvi_arena_allocate_doubles(arena, count);
    members.pass_counts = tvi_arena_allocate(arena, count * sizeof *members.pass_counts);
    if (!allocated) return NULL;
    *allocated = members;
    members.work_of_members->single_stepper = &allocated->single_stepper;
    return allocated;
}

static void prepare_batch(void *work)
{
    batch *members = work;
    tvi_member_stepper_set_tables(&members->single_stepper);
    tvi_curve_workspace_compute_constant_tables(members->work_of_members);
}

/* Returns the history of all members, [member_count]. The history of a member is one number: the largest growth of the
 * contraction ratio of its passes, or, for the plain Taylor method, the size of its last step to a tolerance, from
 * which it continues in later runs. Plain Taylor steps of a given size do not use their history. */
static double *get_contraction_growth_or_step_of_members(const tvi_curve_workspace *work)
{
    return work->has_symplectic_end_corrections ? work->newton.max_contraction_ratio_growth_of_member
                                                : work->last_adapted_step_size;
}

static void copy_lane_history_to_member(const void *work, int lane, void *member_work)
{
    *get_contraction_growth_or_step_of_members(member_work) =
        get_contraction_growth_or_step_of_members(((const batch *)work)->work_of_members)[lane];
}

static void copy_member_history_to_lane(void *work, int lane, const void *member_work)
{
    get_contraction_growth_or_step_of_members(((const batch *)work)->work_of_members)[lane] =
        *get_contraction_growth_or_step_of_members(member_work);
}

static void forget_lane_history(void *work, int lane)
{
    get_contraction_growth_or_step_of_members(((const batch *)work)->work_of_members)[lane] = 0;
}

static void step_single_member(batch *members, double h, const tvi_batch_origin *origin,
                               const tvi_batch_results *results, int m, tvi_stats *stats)
{
    const tvi_member_stepper *single = &members->single_stepper;
    copy_lane_history_to_member(members, m, single->stepper_work);
    if (tvi_step_member(single, single->system->field_series,
                        members->work_of_members->corrected_curve.curve.series_block, 1, h, origin, results, m, stats))
        copy_member_history_to_lane(members, m, single->stepper_work);
}

static void step_batch(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *results,
                       tvi_stats *stats)
{
    batch *members = work;
    const int n = members->single_stepper.system->n, width = members->single_stepper.batch_width;
    for (int m = 0; m < width; m++) members->iterating_mask[m] = results->status[m] == TVI_OK ? -1 : 0;
    const tvi_fast_path_step_results fast = {members->dq,       members->dp,          members->tail,
                                             members->residual, members->pass_counts, members->iterating_mask};
    (void)members->work_of_members->fast_path_step(
        members->work_of_members, members->work_of_members->corrected_curve.span.tau_over_h * h, origin, &fast, stats);
    for (int m = 0; m < width; m++) {
        if (results->status[m] != TVI_OK) continue;
        if (members->pass_counts[m] == TVI_NOT_MADE) {
            step_single_member(members, h, origin, results, m, stats);
            continue;
        }
        for (int at = m; at < n * width; at += width) {
            results->increments.dq[at] = members->dq[at];
            results->increments.dp[at] = members->dp[at];
        }
        results->tail[m] = stats->tail = members->tail[m];
        results->pass_counts[m] = members->pass_counts[m];
        if (members->pass_counts[m] > 0) stats->residual = members->residual[m];
    }
}

const tvi_batch_stepper tvi_curve_batch = {.width = choose_batch_width,
                                           .allocate = allocate_batch,
                                           .set_tables = prepare_batch,
                                           .step = step_batch,
                                           .copy_history_from_lane = copy_lane_history_to_member,
                                           .copy_history_to_lane = copy_member_history_to_lane,
                                           .clear_history = forget_lane_history};
