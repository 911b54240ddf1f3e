/* backward.c - Makes steps back of the adjoint system (backward.h), and the integrals of the derivatives by the
 * parameters and by the time along them, by the quadrature of the steps. */
#include "run/backward.h"
#include "system/refuse.h"

#include <stdlib.h>

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

void tvi_backward_free(tvi_backward *backward)
{
    if (!backward) return;
    tvi_integrator_free(backward->lift);
    tvi_integrator_free(backward->part);
    tvi_adjoint_free(backward->own);
    free(backward->integrand_block);
    free(backward->energy_block);
    free(backward->curve);
    free(backward);
}

/* Sets `difference` by the barycentric weights w of the nodes and of the start of the step (Berrut and Trefethen, SIAM
 * Review 46, 2004): w_j / (w_i (x_i - x_j)), and on the diagonal the sum of 1 / (x_j - x_k), k != j. */
static void set_difference(tvi_backward *to)
{
    const int m = to->nodes.count;
    const double *x = to->nodes.theta;
    double w[TVI_MOST_POINTS];
    for (int j = 0; j < m; j++) {
        w[j] = 1 / x[j];
        for (int k = 0; k < m; k++) w[j] /= k == j ? 1 : x[j] - x[k];
    }
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            double *element = &to->nodes.difference[i * m + j];
            *element = i == j ? 1 / x[j] : w[j] / (w[i] * (x[i] - x[j]));
            for (int k = 0; k < m && i == j; k++) *element += k == j ? 0 : 1 / (x[j] - x[k]);
        }
}

static bool allocate_arrays(tvi_backward *to, const tvi_record *record)
{
    const tvi_adjoint *adjoint = to->adjoint;
    const size_t N = (size_t)to->N, points = (size_t)to->nodes.points;
    const struct {
        double **array;
        size_t size;
    } slices[] = {{&to->curve, 4 * N * points},
                  {&to->z, 4 * N},
                  {&to->x_end, record->state_size},
                  {&to->covector.exit, 2 * N},
                  {&to->covector.told, 2 * N},
                  {&to->covector.surface, 2 * N},
                  {&to->rates, 2 * N},
                  {&to->velocity, N},
                  {&to->by_parameters, (size_t)to->parameters + 1},
                  {&to->values, (size_t)(to->parameters + to->integrals)}};
    const size_t count = sizeof slices / sizeof *slices;
    size_t all = 0;
    for (size_t i = 0; i < count; i++) all += slices[i].size;
    double *memory = calloc(all, sizeof *memory), *next = memory;
    for (size_t i = 0; i < count && memory; i++) *slices[i].array = next, next += slices[i].size;
    to->integrand_block = jet_tape_create_block(adjoint->integrands, to->nodes.points);
    if (adjoint->energy_by_parameters) to->energy_block = jet_tape_create_block(adjoint->energy_by_parameters, 1);
    return memory && to->integrand_block && (!adjoint->energy_by_parameters || to->energy_block);
}

/* Sets to->adjoint, that of the system, or one with the integrals of the record. */
static tvi_status find_adjoint(tvi_backward *to, const tvi_record *record)
{
    to->integrals = record->integrals.count;
    to->adjoint = record->adjoint;
    if (to->integrals == 0) return TVI_OK;
    tvi_integrand *integrands = malloc((size_t)to->integrals * sizeof *integrands);
    if (!integrands) return TVI_ENOMEM;
    for (int k = 0; k < to->integrals; k++) integrands[k] = record->integrals.of[k].integrand;
    const tvi_status status = tvi_adjoint_create(&to->own, record->again->system, to->integrals, integrands);
    free(integrands);
    to->adjoint = to->own;
    return status;
}

