/* finder.c - Computes the time and the state of an event to roundoff, for locate.c.
 *
 * The search (search.h) has found a root on the curve of the step. Near this root a partial step of the method
 * (partial_step.h) gives an accurate state. The straight line through this state, with the slope of the curve, agrees
 * with the method's solution to roundoff over a short distance. The event is the sign change of g on this line. The
 * state of the event is as accurate as that of a step, whatever slope g has. */
#include "events/finder.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [lines] A root is searched on at most this many lines. */
#define EVENT_MAX_LINES 5 /* found: make check-events */
/* [h] A straight line replaces the solution up to this distance. */
#define EVENT_LINE_MAX_LENGTH 2e-9 /* found: make check-events */
/* [h] Half the distance of the two points of a difference quotient. */
#define EVENT_CHORD 1e-5 /* found: make check-events */
/* [1] The slope of a line has this many times the curve's error. */
#define EVENT_SLOPE_ERROR 32.0 /* found: make check-events */
/* [h] A correction of theta is short if it is at most EVENT_SHORT_CORRECTION, and at most EVENT_SHORT_CORRECTION_PART
 * of the distance from the corrected theta to the nearer end of the bracket. */
#define EVENT_SHORT_CORRECTION      1e-6 /* found: make check-events */
#define EVENT_SHORT_CORRECTION_PART 1e-3 /* found: make check-events */
/* [h] Near an event the solution is replaced by a straight line through one of its states, the origin of the line
 * (finder.h). An estimated root of g on the line lies in a small bracket, whose ends move outwards until g changes its
 * sign. A bracket's ends are first this far from the estimated root. */
#define EVENT_SURE_DISTANCE 0x1p-50 /* found: make check-events */
/* [1] Each next move of a bracket's end is this many times as long. */
#define EVENT_BRACKET_GROWTH 16.0 /* found: make check-events */
/* [h] An end of a bracket is at most this far from the line's origin. */
#define EVENT_BRACKET_MAX_DISTANCE (1.0 / 16) /* found: make check-events */

tvi_status tvi_finder_open(tvi_event_finder *finder, tvi_event_search *search)
{
    const tvi_integrator *it = search->integrator;
    const int size = 2 * it->system->n + 1;
    *finder = (tvi_event_finder){
        .search = search, .state_size = size, .line_origin = calloc((size_t)size * 4, sizeof *finder->line_origin)};
    if (!finder->line_origin) return TVI_ENOMEM;
    finder->line_direction = finder->line_origin + size;
    finder->chord_midpoint = finder->line_direction + size;
    finder->scratch_state = finder->chord_midpoint + size;
    return tvi_state_rates_open(&finder->rates_evaluator, it->system, it->parameters);
}

void tvi_finder_close(tvi_event_finder *finder)
{
    tvi_state_rates_close(&finder->rates_evaluator);
    free(finder->line_origin);
}

/* Estimates derivatives at theta by difference quotients over a chord of the curve, between two states x:
 * finder->line_direction becomes dx/dtheta, finder->chord_midpoint the midpoint of the chord, *dg_dtheta the derivative
 * dg/dtheta, and *theta_distance_to_zero the distance from theta to the zero of g. */
static tvi_status estimate_chord_slopes(tvi_event_finder *finder, int event_index, double theta, double *dg_dtheta,
                                        double *theta_distance_to_zero)
{
    const double a = fmax(theta - EVENT_CHORD, 0), b = fmin(theta + EVENT_CHORD, 1);
    double ga = 0, gb = 0;
    tvi_status status = tvi_search_compute_curve_state(finder->search, a, finder->line_direction);
    if (status == TVI_OK) status = tvi_search_evaluate_event(finder->search, event_index, finder->line_direction, &ga);
    if (status == TVI_OK) status = tvi_search_compute_curve_state(finder->search, b, finder->chord_midpoint);
    if (status == TVI_OK) status = tvi_search_evaluate_event(finder->search, event_index, finder->chord_midpoint, &gb);
    *dg_dtheta = (gb - ga) / (b - a);
    *theta_distance_to_zero = -(ga + gb) / (2 * *dg_dtheta);
    for (int i = 0; i < finder->state_size; i++) {
        const double low = finder->line_direction[i], high = finder->chord_midpoint[i];
        finder->line_direction[i] = (high - low) / (b - a);
        finder->chord_midpoint[i] = (low + high) / 2;
    }
    /* If both ends a and b of the chord are inside the step, 0 < a and b < 1, the slope is a central difference, whose
     * error is proportional to EVENT_CHORD^2. Otherwise it is one-sided, with an error proportional to EVENT_CHORD. */
    finder->is_chord_inside_step = a > 0 && b < 1;
    return status;
}

