/* linear_prediction.c - see linear_prediction.h. */
#include "galerkin/linear_prediction.h"

#include <math.h>
#include <string.h>

/* Drives that are there for each coefficient. What fitting costs are some steps, the more the fewer unknowns they have:
 * so many are made before it. */
enum { MAX_LANES = TVI_GALERKIN_MAX_LANES, EXCESS = 3, WAIT = 384, NEXT_WAIT = 3, MOST_WAIT = 4096 };
/* Steps of fewer passes have none to save, and of more unknowns the impulses of some steps are more than what else an
 * integrator keeps. */
enum { MOST_UNKNOWNS = 64 };
#define LEAST_PASSES 3.5
#define GAIN         5.0
/* Passes of generated code of the fewest unknowns take less time than a step whose end no processor foresees, as more
 * steps are where passes are few: fits are made later, and have to save more than one pass. */
enum { SHORT_WAIT = 8 };
#define SHORT_GAIN 1000.0

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Of a window. */
static int samples_of(const galerkin_field *field)
{
    const int drives = EXCESS * 2 * field->points, of_window = REGRESSION_WINDOWS * field->nodes.unknowns;
    return (drives + of_window - 1) / of_window;
}

static bool is_fitted(const galerkin_field *field, const tvi_options *options)
{
    return options->passes == 0 && field->nodes.unknowns <= MOST_UNKNOWNS;
}

int tvi_galerkin_linear_prediction_turns(const galerkin_field *field, const tvi_options *options)
{
    return is_fitted(field, options) ? samples_of(field) + GALERKIN_TURNS : GALERKIN_TURNS;
}

static galerkin_regress *const regress_of[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_galerkin_regress_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_galerkin_regress_avx2,
    [jet_isa_avx512] = tvi_galerkin_regress_avx512,
#endif
};

void tvi_galerkin_linear_prediction_take(galerkin_linear_prediction *w, tvi_arena *arena, const galerkin_field *field,
                                         const tvi_options *options)
{
    const size_t lanes = (size_t)field->nodes.lanes, unknowns = (size_t)field->nodes.unknowns;
    const size_t samples = (size_t)samples_of(field), windows = REGRESSION_WINDOWS;
    galerkin_regression *of = &w->regression;
    *w = (galerkin_linear_prediction){.last = NULL};
    if (!is_fitted(field, options)) return;
    w->last = tvi_arena_history(arena, sizeof *w->last);
    w->windows = tvi_arena_turn(arena, windows * (samples + 2) * unknowns * lanes * sizeof *w->windows);
    for (int i = 0; i < 2; i++)
        w->tables[i] = tvi_arena_turn(arena, tvi_galerkin_table_size(field->nodes.lanes) * sizeof **w->tables);
    w->regress = regress_of[field->system->field_values->sweeps->isa];
    of->lanes = field->nodes.lanes;
    of->unknowns = field->nodes.unknowns;
    of->samples = (int)samples;
    of->halves = field->nodes.unknowns / field->system->n;
    of->scale = field->nodes.scale;
    of->weight = tvi_arena_doubles(arena, unknowns);
    of->per_weight = tvi_arena_doubles(arena, lanes);
    of->basis = tvi_arena_doubles(arena, 2 * lanes * 2 * lanes);
    of->ahead = tvi_arena_doubles(arena, 2 * lanes * lanes);
    of->of_last = tvi_arena_doubles(arena, lanes * lanes);
    of->rise = tvi_arena_doubles(arena, lanes * lanes);
    of->sample = tvi_arena_doubles(arena, windows * samples * unknowns * 3 * lanes);
    of->gram = tvi_arena_doubles(arena, 2 * lanes * 2 * lanes);
    of->factor = tvi_arena_doubles(arena, 2 * lanes * lanes);
    const bool is_short =
        field->loops->steady && galerkin_is_second_order(field) && field->nodes.unknowns <= GALERKIN_FEWEST;
    of->gain = is_short ? SHORT_GAIN : GAIN;
    w->first_wait = fmax(2 * (of->samples + 2), (is_short ? SHORT_WAIT : 1) * (double)WAIT / of->unknowns);
}

