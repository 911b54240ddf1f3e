/* system.h - what the steppers need of the user's problem. */
#ifndef TVI_SRC_SYSTEM_SYSTEM_H
#define TVI_SRC_SYSTEM_SYSTEM_H

#include "algebra/block.h"
#include "algebra/subsystems.h"
#include "tvi.h"

/* The forms in which equations of motion reach the steppers. A Lagrangian or a Hamiltonian whose structure allows it
 * becomes separable when it is made, and costs what a potential costs. */
typedef enum {
    TVI_SEPARABLE,  /* M q'' = F(q, t), M diagonal and constant */
    TVI_LAGRANGIAN, /* d/dt L_v = L_q                           */
    TVI_HAMILTONIAN /* q' = H_p, p' = -H_q                      */
} tvi_form;

/* The second derivative in inputs row and column, row >= column. */
typedef struct {
    int row, column;
} tvi_second;

/* Inputs of the field tapes, and of the energy: separable q (and t); Lagrangian q, v (and t); Hamiltonian q, p (and t).
 * Outputs of the field: separable F; Lagrangian L_q, L_v; Hamiltonian H_q, H_p. */
struct tvi_system {
    int n;
    tvi_system *stepped; /* what steps are made of: the system itself; of a rescaled one, K in n + 1 (rescaled.c) */
    tvi_form form;
    int inputs;      /* q and, unless separable, v or p: where the time stands, if it is used */
    bool uses_time;  /* the field depends on t */
    bool is_driven;  /* there are forces in the field that the energy does not give */
    double *mass;    /* [n] of a separable system; and of others where */
    bool has_masses; /* p = M v + f(q, t), M diagonal and constant, as in a turning frame, or of a driven system */
    tvi_subsystems parts;
    bool regular;      /* Lagrangian, Hamiltonian: L_vv or H_pp is regular somewhere */
    bool is_automatic; /* K of a system whose user gave no g */
    jet_graph *graph;  /* closed; kept so that jets that outlive it are recognised, and for the lift */
    jet *field;        /* [inputs] the outputs of the field, in the graph */
    jet_tape *field_series;
    jet_tape *field_values;
    jet_tape *
        bend_values; /* Hamiltonian: inputs q, p, t, r; outputs the gradient of r.H_p in q and p, for truncated nodes */
    jet_tape *second_values; /* Lagrangian: outputs the field, then the second derivatives of L in (q, v) that are not 0
                                everywhere, one of each pair; Hamiltonian: as second.h has it, or NULL */
    tvi_second *second;      /* [seconds] which they are */
    int seconds;
    bool second_is_whole;        /* of a Hamiltonian: nothing is left out of them */
    jet_tape *energy;            /* separable: V; Lagrangian: L; Hamiltonian: H. NULL for a force */
    jet stated;                  /* V, L or H, in the graph; not of a force, nor of a lift */
    double energy_sign;          /* separable from a Lagrangian: the energy tape gives -V */
    const struct tvi_code *code; /* that runs the tapes; NULL: they are interpreted */
    int energy_inputs;           /* of the energy tape without t: n or 2n (v or p = 0 where only V is asked) */
};

/* The Hamiltonian g h, factor = {g, h}, of which solutions with h = 0 are asked for, with second derivatives if they
 * are cheap beside the field (second.h). */
typedef void tvi_factors_fn(const jet q[], const jet p[], jet t, void *ctx, jet factor[2]);
TVI_NODISCARD tvi_status tvi_system_product(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx);

/* The lift of a system to 2n degrees of freedom: (q, p) and a tangent vector (dq, dp) that moves with it, by H_q.dq +
 * H_p.dp or L_q.dq + L_v.dv (docs/method.md section 10). Coordinates (q, dq), momenta (dp, p). A separable system has a
 * separable lift, too, for methods that pair no momenta with coordinates: masses twice, momenta (p, dp). The lift
 * shares nothing with the system. *out is NULL on failure. */
typedef enum { TVI_LIFT_PAIRED, TVI_LIFT_SEPARABLE } tvi_lift;
TVI_NODISCARD tvi_status tvi_system_lift(tvi_system **out, const tvi_system *system, tvi_lift lift);

/* Fills the blocks of its tapes; with these values of the parameters, NULL: as recorded. */
void tvi_system_prepare(const tvi_system *system, const tvi_block *blocks, const double parameters[]);
/* value[tvi_system_parameters]; those that no function names stay as they are. */
void tvi_system_recorded_parameters(const tvi_system *system, double value[]);

/* Of a base that is ctx and has an energy: H, sum p_i^2 / (2 m_i) + V where there are masses; L of a Lagrangian. */
jet tvi_stated_hamiltonian(const jet q[], const jet p[], jet t, void *ctx);
jet tvi_stated_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

/* While it is recorded, v the inputs n .. 2n - 1: whether `linear` [n] = diag(d) v with d > 0, and no component of
 * `other` [n] depends on v; then system->mass = d. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_separable(tvi_system *system, const jet linear[], const jet other[],
                                                   bool *separable);

/* While it is recorded: whether `linear` = diag(d) v + what does not depend on v; then has_masses, and mass = d. */
void tvi_system_find_inertia(tvi_system *system, const jet linear[]);

/* Of the field that is there: system->parts. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_subsystems(tvi_system *system);

/* Of the field. */
static inline int tvi_system_outputs(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE ? system->n : 2 * system->n;
}

/* Writes the time to all lanes of order 0 of a block of a tape whose first inputs are the system's. */
static inline void tvi_system_set_time(const tvi_system *system, double *x, int lanes, const double t[])
{
    if (!system->uses_time) return;
    for (int lane = 0; lane < lanes; lane++) x[system->inputs * lanes + lane] = t[lane];
}

#endif
