/* galerkin.h - Declares the memory of the stepper of the Galerkin curve, and the functions that galerkin.c calls for
 * what is computed once or seldom: tables, predictions from a step of another size, the roundoff of a pass, the curve
 * at other points, and generated steps. steps.h has the step itself. */
#ifndef TVI_SRC_GALERKIN_GALERKIN_H
#define TVI_SRC_GALERKIN_GALERKIN_H

#include "galerkin/steps.h"
#include "galerkin/tables.h"
#include "system/legendre.h"
#include "system/roundoff.h"

/* ---- The memory of a stepper ------------------------------------------------------------------------------------- */

/* The history of the last two steps, from which the next one is predicted. It is a part of the integrator's history, as
 * the impulses in galerkin_step.ring are. */
typedef struct {
    double last_h, previous_h; /* the sizes of the last step and of the one before it; 0 if there is none */
    double last_t;             /* the time at which the last step began */
    /* The convergence of the last step's passes, or of earlier ones if the last passes do not show it. */
    galerkin_convergence convergence;
    long ring_index; /* the index in galerkin_step.ring of the impulses of the last step */
} galerkin_history;

/* Memory of the prediction (predictor.c). */
typedef struct {
    galerkin_history *history;
    /* [j][lanes] The factors of the last step's impulses in the rates of a step that is `ratio` times as large and
     * begins at the fraction `elapsed` of the last step. The ratio is 0 before the first computation. */
    double *resized_table, ratio, elapsed;
    double *rates;        /* [unknowns][lanes] the rates that resized_table gives */
    double *zeros, *ones; /* [unknowns + lanes] */
} galerkin_predictor;

/* Memory for measuring the roundoff of a pass (probe.c). */
typedef struct galerkin_probe {
    tvi_roundoff_estimator roundoff;
    int row_count; /* the number of rows of nodes.x that a pass reads */
    /* [row_count][lanes] These rows before a pass, and after a pass from displaced unknowns. */
    double *before, *displaced;
    double *saved_free_motion_low, *saved_impulse; /* [unknowns][lanes] */
} galerkin_probe;

typedef struct {
    const tvi_options *options;
    int n;
    galerkin_step step;
    galerkin_coefficients coefficients;
    galerkin_polynomials polynomials;
    galerkin_predictor predictor;
    galerkin_probe probe;
    double *increment_scale; /* [2n] the factors of the sums of impulses in the increments of q and p */
    double *rate_scale;      /* [unknowns] 1 / h, the factor of sums of impulses in predicted rates */
    /* [j][i] What the prediction makes of an impulse of node j at node i: an unknown, nu_ij; or in forms with second
     * derivatives a rate times h, which is 1 / b_i of its own impulse. */
    double *predicted_by_impulse;
    double *tape_block; /* the block of the tape of the field's values, whose inputs include the time */
    /* Lists that the members of the same name in step, step.field and the passes point to (forms.c): valid after
     * tvi_galerkin_set_form, and NULL where the form does not need them. */
    struct {
        int *rate_row, *slot[2], *unknown_of_row, *index_in_block, *row_end, *element_column, *element_slot;
    } lists;
    tvi_legendre_transform legendre;                 /* for a Lagrangian */
    double *start_velocity;                          /* [n] a Lagrangian's velocity at the start of the step */
    const galerkin_generated_steps *generated_steps; /* NULL: the library makes all steps */
} galerkin_work;

/* ---- galerkin.c -------------------------------------------------------------------------------------------------- */

/* Makes a pass, for probe.c. A file that called galerkin_make_pass of steps.h itself would compile its loops once
 * more. */
tvi_status tvi_galerkin_make_pass(const galerkin_step *step, double *movement, galerkin_counts *counts);

