/* springs.c - see springs.h. */
#include "galerkin/step.h"

#include <math.h>
#include <string.h>

/* Steps of fewer passes have little to save. Looks are after so many steps, twice as many each time; modes that were in
 * use for long are worth others. */
enum { LEAST_PASSES = 12, FIRST_WAIT = 2, MOST_WAIT = 1024, LONG_USE = 64 };
enum { DIRECTIONS = 4, GROWTHS = 32, FIRST_BLIND = 2 };
#define STIFF 0x1p-6 /* w^2 of a mode at least, of that of the stiffest one */
#define STAYS 0x1p-3 /* F' changes in a step by this part of it at most */
#define SAVES 0.8    /* the part that is left of what passes cost at most, so that modes are kept at the first look */
#define LESS  1.25   /* passes are more by this factor where the modes have changed */
#define MUCH  0.25   /* where passes without springs leave more than this part of a movement, there are none */

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Of w^2 and v. */
static size_t numbers(const galerkin_field *field)
{
    return (size_t)field->nodes.unknowns * (size_t)(field->nodes.unknowns + 1);
}

/* Of a a, by the growth of a vector that it multiplies again and again. */
static double spectral_radius(const galerkin_coefficients *a)
{
    const int points = a->points;
    double x[TVI_GALERKIN_MAX_LANES], y[TVI_GALERKIN_MAX_LANES], growth = 0;
    for (int i = 0; i < points; i++) x[i] = 1.0 + i;
    for (int k = 0; k < GROWTHS; k++) {
        double size = 0;
        for (int i = 0; i < points; i++) {
            y[i] = 0;
            for (int j = 0; j < points; j++) y[i] += a->matrix[j * a->lanes + i] * a->b[j] * x[j];
            size += fabs(y[i]);
        }
        for (int i = 0; i < points; i++) x[i] = y[i] / size;
        growth += k > 0 ? log(size) : 0;
    }
    return exp(growth / (GROWTHS - 1));
}

void tvi_galerkin_springs_take(galerkin_springs_work *w, tvi_arena *arena, const galerkin_field *field,
                               const tvi_options *options)
{
    const size_t n = (size_t)field->nodes.unknowns, lanes = (size_t)field->nodes.lanes;
    galerkin_springs *of_passes = &w->of_passes;
    *w = (galerkin_springs_work){.last = NULL};
    if (!galerkin_may_have_modes(field) || options->passes != 0) return;
    w->last = tvi_arena_history(arena, sizeof *w->last);
    for (int i = 0; i < GALERKIN_TURNS; i++) w->modes[i] = tvi_arena_turn(arena, numbers(field) * sizeof **w->modes);
    w->of_tables = tvi_arena_doubles(arena, numbers(field));
    w->K = tvi_arena_doubles(arena, n * n);
    w->along = tvi_arena_doubles(arena, n * n);
    w->scratch = tvi_arena_doubles(arena, (1 + 3 * DIRECTIONS) * n);
    of_passes->dual = w->dual = tvi_arena_doubles(arena, n * n);
    of_passes->table = w->table = tvi_arena_doubles(arena, n * lanes * lanes);
    of_passes->r = tvi_arena_doubles(arena, n * lanes);
    of_passes->part = tvi_arena_doubles(arena, n * lanes);
    of_passes->more = tvi_arena_doubles(arena, n * lanes);
    tvi_stiffness_take(&w->stiffness, arena, field->system);
    tvi_factor_take(&w->factor, arena, field->points);
}

void tvi_galerkin_springs_ready(galerkin_springs_work *w, const galerkin_coefficients *coefficients,
                                const galerkin_field *field)
{
    const int n = field->nodes.unknowns;
    const bool is_generated = field->loops->steady;
    w->radius = spectral_radius(coefficients);
    w->is_wanted = !is_generated || galerkin_has_modes(field);
    w->most = is_generated && w->is_wanted && n <= GALERKIN_FEW ? GALERKIN_MODES(n) : n;
}

/* ---- The modes --------------------------------------------------------------------------------------------------- */

/* |a - b|^2 if that is asked for, else |a|^2. */
static double square_of(int count, const double a[], const double b[])
{
    double sum = 0;
    for (int i = 0; i < count; i++) sum += (a[i] - (b ? b[i] : 0)) * (a[i] - (b ? b[i] : 0));
    return sum;
}

