/* tvi.h - Taylor variational integrators: symplectic integrators of any order from the Taylor series of the user's own
 * equations of motion (Schmitt, Shingel and Leok, "Lagrangian and Hamiltonian Taylor Variational Integrators").
 *
 * Conventions
 *   1. The state is (t, q, p): q[n] are coordinates, p[n] their conjugate momenta, t the time; any consistent units.
 *   2. Order of arguments: object, step or time, inputs, then outputs; in-outs in the place of the state; a callback
 *      and its context last.
 *   3. Every function that can fail returns a tvi_status and then leaves what its arguments point to as it was.
 *   4. A system is read-only once made and may be shared between threads; an integrator is used by one thread at a
 *      time.
 *   5. The library prints nothing (but tvi_progress), never exits and has no global state but the text of
 *      tvi_last_error, one a thread. A step allocates nothing.
 *   6. Programs that build with 0.x build with every later 0.x.y. Programs that are linked with libtvi.so.N run with
 *      every later libtvi.so.N, as structures keep their members, and only those with a member `size` grow.
 * The mathematics and its notation are in docs/method.md.
 */
#ifndef TVI_H
#define TVI_H

#include "jet.h"

#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define TVI_NODISCARD __attribute__((__warn_unused_result__))
#else
#define TVI_NODISCARD
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the rest of the library is hidden */
#endif
#ifdef __cplusplus
extern "C" {
#endif

#define TVI_VERSION "0.2.0" /* of this header */
/* The version of the library, static: that of the header that it was built with. */
const char *tvi_version(void);
/* The text of a status: static, never NULL. */
const char *tvi_status_string(tvi_status status);
/* The text of the last refusal in this thread: which argument, output, mass or option was refused, or which operation
 * of the recording with which operand. It belongs to the last function that returned neither TVI_OK nor TVI_ESTOPPED,
 * or to tvi_state_from_text, and has to be asked for before another function is called. It is "" before the first
 * refusal, and never NULL. The text is for people, and may change. */
const char *tvi_last_error(void);

/* TVI_OR_EXIT(call) is for programs that end where anything is refused, such as the examples: there it prints the file,
 * the line, the status and tvi_last_error to stderr, and exits. TVI_OK and TVI_ESTOPPED go on. It wants <stdio.h> and
 * <stdlib.h>. */

#define TVI_OR_EXIT(call)                                                                                              \
    do {                                                                                                               \
        const tvi_status tvi_own_status = (call);                                                                      \
        if (tvi_own_status == TVI_OK || tvi_own_status == TVI_ESTOPPED) break;                                         \
        fprintf(stderr, "%s:%d: %s: %s\n", __FILE__, __LINE__, tvi_status_string(tvi_own_status), tvi_last_error());   \
        exit(EXIT_FAILURE);                                                                                            \
    } while (0)

/* ---- Systems: the user's function, recorded ---------------------------------------------------------------------- */

typedef struct tvi_system tvi_system;

enum { TVI_MAX_DIMENSION = 10000 }; /* the largest n */

/* The force F = dp/dt at (q, t): the function sets force[0..n-1]. The force must not contain the masses. */
typedef void tvi_force_fn(const jet q[], jet t, jet force[], void *ctx);
/* The potential energy V at (q, t). The force is -dV/dq, derived from the recording. */
typedef jet tvi_potential_fn(const jet q[], jet t, void *ctx);
/* The Lagrangian L at (q, v, t). L_vv must be regular where steps are made. */
typedef jet tvi_lagrangian_fn(const jet q[], const jet v[], jet t, void *ctx);
/* The Hamiltonian H at (q, p, t). */
typedef jet tvi_hamiltonian_fn(const jet q[], const jet p[], jet t, void *ctx);

/* There are four ways to state a problem. Force and potential: M q'' = F(q, t) with M = diag(mass) > 0, and p = M v.
 * mass[n] is copied, NULL stands for all 1, and a test particle has a very small mass (docs/limits.md). The function is
 * called once, during the call, with n coordinates. A Lagrangian or a Hamiltonian with a constant diagonal mass and no
 * other velocity in it is recognised, and costs as little as a potential. The system must outlive its integrators; it
 * is freed with tvi_system_free.
 *   TVI_EINVAL      n < 1 or above the maximum, NULL, a mass that is not positive, an output left unset, jets of two
 *                   recordings mixed
 *   TVI_ESINGULAR   a Lagrangian whose L_vv is singular everywhere
 *   TVI_EDOMAIN     an operation on numbers that has no value, such as the logarithm of -1
 *   TVI_ENONFINITE  a mass or a constant of the function that is not finite
 *   TVI_ENOMEM      no memory
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_system_force(tvi_system **out, int n, const double mass[], tvi_force_fn *force, void *ctx);
TVI_NODISCARD tvi_status tvi_system_potential(tvi_system **out, int n, const double mass[], tvi_potential_fn *potential,
                                              void *ctx);
TVI_NODISCARD tvi_status tvi_system_lagrangian(tvi_system **out, int n, tvi_lagrangian_fn *lagrangian, void *ctx);
TVI_NODISCARD tvi_status tvi_system_hamiltonian(tvi_system **out, int n, tvi_hamiltonian_fn *hamiltonian, void *ctx);

/* The local time scale of a state, g(q, p, t) > 0. */
typedef jet tvi_rescale_fn(const jet q[], const jet p[], jet t, void *ctx);
/* Creates the same system with steps that adapt and stay symplectic. Its integrators take h in s, dt = g ds, so that
 * each step covers about h g of time (docs/adaptive.md). Inside, steps are made with K = g (H + e) in (q, t) and (p,
 * e): *t moves on with q, and e = -H at the start of a run belongs to the integrator. If g goes to 0 along the orbit, a
 * run to a time need not end. Everything else is as for the system: its n, its energy, results and events at times t.
 * Methods of type I and Stormer-Verlet do not serve it. It shares nothing with the system. Where g depends on a
 * coordinate with a mass of at most 1e-8 of the largest, K would push it by truncation errors of the others: the system
 * is refused, and with tvi_bodies_scale of test particles it is that of tvi_system_rescaled_reversible. g NULL: the
 * automatic g, whose power -4 is the sum of the fourth powers of the local frequencies, so that h is a phase. For a
 * potential it is (tr (M^-1 V_qq)^2)^(-1/4); for Kepler r^(3/2) / 6^(1/4), in the plane r^(3/2) / 5^(1/4). For a
 * Hamiltonian g^-4 = tr D^2 + (tr C^2)^2 / 4, with G = H_pp, C = H_pq - G H_qp G^-1, D = -G (H_qq - H_qp G^-1 H_pq),
 * which is positive if G is definite, unless both terms are 0. If G is singular everywhere, it is tr (J H'')^4 / 2. It
 * depends on no units, masses, linear point transformations and gauges, and records n^2 second derivatives. It has no
 * value if they are all 0: a system of one degree of freedom whose force has an inflection needs a g of its own. The
 * automatic g does not know weak features that are crossed fast. For this reason steps with it are refused at smaller
 * tails than TVI_MAX_TAIL, unless the options have a max_tail.
 *   TVI_EUNSUPPORTED  a force, a driven or a rescaled system, a Lagrangian that is not recognised as separable: write
 *                     its Hamiltonian; a mass that is too light for K
 *   TVI_EDOMAIN       g is a number that is not positive, or the automatic g has no value anywhere. If g is a function,
 *                     the step is refused, and tvi_last_error speaks of its jet_sqrt, or of the automatic g
 *   others            as of tvi_system_hamiltonian; n + 1 is at most the maximum
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_system_rescaled(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx);

/* Creates the same system with steps that adapt in the reversible form (docs/adaptive.md): q' = g dq/dt, p' = g dp/dt,
 * t' = g by s, for "galerkin". It needs no Hamiltonian: it serves forces, driven systems and any masses, also bodies so
 * light that the energy says nothing of them, which K = g (H + e) pushes by (H + e) g_q. Its steps are symmetric and
 * not symplectic: what is reversible keeps its actions without drift. Everything else is as for tvi_system_rescaled.
 *   TVI_EUNSUPPORTED  a rescaled system; a Lagrangian whose momenta are not A(q, t) v + f(q, t), with A diagonal and
 *                     constant or n at most 8; g NULL for a force, a driven system or a Lagrangian
 *   TVI_EDOMAIN       as of tvi_system_rescaled
 *   others            as of tvi_system_hamiltonian; n + 1 is at most the maximum
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_system_rescaled_reversible(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g,
                                                        void *ctx);

/* Forces that no potential gives, such as friction, drag, control, at (q, v, t) with v = dq/dt: the function sets
 * force[0..n-1]. */
typedef void tvi_drive_fn(const jet q[], const jet v[], jet t, jet force[], void *ctx);
/* Creates the same system with these forces added to dp/dt, for "galerkin" and "taylor", whose order they do not change
 * (docs/driven.md). tvi_energy stays what it was: along the motion dH/dt is force . v. It shares nothing with the
 * system.
 *   TVI_EUNSUPPORTED  a system made from a force, a rescaled one, one that is driven already
 *   others            as of tvi_system_hamiltonian
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_system_driven(tvi_system **out, const tvi_system *system, tvi_drive_fn *drive, void *ctx);

/* The constraints phi(q, t) = 0: the function sets value[0..m-1]. */
typedef void tvi_constraint_fn(const jet q[], jet t, jet value[], void *ctx);
/* Creates the same system on phi = 0, for "galerkin" and, as RATTLE, "stormer-verlet": dp/dt gets the forces of
 * constraint -sum_k lambda_k dphi_k/dq, whose multipliers lambda the steps find. q and p keep their n numbers, p stays
 * what it was (M v), and so does tvi_energy, which is kept if phi does not depend on t. 0 < m < n; each phi_k may have
 * a unit of its own, and is best written in differences of coordinates. A parameter has the same value in phi as in the
 * system. A run begins at a state that is on the constraints to half of its digits, and puts it onto them to roundoff;
 * another state is refused with TVI_EINVAL, and tvi_project moves it. It shares nothing with the system. The first step
 * of a tangent map puts the columns onto the constraints. Rescaled steps do not serve it; compiled code has its tapes,
 * and no steps.
 *   TVI_EINVAL        m < 1 or m >= n, a phi_k that is a number or a function of t alone, an output left unset, NULL
 *   TVI_EUNSUPPORTED  a rescaled system, a tangent system, one that is constrained already
 *   others            as of tvi_system_hamiltonian
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_system_constrained(tvi_system **out, const tvi_system *system, int m,
                                                tvi_constraint_fn *constraint, void *ctx);

void tvi_system_free(tvi_system *system);           /* NULL is allowed */
int tvi_system_dimension(const tvi_system *system); /* n */
/* 1 + the largest index of its parameters (jet_parameter); 0: there are none. */
int tvi_system_parameters(const tvi_system *system);
int tvi_system_constraints(const tvi_system *system); /* m; 0: there are none */

/* Computes the energy H(q, p, t): sum p_i^2 / (2 m_i) + V, p.v - L, or the Hamiltonian itself. It may allocate.
 *   TVI_EUNSUPPORTED  a system made from a force, which has no V
 *   TVI_EDOMAIN, TVI_ENONFINITE  H has no value there
 *   TVI_EINVAL        NULL
 *   TVI_ENOMEM        no memory */
TVI_NODISCARD tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H);
/* Compute the Legendre transforms p = L_v(q, v, t) and v = H_p(q, p, t), [n] each; p = M v if the mass is constant. The
 * direction that the system does not state is solved for. They may allocate.
 *   TVI_ESINGULAR, TVI_ENOCONV  there is no solution, or none was found
 *   others                      as of tvi_energy */
