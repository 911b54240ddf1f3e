/* field.h - Declares the field of a system at the nodes of the Galerkin curve, which gives the rates of the unknowns.
 * Separable systems, Lagrangians and Hamiltonians differ in the functions of galerkin_field_form, and in the order of
 * their equations (galerkin_is_second_order). The stepper (galerkin.c) calls these functions. */
#ifndef TVI_SRC_GALERKIN_FIELD_H
#define TVI_SRC_GALERKIN_FIELD_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "method/stepper.h"
#include "system/roundoff.h"

#include <math.h>

typedef struct galerkin_field_form galerkin_field_form;

/* The equations of a step at its nodes, with all that evaluates them: the field, the nodes and tables. The unknowns are
 * the positions Q at the nodes for a separable system, and positions and momenta (Q, P) otherwise. Their rates are the
 * forces F, with Q'' = F, or the velocities and forces (V, F). */
typedef struct {
    const tvi_system *system;
    const galerkin_field_form *form;
    const galerkin_kernels *kernels;
    int node_count; /* the number of nodes; further lanes repeat the last node */
    galerkin_nodes nodes;
    /* The number of rows of nodes.values that a pass reads. While roundoff is measured, a copy of these rows is
     * kept. */
    int node_value_row_count_read_by_pass;
    /* The step size h for which the weights and scales of the nodes were computed; 0 before the first step. */
    double step_size;
    double *node_weight; /* [lanes] the quadrature weights b_j; 0 for lanes that repeat the last node */
    /* [unknowns] The row of nodes.values that contains the rate of each unknown. */
    int *rate_row_of_unknown;
    /* [unknowns] 1/h for each unknown, where h is the step size: the factor that turns sums of impulses (step size
     * times quadrature weight times rate) into rates. It is used when rates are predicted from the impulses of earlier
     * steps. */
    double *rate_per_impulse;
    double *tape_block; /* the block of the field's tape, whose inputs include the time */
    /* [j][i] The matrix of coefficients.h, a_ij / b_j, or (a a)_ij / b_j for a separable system. */
    double *node_impulse_to_node_unknown_matrix;
    /* [j][i] The factor of the impulse of node j in the predicted quantity at node i. The predicted quantity is the
     * unknown in the fixed-point form, and h times the rate of the unknown in the other forms. */
    double *impulse_to_predicted_unknown_or_rate_matrix;
    /* The roundoff that is added to the outputs of the field's tape while the roundoff of a pass is measured; NULL
     * otherwise. */
    tvi_roundoff_estimator *tape_output_roundoff_to_add;
    /* The memory of the form: lagrangian_work or hamiltonian_work, or NULL for the fixed-point form. The first member
     * of both structures is the context of the passes. */
    void *lagrangian_or_hamiltonian_pass_workspace;
} galerkin_equations;

struct galerkin_field_form {
    void (*allocate)(galerkin_equations *equations, tvi_arena *arena);
    /* Sets the index lists and tables of the form, after the coefficients of the nodes have been computed. */
    void (*set_tables)(galerkin_equations *equations);
    /* Predicts the unknowns of all nodes from the rates at the start of the step. */
    tvi_status (*predict_from_start)(galerkin_equations *equations, const tvi_step_origin *origin);
    /* Predicts the unknowns from the impulses of earlier steps and the factors in `extrapolation`, which contain
     * impulse_to_predicted_unknown_or_rate_matrix. NULL: the kernel `predict` predicts the unknowns. */
    void (*predict)(void *lagrangian_or_hamiltonian_pass_workspace, const galerkin_nodes *nodes,
                    const galerkin_extrapolation *extrapolation);
    /* Makes a pass, without counting it. NULL: galerkin_make_pass evaluates the field and moves the unknowns by their
     * rates. */
    tvi_status (*pass)(galerkin_equations *equations, double *movement, tvi_stats *stats);
    /* Writes the form's constants into generated code. */
    void (*emit)(jet_text *text, const galerkin_equations *equations);
    const char *const *text;
};

/* The rules that end the passes of a fixed-point iteration, of a Newton method that reuses its Jacobian, and of
 * Newton's method (probe.c). */