/* Whether F' at the origin is what it was a step before, as some directions show, which have a part of each mode. */
static bool stays(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    const galerkin_springs_work *of = &w->springs;
    const int n = w->n, count = DIRECTIONS * n;
    const double h = w->field.h;
    double *before = of->scratch, *along = before + n, *now = along + count, *then = now + count;
    unsigned bits = 1;
    for (int i = 0; i < n; i++) before[i] = origin->q[i] - h / w->field.system->mass[i] * origin->p[i];
    for (int i = 0; i < count; i++) {
        bits = bits * 1664525u + 1013904223u;
        along[i] = bits * 0x1p-31 - 1;
    }
    const int of_now = tvi_stiffness_times(&of->stiffness, origin->t, origin->q, DIRECTIONS, along, now);
    const int of_then = tvi_stiffness_times(&of->stiffness, origin->t - h, before, DIRECTIONS, along, then);
    stats->force_evaluations += of_now + of_then;
    return of_now > 0 && of_then > 0 && square_of(count, now, then) <= STAYS * STAYS * square_of(count, now, NULL);
}

static int next_turn(const galerkin_springs_history *last) { return (last->turn + 1) % GALERKIN_TURNS; }

/* The symmetric part of K, if it is all of it but for what may change in a step. */
static bool make_symmetric(int n, double *K)
{
    double other = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) {
            const double half = (K[i * n + j] - K[j * n + i]) / 2;
            other += 2 * half * half;
            K[i * n + j] = K[j * n + i] = (K[i * n + j] + K[j * n + i]) / 2;
        }
    return other <= STAYS * STAYS * square_of(n * n, K, NULL);
}

/* The stiffest modes at the origin, and those that passes would leave much of, for the next turn; how many. */
static int find(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    const galerkin_springs_work *of = &w->springs;
    const double of_square = w->field.h * w->field.h * of->radius;
    double *square = of->modes[next_turn(of->last)], *mode = square + w->n;
    const int n = w->n;
    double *K = of->K, *along = of->along, *value = of->scratch;
    int count = 0;
    if (!stays(w, origin, stats)) return 0;
    for (int i = 0; i < n * n; i++) along[i] = i / n == i % n;
    const int values = tvi_stiffness_times(&of->stiffness, origin->t, origin->q, n, along, K);
    stats->force_evaluations += values;
    if (values == 0 || !make_symmetric(n, K) || !tvi_eigen(n, K, value, value + n) || !(value[0] < 0)) return 0;
    memset(square, 0, numbers(&w->field) * sizeof *square);
    for (; count < of->most; count++) {
        if (value[count] > STIFF * value[0] && -value[count] * of_square < MUCH / 4) break;
        square[count] = -value[count];
        for (int u = 0; u < n; u++) mode[count * n + u] = K[count * n + u] / sqrt(w->field.system->mass[u]);
    }
    return count;
}

/* Those that were found, or none, from here on; what was learned of the passes is of others. */
static void use(galerkin *w, int count)
{
    galerkin_pace *pace = &w->predictor.last->pace;
    galerkin_springs_history *last = w->springs.last;
    if (count > 0) last->turn = next_turn(last);
    last->count = count;
    last->used = last->first = 0;
    *pace = (galerkin_pace){.first = pace->first, .blind = count > 0 ? FIRST_BLIND : 0};
}

/* D - 1 of mode k, by equations that are regular. */
static void set_table(galerkin *w, int k, double w_square)
{
    galerkin_springs_work *of = &w->springs;
    const galerkin_coefficients *a = &w->coefficients;
    const int points = a->points, lanes = a->lanes;
    const double square = w_square * w->field.h * w->field.h;
    double *lu = of->factor.lu, *table = of->table + k * lanes * lanes;
    for (int i = 0; i < points; i++)
        for (int j = 0; j < points; j++) lu[i * points + j] = (i == j) + square * (a->matrix[j * lanes + i] * a->b[j]);
    const bool is_regular = tvi_factor_compute(&of->factor) == TVI_OK;
    for (int j = 0; j < points; j++) {
        double column[TVI_GALERKIN_MAX_LANES] = {0};
        column[j] = 1;
        if (is_regular) tvi_factor_solve(&of->factor, column);
        column[j] -= 1;
        for (int i = 0; i < lanes; i++) table[j * lanes + i] = column[i < points ? i : points - 1];
    }
}