TVI_NODISCARD tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[],
                                      double p[]);
TVI_NODISCARD tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[],
                                      double v[]);

/* Move a state of a constrained system onto it, and tell of it. They may allocate.
 * tvi_project moves q[n] to phi = 0, along the inverse masses times the gradients of phi, and then p[n] to dphi/dt = 0
 * along the gradients: to the nearest state, measured by the masses, if it is near.
 * tvi_constraint_values computes value[m] = phi and rate[m] = dphi/dt along the motion.
 * tvi_multipliers computes lambda[m] of a state on the constraints, in units of a force times q over those of phi, and
 * the force of constraint force[n], which is -sum_k lambda_k dphi_k/dq_i on q_i; force may be NULL.
 *   TVI_EUNSUPPORTED  a system without constraints
 *   TVI_ESINGULAR     a constraint that depends on the others there, or has no gradient: tvi_last_error names it
 *   TVI_ENOCONV       no state is found on the constraints
 *   others            as of tvi_energy and tvi_velocity */
TVI_NODISCARD tvi_status tvi_project(const tvi_system *system, double t, double q[], double p[]);
TVI_NODISCARD tvi_status tvi_constraint_values(const tvi_system *system, double t, const double q[], const double p[],
                                               double value[], double rate[]);
TVI_NODISCARD tvi_status tvi_multipliers(const tvi_system *system, double t, const double q[], const double p[],
                                         double lambda[], double force[]);

