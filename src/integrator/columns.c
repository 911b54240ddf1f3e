/* columns.c - Multiplies all columns of D by the Jacobian matrix of a step at once (columns.h), in groups of a few
 * columns. The lifted system of a group has the state and its tangent vectors (system/lift.c). Its steps follow one
 * another, so that each is predicted from those before it. The state in it is that of the integrator, with its
 * low-order parts, at the start of each step: the columns belong to the very orbit. Columns are not scaled: each is a
 * subsystem of its own, whose passes are measured by its own size.
 *
 * In the reversible form of a rescaled system a neighbouring orbit is at another time after a step in s. The lifted
 * column keeps this difference dt, whose equations are smooth, and a column of D is what is left of it at equal times:
 * dq - dt q', dp - dt p'. */
#include "integrator/columns.h"
#include "method/method.h"
#include "system/refuse.h"

#include <stdlib.h>

/* [columns] A group has at most so many. Each group makes the step of the state once more; the numbers of more columns
 * leave the caches of a core. */
#define AT_ONCE_GROUP 8 /* found: make columns */

/* Successive columns of D. */
typedef struct {
    int first, count;
    tvi_system *lift;
    tvi_integrator *full, *part; /* make the lifted steps, and parts of them */
} column_group;

struct tvi_columns_at_once {
    int count, group_count;
    column_group *groups;
    bool *moves;   /* [count][parameters] tells which components of columns that belong to parameters may not be 0 */
    double *q, *p; /* [(1 + columns of a group) n] a state of a lift, n that of the stepped system */
    double
        *parameters;  /* [(1 + columns of a group) parameters] those of a lift; the first are those of the last step */
    long step_number; /* the integrator's number of the step that the lifts have made; 0: they have made none */
    size_t bytes, counted_bytes; /* what it has, and what the integrator has counted of it */
};

/* Says what columns_at_once does not serve, or NULL. */
static const char *find_unsupported(const tvi_integrator *it)
{
    const tvi_descriptor *method = tvi_find_method(&it->options);
    const bool is_separable = it->stepped->form == TVI_SEPARABLE;
    return it->system->constraints ? "a constrained system: leave it out"
           : tvi_steps_K(it) ? "K = g (H + e): take the reversible form, tvi_system_rescaled_reversible (rescaled(g, "
                               "reversible=True)), or leave it out"
           : it->stepped->form == TVI_LAGRANGIAN
               ? "a Lagrangian whose momenta are no masses times velocities: state the Hamiltonian, or leave it out"
           : it->options.compose_adjoint || method->needs_conjugate_momenta
               ? "this method: it serves \"galerkin\", and for constant masses \"stormer-verlet\" and \"taylor\""
           : !is_separable && !(method->supports->form_mask & TVI_SUPPORTS_FIELD)
               ? "this method for a Hamiltonian that is not separable: it serves \"galerkin\""
               : NULL;
}

bool tvi_at_once_serves(const tvi_integrator *it) { return !find_unsupported(it); }

