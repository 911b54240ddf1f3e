/* crowd.c - the steps of a block of members: as those of an integrator (step.c), in lanes. */
#include "run/crowd.h"
#include "run/guard.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const tvi_crowd_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_crowd_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_crowd_loops_avx2,
    [jet_isa_avx512] = &tvi_crowd_loops_avx512,
#endif
};

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static tvi_crowd *lay_out(tvi_arena *arena, tvi_integrator *one, int width)
{
    tvi_crowd *crowd = tvi_arena_take(arena, sizeof *crowd);
    tvi_crowd laid = {.stepper = one->stepper->crowd, .one = one, .width = width, .dimension = one->stepped->n};
    const size_t row = (size_t)width * sizeof(double), rows = (size_t)laid.dimension;
    double **const history[] = {&laid.now.p, &laid.now.q, &laid.now.p_low, &laid.now.q_low};
    for (size_t i = 0; i < 4; i++) *history[i] = tvi_arena_history(arena, (rows + i % 2) * row);
    laid.begun = tvi_arena_history(arena, (2 * (size_t)one->system->n + 1) * row);
    laid.kept = tvi_arena_history(arena, (size_t)width * sizeof *laid.kept);
    laid.continues = tvi_arena_history(arena, (size_t)width * sizeof *laid.continues);
    double **const of_step[] = {&laid.end.by.dp, &laid.end.by.dq, &laid.end.by.dp_low, &laid.end.by.dq_low};
    for (size_t i = 0; i < 4; i++) *of_step[i] = tvi_arena_take(arena, (rows + i % 2) * row);
    laid.end.status = tvi_arena_take(arena, (size_t)width * sizeof *laid.end.status);
    laid.was = tvi_arena_take(arena, (size_t)width * sizeof *laid.was);
    laid.end.tail = tvi_arena_take(arena, row);
    laid.end.passes = tvi_arena_take(arena, (size_t)width * sizeof *laid.end.passes);
    laid.overflows = tvi_arena_take(arena, row);
    laid.change = tvi_arena_take(arena, row);
    laid.doubts = tvi_arena_take(arena, (size_t)width * sizeof *laid.doubts);
    laid.before = tvi_arena_take(arena, row);
    laid.after = tvi_arena_take(arena, row);
    laid.q = tvi_arena_take(arena, (rows + 1) * row);
    laid.p = tvi_arena_take(arena, rows * row);
    laid.parameters = tvi_arena_take(arena, (size_t)tvi_system_parameters(one->system) * row);
    if (one->energy.block && one->system->form != TVI_LAGRANGIAN)
        tvi_energy_lanes_take(&laid.energy, arena, one->system, width);
    laid.loops = loops_of[one->stepped->field_values->sweeps->isa];
    laid.work = laid.stepper->take(arena, one->stepped, &one->options, width);
    laid.blocks = arena->blocks;
    laid.history = arena->history;
    laid.remembered = tvi_arena_remembered(arena);
    laid.stats.bytes = tvi_arena_bytes(arena);
    if (crowd) *crowd = laid;
    return crowd;
}

tvi_status tvi_crowd_create(tvi_crowd **out, tvi_integrator *one)
{
    const tvi_crowd_stepper *stepper = one->stepper->crowd;
    const int width = stepper ? stepper->width(one->stepped, &one->options) : 1;
    tvi_arena arena = {0};
    *out = NULL;
    if (width == 1) return TVI_OK;
    (void)lay_out(&arena, one, width);
    if (!tvi_arena_open(&arena)) return TVI_ENOMEM;
    *out = lay_out(&arena, one, width);
    tvi_blocks_prepare((*out)->blocks);
    if (stepper->prepare) stepper->prepare((*out)->work);
    if (stepper->simplify) stepper->simplify(one->work);
    return TVI_OK;
}

void tvi_crowd_free(tvi_crowd *crowd) { free(crowd); }

void tvi_crowd_apply_parameters(tvi_crowd *crowd)
{
    tvi_blocks_set_parameters(crowd->blocks, tvi_system_parameters(crowd->one->system), crowd->width,
                              crowd->parameters);
}

/* ---- Members and lanes ------------------------------------------------------------------------------------------- */