/* What constrained.c calls of a step, whose parts galerkin.c describes. */
int tvi_galerkin_lane_count(int node_count);
void tvi_galerkin_set_step_size(galerkin_work *work, double h);
void tvi_galerkin_set_node_times(const galerkin_work *work, const tvi_step_origin *origin, double h);
tvi_status tvi_galerkin_predict_from_start(galerkin_work *work, const tvi_step_origin *origin);

/* ---- dense.c: the curve at other points -------------------------------------------------------------------------- */

/* Points of a curve: out[u][k] = start[u] + (theta[k] move[u] + scale[u] sum_j table_jk L[u][j]) for the components u <
 * count and the points k < points. The number of points is 1, the number of lanes or TVI_SAMPLES. */
typedef struct {
    int lane_count, points, count;
    const double *theta, *start, *move, *scale;
} galerkin_curve_points;

/* Computes `out` [count][points] from the impulses L [count][lanes] and a table [lanes][points]. */
void tvi_galerkin_evaluate(const galerkin_curve_points *at, const double *table, const double *L, double *out);
/* The functions `quadrature`, `at_nodes`, `compute_curve_forces`, `interpolate` and `sample` of the stepper
 * (method/stepper.h). */
int tvi_galerkin_quadrature(const void *self, double theta[], double b[]);
void tvi_galerkin_at_nodes(void *self, const double q_start[], const double p_start[], double *q, double *p);
int tvi_galerkin_curve_forces(const void *self, double *forces);
void tvi_galerkin_interpolate(void *self, double theta, double dq[], double dp[]);
void tvi_galerkin_sample(void *self, const tvi_component_range used[2], const double q_start[], const double p_start[],
                         double *q, double *p);

/* ---- forms.c: the three forms of the equations ------------------------------------------------------------------- */

/* Allocates what the form needs, after the nodes. */
void tvi_galerkin_allocate_form(galerkin_work *work, tvi_arena *arena);
/* Sets lists and pointers, after the coefficients are computed. */
void tvi_galerkin_set_form(galerkin_work *work);
/* Inverts the matrix of each lane by elimination with row exchanges; lu_factor is a tvi_lu_factor. Returns false if a
 * matrix is singular or not finite. */
bool tvi_galerkin_invert_by_exchanges(const node_matrix *matrix, int lanes, void *lu_factor);

/* ---- predictor.c: the prediction from earlier steps (docs/method.md section 5) ----------------------------------- */

void tvi_galerkin_allocate_predictor(galerkin_work *work, tvi_arena *arena);
void tvi_galerkin_set_predictor(galerkin_work *work);
/* Returns whether the last step can predict the next one, of size step.h from time t, because its nodes are near those
 * of the last step. It cannot in the first step of a run. *elapsed is the fraction of the last step at which the new
 * step begins: 1 for its end, 0 for its start. */
bool tvi_galerkin_can_predict(const galerkin_work *work, double t, double *elapsed);
/* Returns the prediction from the last step, which has another size or begins elsewhere. */
galerkin_extrapolation tvi_galerkin_resize_last_step(galerkin_work *work, double elapsed);

/* ---- probe.c: the rules that end passes, and the roundoff of a pass (docs/method.md section 5) ------------------- */

/* Returns the rule that ends the passes of this system, with the user's options. */
tvi_stopping_rule tvi_galerkin_make_stopping_rule(const galerkin_work *work);
void tvi_galerkin_allocate_probe(galerkin_work *work, tvi_arena *arena);

/* ---- emit_steps.c: generated steps ------------------------------------------------------------------------------- */

/* The names of the tapes of the field's values and of its second derivatives in generated code. To such a name
 * jet_emit_tape (ad/emit.h) appends _values_LANES, _is_split and the like, and emit_steps.c does the same. */
#define GALERKIN_VALUES_TAPE  "tvi_values"
#define GALERKIN_HESSIAN_TAPE "tvi_hessian"

/* Writes the generated steps of one system, after the sweeps of its tapes. */
void tvi_galerkin_emit_steps(jet_text *text, const galerkin_work *work);

#endif