tvi_status tvi_backward_create(tvi_record *record)
{
    const tvi_integrator *again = record->again;
    tvi_backward *to = calloc(1, sizeof *to);
    if (!to) return TVI_ENOMEM;
    tvi_options options = again->options;
    options.max_tail = -1; /* the guard has checked the steps of the run */
    options.compiled = NULL;
    options.passes = 0; /* the multipliers converge at another rate than the state */
    options.tolerance = 0;
    tvi_status status = find_adjoint(to, record);
    if (status == TVI_OK) status = tvi_integrator_create(&to->lift, to->adjoint->lift, &options);
    if (status == TVI_OK) status = tvi_integrator_create(&to->part, to->adjoint->lift, &options);
    if (status == TVI_OK) {
        to->layout = tvi_adjoint_layout_of(to->adjoint);
        to->N = again->stepped->n;
        to->parameters = tvi_system_parameters(again->system);
        to->nodes.points = again->stepper->quadrature(again->work, to->nodes.theta, to->nodes.b);
        while (to->nodes.count < to->nodes.points && to->nodes.b[to->nodes.count] != 0) to->nodes.count++;
        if (to->lift->system->form == TVI_LAGRANGIAN) set_difference(to);
        if (!allocate_arrays(to, record)) status = TVI_ENOMEM;
    }
    if (status == TVI_OK) record->backward = to;
    else tvi_backward_free(to);
    return status;
}

void tvi_backward_set_parameters(tvi_record *record, tvi_integrator *lift, const double by_integrals[])
{
    tvi_backward *to = record->backward;
    const double *value = record->again->parameters;
    for (int i = 0; i < to->parameters; i++) to->values[i] = value[i];
    for (int k = 0; k < to->integrals; k++) to->values[to->parameters + k] = by_integrals ? by_integrals[k] : 0;
    tvi_integrator_load_parameters(lift, to->values, 1);
    jet_tape_set_parameters(to->adjoint->integrands, to->integrand_block, to->nodes.points,
                            to->parameters + to->integrals, 1, to->values);
    if (to->energy_block)
        jet_tape_set_parameters(to->adjoint->energy_by_parameters, to->energy_block, 1, to->parameters, 1, value);
}

/* ---- The state of the lift --------------------------------------------------------------------------------------- */

/* Returns the element with this index of the layout, in the lift's state, and in *low its low-order part. */
static double *element(const tvi_integrator *lift, int index, double **low)
{
    const int n = lift->stepped->n;
    *low = index < n ? &lift->state.q_low[index] : &lift->state.p_low[index - n];
    return index < n ? &lift->state.q[index] : &lift->state.p[index - n];
}

void tvi_backward_set_x(const tvi_backward *to, tvi_integrator *lift, const double state[])
{
    const int N = to->N, low_parts = 2 * N + 1;
    double *low;
    for (int i = 0; i < 2 * N; i++) {
        const int of = i < N ? i : i + 1; /* the variable of the steps stands between q and p */
        double *x = element(lift, i < N ? to->layout.q + i : to->layout.p + i - N, &low);
        *x = state[of];
        *low = state[of + low_parts];
    }
    lift->state.q[2 * N] = state[N];
    lift->state.q_low[2 * N] = state[N + low_parts];
}

static double *a_element(const tvi_backward *to, const tvi_integrator *lift, int i, double **low)
{
    return element(lift, i < to->N ? to->layout.a_q + i : to->layout.a_p + i - to->N, low);
}

static double sign_of_a(const tvi_backward *to, int i) { return i < to->N ? to->layout.sign_of_a_q : 1; }

void tvi_backward_add(const tvi_backward *to, tvi_integrator *lift, const double covector[])
{
    double *low;
    for (int i = 0; i < 2 * to->N; i++) {
        double *a = a_element(to, lift, i, &low);
        *a = tvi_add_compensated(*a, low, sign_of_a(to, i) * covector[i], 0);
    }
}

void tvi_backward_get(const tvi_backward *to, const tvi_integrator *lift, double covector[])
{
    double *low;
    for (int i = 0; i < 2 * to->N; i++) covector[i] = sign_of_a(to, i) * *a_element(to, lift, i, &low);
}