/* Tells whether the search has estimated the root, and the estimate lies inside the bracket, away from its ends. */
static bool is_theta_guess_inside_bracket(const tvi_event_root *root)
{
    return root->theta_guess > root->bracket.left + EVENT_CHORD &&
           root->theta_guess < root->bracket.right - EVENT_CHORD;
}

/* Tells whether a correction of theta is short, in itself and in relation to the distance of the corrected theta from
 * the ends of the root's bracket. */
static bool is_theta_correction_short(const tvi_event_root *root, double theta, double correction)
{
    return fabs(correction) <=
           fmin(EVENT_SHORT_CORRECTION, EVENT_SHORT_CORRECTION_PART * fmin(theta + correction - root->bracket.left,
                                                                           root->bracket.right - (theta + correction)));
}

/* Returns the largest difference between finder->chord_midpoint, which represents the curve, and finder->line_origin in
 * the component_count components from first_component on, divided by the largest of these components. */
static double relative_curve_error(const tvi_event_finder *finder, int first_component, int component_count)
{
    double apart = 0, size = 0;
    for (int i = first_component; i < first_component + component_count; i++) {
        apart = fmax(apart, fabs(finder->line_origin[i] - finder->chord_midpoint[i]));
        size = fmax(size, fabs(finder->line_origin[i]));
    }
    return tvi_ratio_or_zero(apart, size);
}

/* Returns the difference between the time t of finder->line_origin and the time of finder->chord_midpoint, which
 * represents the curve, divided by |t| + |dt/dtheta|. */
static double relative_curve_time_error(const tvi_event_finder *finder)
{
    const int t = finder->state_size - 1;
    return tvi_ratio_or_zero(fabs(finder->line_origin[t] - finder->chord_midpoint[t]),
                             fabs(finder->line_origin[t]) + fabs(finder->line_direction[t]));
}

/* Sets finder->line_origin to the state that the last partial step has computed, which lies at theta. */
static void set_chord_origin(tvi_event_finder *finder, double theta)
{
    tvi_partial_step_copy_state(finder->search->partial_step, finder->line_origin);
    finder->line_origin_theta = theta;
}

/* ---- Lines with the slope of a chord of the curve ---------------------------------------------------------------- */

/* Computes the state [2n + 1] on the line, state = line_origin + theta_from_line_origin line_direction. */
static void compute_state_on_line(const tvi_event_finder *finder, double theta_from_line_origin, double state[])
{
    for (int i = 0; i < finder->state_size; i++)
        state[i] = finder->line_origin[i] + theta_from_line_origin * finder->line_direction[i];
}

/* The context argument of the functions that tvi_narrow_bracket calls: the event whose function they evaluate. */
typedef struct {
    tvi_event_finder *finder;
    int event_index;
} finder_event_context;

static tvi_status evaluate_event_at_line_distance(void *ctx, double distance, double *g)
{
    const finder_event_context *context = ctx;
    compute_state_on_line(context->finder, distance, context->finder->scratch_state);
    return tvi_search_evaluate_event(context->finder->search, context->event_index, context->finder->scratch_state, g);
}

/* Evaluates the function g at both ends of the bracket. If both values belong to the same side of the root, the bracket
 * moves to the neighbouring interval on the other side, until it contains the root or reaches lower_limit or
 * upper_limit. The first such interval has the width next_width, and each further one is width_growth times as wide.
 * *has_root tells whether the bracket contains the root. */
