/* system.h - Declares a system as the steppers need it: the tapes of its field and its energy, and its masses. */
#ifndef TVI_SRC_SYSTEM_SYSTEM_H
#define TVI_SRC_SYSTEM_SYSTEM_H

#include "algebra/block.h"
#include "algebra/subsystems.h"
#include "tvi.h"

/* The forms in which equations of motion reach the steppers. A Lagrangian or a Hamiltonian whose structure allows it
 * becomes separable when it is created, and costs as little as a potential. */
typedef enum {
    TVI_SEPARABLE,  /* M q'' = F(q, t), M diagonal and constant */
    TVI_LAGRANGIAN, /* d/dt L_v = L_q                           */
    TVI_HAMILTONIAN /* q' = H_p, p' = -H_q                      */
} tvi_form;

/* The second derivative by inputs row and column, row >= column. */
typedef struct {
    int row, column;
} tvi_hessian_entry;

/* A system. The inputs of its field tapes, and of the energy, are q (and t) if it is separable; q, v (and t) of a
 * Lagrangian; q, p (and t) of a Hamiltonian. The outputs of the field are F; L_q, L_v; or H_q, H_p. */
struct tvi_system {
    int n;
    /* The system that steps are made of: itself, or K in n + 1 coordinates if it is rescaled (rescaled.c). */
    tvi_system *stepped;
    tvi_form form;
    /* The number of inputs without the time; the time, if it is used, is the next one. */
    int inputs;
    bool uses_time; /* the field depends on t */
    bool is_driven; /* forces in the field do not come from the energy */
    /* [n] of a separable system, and of others with has_masses. */
    double *mass;
    /* p = M v + f(q, t), M diagonal and constant, as in a rotating frame, or in a driven system. */
    bool has_masses;
    /* The parts of the tail are compared by the movements of the coordinates (algebra/tail.h). */
    bool compares_movements;
    tvi_subsystems parts;
    /* Lagrangian or Hamiltonian: L_vv or H_pp is regular somewhere. */
    bool regular;
    bool is_automatic; /* K of a system whose user gave no g */
    /* The closed recording. It is kept to recognise its jets, and to record the tangent system (ad/lift.c). */
    jet_graph *graph;
    /* [inputs] the outputs of the field in the graph. */
    jet *field;
    jet_tape *field_series;
    jet_tape *field_values;
    jet_tape *
        /* Hamiltonian: inputs q, p, t, r; outputs the gradient of r.H_p in q and p, for truncated nodes. */
        bend_values;
    /* Outputs the field, then second derivatives. Lagrangian: those of L in (q, v) that are not 0 everywhere, one of
     * each symmetric pair. Hamiltonian: as hessian.h has it, or NULL. */
    jet_tape *hessian_values;
    tvi_hessian_entry *hessian; /* [hessian_entries] */
    int hessian_entries;
    bool hessian_is_complete; /* of a Hamiltonian: no term is left out */
    /* V of a separable system, L of a Lagrangian, H of a Hamiltonian; NULL for a force. */
    jet_tape *energy;
    /* V, L or H in the graph; unset for a force and for a lift. */
    jet stated;
    /* -1 if a Lagrangian became separable: its tape gives -V. */
    double energy_sign;
    const struct tvi_code *code; /* runs the tapes; NULL: they are interpreted */
    /* The inputs of the energy tape without t: n or 2n, with v or p = 0 where V is asked for. */
    int energy_inputs;
};

/* Creates the Hamiltonian g h, factor = {g, h}, for solutions with h = 0. It has second derivatives if they cost little
 * beside the field (hessian.h). */
typedef void tvi_factors_fn(const jet q[], const jet p[], jet t, void *ctx, jet factor[2]);
TVI_NODISCARD tvi_status tvi_system_create_rescaled(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx);

/* Creates the lift of a system to 2n degrees of freedom: (q, p) and a tangent vector (dq, dp) that moves with it, by
 * H_q.dq + H_p.dp or L_q.dq + L_v.dv (docs/method.md section 10). Its coordinates are (q, dq), its momenta (dp, p). A
 * separable system also has a separable lift, for methods that pair no momenta with coordinates, with the masses twice
 * and the momenta (p, dp). The lift shares nothing with the system. *out is NULL on failure. */
typedef enum { TVI_LIFT_PAIRED, TVI_LIFT_SEPARABLE } tvi_lift;
TVI_NODISCARD tvi_status tvi_system_lift(tvi_system **out, const tvi_system *system, tvi_lift lift);

/* Fills the blocks of the system's tapes, with these values of the parameters. NULL leaves them as recorded. */
void tvi_system_prepare(const tvi_system *system, const tvi_block *blocks, const double parameters[]);
/* Reads value[tvi_system_parameters] from the recording. Parameters that no function names stay as they are. */
void tvi_system_recorded_parameters(const tvi_system *system, double value[]);

/* Record H, or L of a Lagrangian, of the base `ctx`, which has an energy. With masses H is sum p_i^2 / (2 m_i) + V. */
jet tvi_stated_hamiltonian(const jet q[], const jet p[], jet t, void *ctx);
jet tvi_stated_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

/* Tells whether `linear` [n] = diag(d) v with d > 0, and no component of `other` [n] depends on v, the inputs n .. 2n -
 * 1 of the open recording. Then it sets system->mass = d. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_separable(tvi_system *system, const jet linear[], const jet other[],
                                                   bool *separable);

/* Finds out whether `linear` = diag(d) v + terms without v in the open recording. Then it sets has_masses, and mass =
 * d. */
void tvi_system_find_inertia(tvi_system *system, const jet linear[]);

/* Sets system->parts from the field. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_system_find_subsystems(tvi_system *system);
/* Makes the time, the last coordinate of a rescaled system, a subsystem of its own, whose tail counts in full. */
void tvi_system_split_time(tvi_system *system);

/* The number of outputs of the field. */
static inline int tvi_system_outputs(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE ? system->n : 2 * system->n;
}

/* Writes the time to all lanes of order 0 of a block whose tape has the system's inputs first. */
static inline void tvi_system_set_time(const tvi_system *system, double *x, int lanes, const double t[])
{
    if (!system->uses_time) return;
    for (int lane = 0; lane < lanes; lane++) x[system->inputs * lanes + lane] = t[lane];
}

#endif
