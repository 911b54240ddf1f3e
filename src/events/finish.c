/* finish.c - Computes the time and the state of an event to roundoff, from a root that search.c has bracketed on the
 * curve of a step. events.c calls it.
 *
 * The curve is less accurate than the states that partial steps of the method compute (inside_step.h). Two such
 * states near the root, at a and b, define a straight line. It differs from the method's solution by about (theta -
 * a) (theta - b) x'' / 2, where x'' is the second derivative of the state by theta. The event is the sign change of
 * g on this line, if the difference is below roundoff there. Otherwise the state at this sign change and that at b
 * define the next line: these are secants, of the solution instead of g. The state of the event is therefore as
 * accurate as that of a step, whatever slope g has. */
#include "events/events.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* [1] The root of the samples' polynomial is used if its distance from the nearest state by a partial step is at most
 * this part of its distance from the nearer end of the bracket. */
#define EVENT_SHORT_CORRECTION 1e-3 /* found: make check-events */

/* Secants multiply the number of correct digits by 1.6: eight lines lead from one correct digit to roundoff. */
enum { MOST_LINES = 8 };

/* The least distance of a line's first two states: a difference quotient over the square root of roundoff has an error
 * of about this size, too. */
static const double FIRST_DISTANCE = 0x1p-26;
/* The largest error of a line, in units in which x'' h^2 is 2: well below roundoff. */
static const double MOST_ERROR = DBL_EPSILON / 16;
/* A sign change of g on a line is looked for in an interval that is four units of roundoff wide on both sides of its
 * estimate, and then in wider ones. Each is 16 times as wide as the one before, so that 12 reach everywhere. */
static const double LEAST_DISTANCE = 4 * DBL_EPSILON, GROWTH = 16;

/* Makes search->line.last the state at theta whose x is in the memory of search->line.before, and which becomes that.
 * Computes *g there. */
static tvi_status add_state(tvi_event_search *search, double theta, bool is_by_curve, double *g)
{
    double *x = search->line.before.x;
    const tvi_status status = tvi_watched_evaluate(search->sought->watched, x, g);
    search->line.before = search->line.last;
    search->line.last = (tvi_accurate_state){.theta = theta, .g = *g, .x = x, .is_by_curve = is_by_curve};
    return status;
}

/* Computes the state at theta by a partial step, and *g there. It becomes search->line.last. ctx is the search. */
static tvi_status add_state_by_partial_step(void *ctx, double theta, double *g)
{
    tvi_event_search *search = ctx;
    double *x = search->line.before.x;
    tvi_status status = tvi_partial_step_compute_state(&search->partial_step, theta * search->integrator->last_step.h);
    if (status != TVI_OK) return status;
    memcpy(x, search->partial_step.state, (size_t)search->state_size * sizeof *x);
    return add_state(search, theta, false, g);
}

/* Computes the state at theta from that of search->line.last and the change of the curve between both, which costs
 * less than a partial step, and *g there. It becomes search->line.last. */
static tvi_status add_state_by_curve(tvi_event_search *search, double theta, double *g)
{
    const tvi_accurate_state *last = &search->line.last;
    const int n = search->integrator->system->n;
    double *x = search->line.before.x, *on_curve = search->scratch_state, *time = &on_curve[2 * n];
    tvi_status status = tvi_evaluate_dense_output(search->integrator, last->theta, time, on_curve, on_curve + n);
    for (int i = 0; i < search->state_size; i++) x[i] = last->x[i] - on_curve[i];
    if (status == TVI_OK) status = tvi_evaluate_dense_output(search->integrator, theta, time, on_curve, on_curve + n);
    for (int i = 0; i < search->state_size; i++) x[i] += on_curve[i];
    return status == TVI_OK ? add_state(search, theta, true, g) : status;
}

/* Computes the state on the line at the given distance (in theta) from search->line.last. */
static void compute_state_on_line(const tvi_event_search *search, double distance, double state[])
{
    const tvi_accurate_state *before = &search->line.before, *last = &search->line.last;
    const double part = distance / (last->theta - before->theta);
    for (int i = 0; i < search->state_size; i++) state[i] = last->x[i] + part * (last->x[i] - before->x[i]);
}

/* Computes *g on the line at the given distance from search->line.last. ctx is the search. */
static tvi_status evaluate_on_line(void *ctx, double distance, double *g)
{
    tvi_event_search *search = ctx;
    compute_state_on_line(search, distance, search->scratch_state);
    return tvi_watched_evaluate(search->sought->watched, search->scratch_state, g);
}