static tvi_status move_bracket_to_root(const tvi_event_root *root, tvi_sign_bracket *bracket, double lower_limit,
                                       double upper_limit, double next_width, double width_growth,
                                       tvi_bracketed_function *function, void *ctx, bool *has_root)
{
    tvi_status status = function(ctx, bracket->left, &bracket->g_left);
    if (status == TVI_OK) status = function(ctx, bracket->right, &bracket->g_right);
    for (; status == TVI_OK && tvi_has_sign_after_root(root, bracket->g_left) && bracket->left > lower_limit;
         next_width *= width_growth) {
        bracket->right = bracket->left, bracket->g_right = bracket->g_left;
        bracket->left = fmax(bracket->left - next_width, lower_limit);
        status = function(ctx, bracket->left, &bracket->g_left);
    }
    for (; status == TVI_OK && !tvi_has_sign_after_root(root, bracket->g_right) && bracket->right < upper_limit;
         next_width *= width_growth) {
        bracket->left = bracket->right, bracket->g_left = bracket->g_right;
        bracket->right = fmin(bracket->right + next_width, upper_limit);
        status = function(ctx, bracket->right, &bracket->g_right);
    }
    *has_root = status == TVI_OK && !tvi_has_sign_after_root(root, bracket->g_left) &&
                tvi_has_sign_after_root(root, bracket->g_right);
    return status;
}

/* Computes the distance (in theta) from finder->line_origin to the root on the line. Sets finder->has_root_on_line to
 * true if the line has a root inside the step at a distance of at most EVENT_BRACKET_MAX_DISTANCE. g is the value at
 * finder->line_origin. `slope` is an estimate of the derivative of g along the line, which need not be accurate. */
static tvi_status find_root_on_line(tvi_event_finder *finder, const tvi_event_root *root, double g, double slope,
                                    double *distance)
{
    finder_event_context context = {finder, root->event_index};
    const double least = fmax(-finder->line_origin_theta, -EVENT_BRACKET_MAX_DISTANCE),
                 largest = fmin(1 - finder->line_origin_theta, EVENT_BRACKET_MAX_DISTANCE), first = -g / slope;
    double next;
    *distance = fabs(first) <= EVENT_BRACKET_MAX_DISTANCE ? first : 0;
    tvi_status status = evaluate_event_at_line_distance(&context, *distance, &next);
    if (status != TVI_OK) return status;
    const double second = *distance - next / slope;
    if (fabs(next) < fabs(g) && fabs(second) <= EVENT_BRACKET_MAX_DISTANCE) *distance = second;
    tvi_sign_bracket bracket = {.left = fmin(fmax(*distance - EVENT_SURE_DISTANCE, least), largest),
                                .right = fmin(fmax(*distance + EVENT_SURE_DISTANCE, least), largest)};
    status = move_bracket_to_root(root, &bracket, least, largest, EVENT_BRACKET_GROWTH * EVENT_SURE_DISTANCE,
                                  EVENT_BRACKET_GROWTH, evaluate_event_at_line_distance, &context,
                                  &finder->has_root_on_line);
    if (!finder->has_root_on_line || bracket.right - bracket.left <= 2 * EVENT_SURE_DISTANCE) return status;
    status = tvi_narrow_bracket(&bracket, DBL_EPSILON / 4, evaluate_event_at_line_distance, &context);
    *distance = bracket.right;
    return status;
}

/* Sets the event's theta and state to those at the given distance from finder->line_origin on the line. */
static void set_event_state_on_line(const tvi_event_finder *finder, tvi_event_root *root, double distance,
                                    double state[])
{
    root->theta = finder->line_origin_theta + distance;
    compute_state_on_line(finder, distance, state);
}

/* Sets root->theta to the given theta, and computes the event's state there by a partial step. */
static tvi_status set_event_state_by_partial_step(tvi_event_finder *finder, tvi_event_root *root, double theta,
                                                  double state[])
{
    const tvi_status status =
        tvi_partial_step_compute_state(finder->search->partial_step, theta * finder->search->integrator->h);
    set_chord_origin(finder, theta);
    if (status == TVI_OK) set_event_state_on_line(finder, root, 0, state);
    return status;
}

/* Computes the state at theta by a partial step, and begins a line there. finder->accurate_distance becomes the
 * distance over which an error of the line's slope stays below roundoff. */
static tvi_status begin_line_at_theta(tvi_event_finder *finder, double theta)
{
    const int n = finder->search->integrator->system->n;
    const tvi_status status =
        tvi_partial_step_compute_state(finder->search->partial_step, theta * finder->search->integrator->h);
    if (status != TVI_OK) return status;
    set_chord_origin(finder, theta);
    const double apart = fmax(fmax(relative_curve_error(finder, 0, n), relative_curve_error(finder, n, n)),
                              relative_curve_time_error(finder));
    finder->accurate_distance =
        finder->is_chord_inside_step ? fmin(EVENT_LINE_MAX_LENGTH, DBL_EPSILON / (8 * EVENT_SLOPE_ERROR) / apart) : 0;
    return TVI_OK;
}

