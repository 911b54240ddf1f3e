/* record.c - Writes a record (record.h): keeps the states of the steps as long as there is room, copies the
 * integrator's history where there is none for more, and makes the steps from such a copy again when their states are
 * wanted. */
#include "run/record.h"
#include "method/fingerprint.h"
#include "system/refuse.h"

#include <stdlib.h>

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

enum { DEFAULT_BYTES = 64 << 20, FEWEST_STEPS = 16 };

/* Makes room for one more element of an array, which has at most so many. */
static tvi_status grow_to(tvi_record *record, void **array, tvi_grown *of, size_t element_bytes, size_t most)
{
    if (of->count < of->capacity) return TVI_OK;
    const size_t twice = of->capacity > 0 ? 2 * of->capacity : FEWEST_STEPS, capacity = twice < most ? twice : most;
    void *grown = realloc(*array, capacity * element_bytes);
    if (!grown) return jet_explain_out_of_memory(TVI_ENOMEM);
    record->bytes.taken += (capacity - of->capacity) * element_bytes;
    *array = grown;
    of->capacity = capacity;
    return TVI_OK;
}

static tvi_status grow(tvi_record *record, void **array, tvi_grown *of, size_t element_bytes)
{
    return grow_to(record, array, of, element_bytes, SIZE_MAX);
}

/* Refuses what would take more memory than the record may have. */
static tvi_status take_bytes(tvi_record *record, size_t bytes)
{
    if (bytes >
        record->bytes.most - (record->bytes.taken < record->bytes.most ? record->bytes.taken : record->bytes.most))
        return jet_refuse(TVI_ENOMEM, "the record is full after %ld steps: it may take %zu bytes", record->step_count,
                          record->bytes.most);
    record->bytes.taken += bytes;
    return TVI_OK;
}

static void *take(tvi_record *record, size_t bytes)
{
    if (take_bytes(record, bytes) != TVI_OK) return NULL;
    void *taken = malloc(bytes);
    if (taken) return taken;
    record->bytes.taken -= bytes;
    (void)jet_explain_out_of_memory(TVI_ENOMEM);
    return NULL;
}

static size_t told_bytes(const tvi_record *record, bool is_event)
{
    const size_t state = 2 * (size_t)record->again->system->n + 1;
    return (is_event ? 2 * state + (size_t)tvi_system_parameters(record->again->system) : state) * sizeof(double);
}

/* Forgets all from the step with this index on. */
static void forget_from(tvi_record *record, long step)
{
    const size_t history = record->again->history.bytes, state = record->state_size * sizeof(double);
    while (record->counts.checkpoints.count > 0 &&
           record->checkpoints[record->counts.checkpoints.count - 1].step >= step) {
        free(record->checkpoints[--record->counts.checkpoints.count].history);
        record->bytes.taken -= history;
    }
    while (record->counts.pieces.count > 0 && record->pieces[record->counts.pieces.count - 1].first_step >= step) {
        free(record->pieces[--record->counts.pieces.count].end_state);
        record->bytes.taken -= state;
    }
    while (record->counts.rows.count > 0 && record->rows[record->counts.rows.count - 1].first_step >= step)
        record->counts.rows.count--;
}

void tvi_record_begin_anew(tvi_record *record)
{
    forget_from(record, 0);
    for (; record->counts.told.count > 0; record->counts.told.count--) {
        const tvi_told *told = &record->told[record->counts.told.count - 1];
        record->bytes.taken -= told_bytes(record, told->gradient);
        free(told->state);
    }
    record->kept.of.count = 0;
    record->kept.first_step = record->step_count = 0;
    record->time_count = record->event_count = 0;
    for (int k = 0; k < record->integrals.count; k++) record->integrals.of[k].value = record->integrals.of[k].low = 0;
}

tvi_status tvi_record_create(tvi_record **out, const tvi_integrator *it, size_t bytes)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!it) return jet_refuse(TVI_EINVAL, "integrator is NULL");
    if (it->system->constraints) return jet_refuse(TVI_EUNSUPPORTED, "gradients do not serve constrained systems");
    if (!it->stepper->quadrature)
        return jet_refuse(TVI_EUNSUPPORTED, "gradients are for the methods galerkin and stormer-verlet");
    tvi_record *record = calloc(1, sizeof *record);
    if (!record) return jet_explain_out_of_memory(TVI_ENOMEM);
    record->state_size = 4 * (size_t)it->stepped->n + 2;
    record->bytes.most = bytes > 0 ? bytes : DEFAULT_BYTES;
    record->kept.most = (long)(record->bytes.most / 2 / (record->state_size * sizeof(double)));
    record->end = calloc(2 * (size_t)it->system->n + 1, sizeof *record->end);
    tvi_status status = record->end ? tvi_integrator_create_like(&record->again, it) : TVI_ENOMEM;
    if (status == TVI_OK) status = tvi_adjoint_of(it->system, &record->adjoint);
    if (status == TVI_OK && record->kept.most < FEWEST_STEPS)
        status = jet_refuse(TVI_EINVAL, "bytes = %zu is not enough for a record", bytes);
    if (status == TVI_OK) *out = record;
    else tvi_record_free(record);
    return jet_explain_out_of_memory(status);
}

