/* galerkin.c - Makes steps of the Galerkin curve: free values at m Gauss nodes, which is Gauss collocation
 * (docs/method.md section 4). With a, b, c its coefficients and F_j the field at node j,
 *    separable:    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *                  q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 *    otherwise:    (Q, P)_i = (q0, p0) + h sum_j a_ij (V, F)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (V, F)_j,
 * with (V, F) = (H_p, -H_q), or L_v(Q, V) = P and F = L_q (field.h). Passes solve these equations. They begin with a
 * prediction from earlier steps. The nodes are lanes of one sweep of the field's tape. */
#include "compiled/code.h"
#include "galerkin/step.h"

#include <math.h>
#include <string.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static int lanes_for(int points)
{
    int lanes = 1;
    while (lanes < points && lanes < 8) lanes *= 2;
    return points <= lanes ? lanes : MAX_LANES;
}

/* The index of the loops for this number of lanes. */
static int loops_index(int lanes)
{
    int index = 0;
    while (1 << index < lanes) index++;
    return index;
}

/* The loops of the instruction set that the system's tapes run with. */
static const galerkin_loops *const *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_galerkin_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_galerkin_loops_avx2,
    [jet_isa_avx512] = tvi_galerkin_loops_avx512,
#endif
};

static const galerkin_form *form_of(const tvi_system *system)
{
    return !system->hessian_values          ? &tvi_galerkin_form_plain
           : system->form == TVI_LAGRANGIAN ? &tvi_galerkin_form_lagrangian
           : system->hessian_is_complete    ? &tvi_galerkin_form_hamiltonian
                                            : &tvi_galerkin_form_product;
}

bool tvi_galerkin_is_plain(const tvi_system *system) { return form_of(system) == &tvi_galerkin_form_plain; }

/* Counts the last coordinates that H does not depend on, as the time of a rescaled system whose forces do not depend on
 * it. Such a coordinate is a quadrature, which needs no movement, and its momentum does not move. */
static int cyclic_at_end(const tvi_system *system)
{
    const int *force = system->field_values->output;
    int count = 0;
    if (system->form != TVI_HAMILTONIAN) return 0;
    while (count < system->n && jet_tape_is_slot_zero(system->field_values, force[system->n - 1 - count])) count++;
    return count;
}

static void take_field(galerkin_field *field, tvi_arena *arena, const tvi_system *system, int points)
{
    galerkin_nodes *nodes = &field->nodes;
    field->system = system;
    field->points = points;
    const int lanes_needed = lanes_for(points);
    field->loops = loops_of[system->field_values->sweeps->isa][loops_index(lanes_needed)];
    field->form = form_of(system);
    nodes->unknowns = system->inputs;
    nodes->lanes = lanes_needed;
    nodes->points = points;
    nodes->width = 1;
    nodes->half = system->n;
    nodes->parts = system->parts;
    const int cyclic = cyclic_at_end(system);
    nodes->moving = cyclic > 0 ? system->n - cyclic : nodes->unknowns;
    const size_t unknowns = (size_t)nodes->unknowns, lanes = (size_t)nodes->lanes;
    nodes->high = tvi_arena_doubles(arena, unknowns * lanes);
    nodes->base = tvi_arena_doubles(arena, unknowns * lanes);
    nodes->weight = tvi_arena_doubles(arena, lanes);
    nodes->start = tvi_arena_doubles(arena, unknowns);
    nodes->scale = tvi_arena_doubles(arena, unknowns);
    nodes->inverse_size = tvi_arena_doubles(arena, unknowns);
    nodes->per_movement = tvi_arena_doubles(arena, (size_t)system->n);
    field->slot = tvi_arena_allocate(arena, unknowns * sizeof(int));
}