static tvi_status evaluate_after_partial_step(void *ctx, double theta, double *g)
{
    const finder_event_context *context = ctx;
    tvi_event_finder *finder = context->finder;
    const tvi_status status = begin_line_at_theta(finder, theta);
    return status == TVI_OK ? tvi_search_evaluate_event(finder->search, context->event_index, finder->line_origin, g)
                            : status;
}

/* Finds the root by narrowing the bracket, with one partial step for each value of the function, and sets the event to
 * the root. The bracket contains the root of the curve, and the root that the partial steps have may lie outside. The
 * bracket is therefore moved first, between lower_limit and theta = 1. */
static tvi_status find_event_by_partial_steps(tvi_event_finder *finder, tvi_event_root *root,
                                              tvi_bracketed_function *function, tvi_sign_bracket bracket,
                                              double lower_limit, double least_width, double state[])
{
    finder_event_context context = {finder, root->event_index};
    bool has_root;
    tvi_status status =
        move_bracket_to_root(root, &bracket, lower_limit, 1, tvi_sample_theta[0], 1, function, &context, &has_root);
    root->is_absent_from_accurate_solution = status == TVI_OK && !has_root;
    if (!has_root) return status;
    status = tvi_narrow_bracket(&bracket, least_width, function, &context);
    return status == TVI_OK ? set_event_state_by_partial_step(finder, root, bracket.right, state) : status;
}

/* Finds the root on the curve first, and then on straight lines with the slope of a chord of the curve. Each line
 * begins at the theta of the root on the line before. The iteration ends when two successive roots are near each
 * other. */
static tvi_status find_event_on_chord_lines(tvi_event_finder *finder, tvi_event_root *root, double state[])
{
    double theta = root->theta_guess, g = 0, slope, distance = 0, distance_to_zero = 0;
    tvi_status status = TVI_OK;
    if (is_theta_guess_inside_bracket(root))
        status = estimate_chord_slopes(finder, root->event_index, theta, &slope, &distance_to_zero);
    if (status == TVI_OK && is_theta_guess_inside_bracket(root) &&
        is_theta_correction_short(root, theta, distance_to_zero))
        theta += distance_to_zero;
    else if (status == TVI_OK) status = tvi_search_find_curve_root(finder->search, root, &theta);
    for (int k = 0; k < EVENT_MAX_LINES && status == TVI_OK; k++) {
        status = estimate_chord_slopes(finder, root->event_index, theta, &slope, &distance_to_zero);
        if (status == TVI_OK)
            status = evaluate_after_partial_step(&(finder_event_context){finder, root->event_index}, theta, &g);
        if (status == TVI_OK) status = find_root_on_line(finder, root, g, slope, &distance);
        if (status != TVI_OK) return status;
        if (!finder->has_root_on_line) break;
        if (fabs(distance) <= fmax(finder->accurate_distance, DBL_EPSILON)) {
            set_event_state_on_line(finder, root, distance, state);
            return TVI_OK;
        }
        theta = fmin(fmax(theta + distance, 0), 1);
    }
    return status == TVI_OK ? find_event_by_partial_steps(finder, root, evaluate_after_partial_step, root->bracket, 0,
                                                          DBL_EPSILON / 4, state)
                            : status;
}

/* ---- Lines along the time derivatives ---------------------------------------------------------------------------- */

/* Sets finder->line_direction to dx/dtheta at a state x = (q, p, t): h times (dq/dt, dp/dt, 1). */
static tvi_status set_line_direction_to_rates(tvi_event_finder *finder, const double state[])
{
    const int last = finder->state_size - 1;
    const double h = finder->search->integrator->h;
    const tvi_status status = tvi_state_rates_compute(&finder->rates_evaluator, state, finder->line_direction);
    for (int i = 0; i < last; i++) finder->line_direction[i] *= h;
    finder->line_direction[last] = h;
    return status;
}