/* ---- Methods: a generating function + where the curve is expanded + a node rule ---------------------------------- */

typedef enum { TVI_TYPE1, TVI_TYPE2, TVI_TYPE3, TVI_POINCARE, TVI_TAYLOR, TVI_STORMER_VERLET } tvi_method;
typedef enum { TVI_AT_START, TVI_AT_MIDPOINT, TVI_AT_END, TVI_AT_BOTH_ENDS, TVI_AT_NODES } tvi_expansion;
typedef enum { TVI_NODES_ON_CURVE, TVI_NODES_TRUNCATED } tvi_nodes;
typedef enum {
    TVI_QUADRATURE_AUTO,
    TVI_GAUSS,
    TVI_LOBATTO,
    TVI_TRAPEZOID,
    TVI_RECTANGLE_START,
    TVI_RECTANGLE_END
} tvi_quadrature;
enum { TVI_PREDICT_ONLY = -1 };
enum { TVI_MAX_DEGREE = 100 }; /* of the Taylor curve */
enum { TVI_MAX_NODES = 10 };   /* of the Galerkin curve */
#define TVI_MAX_TAIL 1.0       /* of a step, unless the options say otherwise */

/* The options of an integrator. Zeros in all members but method, expansion and order are a sensible choice. */
typedef struct {
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    int order; /* of the whole method; refused if no degree gives it */
    /* N of the Taylor curve, or the number of nodes of the Galerkin curve (TVI_AT_NODES); 0 = the smallest that gives
     * the order. Another number decides the order. */
    int degree;
    bool compose_adjoint; /* half a step, then half a step of the adjoint: symmetric */
    tvi_quadrature quadrature;
    /* AUTO, 0: Gauss with one node more than the order needs. TVI_AT_NODES: the degree. */
    int quadrature_points;
    double tolerance; /* stop if a relative correction is not above it; 0 = roundoff */
    int passes;       /* 0 = until converged; k > 0 = exactly k corrections; TVI_PREDICT_ONLY = none */
    int max_passes;   /* 0 = the library's bound */
    /* A step whose tvi_stats.tail is larger is refused, and so is one that changes the energy by more than a right step
     * does, or is unstable, by Stormer-Verlet (docs/adaptive.md). 0 = TVI_MAX_TAIL, or less with the automatic g of
     * tvi_system_rescaled; < 0: no step is refused. */
    double max_tail;
    /* Code for the same system and options (tvi_compile); NULL: steps are interpreted. */
    const struct tvi_compiled *compiled;
} tvi_options;

