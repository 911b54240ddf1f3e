/* curve_batch.c - makes one step of several members of an ensemble at once, each a curve in one vector lane.
 * Ensembles call it through tvi_curve_batch (method/single.h). It uses the quick step of curve_step.h: member m is
 * lane m of a sweep, and lane node * width + m at the nodes. A member for which the quick step fails, or that is
 * outside of the domain, makes its step alone. */
#include "generating/curve.h"
#include "generating/curve_stepper.h"
#include "method/method.h"
#include "method/single.h"

/* These bound the blocks of the series and of its tangents along one direction, which are to stay in the first-level
 * cache; a block of the least width may be larger. */
enum { MOST_BYTES = 32 << 10, MOST_BYTES_OF_ALL = 256 << 10 };

typedef struct {
    tvi_member_stepper by_itself;
    tvi_curve_workspace *lanes;
    long long *is_moving;    /* [width] */
    double *dq, *dp;         /* [n][width] */
    double *tail, *residual; /* [width] */
    int *passes;             /* [width] */
} batch;

static bool is_plain_taylor_method(const tvi_options *options) { return !tvi_find_method(options)->curve.correct_ends; }

/* Returns whether the field of corrected curves needs no momenta of nodes. */
static bool can_step_corrected_in_lanes(const tvi_system *system, const tvi_options *options)
{
    const bool is_hamilton = tvi_find_method(options)->curve.action == TVI_ACTION_HAMILTON;
    const bool has_field = system->form == TVI_SEPARABLE || (system->form == TVI_HAMILTONIAN && is_hamilton);
    return tvi_has_quick_step(system, options) && has_field && options->nodes == TVI_NODES_ON_CURVE &&
           options->degree > 1;
}

static int choose_batch_width(const tvi_system *system, const tvi_options *options)
{
    if (is_plain_taylor_method(options) ? system->form == TVI_LAGRANGIAN
                                        : !can_step_corrected_in_lanes(system, options))
        return 1;
    const int orders = tvi_get_action_sizes(system, options).orders, blocks = is_plain_taylor_method(options) ? 1 : 2;
    const int bytes = blocks * system->field_series->slots * orders * (int)sizeof(double);
    int width = TVI_LEAST_WIDTH;
    if (TVI_LEAST_WIDTH * bytes > MOST_BYTES_OF_ALL) return 1;
    while (2 * width <= TVI_MOST_WIDTH && 2 * width * bytes <= MOST_BYTES) width *= 2;
    return width;
}

static void *allocate_batch(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    batch *taken = tvi_arena_allocate(arena, sizeof *taken), members = {0};
    const size_t count = (size_t)width, numbers = (size_t)system->n * count;
    const tvi_stepper *stepper = tvi_find_method(options)->stepper;
    tvi_member_stepper_allocate(&members.by_itself, arena, stepper, system, options, width,
                                options->quadrature_points + 1);
    members.lanes = tvi_curve_workspace_allocate(arena, system, options, width);
    members.is_moving = tvi_arena_allocate(arena, count * sizeof *members.is_moving);
    members.dq = tvi_arena_allocate_doubles(arena, numbers);
    members.dp = tvi_arena_allocate_doubles(arena, numbers);
    members.residual = tvi_arena_allocate_doubles(arena, count);
    members.tail = tvi_arena_allocate_doubles(arena, count);
    members.passes = tvi_arena_allocate(arena, count * sizeof *members.passes);
    if (!taken) return NULL;
    *taken = members;
    members.lanes->by_itself = &taken->by_itself;
    return taken;
}

static void prepare_batch(void *work)
{
    batch *members = work;
    tvi_member_stepper_set_tables(&members->by_itself);
    tvi_curve_workspace_fill_tables(members->lanes);
}

/* Copies the history of a member. Plain steps of a given size leave nothing to the next one. A step to a tolerance
 * leaves its size, from which the member continues in later runs. */
static void copy_member_history(const tvi_curve_workspace *from, int lane, const tvi_curve_workspace *to, int to_lane)
{
    if (from->corrects) to->newton.history[to_lane] = from->newton.history[lane];
    else to->chosen[to_lane] = from->chosen[lane];
}

static void copy_lane_to_member(const void *work, int lane, void *one)
{
    copy_member_history(((const batch *)work)->lanes, lane, one, 0);
}

static void copy_member_to_lane(void *work, int lane, const void *one)
{
    copy_member_history(one, 0, ((const batch *)work)->lanes, lane);
}

static void forget_lane_history(void *work, int lane)
{
    const tvi_curve_workspace *lanes = ((const batch *)work)->lanes;
    if (lanes->corrects) lanes->newton.history[lane] = (tvi_newton_history){0};
    else lanes->chosen[lane] = 0;
}

static void step_member_by_itself(batch *members, double h, const tvi_batch_origin *origin,
                                  const tvi_batch_results *end, int m, tvi_stats *stats)
{
    const tvi_member_stepper *single = &members->by_itself;
    copy_lane_to_member(members, m, single->stepper_work);
    if (tvi_step_member(single, single->system->field_series, members->lanes->closure.curve.series_block, 1, h, origin,
                        end, m, stats))
        copy_member_to_lane(members, m, single->stepper_work);
}

static void step_batch(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *end,
                       tvi_stats *stats)
{
    batch *members = work;
    const int n = members->by_itself.system->n, width = members->by_itself.width;
    for (int m = 0; m < width; m++) members->is_moving[m] = end->status[m] == TVI_OK ? -1 : 0;
    const tvi_quick_step_results quick = {members->dq,       members->dp,     members->tail,
                                          members->residual, members->passes, members->is_moving};
    (void)members->lanes->quick_step(members->lanes, members->lanes->closure.span.tau * h, origin, &quick, stats);
    for (int m = 0; m < width; m++) {
        if (end->status[m] != TVI_OK) continue;
        if (members->passes[m] == TVI_NOT_MADE) {
            step_member_by_itself(members, h, origin, end, m, stats);
            continue;
        }
        for (int at = m; at < n * width; at += width) {
            end->increments.dq[at] = members->dq[at];
            end->increments.dp[at] = members->dp[at];
        }
        end->tail[m] = stats->tail = members->tail[m];
        end->passes[m] = members->passes[m];
        if (members->passes[m] > 0) stats->residual = members->residual[m];
    }
}

const tvi_batch_stepper tvi_curve_batch = {.width = choose_batch_width,
                                           .take = allocate_batch,
                                           .prepare = prepare_batch,
                                           .step = step_batch,
                                           .lane_to_scalar = copy_lane_to_member,
                                           .scalar_to_lane = copy_member_to_lane,
                                           .forget = forget_lane_history};