/* The arrays of a state, and their rows. */
enum { ARRAYS = 4 };
static void list_arrays(const tvi_run_state *of, int dimension, double *array[ARRAYS], int rows[ARRAYS])
{
    double *const all[ARRAYS] = {of->q, of->q_low, of->p, of->p_low};
    for (int a = 0; a < ARRAYS; a++) {
        array[a] = all[a];
        rows[a] = a < 2 ? dimension + 1 : dimension;
    }
}

void tvi_crowd_get(const tvi_crowd *crowd, int lane, tvi_integrator *it)
{
    double *from[ARRAYS], *to[ARRAYS];
    int rows[ARRAYS];
    list_arrays(&crowd->now, crowd->dimension, from, rows);
    list_arrays(&it->now, crowd->dimension, to, rows);
    tvi_arena_copy(it->history, NULL, it->remembered);
    for (int a = 0; a < ARRAYS; a++)
        for (int row = 0; row < rows[a]; row++) to[a][row] = from[a][row * crowd->width + lane];
    for (int row = 0; row <= 2 * it->system->n; row++) it->begun[row] = crowd->begun[row * crowd->width + lane];
    *it->kept = crowd->kept[lane];
    *it->continues = crowd->continues[lane];
    if (crowd->stepper->get) crowd->stepper->get(crowd->work, lane, it->work);
    it->has_dense = false;
}

void tvi_crowd_put(tvi_crowd *crowd, int lane, const tvi_integrator *it)
{
    double *from[ARRAYS], *to[ARRAYS];
    int rows[ARRAYS];
    list_arrays(&it->now, crowd->dimension, from, rows);
    list_arrays(&crowd->now, crowd->dimension, to, rows);
    for (int a = 0; a < ARRAYS; a++)
        for (int row = 0; row < rows[a]; row++) to[a][row * crowd->width + lane] = from[a][row];
    for (int row = 0; row <= 2 * it->system->n; row++) crowd->begun[row * crowd->width + lane] = it->begun[row];
    crowd->kept[lane] = *it->kept;
    crowd->continues[lane] = *it->continues;
    if (crowd->stepper->put) crowd->stepper->put(crowd->work, lane, it->work);
}

void tvi_crowd_repeat(tvi_crowd *crowd, int lane)
{
    double *array[ARRAYS];
    int rows[ARRAYS];
    list_arrays(&crowd->now, crowd->dimension, array, rows);
    for (int a = 0; a < ARRAYS; a++)
        for (int row = 0; row < rows[a]; row++) array[a][row * crowd->width + lane] = array[a][row * crowd->width];
}

/* Whether row `row` of the lane is bitwise x. */
static bool has_number(const tvi_crowd *crowd, const double *rows, int row, int lane, double x)
{
    return memcmp(&rows[row * crowd->width + lane], &x, sizeof x) == 0;
}

bool tvi_crowd_has(const tvi_crowd *crowd, int lane, double t, const double q[], const double p[])
{
    const int n = crowd->one->system->n;
    bool is_same = has_number(crowd, crowd->now.q, n, lane, t);
    for (int i = 0; i < n && is_same; i++)
        is_same = has_number(crowd, crowd->now.q, i, lane, q[i]) && has_number(crowd, crowd->now.p, i, lane, p[i]);
    return is_same;
}

