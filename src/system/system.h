/* system.h - Declares a system as the steppers need it: the tapes of its field and its energy, and its masses.
 * statement.c creates it. */
#ifndef TVI_SRC_SYSTEM_SYSTEM_H
#define TVI_SRC_SYSTEM_SYSTEM_H

#include "algebra/block.h"
#include "algebra/subsystems.h"
#include "tvi.h"

/* The forms of equations of motion that the steppers know. A Lagrangian or a Hamiltonian whose structure allows it
 * becomes separable when it is created, and then costs as little as a potential. */
typedef enum {
    TVI_SEPARABLE,  /* M q'' = F(q, t), with M diagonal and constant */
    TVI_LAGRANGIAN, /* d/dt L_v = L_q                           */
    TVI_HAMILTONIAN /* q' = H_p, p' = -H_q                      */
} tvi_form;

/* The row and column of a second derivative: the numbers of two inputs, row >= column. */
typedef struct {
    int row, column;
} tvi_hessian_entry;

/* A system. The inputs of the tapes of its field and its energy are q if it is separable; q, v of a Lagrangian; q, p
 * of a Hamiltonian; and then t if it is used. The outputs of the field are F; or L_q, L_v; or H_q, H_p. */
struct tvi_system {
    int n;
    /* The system in which steps are made: itself, or the system with the Hamiltonian K in n + 1 coordinates if it is
     * rescaled (rescaled.c). */
    tvi_system *stepped;
    tvi_form form;
    /* Number of the field's inputs without the time. If the time is used, it is the next input. */
    int inputs;
    bool uses_time; /* The field depends on t. */
    bool is_driven; /* The field contains forces that do not come from the energy. */
    /* [n] Masses of a separable system, and of others with has_masses. */
    double *mass;
    /* p = M v + f(q, t) with M diagonal and constant, as in a rotating frame or in a driven system. */
    bool has_masses;
    /* The parts of the tail are compared by the movements of the coordinates (algebra/tail.h). */
    bool compares_movements;
    tvi_subsystems parts;
    /* The same for the tail, in which the time of a rescaled system is a part of its own. */
    tvi_subsystems tail_parts;
    /* L_vv of the Lagrangian, or H_pp of the Hamiltonian, is regular somewhere. */
    bool regular;
    bool is_automatic; /* The time scale in K is the automatic one (automatic.h). */
    /* The closed recording. It is kept to recognise its jets, and to record the tangent system (ad/lift.c). */
    jet_graph *graph;
    /* [inputs] Outputs of the field in the graph. */
    jet *field;
    jet_tape *field_series;
    jet_tape *field_values;
    /* Hamiltonian: the gradient of r.H_p in q and p, for truncated nodes. The inputs are q, p, t, r. */
    jet_tape *bend_values;
    /* Computes the field and then second derivatives. Lagrangian: those of L in (q, v) that are not 0 everywhere,
     * one of each symmetric pair. Hamiltonian: those that hessian.h describes, or NULL. */
    jet_tape *hessian_values;
    tvi_hessian_entry *hessian; /* [hessian_entries] Rows and columns of the second derivatives. */
    int hessian_entries;
    bool hessian_is_complete; /* Hamiltonian: the second derivatives are complete. */
    /* Computes V of a separable system, L of a Lagrangian, or H of a Hamiltonian; NULL for a force. */
    jet_tape *energy;
    /* V, L or H in the graph; unset for a force, and for a lift unless it is a Hamiltonian. */
    jet stated;
    /* -1 if a Lagrangian became separable, since the energy tape then gives -V; otherwise 1. */
    double energy_sign;
    const struct tvi_code *code; /* Generated code that runs the tapes; NULL: they are interpreted. */
    /* Number of inputs of the energy tape without t: n or 2n. To get V, v or p is set to 0. */
    int energy_inputs;
};

/* Creates a system with the Hamiltonian g h, factor = {g, h}, for solutions with h = 0. It has second derivatives if
 * they are cheap (hessian.h). */
typedef void tvi_factors_fn(const jet q[], const jet p[], jet t, void *ctx, jet factor[2]);
TVI_NODISCARD tvi_status tvi_system_create_rescaled(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx);

/* Creates the lift of a system, which moves a state (q, p) together with a tangent vector (dq, dp). It has 2n
 * degrees of freedom, and the Hamiltonian H_q.dq + H_p.dp or the Lagrangian L_q.dq + L_v.dv (docs/method.md, section
 * 10). Its coordinates are (q, dq), and its momenta (dp, p). A separable system also has a separable lift, with the
 * momenta (p, dp) and each mass twice, for methods that do not need momenta to be conjugate to the coordinates. The
 * lift shares nothing with the system. *out is NULL on failure. */
typedef enum { TVI_LIFT_PAIRED, TVI_LIFT_SEPARABLE } tvi_lift;
TVI_NODISCARD tvi_status tvi_system_create_lift(tvi_system **out, const tvi_system *system, tvi_lift lift);

/* Prepares the blocks of the system's tapes, with these values of the parameters. NULL stands for those in the
 * recording. */
void tvi_system_prepare_blocks(const tvi_system *system, const tvi_block *blocks, const double parameters[]);
/* Reads the recorded values of all parameters. Elements of `value` for which no function has a parameter stay as
 * they are. */
void tvi_system_read_recorded_parameters(const tvi_system *system, double value[]);

/* Record H, or L of a Lagrangian, of the system `ctx`, which has an energy. H of a separable system is sum p_i^2 /
 * (2 m_i) + V. */
jet tvi_record_stated_hamiltonian(const jet q[], const jet p[], jet t, void *ctx);
jet tvi_record_stated_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

/* Tells whether `linear` [n] = diag(d) v with d > 0, and no component of `other` [n] depends on v. v are the inputs
 * n .. 2n - 1 of the open recording. If so, it sets system->mass = d. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_separable(tvi_system *system, const jet linear[], const jet other[],
                                                   bool *separable);

/* Finds out whether `linear` = diag(d) v + terms without v, in the open recording. If so, it sets has_masses, and
 * mass = d. */
void tvi_system_find_inertia(tvi_system *system, const jet linear[]);

/* Finds the subsystems of the field, and sets system->parts and tail_parts. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_subsystems(tvi_system *system);
/* Makes the time, the last coordinate of a rescaled system, a part of its own of the tail, which counts in full. */
void tvi_system_split_time_from_tail(tvi_system *system);

/* Returns the number of outputs of the field. */
static inline int tvi_system_output_count(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE ? system->n : 2 * system->n;
}

/* Writes the time to all lanes of order 0 of a block, whose tape begins with the inputs of the system. */
static inline void tvi_system_write_time(const tvi_system *system, double *block, int lanes, const double t[])
{
    if (!system->uses_time) return;
    for (int lane = 0; lane < lanes; lane++) block[system->inputs * lanes + lane] = t[lane];
}

#endif
