/* statement.c - Records the user's function, and lowers it to the tapes that the steppers run. */
#include "system/system.h"
#include "system/legendre.h"
#include "system/hessian.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>

/* The statement of a system: one of the first four functions, or the factors of a Hamiltonian, or a system to lift. */
typedef struct {
    tvi_force_fn *force;
    tvi_potential_fn *potential;
    tvi_lagrangian_fn *lagrangian;
    tvi_hamiltonian_fn *hamiltonian;
    tvi_factors_fn *factors;
    const double *mass;
    void *ctx;
    const tvi_system *base;
    bool has_momenta; /* of the lift: it is not separable */
    /* The forces of a driven Hamiltonian or Lagrangian; NULL if there are none. */
    tvi_drive_fn *drive;
    void *drive_ctx;
} statement;

/* A recording that is open. Its jets belong to the graph. */
typedef struct {
    tvi_system *system;
    /* Inputs: coordinates; velocities or momenta; directions of the bend; time. */
    jet *q, *v, *r, t;
    jet scalar; /* V, L or H */
    jet *field; /* [2n] the system's */
    jet *bend;  /* [2n] */
    /* [2n + hessian_entries] the field, then the second derivatives. */
    jet *hessian;
} recording;

static tvi_status check_masses(int n, const double mass[])
{
    if (!mass) return TVI_OK;
    for (int i = 0; i < n; i++) {
        if (!isfinite(mass[i])) return jet_refuse(TVI_ENONFINITE, "mass[%d] = %g is not finite", i, mass[i]);
        if (mass[i] <= 0) return jet_refuse(TVI_EINVAL, "mass[%d] = %g is not positive", i, mass[i]);
    }
    return TVI_OK;
}

/* The name of what the function returns or sets. */
static const char *name_of(const statement *given)
{
    return given->force ? "force" : given->potential ? "potential" : given->lagrangian ? "Lagrangian" : "Hamiltonian";
}

/* Opens a recording with the inputs q, v (or p), t, r, in this order. A force or a potential has neither v nor r. */
static tvi_status open_recording(recording *rec, int n, const statement *given)
{
    const bool general = given->lagrangian || given->hamiltonian || given->factors || given->has_momenta;
    const size_t count = (size_t)n;
    tvi_system *system = rec->system = calloc(1, sizeof *system);
    if (!system) return TVI_ENOMEM;
    system->n = n;
    system->has_masses = !general;
    system->stepped = system;
    system->mass = malloc(count * sizeof *system->mass);
    system->graph = jet_graph_create(general ? 3 * n + 1 : n + 1);
    rec->q = malloc(3 * count * sizeof *rec->q);
    rec->field = system->field = malloc(2 * count * sizeof *rec->field);
    rec->bend = malloc(2 * count * sizeof *rec->bend);
    if (!system->mass || !system->graph || !rec->q || !rec->field || !rec->bend) return TVI_ENOMEM;
    jet_graph_name(system->graph, name_of(given));
    rec->v = rec->q + n;
    rec->r = rec->v + n;
    const int inputs = general ? 2 * n : n;
    for (int i = 0; i < inputs; i++) rec->q[i] = jet_graph_input(system->graph, i);
    rec->t = jet_graph_input(system->graph, inputs);
    for (int i = 0; i < n; i++) {
        if (general) rec->r[i] = jet_graph_input(system->graph, inputs + 1 + i);
        rec->field[i] = jet_unset();
        system->mass[i] = given->mass ? given->mass[i] : 1;
    }
    return TVI_OK;
}

/* ---- From each statement to a form ------------------------------------------------------------------------------- */

/* Computes out[2n] = dx/d(q, v). */
static tvi_status gradient(const recording *rec, jet x, jet out[])
{
    tvi_system *system = rec->system;
    if (!jet_gradient(system->graph, x, 2 * system->n, out)) return TVI_ENOMEM;
    tvi_status status = TVI_OK;
    for (int i = 0; i < 2 * system->n && status == TVI_OK; i++) {
        jet component = out[i]; /* a number among them stays one */
        status = jet_graph_accept(system->graph, 1, &component);
    }
    return status;
}

/* Records F = -dV/dq; of a separable Hamiltonian, -dH/dq. */
static tvi_status record_force(recording *rec)
{
    tvi_system *system = rec->system;
    return jet_gradient(system->graph, jet_neg(rec->scalar), system->n, rec->field) ? TVI_OK : TVI_ENOMEM;
}

static tvi_status record_potential(recording *rec, const statement *given)
{
    tvi_system *system = rec->system;
    rec->scalar = given->potential(rec->q, rec->t, given->ctx);
    const tvi_status status = jet_graph_accept(system->graph, 1, &rec->scalar);
    return status == TVI_OK ? record_force(rec) : status;
}