void tvi_record_free(tvi_record *record)
{
    if (!record) return;
    if (record->again) tvi_record_begin_anew(record);
    for (size_t i = 0; i < record->counts.event_gradients.count; i++) {
        jet_tape_free(record->event_gradients[i].tape);
        free(record->event_gradients[i].block);
    }
    tvi_backward_free(record->backward);
    tvi_integrals_free(record);
    tvi_integrator_free(record->again);
    free(record->kept.states);
    free(record->checkpoints);
    free(record->pieces);
    free(record->rows);
    free(record->told);
    free(record->event_gradients);
    free(record->end);
    free(record);
}

long tvi_record_counts(const tvi_record *record, int *times, int *events)
{
    if (times) *times = record ? record->time_count : 0;
    if (events) *events = record ? record->event_count : 0;
    return record ? record->step_count : 0;
}

size_t tvi_record_bytes(const tvi_record *record)
{
    return record ? record->bytes.taken + record->again->stats.bytes : 0;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

static bool has_parameters_of(const tvi_record *record, const tvi_integrator *it)
{
    const size_t bytes = (size_t)tvi_system_parameters(it->system) * sizeof *it->parameters;
    return bytes == 0 || memcmp(record->again->parameters, it->parameters, bytes) == 0;
}

tvi_status tvi_record_begin_run(tvi_record *record, const tvi_integrator *it)
{
    const tvi_integrator *again = record->again;
    if (it->system != again->system || it->options.compiled != again->options.compiled ||
        tvi_options_fingerprint(&it->options) != tvi_options_fingerprint(&again->options))
        return jet_refuse(TVI_EINVAL, "the record was created for another system or other options");
    /* The writer is the integrator whose run writes the record. A run that longjmp has left is none: its own integrator
     * may begin another. */
    if (record->writer && record->writer != it) return jet_refuse(TVI_EINVAL, "another run writes the record");
    const size_t n = (size_t)it->system->n;
    const bool has_begun = record->step_count > 0 || record->counts.told.count > 0;
    const bool goes_on = has_begun && tvi_integrator_state_equals(it, record->end[2 * n], record->end, record->end + n);
    if (goes_on && !has_parameters_of(record, it))
        return jet_refuse(TVI_EUNSUPPORTED, "the run goes on with other parameters: a record has one set of them");
    if (!goes_on) tvi_record_begin_anew(record);
    tvi_integrator_load_parameters(record->again, it->parameters, 1);
    const tvi_piece *last = record->counts.pieces.count > 0 ? &record->pieces[record->counts.pieces.count - 1] : NULL;
    record->begins_piece = !last || last->end != TVI_END_AT_STEP;
    record->steps_before_run = record->step_count;
    record->writer = it;
    return TVI_OK;
}

static tvi_status add_piece(tvi_record *record, bool starts_anew)
{
    tvi_status status = grow(record, (void **)&record->pieces, &record->counts.pieces, sizeof *record->pieces);
    double *end_state = status == TVI_OK ? take(record, record->state_size * sizeof *end_state) : NULL;
    if (!end_state) return TVI_ENOMEM;
    record->pieces[record->counts.pieces.count++] =
        (tvi_piece){record->step_count, starts_anew, TVI_END_AT_STEP, end_state};
    record->begins_piece = false;
    return TVI_OK;
}

/* Copies the history from which the integrator has made its last step. */
static tvi_status add_checkpoint(tvi_record *record, const tvi_integrator *it)
{
    tvi_status status =
        grow(record, (void **)&record->checkpoints, &record->counts.checkpoints, sizeof *record->checkpoints);
    char *history = status == TVI_OK ? take(record, it->history.bytes) : NULL;
    if (!history) return TVI_ENOMEM;
    tvi_integrator_copy_before(it, history);
    record->checkpoints[record->counts.checkpoints.count++] = (tvi_checkpoint){record->step_count, history};
    return TVI_OK;
}

static tvi_status add_row(tvi_record *record, double h)
{
    const size_t count = record->counts.rows.count;
    if (count > 0 && record->rows[count - 1].h == h) return TVI_OK;
    const tvi_status status = grow(record, (void **)&record->rows, &record->counts.rows, sizeof *record->rows);
    if (status == TVI_OK) record->rows[record->counts.rows.count++] = (tvi_row_of_h){record->step_count, h};
    return status;
}

/* Keeps the state at the start of an integrator's last step. */
static tvi_status keep_state(tvi_record *record, const tvi_integrator *it)
{
    const size_t size = record->state_size;
    const tvi_status status = grow_to(record, (void **)&record->kept.states, &record->kept.of, size * sizeof(double),
                                      (size_t)record->kept.most);
    if (status == TVI_OK)
        tvi_full_state_get(&it->last_step.start, it->stepped->n, record->kept.states + size * record->kept.of.count++);
    return status;
}

tvi_status tvi_record_add_step(tvi_record *record, const tvi_integrator *it)
{
    const bool starts_anew = !*it->last_step.was_state_from_step;
    const bool begins_piece = record->begins_piece || starts_anew;
    if (!has_parameters_of(record, it))
        return jet_refuse(TVI_EUNSUPPORTED, "an observer has set parameters: a record has one set of them");
    if ((long)record->kept.of.count == record->kept.most ||
        record->kept.first_step + (long)record->kept.of.count != record->step_count)
        record->kept.first_step = record->step_count, record->kept.of.count = 0;
    tvi_status status = begins_piece ? add_piece(record, starts_anew) : TVI_OK;
    if (status == TVI_OK && (begins_piece || record->kept.of.count == 0)) status = add_checkpoint(record, it);
    if (status == TVI_OK) status = add_row(record, it->last_step.h);
    if (status == TVI_OK) status = keep_state(record, it);
    if (status == TVI_OK && record->integrals.count > 0) status = tvi_integrals_add_step(record, it);
    if (status != TVI_OK) {
        forget_from(record, record->step_count);
        record->begins_piece = begins_piece;
        return status;
    }
    tvi_full_state_get(&it->state, it->stepped->n, record->pieces[record->counts.pieces.count - 1].end_state);
    record->step_count++;
    return TVI_OK;
}

void tvi_record_drop_step(tvi_record *record)
{
    const size_t pieces = record->counts.pieces.count;
    record->step_count--;
    forget_from(record, record->step_count);
    tvi_integrals_drop_step(record);
    record->kept.of.count--;
    record->begins_piece = record->counts.pieces.count < pieces;
    if (!record->begins_piece)
        memcpy(record->pieces[record->counts.pieces.count - 1].end_state,
               record->kept.states + record->state_size * record->kept.of.count,
               record->state_size * sizeof *record->kept.states);
}

tvi_status tvi_record_end_run(tvi_record *record, const tvi_integrator *it, tvi_piece_end end, double t,
                              const double q[], const double p[])
{
    const size_t n = (size_t)it->system->n;
    if (!record->writer) return TVI_OK;
    record->writer = NULL;
    if (record->step_count > record->steps_before_run) record->pieces[record->counts.pieces.count - 1].end = end;
    memcpy(record->end, q, n * sizeof *q);
    memcpy(record->end + n, p, n * sizeof *p);
    record->end[2 * n] = t;
    if (end != TVI_END_AT_EVENT || record->integrals.count == 0) return TVI_OK;
    return tvi_integrals_cut_step(record, it, record->told[record->counts.told.count - 1].offset);
}

void tvi_record_mark_exit(tvi_record *record) { record->told[record->counts.told.count - 1].is_exit = true; }

void tvi_record_close(tvi_record *const *record)
{
    if (*record) (*record)->writer = NULL;
}

/* Makes the steps between two checkpoints again, and keeps their states. */
static tvi_status make_steps_again(tvi_record *record, size_t checkpoint)
{
    tvi_integrator *again = record->again;
    const size_t n = (size_t)again->system->n, last = record->counts.checkpoints.count - 1;
    const long first = record->checkpoints[checkpoint].step,
               end = checkpoint < last ? record->checkpoints[checkpoint + 1].step : record->step_count;
    double *x = malloc((2 * n + 1) * sizeof *x);
    if (!x) return jet_explain_out_of_memory(TVI_ENOMEM);
    tvi_arena_copy_history(again->history.now, record->checkpoints[checkpoint].history, again->history.bytes);
    tvi_integrator_copy_state(again, &x[2 * n], x, x + n);
    record->kept.first_step = first;
    record->kept.of.count = 0;
    tvi_status status = TVI_OK;
    for (long step = first; step < end && status == TVI_OK; step++) {
        status = tvi_step(again, tvi_record_size_of_step(record, step), &x[2 * n], x, x + n);
        if (status == TVI_OK) status = keep_state(record, again);
    }
    if (status != TVI_OK) record->kept.of.count = 0;
    free(x);
    return status;
}

double tvi_record_size_of_step(const tvi_record *record, long step)
{
    size_t low = 0, high = record->counts.rows.count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (record->rows[middle].first_step <= step) low = middle;
        else high = middle;
    }
    return record->rows[low].h;
}