static void take_tail_inputs(galerkin_tail_inputs *inputs, tvi_arena *arena, const tvi_system *system, double *scale)
{
    galerkin_sums *sums = &inputs->sums;
    double **const vectors[] = {&sums->once,  &sums->twice,    &sums->last,
                                &sums->reach, &sums->once_low, &sums->twice_low};
    for (size_t i = 0; i < 6; i++) *vectors[i] = tvi_arena_doubles(arena, (size_t)system->inputs + 7);
    inputs->n = system->n;
    inputs->is_separable = system->form == TVI_SEPARABLE;
    inputs->has_masses = system->compares_movements;
    inputs->parts = system->parts;
    inputs->scale = scale;
    inputs->per_scale = tvi_arena_doubles(arena, (size_t)system->n);
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin *taken = tvi_arena_allocate(arena, sizeof *taken);
    galerkin w = {.options = options, .n = system->n};
    take_field(&w.field, arena, system, options->degree);
    const int unknowns = w.field.nodes.unknowns, lanes = w.field.nodes.lanes;
    tvi_galerkin_coefficients_take(&w.coefficients, arena, w.field.points, lanes);
    w.field.b = w.coefficients.b;
    w.field.matrix = w.coefficients.matrix;
    tvi_galerkin_predictor_take(&w.predictor, arena, &w.field);
    tvi_galerkin_dense_take(&w.dense, arena, w.field.points, lanes, system->field_values->sweeps);
    w.drift = tvi_arena_doubles(arena, (size_t)unknowns);
    w.drift_low = tvi_arena_doubles(arena, (size_t)unknowns);
    w.share = tvi_arena_doubles(arena, (size_t)w.n);
    w.ratio = tvi_arena_doubles(arena, (size_t)w.n);
    w.rise = tvi_arena_doubles(arena, 2 * (size_t)w.n);
    take_tail_inputs(&w.tail_inputs, arena, system, w.field.nodes.scale);
    w.field.form->take(&w.field, arena);
    tvi_galerkin_probe_take(&w.probe, arena, &w.field);
    if (taken) *taken = w;
    return taken;
}