/* Adds the forces to dp/dt, which is sign times the first half of the field. A driven system is never separable. */
static tvi_status record_drive(recording *rec, const statement *given, const jet v[], double sign)
{
    tvi_system *system = rec->system;
    const int n = system->n;
    jet *force = malloc((size_t)n * sizeof *force);
    if (!force) return TVI_ENOMEM;
    for (int i = 0; i < n; i++) force[i] = jet_unset();
    given->drive(rec->q, v, rec->t, force, given->drive_ctx);
    jet_graph_name(system->graph, "driving force");
    const tvi_status status = jet_graph_accept(system->graph, n, force);
    jet_graph_name(system->graph, name_of(given));
    for (int i = 0; i < n; i++) rec->field[i] = jet_add(rec->field[i], jet_mul(sign, force[i]));
    free(force);
    system->is_driven = true;
    return status;
}

/* Finds masses in the second half of the field, and whether the system is separable. A driven system is not. */
static tvi_status find_masses(const recording *rec, const statement *given, bool *separable)
{
    tvi_system *system = rec->system;
    const jet *linear = rec->field + system->n;
    tvi_status status = TVI_OK;
    if (!given->drive) status = tvi_system_find_separable(system, linear, rec->field, separable);
    if (status == TVI_OK && !*separable) tvi_system_find_inertia(system, linear);
    else system->has_masses = *separable;
    return status;
}

/* Records field = (L_q, L_v). It is separable if L_v = M v and L_q has no v: then F = L_q, V = -L(q, 0). */
static tvi_status record_lagrangian(recording *rec, const statement *given)
{
    tvi_system *system = rec->system;
    rec->scalar = given->lagrangian(rec->q, rec->v, rec->t, given->ctx);
    tvi_status status = jet_graph_accept(system->graph, 1, &rec->scalar);
    if (status == TVI_OK) status = gradient(rec, rec->scalar, rec->field);
    bool separable = false;
    if (status == TVI_OK) status = find_masses(rec, given, &separable);
    if (status == TVI_OK && given->drive) status = record_drive(rec, given, rec->v, 1);
    system->energy_sign = -1;
    if (separable || status != TVI_OK) return status;
    system->form = TVI_LAGRANGIAN;
    return tvi_hessian_record(system, &rec->hessian);
}

/* Records bend, the gradient of r.H_p. */
static tvi_status record_bend(recording *rec)
{
    tvi_system *system = rec->system;
    const int n = system->n;
    jet along = jet_dot(rec->r, rec->field + n, n);
    tvi_status status = jet_graph_accept(system->graph, 1, &along);
    if (status == TVI_OK) status = gradient(rec, along, rec->bend);
    return status == TVI_OK ? jet_graph_accept(system->graph, 2 * n, rec->bend) : status;
}

static tvi_status record_product(recording *rec, const statement *given)
{
    tvi_system *system = rec->system;
    jet factor[2];
    given->factors(rec->q, rec->v, rec->t, given->ctx, factor);
    rec->scalar = jet_mul(factor[0], factor[1]);
    system->form = TVI_HAMILTONIAN;
    tvi_status status = jet_graph_accept(system->graph, 1, &rec->scalar);
    if (status == TVI_OK) status = gradient(rec, rec->scalar, rec->field);
    if (status == TVI_OK) status = tvi_hessian_record_rescaled(system, factor, &rec->hessian);
    return status == TVI_OK ? record_bend(rec) : status;
}

/* Records field = (H_q, H_p). It is separable if H_p = M^-1 p and H_q has no p: then F = -H_q, V = H(q, 0). */
static tvi_status record_hamiltonian(recording *rec, const statement *given)
{
    tvi_system *system = rec->system;
    const int n = system->n;
    rec->scalar = given->hamiltonian(rec->q, rec->v, rec->t, given->ctx);
    tvi_status status = jet_graph_accept(system->graph, 1, &rec->scalar);
    if (status == TVI_OK) status = gradient(rec, rec->scalar, rec->field);
    bool separable = false;
    if (status == TVI_OK) status = find_masses(rec, given, &separable);
    if (status == TVI_OK && given->drive) status = record_drive(rec, given, rec->field + n, -1);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n && system->has_masses; i++) system->mass[i] = 1 / system->mass[i];
    if (separable) return record_force(rec);
    system->form = TVI_HAMILTONIAN;
    return record_bend(rec);
}

/* ---- The lift ---------------------------------------------------------------------------------------------------- */

