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
    TVI_SEPARABLE,   /* M q'' = F(q, t), with M diagonal and constant */
    TVI_LAGRANGIAN,  /* d/dt L_v = L_q, with L(q, v, t)          */
    TVI_HAMILTONIAN, /* q' = H_p, p' = -H_q, with H(q, p, t)     */
    TVI_FIELD        /* q' = a(q, p, t), p' = b(q, p, t), rates that need come from no H */
} tvi_form;

/* A body of mass 0 has this part of the largest mass (tvi_bodies.h). */
#define TVI_TEST_MASS 1e-30

/* The row and column of a second derivative: the numbers of two inputs, row >= column. */
typedef struct {
    int row, column;
} tvi_hessian_entry;

/* A system. The inputs of the tapes of its field and its energy are q if it is separable; q, v of a Lagrangian; q, p
 * of a Hamiltonian or of a field of rates; and then t if it is used. The outputs of the field are F; or L_q, L_v; or
 * H_q, H_p; or -p', q', so that a field of rates reads as a Hamiltonian does. */
struct tvi_system {
    int n;
    /* The system in which steps are made: this system itself, or, if it is rescaled, a system in n + 1 coordinates:
     * that of the Hamiltonian K, or the field of rates by s (rescaled.c). */
    tvi_system *stepped_system;
    tvi_form form;
    /* The number of inputs of the field without the time. If the time is used, it is the next input. */
    int input_count;
    bool uses_time; /* The field depends on the time t, which then is an input of its tape. */
    bool is_driven; /* The field contains forces that do not come from the energy. */
    /* [n] The masses of a separable system, and of others with has_masses. */
    double *mass;
    /* The momenta are p = M v + f(q, t), with a diagonal and constant M, as in a rotating frame or in a driven
     * system. */
    bool has_masses;
    tvi_subsystems subsystems; /* The parts of the system that do not interact. */
    /* What the tail of a step (algebra/tail.h) needs to know; valid in every system. */
    struct {
        /* The subsystems whose components the tail compares: those of the system, except that the time of a rescaled
         * system is a subsystem of its own. */
        tvi_subsystems subsystems;
        /* A component's share of the motion, by which the tail weighs it, is computed from the change of its coordinate
         * alone, without its momentum. */
        bool has_shares_without_momenta;
        bool has_automatic_scale; /* The time scale in K is the automatic one (automatic.c). */
    } tail;
    /* True if the matrix L_vv of the Lagrangian, or H_pp of the Hamiltonian, was found to be regular at some state. */
    bool is_regular;
    /* The coordinates are places of bodies in a space of so many axes, 1 to 3, which attract each other. Negative: of
     * bodies that do not, in a field that the user has given. 0: they are not known to be places. */
    int axes;
    struct tvi_constraints *constraints; /* The constraints phi(q, t) = 0 (constraint.h); NULL: there are none. */
    /* The recording, finished once the system is created. It is kept to recognise its jets, and to record the tangent
     * system (ad/lift.c). */
    struct {
        jet_graph *graph;
        jet *field;        /* [inputs] The outputs of the field in the graph. */
        jet user_function; /* The user's V, L or H; unset for a force, and for a lift unless it is a Hamiltonian. */
        bool is_tangent;   /* tvi_system_tangent has recorded it: no other system is made of it. */
        struct tvi_adjoint *adjoint; /* The adjoint system, if a gradient has asked for it (adjoint.h). */
    } record;
    jet_tape *field_series; /* Computes the Taylor series of the field. */
    jet_tape *field_values; /* Computes the values of the field. */
    /* Computes the gradient of r.H_p by q and p, for a vector r. The node rule TVI_NODES_TRUNCATED of a Hamiltonian
     * needs it. The inputs are q, p, t, r. */
    jet_tape *r_dot_Hp_values;
    /* Second derivatives, those that are not 0 everywhere, one of each symmetric pair. Lagrangian: those of L by q and
     * v. Hamiltonian K = g f of a rescaled system, whose solutions have f = 0: those of K by q and p, or, if these are
     * too expensive, the same without the term f g''; none if those are, too. None for all other systems: `values` is
     * NULL, and entry_count is 0. */
    struct {
        jet_tape *values;         /* Computes the field and then the second derivatives. */
        tvi_hessian_entry *entry; /* [entry_count] Rows and columns of the second derivatives. */
        int entry_count;
        bool is_complete; /* `values` contains the complete K'' of a rescaled Hamiltonian. */
    } hessian;
    /* The energy: `tape` is NULL for a force, and the other members are then unused. */
    struct {
        jet_tape *tape; /* Computes V of a separable system, L of a Lagrangian, or H of a Hamiltonian. */
        double sign;    /* -1 if a Lagrangian became separable, since the tape then gives -V; otherwise 1. */
        /* The number of inputs of the tape without t: n, or 2n. In a separable system with 2n inputs, V is the energy
         * at v = 0 or p = 0, up to its sign. */
        int input_count;
    } energy;
    /* Generated code for the tapes. NULL: the interpreter runs the tapes. */
    const struct tvi_generated_code *code;
};