/* The options for a user who does not choose: "galerkin" of order 16, which is symmetric, on-curve, serves every
 * system, and is the fastest at equal error over the scenes of the bench (docs/choosing.md). */
tvi_options tvi_options_default(void);
/* Sets the options to the method of this name and order. The paper's forms, with truncated nodes, are "tvi",
 * "htvi-right", "htvi-left", "svhd", "symmetric-tvi". On-curve forms are "start", "end", "midpoint", "both-ends" (type
 * I), "right", "left" (types II and III at the start), "poincare". Other methods are "galerkin" (type I with free
 * values at Gauss nodes, for any system), "taylor" and "stormer-verlet".
 *   TVI_EINVAL  no such name, or an order that the method cannot have */
TVI_NODISCARD tvi_status tvi_options_named(const char *name, int order, tvi_options *options);
/* Checks whether the options make a method for the system. On refusal *why (if why is not NULL) is static text that
 * names the option that does not fit.
 *   TVI_EINVAL        a value out of range, NULL
 *   TVI_EUNSUPPORTED  a combination that makes no method */
TVI_NODISCARD tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why);

/* ---- Compiled systems -------------------------------------------------------------------------------------------- */

/* Compiled code: a system's recorded functions as machine code, for the steps of one method (docs/compiled.md). Results
 * agree with those of the system to roundoff, in a fraction of the time. tvi_options.compiled gives it to an
 * integrator. */
typedef struct tvi_compiled tvi_compiled;