/* Sets the inputs of the base among those of its lift, and the directions in which they move. */
static void place_inputs(const recording *rec, const tvi_system *base, jet input[], jet direction[])
{
    const int n = base->n, inputs = jet_graph_inputs(base->graph), time = inputs == n + 1 ? n : 2 * n;
    const bool momenta = rec->system->form == TVI_HAMILTONIAN;
    for (int i = 0; i < inputs; i++) input[i] = direction[i] = jet_unset();
    for (int i = 0; i < n; i++) {
        input[i] = rec->q[i];
        direction[i] = rec->q[n + i];
        if (base->form == TVI_SEPARABLE) continue;
        input[n + i] = rec->v[momenta ? n + i : i];
        direction[n + i] = rec->v[momenta ? i : n + i];
    }
    input[time] = rec->t;
    direction[time] = jet_const(0);
}

/* Sets the field of the lift: H_Q = ((H_q)', H_q), H_P = (H_p, (H_p)'); L_Q = ((L_q)', L_q), L_V = ((L_v)', L_v);
 * separable -H_q = F, H_p = M^-1 p, or F and F'. */
static void place_field(recording *rec, const tvi_system *base, const jet value[], const jet rate[])
{
    const int n = base->n;
    const bool separable = base->form == TVI_SEPARABLE, swaps = base->form == TVI_LAGRANGIAN;
    jet *field = rec->field;
    for (int i = 0; i < n; i++) {
        const bool paired = rec->system->form != TVI_SEPARABLE;
        field[i] = !paired ? value[i] : separable ? jet_neg(rate[i]) : rate[i];
        field[n + i] = !paired ? rate[i] : separable ? jet_neg(value[i]) : value[i];
        if (!paired) continue;
        const jet first = separable ? jet_div(rec->v[n + i], base->mass[i]) : value[n + i];
        const jet second = separable ? jet_div(rec->v[i], base->mass[i]) : rate[n + i];
        field[2 * n + i] = swaps ? second : first;
        field[3 * n + i] = swaps ? first : second;
    }
}

/* Records the parameters of the lift: the values of the base, then their rates, which are 0 unless they are set. */
static void place_parameters(const recording *rec, int parameters, jet parameter_direction[])
{
    for (int i = 0; i < parameters; i++)
        parameter_direction[i] = jet_graph_parameter(rec->system->graph, parameters + i, 0);
}

static tvi_status record_lift(recording *rec, const statement *given)
{
    const tvi_system *base = given->base;
    tvi_system *system = rec->system;
    const int parameters = jet_graph_parameters(base->graph);
    system->regular = base->regular;
    system->has_masses = !given->has_momenta;
    if (given->has_momenta) system->form = base->form == TVI_LAGRANGIAN ? TVI_LAGRANGIAN : TVI_HAMILTONIAN;
    for (int i = 0; i < system->n; i++) system->mass[i] = base->mass[i % base->n];
    const size_t inputs = (size_t)jet_graph_inputs(base->graph), outputs = (size_t)base->inputs;
    jet *jets = malloc((2 * (inputs + outputs) + (size_t)parameters) * sizeof *jets);
    if (!jets) return TVI_ENOMEM;
    jet *input = jets, *direction = input + inputs, *value = direction + inputs, *rate = value + outputs;
    jet *parameter_direction = rate + outputs;
    place_inputs(rec, base, input, direction);
    place_parameters(rec, parameters, parameter_direction);
    bool lifted = jet_lift(base->graph, system->graph, input, direction, parameter_direction, base->inputs, base->field,
                           value, rate);
    if (lifted) place_field(rec, base, value, rate);
    if (lifted && base->form == TVI_HAMILTONIAN) /* the lift's own H is the rate of H */
        lifted = jet_lift(base->graph, system->graph, input, direction, parameter_direction, 1, &base->stated, value,
                          &rec->scalar);
    free(jets);
    if (!lifted) return TVI_ENOMEM;
    if (base->form == TVI_HAMILTONIAN && jet_graph_accept(system->graph, 1, &rec->scalar) != TVI_OK) return TVI_ENOMEM;
    return system->form == TVI_HAMILTONIAN  ? record_bend(rec)
           : system->form == TVI_LAGRANGIAN ? tvi_hessian_record(system, &rec->hessian)
                                            : TVI_OK;
}

static tvi_status record_statement(recording *rec, const statement *given)
{
    rec->system->energy_sign = 1;
    if (given->base) return record_lift(rec, given);
    if (given->lagrangian) return record_lagrangian(rec, given);
    if (given->factors) return record_product(rec, given);
    if (given->hamiltonian) return record_hamiltonian(rec, given);
    if (given->potential) return record_potential(rec, given);
    given->force(rec->q, rec->t, rec->field, given->ctx);
    return TVI_OK;
}