/* ---- Roots ------------------------------------------------------------------------------------------------------- */

/* Evaluates the function at both ends of the bracket. If both values belong to the same side of the sought root, the
 * bracket moves to the neighbouring interval on the other side, until it contains the root or reaches a limit. The
 * first such interval has the given width, and each further one is `growth` times as wide. *has_root tells whether
 * the bracket contains the root. */
static tvi_status move_bracket_to_root(const tvi_event_search *search, tvi_sign_bracket *bracket, double lower_limit,
                                       double upper_limit, double width, double growth,
                                       tvi_bracketed_function *function, void *ctx, bool *has_root)
{
    const tvi_event_root *root = search->sought;
    tvi_status status = function(ctx, bracket->left, &bracket->g_left);
    if (status == TVI_OK) status = function(ctx, bracket->right, &bracket->g_right);
    for (; status == TVI_OK; width *= growth) {
        if (tvi_has_sign_after_root(root, bracket->g_left) && bracket->left > lower_limit) {
            bracket->right = bracket->left, bracket->g_right = bracket->g_left;
            bracket->left = fmax(bracket->left - width, lower_limit);
            status = function(ctx, bracket->left, &bracket->g_left);
        } else if (!tvi_has_sign_after_root(root, bracket->g_right) && bracket->right < upper_limit) {
            bracket->left = bracket->right, bracket->g_left = bracket->g_right;
            bracket->right = fmin(bracket->right + width, upper_limit);
            status = function(ctx, bracket->right, &bracket->g_right);
        } else {
            break;
        }
    }
    *has_root = status == TVI_OK && !tvi_has_sign_after_root(root, bracket->g_left) &&
                tvi_has_sign_after_root(root, bracket->g_right);
    return status;
}

/* Computes the distance from search->line.last to the root on the line. It is NAN if the line has no root inside the
 * step that is no farther than half an interval between samples. */
static tvi_status find_root_on_line(tvi_event_search *search, double *distance)
{
    const tvi_accurate_state *before = &search->line.before, *last = &search->line.last;
    const double farthest = tvi_sample_theta[0] / 2;
    const double least = fmax(-last->theta, -farthest), largest = fmin(1 - last->theta, farthest);
    const double secant = -last->g * (last->theta - before->theta) / (last->g - before->g);
    bool has_root;
    *distance = fabs(secant) <= farthest ? secant : 0;
    tvi_sign_bracket bracket = {.left = tvi_clamp(least, *distance - LEAST_DISTANCE, largest),
                                .right = tvi_clamp(least, *distance + LEAST_DISTANCE, largest)};
    tvi_status status = move_bracket_to_root(search, &bracket, least, largest, GROWTH * LEAST_DISTANCE, GROWTH,
                                             evaluate_on_line, search, &has_root);
    if (has_root && bracket.right - bracket.left <= 2 * LEAST_DISTANCE) return status;
    if (has_root) status = tvi_narrow_bracket(&bracket, DBL_EPSILON / 4, evaluate_on_line, search);
    *distance = has_root ? bracket.right : NAN;
    return status;
}

/* Tells whether a state at state_theta is near theta, an estimate of the root inside its bracket. */
static bool is_near(const tvi_event_search *search, double theta, double state_theta)
{
    const tvi_sign_bracket *bracket = &search->sought->bracket;
    return fabs(state_theta - theta) <= EVENT_SHORT_CORRECTION * fmin(theta - bracket->left, bracket->right - theta);
}

/* Finds two states that define the first line. These are those of the root before, if they are near the root of the
 * samples' polynomial; or else one at this root, and one where the slope of the polynomial leads from there, by the
 * curve if that is accurate enough; or else, if this is not near, one at the root of the curve, and one beside it. */