extern const tvi_stopping_rule tvi_galerkin_fixed_point, tvi_galerkin_quasi_newton, tvi_galerkin_newton;

/* The forms of the field. In the fixed-point form the rates are outputs of the tape, and passes are a fixed-point
 * iteration. The passes of the forms of a Lagrangian and of a Hamiltonian also use second derivatives. */
extern const galerkin_field_form tvi_galerkin_form_fixed_point, tvi_galerkin_form_lagrangian,
    tvi_galerkin_form_hamiltonian;

/* Returns true if the equations are Q'' = F, and false if they are Q' = V and P' = F. */
static inline bool galerkin_is_second_order(const galerkin_equations *equations)
{
    return equations->system->form == TVI_SEPARABLE;
}

/* Writes the steps of one system into generated code, after the sweeps of its tapes (emit.c). `rule` decides when the
 * passes of a step end. */
void tvi_galerkin_emit_steps(jet_text *text, const galerkin_equations *equations, const tvi_stopping_rule *rule);
/* Writes the definition of the array `static const int galerkin_NAME[]`, with a 0 after its last element. */
void tvi_galerkin_emit_int_array(jet_text *text, const char *name, int count, const int value[]);
extern const char *const tvi_embedded_galerkin_plain[], *const tvi_embedded_galerkin_lagrangian[];
extern const char *const tvi_embedded_galerkin_hamiltonian[];
/* Returns the number of rows at the start of a tape's block that a sweep reads and does not write: inputs and
 * constants. */
static inline int galerkin_count_input_and_constant_rows(const jet_tape *tape)
{
    return tape->input_count + tape->constant_count;
}

/* Adds numbers of the size of tape_output_roundoff_to_add, with random signs, to the outputs of a tape in its block. */
void tvi_galerkin_perturb_tape_outputs_by_roundoff(const galerkin_equations *equations, const jet_tape *tape,
                                                   double *block);

/* Evaluates the field's tape at the unknowns, which are its inputs. */
static inline tvi_status galerkin_evaluate_field(galerkin_equations *equations)
{
    const jet_tape *tape = equations->system->field_values;
    double *block = equations->nodes.values;
    if (!jet_sweep_values(tape, block, equations->nodes.lane_count)) return TVI_EDOMAIN;
    if (equations->tape_output_roundoff_to_add) tvi_galerkin_perturb_tape_outputs_by_roundoff(equations, tape, block);
    return TVI_OK;
}

/* Moves the unknowns by their rates. Returns the movement: the sum of the squares of the relative changes of the
 * unknowns. */
static inline double galerkin_move_unknowns_sum_squared_changes(const galerkin_equations *equations)
{
    return equations->kernels->move(&equations->nodes, equations->node_impulse_to_node_unknown_matrix,
                                    equations->nodes.values, equations->rate_row_of_unknown);
}

/* Predicts the unknowns from the impulses of earlier steps. */
static inline void galerkin_predict_unknowns(const galerkin_equations *equations,
                                             const galerkin_extrapolation *extrapolation)
{
    if (equations->form->predict)
        equations->form->predict(equations->lagrangian_or_hamiltonian_pass_workspace, &equations->nodes, extrapolation);
    else equations->kernels->predict(&equations->nodes, extrapolation);
}

/* Makes a pass: evaluates the rates of the unknowns, moves the unknowns by their rates, and counts the pass. *movement
 * becomes the sum of the squares of the relative changes of the unknowns. */
static inline tvi_status galerkin_make_pass(galerkin_equations *equations, double *movement, tvi_stats *stats)
{
    stats->force_evaluations += equations->node_count;
    if (equations->form->pass) {
        const tvi_status status = equations->form->pass(equations, movement, stats);
        if (status != TVI_OK) return status;
    } else {
        if (galerkin_evaluate_field(equations) != TVI_OK) return TVI_EDOMAIN;
        *movement = galerkin_move_unknowns_sum_squared_changes(equations);
    }
    stats->passes++;
    return isfinite(*movement) ? TVI_OK : TVI_ENONFINITE;
}

#endif