typedef struct {
    const char *compiler; /* NULL: the environment variable CC, or cc; arguments follow, between blanks */
    /* NULL: the flags of the library's own instruction set, and -O3. */
    const char *flags;
    /* A directory, which is created if it is missing; NULL: tvi below XDG_CACHE_HOME, or below ~/.cache; "": nothing is
     * kept. */
    const char *cache;
} tvi_compiler;

/* Generates C, compiles it by the C compiler of the machine, without a shell, and loads it. This takes some seconds,
 * for any number of bodies (docs/compiled.md). The result is kept in the cache, under a hash of what was compiled and
 * how: the next time takes milliseconds, also in another process, and several processes may do so at once. The
 * directory is made with the mode 0700, or must be the user's own and have it. The options are those for
 * tvi_integrator_create; their `compiled` is not read. how NULL: all members NULL. *out is NULL on failure.
 *   TVI_ECOMPILE  no compiler, an error of it, or the result cannot be written or loaded; the directory is a link, is
 *                 not the user's own, or has another mode than 0700
 *   TVI_ENOMEM    no memory
 *   others        as of tvi_options_check */
TVI_NODISCARD tvi_status tvi_compile(tvi_compiled **out, const tvi_system *system, const tvi_options *options,
                                     const tvi_compiler *how);
/* Writes the same C to a file, which is compiled with the program. It defines `const tvi_compiled *name(void)`, whose
 * result is not to be freed. It serves the version of the library that wrote it, and machines that have the
 * instructions that it is compiled to.
 * Names of the C library are the user's to avoid: the file includes headers of it.
 *   TVI_EINVAL    NULL; a name that is no identifier, is a keyword of C or in capitals, or begins with _, tvi_ or jet_
 *   TVI_ECOMPILE  the file cannot be written
 *   others        as of tvi_compile */
TVI_NODISCARD tvi_status tvi_compiled_write(const tvi_system *system, const tvi_options *options, const char *name,
                                            const char *path);
/* Frees the code. Integrators that use it keep what they need. NULL is allowed. */
void tvi_compiled_free(tvi_compiled *compiled);

/* ---- Integrators ------------------------------------------------------------------------------------------------- */

typedef struct tvi_integrator tvi_integrator;

/* Creates an integrator. NULL options: tvi_options_default. It keeps options.compiled as long as it lives, even if the
 * user frees it. *out is NULL on failure.
 *   TVI_ENOMEM  no memory
 *   others      as of tvi_options_check */
TVI_NODISCARD tvi_status tvi_integrator_create(tvi_integrator **out, const tvi_system *system,
                                               const tvi_options *options);
void tvi_integrator_free(tvi_integrator *integrator);                        /* NULL is allowed */
const tvi_options *tvi_integrator_options(const tvi_integrator *integrator); /* resolved: degree, points */

/* Sets the integrator's own values of the parameters of its system, value[tvi_system_parameters] in the order of their
 * indices. Before, they are those of the recording. tvi_state_to_text keeps them. A run goes on with new values as from
 * a new state. They may be set between any two steps; nothing is allocated. Events with a parameter of the same index
 * get the value, too.
 *   TVI_EINVAL      NULL
 *   TVI_ENONFINITE  a value that is not finite; the old ones stay */
TVI_NODISCARD tvi_status tvi_integrator_set_parameters(tvi_integrator *integrator, const double value[]);
/* Do what tvi_energy, tvi_momentum and so on do, with the integrator's values of the parameters. */
TVI_NODISCARD tvi_status tvi_integrator_energy(const tvi_integrator *integrator, double t, const double q[],
                                               const double p[], double *H);
TVI_NODISCARD tvi_status tvi_integrator_momentum(const tvi_integrator *integrator, double t, const double q[],
                                                 const double v[], double p[]);
TVI_NODISCARD tvi_status tvi_integrator_velocity(const tvi_integrator *integrator, double t, const double q[],
                                                 const double p[], double v[]);
TVI_NODISCARD tvi_status tvi_integrator_project(const tvi_integrator *integrator, double t, double q[], double p[]);
TVI_NODISCARD tvi_status tvi_integrator_constraint_values(const tvi_integrator *integrator, double t, const double q[],
                                                          const double p[], double value[], double rate[]);
TVI_NODISCARD tvi_status tvi_integrator_multipliers(const tvi_integrator *integrator, double t, const double q[],
                                                    const double p[], double lambda[], double force[]);