static tvi_status lower(recording *rec, const statement *given)
{
    tvi_system *system = rec->system;
    const int n = system->n, outputs = system->form == TVI_SEPARABLE ? n : 2 * n;
    const tvi_status status = jet_graph_accept(system->graph, outputs, rec->field);
    if (status != TVI_OK) return status;
    jet_graph_close(system->graph);
    system->inputs = outputs;
    system->field_series = jet_tape_create(system->graph, outputs, outputs, rec->field, JET_TAPE_SERIES);
    system->field_values = jet_tape_create(system->graph, outputs, outputs, rec->field, JET_TAPE_VALUES);
    if (!system->field_series || !system->field_values) return TVI_ENOMEM;
    if (tvi_system_find_subsystems(system) != TVI_OK) return TVI_ENOMEM;
    system->compares_movements = system->has_masses;
    system->uses_time = system->field_series->inputs > outputs;
    if (system->form == TVI_HAMILTONIAN) {
        system->bend_values = jet_tape_create(system->graph, 3 * n + 1, 2 * n, rec->bend, JET_TAPE_VALUES);
        if (!system->bend_values) return TVI_ENOMEM;
    }
    if (rec->hessian && tvi_hessian_lower(system, rec->hessian) != TVI_OK) return TVI_ENOMEM;
    if (given->force || (given->base && given->base->form != TVI_HAMILTONIAN)) return TVI_OK;
    system->energy_inputs = given->potential ? n : 2 * n;
    system->stated = rec->scalar;
    system->energy = jet_tape_create(system->graph, system->energy_inputs, 1, &rec->scalar, JET_TAPE_VALUES);
    return system->energy ? TVI_OK : TVI_ENOMEM;
}

static tvi_status record_system(tvi_system **out, int n, const statement *given)
{
    *out = NULL;
    recording rec = {0};
    tvi_status status = open_recording(&rec, n, given);
    if (status == TVI_OK) status = record_statement(&rec, given);
    if (status == TVI_OK) status = lower(&rec, given);
    if (status == TVI_OK && !given->base) status = tvi_legendre_probe(rec.system);
    free(rec.q);
    free(rec.bend);
    free(rec.hessian);
    if (status == TVI_OK) *out = rec.system;
    else tvi_system_free(rec.system);
    return jet_refuse_memory(status);
}

static tvi_status make_system(tvi_system **out, int n, const statement *given)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (n < 1 || n > TVI_MAX_DIMENSION) return jet_refuse(TVI_EINVAL, "n = %d is not 1 .. %d", n, TVI_MAX_DIMENSION);
    if (!given->force && !given->potential && !given->lagrangian && !given->hamiltonian && !given->factors)
        return jet_refuse(TVI_EINVAL, "the function is NULL");
    const tvi_status status = check_masses(n, given->mass);
    return status == TVI_OK ? record_system(out, n, given) : status;
}

tvi_status tvi_system_lift(tvi_system **out, const tvi_system *system, tvi_lift lift)
{
    const bool has_momenta = system->form != TVI_SEPARABLE || lift == TVI_LIFT_PAIRED;
    return record_system(out, 2 * system->n, &(statement){.base = system, .has_momenta = has_momenta});
}

tvi_status tvi_system_force(tvi_system **out, int n, const double mass[], tvi_force_fn *force, void *ctx)
{
    return make_system(out, n, &(statement){.force = force, .mass = mass, .ctx = ctx});
}

tvi_status tvi_system_potential(tvi_system **out, int n, const double mass[], tvi_potential_fn *potential, void *ctx)
{
    return make_system(out, n, &(statement){.potential = potential, .mass = mass, .ctx = ctx});
}

tvi_status tvi_system_lagrangian(tvi_system **out, int n, tvi_lagrangian_fn *lagrangian, void *ctx)
{
    return make_system(out, n, &(statement){.lagrangian = lagrangian, .ctx = ctx});
}

tvi_status tvi_system_create_rescaled(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx)
{
    return make_system(out, n, &(statement){.factors = factors, .ctx = ctx});
}

tvi_status tvi_system_hamiltonian(tvi_system **out, int n, tvi_hamiltonian_fn *hamiltonian, void *ctx)
{
    return make_system(out, n, &(statement){.hamiltonian = hamiltonian, .ctx = ctx});
}

tvi_status tvi_system_driven(tvi_system **out, const tvi_system *system, tvi_drive_fn *drive, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system || !drive) return jet_refuse(TVI_EINVAL, "%s is NULL", system ? "drive" : "system");
    const char *const unsupported = !system->energy             ? "a force has no energy: state the potential"
                                    : system->stepped != system ? "the system is rescaled"
                                    : system->is_driven         ? "the system is driven already: add the forces in one"
                                                                : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    statement given = {.ctx = (void *)system, .drive = drive, .drive_ctx = ctx};
    if (system->form == TVI_LAGRANGIAN) given.lagrangian = tvi_stated_lagrangian;
    else given.hamiltonian = tvi_stated_hamiltonian;
    return make_system(out, system->n, &given);
}