void tvi_backward_clear(tvi_integrator *lift)
{
    tvi_arena_copy_history(lift->history.now, NULL, lift->history.bytes);
    *lift->is_state_from_step = true; /* its state is set here, with low-order parts */
}

/* Begins the history of the lift anew: what it predicts. */
static void forget_predictions(tvi_integrator *lift)
{
    const size_t state = lift->history.state_bytes;
    tvi_arena_copy_history(lift->history.now + state, NULL, lift->history.bytes - state);
}

/* ---- Steps back -------------------------------------------------------------------------------------------------- */

/* Computes the coordinates and the momenta of the lift at the nodes of its last step: curve [4N][points]; of a
 * Lagrangian its velocities in the place of the momenta, by the polynomial through the nodes. */
static void compute_curve(const tvi_backward *to, const tvi_integrator *lift)
{
    const int n = 2 * to->N, m = to->nodes.count, points = to->nodes.points;
    const tvi_run_state *start = &lift->last_step.start;
    double *second = to->curve + n * points;
    lift->stepper->at_nodes(lift->work, start->q, start->p, to->curve, second);
    for (int i = 0; i < n && lift->system->form == TVI_LAGRANGIAN; i++)
        for (int k = 0; k < points; k++) {
            const double *difference = to->nodes.difference + (k < m ? k : m - 1) * m;
            double *v = &second[i * points + k];
            *v = 0;
            for (int j = 0; j < m; j++) *v += difference[j] * (to->curve[i * points + j] - start->q[i]);
            *v /= lift->last_step.h;
        }
}

/* Adds the integrals of S_c and S_t over the last step back. */
static tvi_status add_integrals(tvi_record *record, const tvi_integrator *lift)
{
    tvi_backward *to = record->backward;
    const jet_tape *tape = to->adjoint->integrands;
    const int points = to->nodes.points, n = 2 * to->N, inputs = lift->system->form == TVI_SEPARABLE ? n : 2 * n;
    const double h = lift->last_step.h, t = lift->last_step.start.q[n];
    if (to->parameters == 0 && !lift->stepped->uses_time) return TVI_OK;
    compute_curve(to, lift);
    memcpy(to->integrand_block, to->curve, (size_t)(inputs * points) * sizeof *to->curve);
    for (int k = 0; k < points && tape->input_count > inputs; k++)
        to->integrand_block[inputs * points + k] = t + to->nodes.theta[k] * h;
    if (!jet_sweep_values(tape, to->integrand_block, points))
        return jet_refuse(TVI_EDOMAIN, "the derivatives by the parameters have no value");
    for (int i = 0; i < tape->output_count; i++) {
        const int parameter = i < tape->output_count - 1 ? i : to->parameters;
        double sum = 0;
        for (int k = 0; k < points; k++) sum += to->nodes.b[k] * to->integrand_block[tape->output_slot[i] * points + k];
        to->by_parameters[parameter] -= h * sum;
    }
    return TVI_OK;
}

static bool has_multipliers(const tvi_backward *to, const tvi_integrator *lift)
{
    double *low;
    for (int i = 0; i < 2 * to->N; i++)
        if (*a_element(to, lift, i, &low) != 0) return true;
    for (int k = to->parameters; k < tvi_system_parameters(lift->system); k++)
        if (lift->parameters[k] != 0) return true;
    return false;
}

tvi_status tvi_backward_step(tvi_record *record, tvi_integrator *lift, double h)
{
    tvi_backward *to = record->backward;
    double t, *p = to->z + 2 * to->N;
    if (!has_multipliers(to, lift)) return TVI_OK;
    tvi_integrator_copy_state(lift, &t, to->z, p);
    tvi_status status = tvi_step(lift, -h, &t, to->z, p);
    if (tvi_is_failure_of_member(status)) {
        forget_predictions(lift);
        status = tvi_step(lift, -h, &t, to->z, p);
    }
    if (status != TVI_OK) return jet_refuse(status, "the way back: %s", jet_last_refusal_text());
    return add_integrals(record, lift);
}
