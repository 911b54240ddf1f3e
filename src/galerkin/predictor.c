/* predictor.c - Predicts the unknowns of a step from earlier steps (docs/method.md section 5). */
#include "galerkin/galerkin.h"

/* [1] After a step whose first pass moved the unknowns by more than this part, root mean square, the next step is
 * predicted from the last one alone. */
#define GALERKIN_ROUGH_PREDICTION 1e-2 /* found: make longrun */
/* [h] A step follows the last one if it begins less than this from where the last one ended. */
#define GALERKIN_MAX_TIME_GAP 0.25 /* found: make longrun */
/* [1] A step is predicted from the last one if its size, divided by that of the last step, is at most this. */
#define GALERKIN_PREDICTION_MAX_RATIO 1.5 /* found: make longrun */
/* [1] The least such quotient. A step in the opposite direction has a negative one. */
#define GALERKIN_PREDICTION_BACK_RATIO (-2) /* found: make longrun */

void tvi_galerkin_allocate_predictor(galerkin_work *work, tvi_arena *arena)
{
    galerkin_predictor *predictor = &work->predictor;
    const galerkin_nodes *nodes = &work->step.nodes;
    const size_t unknowns = (size_t)nodes->unknown_count, lanes = (size_t)nodes->lane_count;
    predictor->history = tvi_arena_allocate_copied(arena, sizeof *predictor->history);
    for (int i = 0; i < GALERKIN_RING_LENGTH; i++)
        work->step.ring[i] = tvi_arena_allocate_uncopied(arena, unknowns * lanes * sizeof(double));
    work->step.two_step_prediction_table = tvi_arena_allocate_doubles(arena, 2 * lanes * lanes);
    work->step.last_step_prediction_table = tvi_arena_allocate_doubles(arena, lanes * lanes);
    predictor->resized_table = tvi_arena_allocate_doubles(arena, lanes * lanes);
    predictor->rates = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    predictor->zeros = tvi_arena_allocate_doubles(arena, unknowns + lanes);
    predictor->ones = tvi_arena_allocate_doubles(arena, unknowns + lanes);
}

/* Computes the tables that extrapolate two steps and one. For two steps a polynomial of degree 3m/2 needs the fewest
 * passes, with m nodes: a higher degree raises the roundoff of the prediction more than it lowers its truncation
 * error. */
void tvi_galerkin_set_predictor(galerkin_work *work)
{
    galerkin_predictor *predictor = &work->predictor;
    galerkin_step *step = &work->step;
    const int m = step->nodes.node_count, lanes = step->nodes.lane_count, unknowns = step->nodes.unknown_count;
    tvi_galerkin_extrapolation(&work->coefficients, 2, m > 1 ? 3 * m / 2 : 1, work->predicted_by_impulse,
                               work->step.two_step_prediction_table);
    tvi_galerkin_extrapolation(&work->coefficients, 1, m - 1, work->predicted_by_impulse,
                               work->step.last_step_prediction_table);
    step->two_step_max_movement = unknowns * lanes * (GALERKIN_ROUGH_PREDICTION * GALERKIN_ROUGH_PREDICTION);
    for (int i = 0; i < unknowns + lanes; i++) predictor->ones[i] = 1;
}

bool tvi_galerkin_can_predict(const galerkin_work *work, double t, double *elapsed)
{
    const galerkin_history *history = work->predictor.history;
    const double h = work->step.h;
    if (history->last_h == 0) return false;
    const double ratio = h == history->last_h ? 1 : h / history->last_h;
    const bool is_next = fabs(t - (history->last_t + history->last_h)) < GALERKIN_MAX_TIME_GAP * fabs(h);
    *elapsed = is_next ? 1 : 0;
    return ratio <= GALERKIN_PREDICTION_MAX_RATIO &&
           (is_next ? ratio >= GALERKIN_PREDICTION_BACK_RATIO : t == history->last_t && ratio > 0);
}

/* Computes resized_table for a step that is `ratio` times as large as the last one and begins at the fraction `elapsed`
 * of it. In units of the last step the nodes of the new step are at elapsed + ratio c_i. */
static void set_resized_table(galerkin_work *work, double ratio, double elapsed)
{
    galerkin_predictor *predictor = &work->predictor;
    const int m = work->step.nodes.node_count, lanes = work->step.nodes.lane_count;
    const double *b = work->coefficients.b, *c = work->coefficients.c;
    if (ratio == predictor->ratio && elapsed == predictor->elapsed) return;
    predictor->ratio = ratio;
    predictor->elapsed = elapsed;
    const galerkin_curve_points at = {lanes, lanes, m, c, predictor->zeros, predictor->zeros, predictor->ones};
    double place[GALERKIN_MAX_LANES] = {0}, P[GALERKIN_MAX_LANES * GALERKIN_MAX_LANES] = {0};
    for (int i = 0; i < lanes; i++) place[i] = elapsed + ratio * c[i];
    tvi_galerkin_legendre(&work->polynomials, lanes, place, P);
    tvi_galerkin_evaluate(&at, P, work->polynomials.legendre_factor_by_node, predictor->resized_table);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < lanes; i++) predictor->resized_table[j * lanes + i] *= ratio * b[i];
}

galerkin_extrapolation tvi_galerkin_resize_last_step(galerkin_work *work, double elapsed)
{
    galerkin_predictor *predictor = &work->predictor;
    const galerkin_step *step = &work->step;
    const int lanes = step->nodes.lane_count;
    const galerkin_curve_points at = {
        lanes, lanes, step->nodes.unknown_count, step->c, predictor->zeros, predictor->zeros, predictor->ones};
    set_resized_table(work, step->h / predictor->history->last_h, elapsed);
    tvi_galerkin_evaluate(&at, predictor->resized_table, galerkin_ring_at(step, (int)predictor->history->ring_index),
                          predictor->rates);
    return (galerkin_extrapolation){work->predicted_by_impulse, work->predicted_by_impulse, predictor->rates,
                                    predictor->rates, true};
}