/* Makes one step of size h from (t, q, p) in place; h < 0 goes back, and h may change from step to step.
 *   TVI_EINVAL      NULL, h = 0 or not finite
 *   TVI_ENONFINITE  a state that is not finite, or equations that are not finite there
 *   TVI_EDOMAIN     the function was evaluated outside its domain
 *   TVI_ENOCONV     the corrector did not converge: the step is too large
 *   TVI_ESINGULAR   its matrix is singular: the step is too large
 *   TVI_ETOOLARGE   its passes or its sums overflow; or its equations were solved, but it is wrong:
 *                   tvi_options.max_tail */
TVI_NODISCARD tvi_status tvi_step(tvi_integrator *integrator, double h, double *t, double q[], double p[]);

/* Forgets the last step. A step also forgets it if t, q, p are not bitwise what the last successful step returned;
 * otherwise the low-order parts of the compensated sums carry on. After longjmp has left an observer, an integrator
 * makes no step before a reset. An observer may call it, but a step that the observer then makes ends the run. */
void tvi_integrator_reset(tvi_integrator *integrator);

/* An observer is called after each step, with step = 1..steps; a value other than 0 stops the run. */
typedef int tvi_observer(long step, double t, const double q[], const double p[], void *ctx);
/* Makes `steps` steps of size h. The state is that of the last successful step, whatever the status; the observer may
 * be NULL.
 *   TVI_ESTOPPED  the observer stopped it
 *   TVI_EINVAL    steps < 0
 *   others        of the step that failed */
TVI_NODISCARD tvi_status tvi_integrate(tvi_integrator *integrator, double h, long steps, double *t, double q[],
                                       double p[], tvi_observer *observer, void *ctx);

/* Computes the state at t0 + theta h, 0 <= theta <= 1, of the last step, on the step's own curve. At theta = 0 and 1 it
 * is the state before and after the step. Between them its order is the curve's, not the method's. The error that one
 * step adds, as measured by the tests, is O(h^(N+1)) in q and O(h^N) in p (O(h^2) for N = 1); for Poincare O(h^(N+1))
 * in both (O(h^2) for N = 0); for the Galerkin curve O(h^(N+1)) in both, and O(h^(N+2)) in q of a separable system; for
 * Stormer-Verlet O(h^3).
 *   TVI_EINVAL      before a step, after one that failed, and for theta outside [0, 1]
 *   TVI_ENONFINITE  the curve overflows there */
TVI_NODISCARD tvi_status tvi_dense(tvi_integrator *integrator, double theta, double q[], double p[]);

/* An observer for long runs: if the standard error is a terminal it draws a bar there, elsewhere it draws nothing. ctx
 * is a tvi_progress_bar, {.steps = steps}. An observer of your own in it is called after each step, with its ctx. No
 * other function of the library prints. */
typedef struct {
    long steps;             /* of the whole run: the bar is full then */
    tvi_observer *observer; /* NULL: none */
    void *ctx;
    long shown; /* belongs to the library */
} tvi_progress_bar;
int tvi_progress(long step, double t, const double q[], const double p[], void *ctx);

/* Counts since the integrator was created. A pass is one evaluation of the residual followed by one correction, an
 * expansion one series of the curve, a force evaluation one value of the force at one node. */
typedef struct {
    long steps, passes, expansions, force_evaluations, factorisations;
    /* The last correction of the last step relative to the curve's size; 0 for explicit methods. */
    double residual;
    /* The tail of the last step: the last term of the force on a coordinate, relative to its momentum and all of that
     * force; the largest of all coordinates. Above 0.1 the step is too large, below 0.01 it seldom is
     * (docs/choosing.md). The tail is 0 if the force has one term only: degrees 1 and 2, one node, Stormer-Verlet. */
    double tail;
    /* The largest tail since the integrator was created or reset, also of a step that was refused. */
    double largest_tail;
    /* The largest defect since the integrator was created or reset, also of a step that was refused: how far the forces
     * on a body at the ends of a step are from the step's polynomial, relative to the largest force in it. It is
     * computed by "galerkin" for the systems of tvi_bodies.h, where the tail is above 1e-3; above 0.28 a step is
     * refused. */
    double largest_defect;
    size_t bytes;     /* of memory held by the integrator */
    bool is_compiled; /* its steps run tvi_options.compiled */
} tvi_stats;
const tvi_stats *tvi_integrator_stats(const tvi_integrator *integrator);