/* Creates a system with the Hamiltonian g f for solutions with f = 0. The function `factors` records factor = {g, f}.
 * The system has second derivatives if they are cheap (tvi_record_hessian_of_factored_H). */
typedef void tvi_factors_fn(const jet q[], const jet p[], jet t, void *ctx, jet factor[2]);
TVI_NODISCARD tvi_status tvi_system_create_from_factors(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx);

/* Creates a system of the form TVI_FIELD. The function `rates` records rate [2n] = (q', p'). */
typedef void tvi_rates_fn(const jet q[], const jet p[], jet t, void *ctx, jet rate[]);
TVI_NODISCARD tvi_status tvi_system_create_from_rates(tvi_system **out, int n, tvi_rates_fn *rates, void *ctx);

/* Creates the same system once more: a walk through its recording, which shares nothing with it. */
TVI_NODISCARD tvi_status tvi_system_copy(tvi_system **out, const tvi_system *system);

/* Records outputs of a system's closed recording once more, into the graph of q; velocities_or_momenta NULL: they are
 * 0, as those of a separable system. Returns false if memory is lacking. */
bool tvi_system_record_again(const tvi_system *base, const jet q[], const jet velocities_or_momenta[], jet t, int count,
                             const jet output[], jet value[]);

/* Creates the lift of a system, which moves a state (q, p) together with a tangent vector (dq, dp). It has 2n
 * degrees of freedom, and the Hamiltonian H_q.dq + H_p.dp or the Lagrangian L_q.dq + L_v.dv (docs/method.md, section
 * 10). Its coordinates are (q, dq), and its momenta (dp, p). A separable system also has a separable lift, with the
 * momenta (p, dp) and each mass twice, for methods that do not need momenta to be conjugate to the coordinates. The
 * lift shares nothing with the system. *out is NULL on failure. */
typedef enum { TVI_LIFT_PAIRED, TVI_LIFT_SEPARABLE } tvi_lift;
TVI_NODISCARD tvi_status tvi_system_create_lift(tvi_system **out, const tvi_system *system, tvi_lift lift);
/* Creates the lift of a system that is no Lagrangian for so many tangent vectors at once, with the coordinates (q,
 * dq_1, dq_2, ..) and the momenta (p, dp_1, dp_2, ..). It is separable if the system is, and otherwise a field of
 * rates. Parameter (1 + c) P + i of the lift is the component of tangent vector c, 0.., that belongs to parameter i of
 * P; it is 0 unless moves[c][i] is set, which makes the field cheaper. */
TVI_NODISCARD tvi_status tvi_system_create_columns_lift(tvi_system **out, const tvi_system *system, int columns,
                                                        const bool moves[]);

/* Sets the constants and parameters of the blocks of the system's tapes. parameters NULL stands for the values in the
 * recording. */
void tvi_system_prepare_blocks(const tvi_system *system, const tvi_tape_block *blocks, const double parameters[]);
/* Reads the recorded values of all parameters. Elements of `value` that belong to no recorded parameter
 * stay as they are. */