tvi_status tvi_crowd_begin(tvi_crowd *crowd, int lane, double t, const double q[], const double p[])
{
    if (crowd->continues[lane] && tvi_crowd_has(crowd, lane, t, q, p)) return TVI_OK;
    *crowd->one->continues = false;
    tvi_integrator_lend_parameters(crowd->one, crowd->parameters + lane, crowd->width);
    const tvi_status status = tvi_integrator_begin(crowd->one, t, q, p);
    if (status == TVI_OK) tvi_crowd_put(crowd, lane, crowd->one);
    return status;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* As that of an integrator. */
static tvi_status check_time(double t, double dt, double h)
{
    if (fabs(dt) <= DBL_EPSILON * DBL_EPSILON * fabs(t)) return TVI_ENOCONV;
    return (dt > 0) == (h > 0) ? TVI_OK : TVI_ETOOLARGE;
}

static tvi_status overflow_of(const tvi_crowd *crowd, int lane)
{
    tvi_integrator *one = crowd->one;
    tvi_crowd_get(crowd, lane, one);
    tvi_integrator_lend_parameters(one, crowd->parameters + lane, crowd->width);
    tvi_arena_copy(one->before, one->history, one->marked);
    return tvi_step_overflow(one);
}

/* The lane's step, as the guard sees it. */
static tvi_guarded guarded(const tvi_crowd *crowd, int lane)
{
    const tvi_crowd_end *end = &crowd->end;
    return (tvi_guarded){
        .n = crowd->one->system->n,
        .dimension = crowd->dimension,
        .stride = crowd->width,
        .q = crowd->now.q + lane,
        .p = crowd->now.p + lane,
        .dq = end->by.dq + lane,
        .dp = end->by.dp + lane,
    };
}

static tvi_signs signs_of(const tvi_crowd *crowd, int lane, bool took_series)
{
    const tvi_crowd_end *end = &crowd->end;
    return (tvi_signs){end->tail[lane], end->passes[lane], took_series,
                       crowd->stepper->most_change ? &crowd->change[lane] : NULL};
}

/* Whether the lane's step is one to return, as far as that is seen without its energy. */
static tvi_status judge(const tvi_crowd *crowd, int lane, double h)
{
    const int n = crowd->one->system->n, time = n * crowd->width + lane;
    if (crowd->overflows[lane] != 0) return overflow_of(crowd, lane);
    const tvi_status status = crowd->dimension > n ? check_time(crowd->now.q[time], crowd->end.by.dq[time], h) : TVI_OK;
    return status == TVI_OK ? tvi_guard_tail(crowd->one, crowd->end.tail[lane]) : status;
}

/* The energies of the doubtful lanes at (q, p), where the time is row n of q. */
static void find_energies(tvi_crowd *crowd, const double *q, const double *p, double H[])
{
    tvi_integrator *one = crowd->one;
    const int n = one->system->n, width = crowd->width;
    if (crowd->energy.block) {
        tvi_energy_in_lanes(&crowd->energy, q + n * width, q, p, H);
        return;
    }
    for (int lane = 0; lane < width; lane++) {
        if (!crowd->doubts[lane]) continue;
        for (int i = 0; i <= n; i++) one->end[i] = q[i * width + lane];
        for (int i = 0; i < n; i++) one->end[n + 1 + i] = p[i * width + lane];
        tvi_integrator_lend_parameters(one, crowd->parameters + lane, width);
        const tvi_status status = tvi_energy_of(&one->energy, one->end[n], one->end, one->end + n + 1, &H[lane]);
        if (status != TVI_OK) H[lane] = status == TVI_ENONFINITE ? INFINITY : NAN;
    }
}

static void find_scales(tvi_crowd *crowd)
{
    const double *q = crowd->begun, *p = q + (crowd->one->system->n + 1) * crowd->width;
    find_energies(crowd, q, p, crowd->before);
    for (int lane = 0; lane < crowd->width; lane++) {
        const double H = crowd->before[lane];
        if (crowd->doubts[lane]) tvi_guard_set_scale(&crowd->kept[lane], isfinite(H) ? H : 0);
    }
}

/* Refuses the doubtful lanes whose energy says that they are too large (guard.c). */
static void look_at_energies(tvi_crowd *crowd)
{
    const int width = crowd->width, n = crowd->one->system->n;
    const tvi_crowd_end *end = &crowd->end;
    bool has_scales = true, knows_all = true;
    for (int lane = 0; lane < width; lane++) {
        has_scales = has_scales && (crowd->kept[lane].has_scale || !crowd->doubts[lane]);
        knows_all = knows_all && (crowd->kept[lane].is_known || !crowd->doubts[lane]);
    }
    if (!has_scales) find_scales(crowd);
    if (!knows_all) find_energies(crowd, crowd->now.q, crowd->now.p, crowd->before);
    for (int k = 0; k < (n + 1) * width; k++) crowd->q[k] = crowd->now.q[k] + end->by.dq[k];
    for (int k = 0; k < n * width; k++) crowd->p[k] = crowd->now.p[k] + end->by.dp[k];
    find_energies(crowd, crowd->q, crowd->p, crowd->after);
    for (int lane = 0; lane < width; lane++) {
        tvi_kept_energy *kept = &crowd->kept[lane];
        if (!crowd->doubts[lane]) continue;
        if (!kept->is_known) kept->H = crowd->before[lane];
        const double after = crowd->after[lane];
        const tvi_status status = isnan(after) ? TVI_EDOMAIN : isfinite(after) ? TVI_OK : TVI_ENONFINITE;
        const tvi_guarded s = guarded(crowd, lane);
        if (isfinite(kept->H) && tvi_guard_loses(&s, kept, status, after)) end->status[lane] = TVI_ETOOLARGE;
    }
}

/* Whether the steps of all lanes are to be returned, and no energy is to be looked at: so it is in most steps. */
static bool are_sure(tvi_crowd *crowd, bool took_series)
{
    const tvi_crowd_end *end = &crowd->end;
    const tvi_sure most = tvi_guard_sure(crowd->one);
    double largest = crowd->stats.largest_tail;
    bool any = took_series || crowd->stepper->most_change || crowd->dimension > crowd->one->system->n;
    for (int lane = 0; lane < crowd->width && !any; lane++) {
        const double tail = end->tail[lane];
        const bool is_large = !(tail <= most.tail) | (end->passes[lane] > most.passes) | (crowd->overflows[lane] != 0);
        if (end->status[lane] != TVI_OK) continue;
        any = is_large;
        largest = tvi_larger(tail, largest);
    }
    if (any) return false;
    for (int lane = 0; lane < crowd->width; lane++) crowd->kept[lane].is_known = false;
    crowd->stats.largest_tail = largest;
    return true;
}

/* Sets the status of the lanes whose steps are not to be returned. */
static void check_lanes(tvi_crowd *crowd, double h, bool took_series)
{
    const int width = crowd->width;
    tvi_status *status = crowd->end.status;
    bool any = false;
    if (are_sure(crowd, took_series)) return;
    for (int lane = 0; lane < width; lane++) {
        crowd->doubts[lane] = false;
        if (status[lane] != TVI_OK) continue;
        const tvi_signs signs = signs_of(crowd, lane, took_series);
        crowd->stats.largest_tail = tvi_larger(signs.tail, crowd->stats.largest_tail);
        status[lane] = judge(crowd, lane, h);
        crowd->doubts[lane] = status[lane] == TVI_OK && tvi_guard_asks(crowd->one, &signs, &crowd->kept[lane]);
        any = any || crowd->doubts[lane];
    }
    if (any) look_at_energies(crowd);
}

/* One step; how many lanes have made it. */
static int step(tvi_crowd *crowd, double h)
{
    const int width = crowd->width, rows = crowd->dimension, time = rows * width;
    const tvi_run_state *now = &crowd->now;
    const tvi_crowd_end *end = &crowd->end;
    const tvi_crowd_origin origin = {now->q + time, now->q_low + time, now->q, now->q_low, now->p, now->p_low};
    const long expansions = crowd->stats.expansions;
    int made = 0;
    memcpy(crowd->was, end->status, (size_t)width * sizeof *crowd->was);
    crowd->stepper->step(crowd->work, h, &origin, end, &crowd->stats);
    for (int lane = 0; lane < width; lane++)
        if (end->status[lane] == TVI_ENONFINITE && crowd->was[lane] == TVI_OK)
            end->status[lane] = overflow_of(crowd, lane);
    for (int lane = 0; lane < width; lane++) end->by.dq[time + lane] = h;
    memset(crowd->overflows, 0, (size_t)width * sizeof *crowd->overflows);
    crowd->loops->check(rows + 1, width, now->q, end->by.dq, crowd->overflows);
    crowd->loops->check(rows, width, now->p, end->by.dp, crowd->overflows);
    if (crowd->stepper->most_change) crowd->stepper->most_change(crowd->work, crowd->change);
    check_lanes(crowd, h, crowd->stats.expansions != expansions);
    crowd->loops->advance(rows + 1, width, now->q, now->q_low, end->by.dq, end->by.dq_low, end->status);
    crowd->loops->advance(rows, width, now->p, now->p_low, end->by.dp, end->by.dp_low, end->status);
    for (int lane = 0; lane < width; lane++) {
        if (end->status[lane] == TVI_OK) crowd->continues[lane] = true;
        made += end->status[lane] == TVI_OK;
    }
    return made;
}

void tvi_crowd_steps(tvi_crowd *crowd, double h, long steps)
{
    int made = 1;
    for (long k = 0; k < steps && made > 0; k++) {
        made = step(crowd, h);
        crowd->stats.steps += made;
    }
}