void tvi_galerkin_linear_prediction_prepare(galerkin_linear_prediction *w, const galerkin_coefficients *a,
                                            const galerkin_field *field)
{
    long double basis[2 * MAX_LANES][3 * MAX_LANES], ahead[2 * MAX_LANES][MAX_LANES];
    const galerkin_regression *of = &w->regression;
    const int m = a->points, lanes = a->lanes;
    if (!w->last) return;
    for (int i = 0; i < m; i++) of->per_weight[i] = 1 / a->b[i];
    for (int i = 0; i < m * lanes; i++) of->rise[i] = a->b[i / lanes] * field->ahead[i];
    tvi_galerkin_set_ahead(a, 1, m - 1, ahead);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) of->of_last[j * lanes + i] = (double)ahead[j][i];
    tvi_galerkin_set_basis(a, 2 * m, 2 * m - 1, basis);
    for (int k = 0; k < 2 * m; k++) {
        for (int i = 0; i < 2 * m; i++) of->basis[(i / m * lanes + i % m) * 2 * lanes + k] = (double)basis[k][i];
        if (k > tvi_galerkin_degree(m)) continue;
        for (int i = 0; i < m; i++) of->ahead[k * lanes + i] = (double)basis[k][2 * m + i];
    }
}

/* ---- The fit ----------------------------------------------------------------------------------------------------- */

/* Windows are kept in the second half of the time until coefficients are fitted, the last one at its end. */
static double next_window(const galerkin_fitting *last)
{
    const int left = REGRESSION_WINDOWS - 1 - last->windows;
    return ceil(last->wait - (last->wait - last->from) * left / (2 * (REGRESSION_WINDOWS - 1)));
}

void tvi_galerkin_linear_prediction_start(galerkin_linear_prediction *w, double h)
{
    galerkin_fitting *last = w->last;
    *last = (galerkin_fitting){
        .h = h, .wait = w->first_wait, .plain = INFINITY, .fitted = last->fitted, .turn = last->turn};
    last->next = next_window(last);
}

static void wait_again(galerkin_fitting *last)
{
    last->windows = 0;
    last->passes = 0;
    last->from = last->steps;
    last->wait = last->steps + fmin(NEXT_WAIT * last->steps, MOST_WAIT);
}

static void keep_window(galerkin_linear_prediction *w, const galerkin_predictor *predictor)
{
    const int steps = w->regression.samples + 2, numbers = w->regression.unknowns * w->regression.lanes;
    double *to = w->windows + w->last->windows++ * steps * numbers;
    for (int k = 0; k < steps; k++, to += numbers)
        memcpy(to, tvi_galerkin_impulses(predictor, -k), (size_t)numbers * sizeof *to);
}

/* Coefficients that do not save passes are given up, else others are fitted. */
static void fit(galerkin_linear_prediction *w, const galerkin_coefficients *a, const galerkin_field *field)
{
    galerkin_fitting *last = w->last;
    const int turn = 1 - last->turn;
    const double passes = last->passes / (last->steps - last->from);
    const bool was_fitted = last->fitted == last->h;
    last->fitted = 0;
    if (!was_fitted) last->plain = passes;
    if (was_fitted && passes >= last->plain) return;
    if (!w->regress(&w->regression, w->windows, w->tables[turn])) return;
    tvi_galerkin_set_following(a, field, w->tables[turn]);
    last->turn = turn;
    last->fitted = last->h;
}

void tvi_galerkin_linear_prediction_look(galerkin_linear_prediction *w, const galerkin_predictor *predictor,
                                         const galerkin_coefficients *a, const galerkin_field *field)
{
    galerkin_fitting *last = w->last;
    const bool may_save =
        last->windows > 0 || last->fitted == last->h || last->passes >= LEAST_PASSES * (last->steps - last->from);
    if (may_save) keep_window(w, predictor);
    const bool is_full = last->windows == REGRESSION_WINDOWS;
    if (is_full) fit(w, a, field);
    if (is_full || !may_save) wait_again(last);
    last->next = next_window(last);
}