/* Finds the event by a single partial step, to root->theta_guess, and a line from the state there in the direction of
 * its time derivatives. If the root is farther from this state than EVENT_LINE_MAX_LENGTH, the time derivatives are
 * computed again halfway to the root. *is_accurate tells whether the computed event is accurate to roundoff; otherwise
 * another method must compute it. */
static tvi_status find_event_on_rate_line(tvi_event_finder *finder, tvi_event_root *root, double state[],
                                          bool *is_accurate)
{
    finder_event_context context = {finder, root->event_index};
    double g = 0, before = 0, after = 0, found = 0;
    const double h = finder->search->integrator->h;
    tvi_status status = tvi_partial_step_compute_state(finder->search->partial_step, root->theta_guess * h);
    if (status != TVI_OK) return status;
    set_chord_origin(finder, root->theta_guess);
    status = set_line_direction_to_rates(finder, finder->line_origin);
    if (status == TVI_OK)
        status = tvi_search_evaluate_event(finder->search, root->event_index, finder->line_origin, &g);
    if (status == TVI_OK) status = evaluate_event_at_line_distance(&context, -EVENT_CHORD, &before);
    if (status == TVI_OK) status = evaluate_event_at_line_distance(&context, EVENT_CHORD, &after);
    const double slope = (after - before) / (2 * EVENT_CHORD), distance = -g / slope;
    const double tail = fmax(finder->search->integrator->stats.tail,
                             finder->search->partial_step->partial_step_integrator->stats.tail),
                 error = tail * tail;
    if (status != TVI_OK ||
        !(fabs(distance) * error <= DBL_EPSILON / 8 && is_theta_correction_short(root, root->theta_guess, distance)))
        return status;
    if (fabs(distance) > EVENT_LINE_MAX_LENGTH) {
        compute_state_on_line(finder, distance / 2, finder->scratch_state);
        status = set_line_direction_to_rates(finder, finder->scratch_state);
    }
    if (status == TVI_OK) status = find_root_on_line(finder, root, g, slope, &found);
    if (status == TVI_OK) set_event_state_on_line(finder, root, found, state);
    *is_accurate = status == TVI_OK && finder->has_root_on_line && fabs(found - distance) <= EVENT_LINE_MAX_LENGTH &&
                   tvi_all_finite(finder->state_size, state);
    return status;
}

/* Tells whether a line in the direction of the time derivatives (dq/dt, dp/dt) is accurate enough. The line is accurate
 * for methods whose solution differs from that of the differential equations only by the square of the tail
 * (tvi_stats.tail). */
static bool is_line_along_rates_accurate(const tvi_event_finder *finder)
{
    const tvi_integrator *it = finder->search->integrator;
    return finder->rates_evaluator.field_block && !tvi_is_rescaled(it) && it->stepper->is_superconvergent &&
           it->options.degree > 1;
}

/* ---- Events ------------------------------------------------------------------------------------------------------ */

/* Computes (g(theta) - g(0)) / theta, for a step that begins on the event, where g(0) = 0. This quotient is nearly
 * linear in theta if theta is small. */
static tvi_status compute_g_change_per_theta(void *ctx, double theta, double *g_change_over_theta)
{
    const finder_event_context *context = ctx;
    double g_change = 0;
    bool known;
    const tvi_status status =
        tvi_compute_g_change_from_start(context->finder->search, context->event_index, theta, &g_change, &known);
    *g_change_over_theta = g_change / theta;
    return status;
}

tvi_status tvi_finder_find_event(tvi_event_finder *finder, tvi_event_root *root, double state[])
{
    bool is_accurate = false;
    tvi_status status = TVI_OK;
    if (root->is_return_to_zero) {
        const double first = finder->search->watched_events[root->event_index].theta_after_leaving_zero;
        const tvi_sign_bracket bracket = {.left = first, .right = fmax(root->bracket.right, first)};
        return find_event_by_partial_steps(finder, root, compute_g_change_per_theta, bracket, first,
                                           DBL_EPSILON / 4 * first, state);
    }
    if (root->bracket.right == 1 && root->bracket.g_right == 0)
        return set_event_state_by_partial_step(finder, root, 1, state);
    if (is_theta_guess_inside_bracket(root) && is_line_along_rates_accurate(finder))
        status = find_event_on_rate_line(finder, root, state, &is_accurate);
    return is_accurate || status != TVI_OK ? status : find_event_on_chord_lines(finder, root, state);
}