static void prepare(void *work)
{
    galerkin *w = work;
    tvi_galerkin_coefficients_prepare(&w->coefficients, &w->dense, galerkin_is_second_order(&w->field));
    w->field.form->prepare(&w->field);
    const int numbers = w->field.nodes.unknowns * w->field.nodes.lanes;
    tvi_galerkin_predictor_prepare(&w->predictor, &w->coefficients, &w->field);
    w->tail_inputs.per_weight = w->coefficients.inverse_b;
    w->rule = tvi_galerkin_rule(w->field.form->rule, numbers, w->options);
    const bool iterates = w->options->passes != TVI_PREDICT_ONLY;
    w->code = w->field.system->code && iterates ? w->field.system->code->galerkin : NULL;
    w->frame = (galerkin_frame){.loops = w->field.loops,
                                .nodes = &w->field.nodes,
                                .tail_inputs = &w->tail_inputs,
                                .weights = &w->coefficients.weights,
                                .rule = &w->rule,
                                .matrix = w->field.matrix,
                                .c = w->coefficients.c,
                                .from_two = w->predictor.from_two,
                                .from_last = w->predictor.from_last,
                                .rough_limit = w->predictor.rough_limit,
                                .impulses = w->predictor.impulses,
                                .drift = w->drift,
                                .drift_low = w->drift_low,
                                .share = w->share,
                                .ratio = w->ratio,
                                .h = &w->field.h,
                                .own = w->field.own};
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

void tvi_galerkin_set_size(galerkin *w, double h)
{
    const galerkin_nodes *nodes = &w->field.nodes;
    if (h == w->field.h) return;
    w->field.h = h;
    for (int i = 0; i < nodes->lanes; i++) nodes->weight[i] = h * w->field.b[i];
    for (int u = 0; u < nodes->unknowns; u++)
        nodes->scale[u] = galerkin_is_second_order(&w->field) ? h / w->field.system->mass[u]
                          : u < w->n                          ? 1
                                                              : w->field.form->force_sign;
    for (int i = 0; i < w->n; i++) {
        w->rise[i] = nodes->scale[i];
        w->tail_inputs.per_scale[i] = 1 / fabs(nodes->scale[i]);
        nodes->per_movement[i] = w->field.system->has_masses ? w->field.system->mass[i] / fabs(h) : INFINITY;
        w->rise[w->n + i] = galerkin_is_second_order(&w->field) ? 1 : nodes->scale[w->n + i];
    }
}

/* Sets the times of the nodes of a step of size h. */
static void set_times(galerkin *w, const tvi_origin *origin, double h)
{
    double t[MAX_LANES];
    if (!w->field.system->uses_time) return;
    for (int i = 0; i < w->field.nodes.lanes; i++) t[i] = origin->t + (origin->t_low + h * w->coefficients.c[i]);
    tvi_system_write_time(w->field.system, w->field.inputs, w->field.nodes.lanes, t);
}

/* Sets the unknowns of a step that continues no step of its size: by the last step, beginning after `part` of it; NULL:
 * by the field at the start. */
static tvi_status begin(galerkin *w, const tvi_origin *origin, const double *part, tvi_stats *stats)
{
    galerkin_field *field = &w->field;
    field->nodes.impulse = tvi_galerkin_impulses(&w->predictor, 1);
    galerkin_start(&w->frame, &field->nodes, origin);
    if (part) {
        tvi_galerkin_extrapolate(&w->predictor, &w->coefficients, &w->dense, field, *part);
        return TVI_OK;
    }
    set_times(w, origin, 0);
    stats->force_evaluations++;
    return field->form->start(field, origin);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* A step that the library makes. */
typedef struct {
    galerkin *w;
    const tvi_origin *origin;
    /* Counts of the steps that were made. */
    tvi_stats *stats, counted;
} in_library;

/* The roundoff of passes that no longer shrink is measured where their movement may be roundoff, or where the nodes are
 * near the start: far away, loud movements that go to and fro are those of a step that is too large. */
JET_INLINE tvi_status pass(void *work, const galerkin_nodes *nodes, double *moved, double *roundoff)
{
    const in_library *step = work;
    galerkin_field *field = &step->w->field;
    (void)nodes;
    if (roundoff && (*moved <= step->w->rule.roundoff_level || tvi_galerkin_is_near(field, step->origin)))
        return tvi_galerkin_measure(field, &step->w->probe, moved, roundoff, step->stats);
    return tvi_galerkin_pass(field, moved, step->stats);
}

JET_INLINE void predict(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    const in_library *step = work;
    (void)nodes;
    step->w->field.form->predict(&step->w->field, by);
}

static void count(void *work)
{
    in_library *step = work;
    step->counted = *step->stats;
}

static void make_in_library(galerkin *w, const tvi_step_run *row, const tvi_origin *origin, const tvi_run_state *now,
                            galerkin_outcome *to, tvi_stats *stats)
{
    in_library step = {.w = w, .origin = origin, .stats = stats};
    galerkin_make_steps(&w->frame, &w->field.nodes, &(galerkin_solver){pass, predict, count, &step}, row, origin, now,
                        to);
    if (to->made > 0) *stats = step.counted;
}

static void make_by_code(galerkin *w, const tvi_step_run *row, const tvi_origin *origin, const tvi_run_state *now,
                         galerkin_outcome *to, tvi_stats *stats)
{
    w->code->steps(&w->frame, row, origin, now, to);
    const long passes = to->count + (to->made < 1 ? to->tried : 0);
    stats->passes += passes;
    stats->force_evaluations += passes * w->field.points;
    stats->factorisations += to->factors * w->field.points;
}

static void remember(galerkin_history *last, double h, const galerkin_outcome *to)
{
    *last = (galerkin_history){.h = h,
                               .h_before = to->made > 1 ? h : last->h,
                               .t = to->t,
                               .convergence = to->convergence,
                               .ring_index = to->ring_index};
}

typedef void make_steps(galerkin *w, const tvi_step_run *row, const tvi_origin *origin, const tvi_run_state *now,
                        galerkin_outcome *to, tvi_stats *stats);

/* Makes steps of size field->h. The first one is predicted from earlier steps, or from the state alone. */
static galerkin_outcome make(galerkin *w, make_steps *by, bool follows, const tvi_step_run *row,
                             const tvi_origin *origin, const tvi_run_state *now, tvi_stats *stats)
{
    galerkin_history *last = w->predictor.last;
    galerkin_outcome to = {.ring_index = (int)last->ring_index, .largest_tail = stats->largest_tail};
    double part;
    if (w->field.h == last->h) to.convergence = last->convergence;
    follows = follows && tvi_galerkin_can_extrapolate(&w->predictor, &w->field, origin->t, &part);
    to.known = follows ? tvi_galerkin_known(&w->predictor, &w->field, part) : 0;
    if (to.known == 0) to.status = begin(w, origin, follows ? &part : NULL, stats);
    if (to.status != TVI_OK) return to;
    set_times(w, origin, w->field.h);
    by(w, row, origin, now, &to, stats);
    if (to.made < 1) return to;
    remember(last, row->h, &to);
    stats->residual = sqrt(to.moved);
    stats->tail = to.tail;
    return to;
}

static bool iterates(const galerkin *w) { return w->rule.max_passes > 0; }

/* Makes a step from a prediction by earlier steps, or from the state alone. */
static tvi_status step(void *work, double h, const tvi_origin *origin, const tvi_increments *by, tvi_stats *stats)
{
    galerkin *w = work;
    const tvi_step_run row = {.h = h, .steps = 1, .increments = *by};
    double part;
    tvi_galerkin_set_size(w, h);
    if (w->code && make(w, make_by_code, true, &row, origin, NULL, stats).made > 0) return TVI_OK;
    const bool follows = iterates(w) && tvi_galerkin_can_extrapolate(&w->predictor, &w->field, origin->t, &part);
    galerkin_outcome to = make(w, make_in_library, follows, &row, origin, NULL, stats);
    if (to.made < 1 && follows) to = make(w, make_in_library, false, &row, origin, NULL, stats);
    return to.made > 0 ? TVI_OK : to.status;
}

static long run(void *work, const tvi_step_run *row, const tvi_run_state *now, tvi_stats *stats)
{
    galerkin *w = work;
    const tvi_origin origin = {now->q[w->n], now->q_low[w->n], now->q, now->q_low, now->p, now->p_low};
    tvi_stats counted = *stats;
    if (!iterates(w) || w->field.system->uses_time) return 0;
    tvi_galerkin_set_size(w, row->h);
    row->increments.dq[w->n] = row->h;
    const galerkin_outcome to = make(w, w->code ? make_by_code : make_in_library, true, row, &origin, now, &counted);
    if (to.made < 1) return 0;
    *stats = counted;
    stats->largest_tail = to.largest_tail;
    return to.made;
}

/* ---- Generated code ---------------------------------------------------------------------------------------------- */

static void emit_loops(jet_text *text, const tvi_system *system, const tvi_options *options)
{
    tvi_arena arena = {0};
    (void)take(&arena, system, options);
    void *memory = tvi_arena_allocate_memory(&arena);
    galerkin *w = memory ? take(&arena, system, options) : NULL;
    text->is_incomplete |= !w;
    if (!w) return;
    prepare(w);
    tvi_galerkin_emit(text, &w->field, &w->rule);
    free(memory);
}

static tvi_used_tapes uses(const tvi_system *system, const tvi_options *options)
{
    const int lanes = lanes_for(options->degree), width = tvi_galerkin_batch.width(system, options);
    const int of_batch = width > 1 ? width * options->degree : 0;
    tvi_used_tapes used = {.values = {.name = "tvi_values",
                                      .lanes = {lanes, of_batch},
                                      .may_move_pair_factors = system->form == TVI_SEPARABLE},
                           .code_member = "galerkin",
                           .emit_loops = emit_loops};
    if (system->hessian_values) used.hessian = (jet_emission_request){.name = "tvi_hessian", .lanes = {lanes}};
    return used;
}

static bool is_sound(const void *work) { return galerkin_is_sound(((const galerkin *)work)->predictor.last); }

const tvi_stepper tvi_stepper_galerkin = {.take = take,
                                          .prepare = prepare,
                                          .step = step,
                                          .run = run,
                                          .dense = tvi_galerkin_dense,
                                          .sample = tvi_galerkin_sample,
                                          .is_superconvergent = true,
                                          .is_sound = is_sound,
                                          .uses = uses,
                                          .batch = &tvi_galerkin_batch};