tvi_status tvi_record_state(tvi_record *record, long step, const double **state)
{
    if (step < record->kept.first_step || step >= record->kept.first_step + (long)record->kept.of.count) {
        size_t i = record->counts.checkpoints.count - 1;
        while (record->checkpoints[i].step > step) i--;
        const tvi_status status = make_steps_again(record, i);
        if (status != TVI_OK) return status;
    }
    *state = record->kept.states + record->state_size * (size_t)(step - record->kept.first_step);
    return TVI_OK;
}

/* ---- What a run tells -------------------------------------------------------------------------------------------- */

/* Finds the tape of the gradient of an event function, which has the parameters of the record, or creates it. */
static tvi_status find_event_gradient(tvi_record *record, const tvi_event *event, tvi_event_gradient **found)
{
    const int parameters = tvi_system_parameters(record->again->system);
    for (size_t i = 0; i < record->counts.event_gradients.count; i++)
        if (record->event_gradients[i].hash == event->hash) {
            *found = &record->event_gradients[i];
            return TVI_OK;
        }
    tvi_status status = grow(record, (void **)&record->event_gradients, &record->counts.event_gradients,
                             sizeof *record->event_gradients);
    if (status != TVI_OK) return status;
    tvi_event_gradient *made = *found = &record->event_gradients[record->counts.event_gradients.count];
    *made = (tvi_event_gradient){.hash = event->hash};
    status = tvi_event_create_gradient_tape(&made->tape, event, parameters);
    if (status == TVI_OK) made->block = jet_tape_create_block(made->tape, 1);
    if (status == TVI_OK && made->block) {
        record->counts.event_gradients.count++;
        return TVI_OK;
    }
    jet_tape_free(made->tape);
    return jet_explain_out_of_memory(TVI_ENOMEM);
}