void tvi_system_recorded_parameters(const tvi_system *system, double value[]);

/* Record the H or the L of an existing system in the graph of q. `ctx` is that system (const tvi_system *), which must
 * have an energy. H of a separable system is sum p_i^2 / (2 m_i) + V. */
jet tvi_record_user_hamiltonian(const jet q[], const jet p[], jet t, void *ctx);
jet tvi_record_user_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

/* Records the automatic time scale g from H, in the graph of the rescaled Hamiltonian K, whose inputs are q, t, p and e
 * = -H (automatic.c). If g has no value at any state, the result is a jet that holds the error, and the recording of K
 * fails. */
jet tvi_record_automatic_time_scale(const tvi_system *base, jet H);

/* Records the second derivatives of the system's L or H, which are the derivatives of its field, in its open graph.
 * *jets [2n + hessian.entry_count] becomes the field, followed by the second derivatives. The caller frees *jets,
 * whatever the status. */
TVI_NODISCARD tvi_status tvi_hessian_record(tvi_system *system, jet **jets);

/* Records the second derivatives of the Hamiltonian K = g f with hamiltonian_factor = {g, f}, for solutions with f = 0,
 * and sets *field_and_hessian as tvi_hessian_record sets *jets. If the complete K'' is too expensive, the function
 * records g f'' + g' f'^T + f' g'^T, which leaves out f g''. If this matrix is too expensive, too, it records no second
 * derivatives. */
TVI_NODISCARD tvi_status tvi_record_hessian_of_factored_H(tvi_system *system, const jet hamiltonian_factor[2],
                                                          jet **field_and_hessian);

/* Creates the tape of the second derivatives if there are any. The recording must be finished
 * (jet_graph_end_recording). */
TVI_NODISCARD tvi_status tvi_hessian_create_tape(tvi_system *system, const jet jets[]);

/* Finds the masses of a system from the gradient of its recorded L or H: velocity_gradient [n] is the gradient by v,
 * and coordinate_gradient [n] that by q. Here v are the inputs n .. 2n - 1 of the recording, which are momenta for a
 * Hamiltonian. If velocity_gradient = diag(d) v + r, where the numbers d are positive and r does not depend on v, the
 * function sets system->has_masses and system->mass = d. *is_separable becomes true if, in addition, r = 0 and
 * coordinate_gradient does not depend on v. Returns TVI_ENOMEM if memory is lacking. */
TVI_NODISCARD tvi_status tvi_system_find_masses(tvi_system *system, const jet velocity_gradient[],
                                                const jet coordinate_gradient[], bool *is_separable);

/* Sets used[i], i < input_count, if one of the values depends on input i of the graph. Returns TVI_ENOMEM if memory is
 * lacking. */
TVI_NODISCARD tvi_status tvi_system_find_used_inputs(const jet_graph *graph, int input_count, int value_count,
                                                     const jet value[], bool used[]);

/* Finds the subsystems of the field, and sets system->subsystems and tail.subsystems. If the last coordinate is the
 * time, as in a rescaled system, the time becomes a subsystem of its own in tail.subsystems. The tail weighs each
 * component by its share of the motion in its subsystem (algebra/tail.h); alone in its subsystem, the time has the full
 * weight. Returns TVI_ENOMEM if memory is lacking. */
TVI_NODISCARD tvi_status tvi_system_find_subsystems(tvi_system *system, bool has_time_coordinate);

/* Returns the number of outputs of the field. */
static inline int tvi_system_output_count(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE ? system->n : 2 * system->n;
}

/* Writes the times t [lanes] to the input for the time, at order 0, of a block whose tape begins with the inputs of the
 * system. It does nothing if the field does not depend on the time. */
static inline void tvi_system_write_time(const tvi_system *system, double *block, int lanes, const double t[])
{
    if (!system->uses_time) return;
    for (int lane = 0; lane < lanes; lane++) block[system->input_count * lanes + lane] = t[lane];
}

#endif