tvi_status tvi_at_once_check(const tvi_integrator *it)
{
    const char *const unsupported = find_unsupported(it);
    return unsupported ? jet_refuse(TVI_EUNSUPPORTED, "columns_at_once does not serve %s", unsupported) : TVI_OK;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static void free_lift(column_group *group)
{
    tvi_integrator_free(group->full);
    tvi_integrator_free(group->part);
    tvi_system_free(group->lift);
    group->full = group->part = NULL;
    group->lift = NULL;
}

void tvi_at_once_free(tvi_columns_at_once *at_once)
{
    if (!at_once) return;
    for (int i = 0; i < at_once->group_count; i++) free_lift(&at_once->groups[i]);
    free(at_once->groups);
    free(at_once->moves);
    free(at_once->q);
    free(at_once);
}

/* Allocates all but the lifts. */
static tvi_status allocate(tvi_columns_at_once **out, const tvi_integrator *it, int count)
{
    tvi_columns_at_once *at_once = *out = calloc(1, sizeof *at_once);
    const int n = it->stepped->n, P = tvi_system_parameters(it->system);
    const size_t columns = (size_t)count, copies = 1 + (count < AT_ONCE_GROUP ? columns : AT_ONCE_GROUP);
    const size_t numbers = copies * (size_t)n, parameters = copies * (size_t)P, groups = columns / AT_ONCE_GROUP + 1;
    if (!at_once) return TVI_ENOMEM;
    at_once->count = count;
    at_once->groups = calloc(groups, sizeof *at_once->groups);
    at_once->moves = calloc(columns * (size_t)P + 1, sizeof *at_once->moves);
    at_once->q = calloc(2 * numbers + parameters, sizeof *at_once->q);
    if (!at_once->groups || !at_once->moves || !at_once->q) return TVI_ENOMEM;
    for (int first = 0; first < count; first += AT_ONCE_GROUP) {
        const int left = count - first;
        at_once->groups[at_once->group_count++] =
            (column_group){.first = first, .count = left < AT_ONCE_GROUP ? left : AT_ONCE_GROUP};
    }
    at_once->p = at_once->q + numbers;
    at_once->parameters = at_once->p + numbers;
    at_once->bytes = sizeof *at_once + groups * sizeof *at_once->groups + columns * (size_t)P + 1 +
                     (2 * numbers + parameters) * sizeof *at_once->q;
    return TVI_OK;
}

/* Provides a lift in which the columns of D move the parameters that they move, and those that earlier ones did. A lift
 * that does so stays. */
static tvi_status provide_lift(tvi_columns_at_once *at_once, column_group *group, const tvi_integrator *it,
                               const double D[])
{
    const int count = at_once->count, P = tvi_system_parameters(it->system);
    bool *moves = at_once->moves + group->first * P, is_new = !group->part;
    for (int c = 0; c < group->count; c++)
        for (int i = 0; i < P; i++) {
            if (moves[c * P + i] || D[(2 * it->system->n + i) * count + group->first + c] == 0) continue;
            moves[c * P + i] = is_new = true;
        }
    if (!is_new) return TVI_OK;
    tvi_options options = it->options;
    options.max_tail = -1;   /* The guard checks the integrator's own step only. */
    options.compiled = NULL; /* The generated code is that of the system itself. */
    if (group->part) at_once->bytes -= group->full->stats.bytes + group->part->stats.bytes;
    free_lift(group);
    tvi_status status = tvi_system_create_columns_lift(&group->lift, it->stepped, group->count, moves);
    if (status == TVI_OK) status = tvi_integrator_create(&group->full, group->lift, &options);
    if (status == TVI_OK) status = tvi_integrator_create(&group->part, group->lift, &options);
    if (status != TVI_OK) free_lift(group);
    else at_once->bytes += group->full->stats.bytes + group->part->stats.bytes;
    return jet_explain_out_of_memory(status);
}

static tvi_status provide_lifts(tvi_columns_at_once *at_once, const tvi_integrator *it, const double D[])
{
    tvi_status status = TVI_OK;
    for (int i = 0; i < at_once->group_count && status == TVI_OK; i++)
        status = provide_lift(at_once, &at_once->groups[i], it, D);
    return status;
}

tvi_status tvi_at_once_provide(tvi_columns_at_once **at_once, tvi_integrator *it, int count, const double D[])
{
    if (*at_once) it->stats.bytes -= (*at_once)->counted_bytes;
    const bool fits = *at_once && (*at_once)->count == count;
    if (!fits) tvi_at_once_free(*at_once);
    tvi_status status = fits ? TVI_OK : allocate(at_once, it, count);
    if (status == TVI_OK) status = provide_lifts(*at_once, it, D);
    if (status == TVI_OK) {
        it->stats.bytes += (*at_once)->counted_bytes = (*at_once)->bytes;
        return TVI_OK;
    }
    tvi_at_once_free(*at_once);
    *at_once = NULL;
    return jet_explain_out_of_memory(status);
}

/* ---- The lifted state -------------------------------------------------------------------------------------------- */

/* Takes the state from which the lift goes on. Its orbit becomes that of the integrator at the start of its last step,
 * with its low-order parts. */
static void take_state(const tvi_columns_at_once *at_once, const tvi_integrator *lift, const tvi_integrator *it)
{
    const tvi_run_state *start = &it->last_step.start, *to = &lift->state;
    const size_t n = (size_t)it->stepped->n, bytes = n * sizeof *to->q;
    double t;
    memcpy(to->q, start->q, bytes);
    memcpy(to->p, start->p, bytes);
    memcpy(to->q_low, start->q_low, bytes);
    memcpy(to->p_low, start->p_low, bytes);
    to->q[lift->stepped->n] = start->q[n];
    to->q_low[lift->stepped->n] = start->q_low[n];
    tvi_integrator_copy_state(lift, &t, at_once->q, at_once->p);
}

/* Loads the state at the start of the integrator's last step, and the columns D there. The history of the lift begins
 * anew. */
static void load(const tvi_columns_at_once *at_once, const column_group *group, tvi_integrator *lift,
                 const tvi_integrator *it, const double D[], const double parameters[])
{
    const int n = it->stepped->n, rows = it->system->n, count = at_once->count, P = tvi_system_parameters(it->system);
    const double *columns = D + group->first;
    memcpy(at_once->q, it->last_step.start.q, (size_t)n * sizeof *at_once->q);
    memcpy(at_once->p, it->last_step.start.p, (size_t)n * sizeof *at_once->p);
    memcpy(at_once->parameters, parameters, (size_t)P * sizeof *parameters);
    for (int c = 0; c < group->count; c++) {
        double *dq = at_once->q + (1 + c) * n, *dp = at_once->p + (1 + c) * n;
        for (int i = 0; i < n; i++) dq[i] = i < rows ? columns[i * count + c] : 0;
        for (int i = 0; i < n; i++) dp[i] = i < rows ? columns[(rows + i) * count + c] : 0;
        for (int i = 0; i < P; i++) at_once->parameters[(1 + c) * P + i] = columns[(2 * rows + i) * count + c];
    }
    tvi_integrator_load_parameters(lift, at_once->parameters, 1);
    tvi_integrator_reset(lift);
}

/* Makes a step of the lift from the state that was taken or loaded. The integrator's own step was accepted: a column
 * that overflows does so by its own size. */
static tvi_status make_lifted_step(const tvi_columns_at_once *at_once, tvi_integrator *lift, const tvi_integrator *it,
                                   double h)
{
    double t = it->last_step.start.q[it->stepped->n];
    const tvi_status status = tvi_step(lift, h, &t, at_once->q, at_once->p);
    if (status == TVI_OK) return TVI_OK;
    return jet_refuse(status == TVI_ETOOLARGE ? TVI_ENONFINITE : status, "the columns of D at once: %s",
                      jet_last_refusal_text());
}

/* Moves a neighbouring orbit (dq, dp) in a step in s back along the flow by the difference of the times, which is the
 * last component of dq. `block` has the values of the lift's field. */
static void project_to_equal_time(const tvi_integrator *lift, const double block[], int n, double dq[], double dp[])
{
    const int *minus_p_rate = lift->stepped->field_values->output_slot, *q_rate = minus_p_rate + lift->stepped->n;
    const double ds = dq[n - 1] / block[q_rate[n - 1]];
    for (int i = 0; i < n; i++) {
        dq[i] -= ds * block[q_rate[i]];
        dp[i] += ds * block[minus_p_rate[i]];
    }
}

/* Writes the columns of the lifted state to D. */
static tvi_status store(const tvi_columns_at_once *at_once, const column_group *group, tvi_integrator *lift,
                        const tvi_integrator *it, double D[])
{
    const int n = it->stepped->n, rows = it->system->n, count = at_once->count;
    if (tvi_is_rescaled(it) && !tvi_integrator_compute_field(lift, lift->state.q, lift->state.p))
        return jet_refuse(TVI_ENONFINITE, "the columns of D at once: the field has no value at the end of the step");
    for (int c = 0; c < group->count; c++) {
        double *dq = at_once->q + (1 + c) * n, *dp = at_once->p + (1 + c) * n, *column = D + group->first + c;
        if (tvi_is_rescaled(it)) project_to_equal_time(lift, lift->guard.field_block, n, dq, dp);
        for (int i = 0; i < rows; i++) column[i * count] = dq[i];
        for (int i = 0; i < rows; i++) column[(rows + i) * count] = dp[i];
    }
    return TVI_OK;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

tvi_status tvi_at_once_multiply(tvi_columns_at_once *at_once, const tvi_integrator *it, const double start[],
                                bool goes_on, double product[])
{
    const size_t parameter_bytes = (size_t)tvi_system_parameters(it->system) * sizeof(double);
    const bool keeps_history = goes_on && *it->last_step.was_state_from_step &&
                               at_once->step_number == it->stats.steps - 1 &&
                               memcmp(at_once->parameters, it->parameters, parameter_bytes) == 0;
    at_once->step_number = 0;
    tvi_status status = keeps_history ? TVI_OK : provide_lifts(at_once, it, start);
    for (int i = 0; i < at_once->group_count && status == TVI_OK; i++) {
        const column_group *group = &at_once->groups[i];
        if (keeps_history) take_state(at_once, group->full, it);
        else load(at_once, group, group->full, it, start, it->parameters);
        status = make_lifted_step(at_once, group->full, it, it->last_step.h);
        if (status == TVI_OK) status = store(at_once, group, group->full, it, product);
    }
    if (status == TVI_OK) at_once->step_number = it->stats.steps;
    return status;
}

tvi_status tvi_at_once_multiply_by_part(tvi_columns_at_once *at_once, const tvi_integrator *it, const double start[],
                                        const double parameters[], double offset, double product[])
{
    const bool has_step = at_once->step_number == it->stats.steps;
    tvi_status status = has_step ? TVI_OK : provide_lifts(at_once, it, start);
    for (int i = 0; i < at_once->group_count && status == TVI_OK; i++) {
        const column_group *group = &at_once->groups[i];
        if (has_step) tvi_integrator_load_parameters(group->part, group->full->parameters, 1);
        if (has_step) tvi_integrator_copy_before(group->full, group->part->history.now);
        if (has_step) take_state(at_once, group->part, it);
        else load(at_once, group, group->part, it, start, parameters);
        status = make_lifted_step(at_once, group->part, it, offset);
        if (status == TVI_OK) status = store(at_once, group, group->part, it, product);
    }
    return status;
}