static void set_tables(galerkin *w)
{
    galerkin_springs_work *of = &w->springs;
    galerkin_springs *passes = &of->of_passes;
    const int n = w->n;
    const double *square = of->modes[of->last->turn], h = w->field.h;
    const size_t bytes = numbers(&w->field) * sizeof *square;
    passes->count = of->last->count;
    passes->mode = square + n;
    if (passes->count == 0 || (of->h == h && memcmp(of->of_tables, square, bytes) == 0)) return;
    for (int k = 0; k < passes->count; k++) set_table(w, k, square[k]);
    for (int i = 0; i < n * n; i++) of->dual[i] = passes->mode[i] * w->field.system->mass[i % n];
    memcpy(of->of_tables, square, bytes);
    of->h = h;
    const double left = square[0] * h * h * of->radius;
    passes->left = left * left;
    passes->always = left > MUCH || w->rule.goal > w->rule.noise;
    passes->least = passes->always ? 0 : w->rule.noise;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* What passes cost with the modes in use, which half of them solve, of what they cost without. */
static double cost(const galerkin *w)
{
    const int n = w->n, points = w->field.points, slots = w->field.system->field_values->slots;
    return 1 + (double)(w->springs.last->count * (2 * n + points)) / (2 * (n * points + slots));
}

/* Of a step that takes so many passes. */
static void seek(galerkin *w, double passes, const tvi_origin *origin, tvi_stats *stats)
{
    galerkin_springs_history *last = w->springs.last;
    const int count = passes >= LEAST_PASSES ? find(w, origin, stats) : 0;
    last->wait = count > 0 ? FIRST_WAIT : fmin(LONG_USE * last->wait, MOST_WAIT);
    if (count > 0 || last->count > 0) use(w, count);
}

/* Modes in use have to save more than they cost, and at first much more: else what is seen would change with units of
 * roundoff. Where they did so for long, and do so less and less, they are others now. */
static void judge(galerkin *w, double passes, const tvi_origin *origin, tvi_stats *stats)
{
    galerkin_springs_history *last = w->springs.last;
    const bool saves = passes * cost(w) < (last->first == 0 ? SAVES : 1) * last->plain;
    last->wait = fmin(2 * last->wait, MOST_WAIT);
    if (last->first == 0) last->first = passes;
    if (saves && passes < LESS * last->first) return;
    if (last->used >= LONG_USE) {
        last->wait = FIRST_WAIT;
        seek(w, last->plain, origin, stats);
    } else if (!saves) {
        last->wait = MOST_WAIT;
        use(w, 0);
    }
}

static void look(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    galerkin_springs_history *last = w->springs.last;
    const double passes = last->passes / last->steps;
    last->steps = last->passes = 0;
    if (last->count > 0) {
        judge(w, passes, origin, stats);
    } else {
        last->plain = passes;
        seek(w, passes, origin, stats);
    }
}

void tvi_galerkin_springs_prepare(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    galerkin_springs_history *last = w->springs.last;
    const double h = w->field.h;
    if (last->h != h) {
        const bool are_stiff = w->springs.modes[last->turn][0] * h * h * w->springs.radius > MUCH / 4;
        if (last->count > 0 && !are_stiff) use(w, 0);
        last->h = h;
        last->steps = last->passes = last->first = 0;
        last->plain = INFINITY;
        last->wait = FIRST_WAIT;
    }
    if (w->springs.is_wanted && last->steps >= last->wait) look(w, origin, stats);
    set_tables(w);
}

long tvi_galerkin_springs_until(const galerkin *w, long steps)
{
    const galerkin_springs_history *last = w->springs.last;
    if (!last || !w->springs.is_wanted) return steps;
    const double left = last->wait - last->steps;
    return left < 1 ? 1 : left < (double)steps ? (long)left : steps;
}

bool tvi_galerkin_springs_turn(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    galerkin_springs_history *last = w->springs.last;
    if (!last) return false;
    const bool are_new = last->count > 0 && last->used == 0;
    const int count = are_new ? 0 : find(w, origin, stats);
    if (count == 0 && last->count == 0) return false;
    last->plain = INFINITY;
    last->steps = last->passes = 0;
    last->wait = are_new ? MOST_WAIT : FIRST_WAIT;
    use(w, count);
    set_tables(w);
    return true;
}

void tvi_galerkin_springs_forget(galerkin *w)
{
    if (w->springs.last) *w->springs.last = (galerkin_springs_history){0};
}