static tvi_status begin_line(tvi_event_search *search)
{
    const tvi_event_root *root = search->sought;
    const double guess = root->theta_guess;
    tvi_accurate_state *before = &search->line.before, *last = &search->line.last;
    double g = 0;
    tvi_sign_bracket bracket = root->bracket;
    tvi_status status = TVI_OK;
    if (!before->is_by_curve && !last->is_by_curve && fabs(last->theta - before->theta) >= FIRST_DISTANCE &&
        is_near(search, guess, before->theta) && is_near(search, guess, last->theta)) {
        status = tvi_watched_evaluate(root->watched, before->x, &before->g);
        return status == TVI_OK ? tvi_watched_evaluate(root->watched, last->x, &last->g) : status;
    }
    if (isfinite(root->slope_guess)) {
        status = add_state_by_partial_step(search, guess, &g);
        const double correction = -g / root->slope_guess;
        if (status == TVI_OK && is_near(search, guess + correction, guess)) {
            /* A second state beyond the root, at FIRST_DISTANCE, makes the line wrong by the product of both distances,
             * which can be more than roundoff: it is then at the corrected root. */
            const double size = fabs(correction), tail = search->integrator->stats.tail;
            const double distance = size * FIRST_DISTANCE > MOST_ERROR ? size : FIRST_DISTANCE;
            const double second = guess + copysign(distance, correction);
            return tail > 0 && tail * size <= MOST_ERROR ? add_state_by_curve(search, second, &g)
                                                         : add_state_by_partial_step(search, second, &g);
        }
    }
    if (status == TVI_OK)
        status = tvi_narrow_bracket(&bracket, DBL_EPSILON / 2, tvi_watched_evaluate_on_curve, root->watched);
    const double theta = bracket.g_left == 0 ? bracket.left : bracket.right;
    if (status == TVI_OK) status = add_state_by_partial_step(search, theta, &g);
    return status == TVI_OK
               ? add_state_by_partial_step(search, theta + (theta < 0.5 ? FIRST_DISTANCE : -FIRST_DISTANCE), &g)
               : status;
}

/* Finds the root on lines, and sets root->theta and root->state. root->theta remains NAN if a line has no root, or if
 * MOST_LINES lines do not reach roundoff. */
static tvi_status find_root_on_lines(tvi_event_search *search, tvi_event_root *root)
{
    const tvi_accurate_state *before = &search->line.before, *last = &search->line.last;
    tvi_status status = begin_line(search);
    for (int k = 0; k < MOST_LINES && status == TVI_OK; k++) {
        double distance, g;
        status = find_root_on_line(search, &distance);
        if (status != TVI_OK || isnan(distance)) return status;
        const double theta = last->theta + distance, from_before = theta - before->theta;
        const double apart = fmax(fabs(last->theta - before->theta), LEAST_DISTANCE);
        if (fabs(distance * from_before) <= MOST_ERROR && fabs(distance) <= apart) {
            root->theta = theta;
            compute_state_on_line(search, distance, root->state);
            return TVI_OK;
        }
        status = add_state_by_partial_step(search, theta, &g);
    }
    return status;
}

/* Sets root->theta and root->state to those after a partial step. */
static tvi_status set_root_after_partial_step(tvi_event_search *search, tvi_event_root *root, double theta)
{
    double g;
    const tvi_status status = add_state_by_partial_step(search, theta, &g);
    root->theta = theta;
    memcpy(root->state, search->partial_step.state, (size_t)search->state_size * sizeof *root->state);
    return status;
}

/* Finds the root by narrowing the bracket, with one partial step for each value of the function. The bracket contains
 * the root of the curve, and the root that the partial steps have may lie outside. The bracket is therefore moved
 * first, between lower_limit and upper_limit. */
static tvi_status find_root_by_partial_steps(tvi_event_search *search, tvi_event_root *root, tvi_sign_bracket bracket,
                                             double lower_limit, double upper_limit, tvi_bracketed_function *function,
                                             void *ctx)
{
    const double least_width = DBL_EPSILON / 4 * (lower_limit > 0 ? lower_limit : 1);
    bool has_root;
    tvi_status status = move_bracket_to_root(search, &bracket, lower_limit, upper_limit, tvi_sample_theta[0], 1,
                                             function, ctx, &has_root);
    if (!has_root) return status;
    status = tvi_narrow_bracket(&bracket, least_width, function, ctx);
    return status == TVI_OK ? set_root_after_partial_step(search, root, bracket.right) : status;
}

tvi_status tvi_finish_root(tvi_event_search *search, tvi_event_root *root)
{
    const double first = root->watched->theta_after_leaving_zero;
    search->sought = root;
    root->theta = NAN;
    if (root->bracket.left == 0 && root->watched->is_zero_at_step_start) {
        const tvi_sign_bracket bracket = {.left = first, .right = fmax(root->bracket.right, first)};
        return find_root_by_partial_steps(search, root, bracket, first, tvi_sample_theta[TVI_SAMPLES - 2],
                                          tvi_watched_evaluate_change, root->watched);
    }
    if (root->bracket.right == 1 && root->bracket.g_right == 0) return set_root_after_partial_step(search, root, 1);
    const tvi_status status = find_root_on_lines(search, root);
    if (status != TVI_OK || !isnan(root->theta)) return status;
    return find_root_by_partial_steps(search, root, root->bracket, 0, 1, add_state_by_partial_step, search);
}