/* ---- The tangent map --------------------------------------------------------------------------------------------- */

/* Makes a step, bit for bit that of tvi_step, and also moves tangent vectors: D <- M D with M the Jacobian matrix of
 * the step, exact to roundoff (docs/method.md section 10). D is [2n][columns] row-major, rows (dq, dp); the identity
 * gives M. For a system with parameters D has one more row for each, which stays as it is. A column that begins with 0
 * in all other rows and 1 in one of these becomes the derivative of the state with respect to that parameter. Each
 * column costs a step of a system of 2n degrees of freedom (in plain steps: docs/chaos.md), and is treated alone: it
 * carries no sums and no guesses from one step to the next, and scaling it by a power of two scales its result. With a
 * tolerance or a fixed number of passes M may differ from the Jacobian matrix by the corrections that the passes leave
 * out. The first call, and the first with more columns than before, allocate (TVI_ENOMEM); later ones allocate nothing.
 * In tvi_stats the columns count in `bytes` alone, without their recording of the lifted system.
 *   TVI_EINVAL      as tvi_step, and D NULL, columns < 1
 *   TVI_ENONFINITE  as tvi_step, and D that is not finite, before or after
 *   others          as tvi_step; t, q, p and D are then as they were */
TVI_NODISCARD tvi_status tvi_step_tangent(tvi_integrator *integrator, double h, double *t, double q[], double p[],
                                          double D[], int columns);

/* ---- Saved states ------------------------------------------------------------------------------------------------ */

/* Give and take the state (t, q, p) of an integrator as text (docs/roundoff.md). A text has two parts:
 *   - t, q and p, with the low-order parts that the integrator has of them where its last step returned them, the
 *     values of parameters, and the events that stopped the run there. Every version from this one on, every machine,
 *     instruction set and method reads this part, and a run goes on from it to roundoff.
 *   - the history of the steps and the counts, for the system, options, instruction set and version that wrote it. They
 *     go on from it bit for bit as if the run had not been interrupted; for others it is dropped. A state that is not
 *     what the last step returned has zeros in its place, and the counts.
 * The size of a text depends on the system, its parameters and the options alone, and can be asked for before a run.
 *
 * tvi_state_to_text: *size is the size of the buffer `text`, and then the number of characters written; text NULL asks
 * for that number. The text ends with a new line and no 0.
 *   TVI_EINVAL      NULL, a buffer that is too small
 *   TVI_ENONFINITE  a state that is not finite
 *   TVI_ENOMEM      no memory
 * tvi_state_from_text sets t, q and p, from which steps go on, and the parameters. The system has to be that of the
 * text, of which only n and the number of parameters can be seen. Texts of earlier versions are read, their bytes
 * (tvi_state_save) are not. tvi_dense has no last step until the next one is made.
 *   TVI_OK          tvi_last_error is then "", or says that a history was dropped; the counts go on as they were
 *   TVI_EINVAL      NULL; what is no such text, is damaged or cut short, or of another n or number of parameters;
 *                   numbers that no run leaves; a call from an observer
 *   TVI_ENOMEM      no memory
 *   others          of a rescaled system, as of tvi_energy */
TVI_NODISCARD tvi_status tvi_state_to_text(const tvi_integrator *integrator, double t, const double q[],
                                           const double p[], char *text, size_t *size);
TVI_NODISCARD tvi_status tvi_state_from_text(tvi_integrator *integrator, const char *text, size_t size, double *t,
                                             double q[], double p[]);
/* Reads a text without an integrator: the dimension n of the system, t, q[n] and p[n]. t, q and p may be NULL, so that
 * n can be asked for first.
 *   TVI_EINVAL  NULL, what is no such text, is damaged or cut short
 *   TVI_ENOMEM  no memory */
TVI_NODISCARD tvi_status tvi_state_peek(const char *text, size_t size, int *n, double *t, double q[], double p[]);
/* Returns the t, q[n] and p[n] of the last successful step, from which the run goes on; also after its text was read.
 *   TVI_EINVAL  before a step and after a reset; NULL */
TVI_NODISCARD tvi_status tvi_state_last(const tvi_integrator *integrator, double *t, double q[], double p[]);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#include "tvi_runs.h"

#endif