static tvi_status compute_event_gradient(tvi_record *record, const tvi_event *event, const double state[],
                                         double gradient[])
{
    tvi_event_gradient *of = NULL;
    const tvi_status status = find_event_gradient(record, event, &of);
    if (status != TVI_OK) return status;
    memcpy(of->block, state, (2 * (size_t)event->n + 1) * sizeof *state);
    jet_tape_set_parameters(of->tape, of->block, 1, tvi_system_parameters(record->again->system), 1,
                            record->again->parameters);
    if (!jet_sweep_values(of->tape, of->block, 1))
        return jet_refuse(TVI_EDOMAIN, "the derivatives of an event function have no value");
    for (int i = 0; i < of->tape->output_count; i++) gradient[i] = of->block[of->tape->output_slot[i]];
    return TVI_OK;
}

tvi_status tvi_record_tell(tvi_record *record, const tvi_event *event, bool is_before_step, double offset, double t,
                           const double q[], const double p[])
{
    const size_t n = (size_t)record->again->system->n;
    tvi_told told = {.step = record->step_count - (is_before_step ? 0 : 1),
                     .offset = offset,
                     .index = event ? record->event_count : record->time_count};
    if (told.step < 0) return jet_refuse(TVI_EUNSUPPORTED, "times[%d] is in a step before the record", told.index);
    tvi_status status = grow(record, (void **)&record->told, &record->counts.told, sizeof *record->told);
    const size_t bytes = told_bytes(record, event);
    told.state = status == TVI_OK ? take(record, bytes) : NULL;
    if (!told.state) return TVI_ENOMEM;
    memcpy(told.state, q, n * sizeof *q);
    memcpy(told.state + n, p, n * sizeof *p);
    told.state[2 * n] = t;
    told.gradient = event ? told.state + 2 * n + 1 : NULL;
    if (event) status = compute_event_gradient(record, event, told.state, told.gradient);
    if (status != TVI_OK) {
        record->bytes.taken -= bytes;
        free(told.state);
        return status;
    }
    *(event ? &record->event_count : &record->time_count) += 1;
    record->told[record->counts.told.count++] = told;
    return TVI_OK;
}
