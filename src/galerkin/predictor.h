/* predictor.h - Predicts the unknowns of a step from the impulses of earlier steps (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_PREDICTOR_H
#define TVI_SRC_GALERKIN_PREDICTOR_H

#include "galerkin/coefficients.h"
#include "galerkin/field.h"

/* The history of the last two steps. The integrator's history stores this structure and the impulses. */
typedef struct {
    /* The sizes of the last step and of the step before it; 0 if there is none. */
    double step_size, previous_step_size;
    double start_time; /* the time at which the last step began */
    /* The convergence of the last step's passes, or of earlier ones if the last passes do not show it. */
    galerkin_convergence convergence;
    long last_ring_index; /* the index of the last step's impulses in the ring */
} galerkin_history;

/* Returns whether last_ring_index of a loaded history is within the ring. */
static inline bool galerkin_is_ring_index_valid(const galerkin_history *history)
{
    return history->last_ring_index >= 0 && history->last_ring_index < GALERKIN_RING;
}

typedef struct {
    galerkin_history *history;
    /* The impulses of the last steps, [unknowns][lanes] each, stored in the history as a ring buffer. */
    double *impulse_ring[GALERKIN_RING];
    /* The tables of galerkin_extrapolation, for earlier steps of the same size as this step. */
    double *two_step_table, *last_step_table;
    /* If the first movement of a step is larger than this, its prediction had a relative error above 1/100. The next
     * step is then predicted from the last step alone. */
    double rough_movement_limit;
    /* [j][lanes] The factors of the last step's impulses in the rates of a step that is table_step_ratio times as
     * large and begins at table_elapsed_part of the last step. */
    double *resized_step_table;
    /* For which step resized_step_table was computed. The ratio is 0 before the first computation. */
    double table_step_ratio, table_elapsed_part;
    /* [unknowns][lanes] The rates that were extrapolated from the last step. */
    double *extrapolated_rates;
    double *zeros, *ones; /* [unknowns + lanes] vectors of zeros and of ones */
} galerkin_predictor;

void tvi_galerkin_allocate_predictor(galerkin_predictor *predictor, tvi_arena *arena, const galerkin_field *field);
void tvi_galerkin_prepare_predictor(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                    const galerkin_field *field);
/* Returns whether a step of size h from time t begins where the last step ended. */
static inline bool galerkin_follows_last_step(const galerkin_history *history, double h, double t)
{
    return fabs(t - (history->start_time + history->step_size)) < 0.25 * fabs(h);
}

/* Returns whether the last step can predict a step of the field's size from time t, because its nodes are near those
 * of the last step. *elapsed_part is the part of the last step at which the new step begins: 1 for its end, 0 for
 * its start. */
bool tvi_galerkin_can_predict_from_last_step(const galerkin_predictor *predictor, const galerkin_field *field, double t,
                                             double *elapsed_part);
/* Returns how many of the last two steps have the size of this step and lead up to it without a gap: 0 if
 * elapsed_part is not 1. */
int tvi_galerkin_count_steps_of_same_size(const galerkin_predictor *predictor, const galerkin_field *field,
                                          double elapsed_part);
/* Predicts the field's unknowns from the last step, which has another size or starts elsewhere. */
void tvi_galerkin_predict_from_last_step(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                         const galerkin_node_polynomials *polynomials, galerkin_field *field,
                                         double elapsed_part);
/* Returns the impulses of the last step if steps_after_last is 0, of an earlier step if it is negative, and of the next
 * step if it is 1. */
static inline double *galerkin_impulses_of_step(const galerkin_predictor *predictor, int steps_after_last)
{
    return predictor
        ->impulse_ring[(predictor->history->last_ring_index + steps_after_last + GALERKIN_RING) % GALERKIN_RING];
}

#endif
