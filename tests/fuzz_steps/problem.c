/* problem.c - Implements problem.h. */
#include "problem.h"
#include "method/list.h"
#include "method/method.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* ---- The energy -------------------------------------------------------------------------------------------------- */

static int times(formula *f, double factor, int a) { return apply(f, X_MUL, number_of(f, factor), a); }

/* sum m_i r_i^2/2, r from first on, with masses between 1/2 and 4. */
static int kinetic(formula *f, random_source *r, int n, int first)
{
    int sum = number_of(f, 0);
    for (int i = 0; i < n; i++) sum = apply(f, X_ADD, sum, times(f, uniform(r, 0.5, 4), apply(f, X_SQR, first + i, 0)));
    return sum;
}

/* (1/2 + d^2)^c of the distance d between neighbours. */
static int poles(problem *x, random_source *r)
{
    formula *f = &x->f;
    int sum = number_of(f, 0);
    const double exponent = choose(r, 2) ? -1 : uniform(r, -6, -0.5);
    for (int i = 1; i < x->n; i++) {
        const int d = apply(f, X_SUB, x->own + i, x->own + i - 1),
                  r2 = apply(f, X_ADD, number_of(f, 0.5), apply(f, X_SQR, d, 0));
        sum = apply(f, X_ADD, sum, times(f, uniform(r, -1, 1), power(f, r2, exponent)));
    }
    return sum;
}

/* A function of one velocity that is bounded and has a value everywhere: what v belongs to p is then known wherever the
 * search for it begins. */
static int smooth_term(formula *f, random_source *r, int n)
{
    static const operation functions[] = {X_SIN, X_COS, X_TANH, X_ATAN};
    const int v = times(f, uniform(r, -1, 1), SECOND + choose(r, n)), which = choose(r, 6);
    if (which < 4) return apply(f, functions[which], v, 0);
    return power(f, apply(f, X_ADD, number_of(f, 1), apply(f, X_SQR, v, 0)), which == 4 ? 0.5 : -1);
}

/* A product of a function of q and one of p or v, a tenth of what it is, which leaves the second derivatives regular.
 */
static int mixed_term(problem *x, random_source *r)
{
    formula *f = &x->f;
    const int a = random_term(f, r, x->own, x->n, choose(r, 2)),
              b = x->form == OF_LAGRANGIAN ? smooth_term(f, r, x->n)
                                           : random_term(f, r, SECOND, x->n, 1 + choose(r, 2));
    const double size = fmax(1, fabs(f->nodes[a].value)) * fmax(1, fabs(f->nodes[b].value));
    return times(f, 0.1 / size, apply(f, X_MUL, a, b));
}

/* Terms of q and, where there are, of p or v; of t in one problem of three. */
static int terms(problem *x, random_source *r)
{
    formula *f = &x->f;
    int sum = number_of(f, 0);
    const bool has_time = choose(r, 3) == 0;
    for (int i = 0; i < 1 + x->n / 2; i++) {
        int term = random_term(f, r, x->own, x->n, 1 + choose(r, 3));
        if (has_time && i == 0) term = apply(f, X_MUL, term, apply(f, X_COS, times(f, uniform(r, 0.5, 2), TIME), 0));
        sum = apply(f, X_ADD, sum, term);
        if (x->form >= OF_LAGRANGIAN) sum = apply(f, X_ADD, sum, mixed_term(x, r));
    }
    return sum;
}

/* q less where they are about: the nodes that the formula is made of. */
static int own_coordinates(formula *f, int n, double about)
{
    const int number = number_of(f, about);
    if (about == 0) return 0;
    for (int i = 0; i < n; i++) apply(f, X_SUB, i, number);
    return number + 1;
}

static int random_energy(problem *x, random_source *r)
{
    formula *f = &x->f;
    const bool has_second = x->form >= OF_LAGRANGIAN;
    int V = terms(x, r);
    if (choose(r, 2)) V = apply(f, X_ADD, V, poles(x, r));
    if (!has_second) return V;
    return apply(f, x->form == OF_LAGRANGIAN ? X_SUB : X_ADD, kinetic(f, r, x->n, SECOND), V);
}

/* From H(q, p, t) to K = g (H + e), in which t and e are the last coordinate and momentum. */
static void rescale(problem *x, random_source *r)
{
    formula *f = &x->f;
    const int t = x->n++, e = SECOND + t;
    for (int i = INPUTS_MOST; i < f->count; i++) {
        if (f->nodes[i].a == TIME) f->nodes[i].a = t;
        if (f->nodes[i].b == TIME) f->nodes[i].b = t;
    }
    const int term = random_term(f, r, x->own, t, 2);
    x->scale = apply(f, X_EXP, times(f, 0.5 / fmax(1, fabs(f->nodes[term].value)), term), 0);
    x->H = x->energy;
    f->nodes[e].value = x->p[t] = -f->nodes[x->H].value;
    x->energy = apply(f, X_MUL, x->scale, apply(f, X_ADD, x->H, e));
}

/* Node of v_i: H_p, p_i / m_i, or the input itself. */
static int velocity(problem *x, int i)
{
    if (x->form == OF_LAGRANGIAN) return SECOND + i;
    if (x->form == OF_HAMILTONIAN) return x->dp[i];
    return apply(&x->f, X_DIV, SECOND + i, number_of(&x->f, x->mass[i]));
}

/* Forces of q, v and t, which are terms of p' as the derivatives by q are. */
static void add_drive(problem *x, random_source *r, double about)
{
    int input[INPUTS_MOST];
    double place[INPUTS_MOST];
    for (int i = 0; i < INPUTS_MOST; i++) input[i] = i;
    for (int i = 0; i < x->n; i++) input[SECOND + i] = velocity(x, i);
    for (int i = 0; i < INPUTS_MOST; i++) place[i] = x->f.nodes[input[i]].value;
    x->drive = formula_of(INPUTS_MOST, place);
    formula *g = &x->drive;
    const int own = own_coordinates(g, x->n, about);
    for (int i = 0; i < x->n; i++) {
        const int of_q = random_term(g, r, own, x->n, choose(r, 2));
        const int of_v =
            x->form == OF_LAGRANGIAN ? smooth_term(g, r, x->n) : random_term(g, r, SECOND, x->n, choose(r, 2));
        const int term = apply(g, choose(r, 2) ? X_ADD : X_MUL, of_q, of_v), wave = apply(g, X_COS, TIME, 0);
        const double size = fmax(1, fabs(g->nodes[term].value));
        x->driven_by[i] = times(g, 0.5 / size, choose(r, 3) ? term : apply(g, X_MUL, term, wave));
    }
    const int first = append_formula(&x->f, g, input, INPUTS_MOST) - INPUTS_MOST;
    for (int i = 0; i < x->n; i++)
        x->dq[i] = apply(&x->f, x->form == OF_LAGRANGIAN ? X_ADD : X_SUB, x->dq[i], first + x->driven_by[i]);
    x->is_driven = true;
}

/* Some of the numbers from a node on. */
static void choose_parameters(problem *x, random_source *r, int from)
{
    for (int i = from; i < x->f.count && x->parameters < PARAMETERS_MOST; i++) {
        formula_node *z = &x->f.nodes[i];
        if (z->op != X_NUMBER || choose(r, 2)) continue;
        x->parameter[x->parameters++] = z->number;
        z->parameter = x->parameters;
    }
}

problem problem_of(uint64_t seed)
{
    random_source r = {seed * UINT64_C(0xd1342543de82ef95)}, of_rescaled = {seed * UINT64_C(0x9e3779b97f4a7c15)},
                  of_parameters = {seed * UINT64_C(0xaf251af3b0f025b5)},
                  of_drives = {seed * UINT64_C(0x2545f4914f6cdd1d)};
    static const double places[] = {0, 0, 0, 1, 1e6}; /* that the coordinates are about */
    const int few = choose(&r, 4);
    const double about = places[choose(&r, 5)];
    problem x = {.form = (form)choose(&r, FORMS), .n = 1 + choose(&r, few ? 4 : N_MOST), .t = uniform(&r, -3, 3)};
    double place[INPUTS_MOST];
    int gradient[INPUTS_MOST];
    for (int i = 0; i < N_MOST; i++) {
        place[i] = x.q[i] = about + uniform(&r, -1, 1);
        place[SECOND + i] = x.p[i] = uniform(&r, -1, 1);
        x.mass[i] = choose(&r, 3) ? uniform(&r, 0.2, 5) : 1;
    }
    place[TIME] = x.t;
    x.rescales = x.form == OF_HAMILTONIAN && x.n < N_MOST && choose(&of_rescaled, 3) == 1;
    if (x.rescales) place[x.n] = x.q[x.n] = x.t;
    x.f = formula_of(INPUTS_MOST, place);
    x.own = own_coordinates(&x.f, x.n, about);
    const int first = x.f.count;
    x.energy = random_energy(&x, &r);
    if (choose(&of_parameters, 3) == 0) choose_parameters(&x, &of_parameters, first);
    if (x.rescales) rescale(&x, &of_rescaled);
    gradient_of(&x.f, x.energy, INPUTS_MOST, gradient);
    for (int i = 0; i < x.n; i++) {
        x.dq[i] = x.form == OF_FORCE ? apply(&x.f, X_NEG, gradient[i], 0) : gradient[i];
        x.dp[i] = gradient[SECOND + i];
        if (x.form == OF_LAGRANGIAN) x.p[i] = x.f.nodes[x.dp[i]].value;
    }
    if (x.form != OF_FORCE && !x.rescales && choose(&of_drives, 4) == 0) add_drive(&x, &of_drives, about);
    return x;
}

void problem_free(problem *x)
{
    free(x->f.nodes);
    free(x->drive.nodes);
}

/* ---- The system -------------------------------------------------------------------------------------------------- */

static void place_inputs(const problem *x, const jet q[], const jet r[], jet t, jet input[])
{
    for (int i = 0; i < INPUTS_MOST; i++) input[i] = jet_const(0);
    for (int i = 0; i < x->n; i++) input[i] = q[i];
    for (int i = 0; r && i < x->n; i++) input[SECOND + i] = r[i];
    input[TIME] = t;
}

static void record_force(const jet q[], jet t, jet force[], void *ctx)
{
    const problem *x = ctx;
    jet input[INPUTS_MOST];
    place_inputs(x, q, NULL, t, input);
    record(&x->f, input, x->n, x->dq, force);
}

static jet record_potential(const jet q[], jet t, void *ctx)
{
    const problem *x = ctx;
    jet input[INPUTS_MOST], V;
    place_inputs(x, q, NULL, t, input);
    record(&x->f, input, 1, &x->energy, &V);
    return V;
}

static jet record_energy(const jet q[], const jet r[], jet t, void *ctx)
{
    const problem *x = ctx;
    jet input[INPUTS_MOST], E;
    place_inputs(x, q, r, t, input);
    record(&x->f, input, 1, &x->energy, &E);
    return E;
}

/* Nodes of the rescaled system: they take the time from the place of the last coordinate. */
static jet record_unscaled(const problem *x, int node, const jet q[], const jet p[], jet t)
{
    jet input[INPUTS_MOST], value;
    const int n = x->n - 1;
    for (int i = 0; i < INPUTS_MOST; i++) input[i] = jet_const(0);
    for (int i = 0; i < n; i++) input[i] = q[i], input[SECOND + i] = p[i];
    input[n] = t;
    record(&x->f, input, 1, &node, &value);
    return value;
}

static jet record_H(const jet q[], const jet p[], jet t, void *ctx)
{
    const problem *x = ctx;
    return record_unscaled(x, x->H, q, p, t);
}

static jet record_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const problem *x = ctx;
    return record_unscaled(x, x->scale, q, p, t);
}

static tvi_status rescaled_system(problem *x, tvi_system **system)
{
    tvi_system *base;
    tvi_status status = tvi_system_hamiltonian(&base, x->n - 1, record_H, x);
    if (status == TVI_OK) status = tvi_system_rescaled(system, base, record_scale, x);
    tvi_system_free(base);
    return status;
}

static void record_drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    const problem *x = ctx;
    jet input[INPUTS_MOST];
    place_inputs(x, q, v, t, input);
    record(&x->drive, input, x->n, x->driven_by, force);
}

static tvi_status plain_system(problem *x, tvi_system **system)
{
    switch (x->form) {
    case OF_FORCE: return tvi_system_force(system, x->n, x->mass, record_force, x);
    case OF_POTENTIAL: return tvi_system_potential(system, x->n, x->mass, record_potential, x);
    case OF_LAGRANGIAN: return tvi_system_lagrangian(system, x->n, record_energy, x);
    default: return tvi_system_hamiltonian(system, x->n, record_energy, x);
    }
}

tvi_status problem_system(problem *x, tvi_system **system)
{
    tvi_system *base;
    if (x->rescales) return rescaled_system(x, system);
    if (!x->is_driven) return plain_system(x, system);
    tvi_status status = plain_system(x, &base);
    if (status == TVI_OK) status = tvi_system_driven(system, base, record_drive, x);
    tvi_system_free(base);
    return status;
}

/* ---- The method -------------------------------------------------------------------------------------------------- */

/* Whether the definition of the method is one for this form: that of a Lagrangian which the library sees to be
 * separable, or of a Hamiltonian without its masses, is that of a potential. */
static bool defines(form of, const tvi_options *options)
{
    if (options->method == TVI_STORMER_VERLET) return of <= OF_POTENTIAL;
    return of != OF_LAGRANGIAN || options->method == TVI_TYPE1 || options->method == TVI_TAYLOR;
}

tvi_options random_method(form of, const tvi_system *system, random_source *r)
{
    tvi_options options = {0};
    tvi_integrator *integrator = NULL;
    int count = 0;
    while (tvi_methods[count]) count++;
    while (!integrator) {
        const tvi_descriptor *method = tvi_methods[choose(r, count)];
        options = (tvi_options){.method = method->method,
                                .expansion = method->expansion,
                                .nodes = (tvi_nodes)choose(r, 2),
                                .degree = 1 + choose(r, choose(r, 3) ? 4 : 9),
                                .compose_adjoint = choose(r, 6) == 0,
                                .quadrature = choose(r, 6) ? TVI_QUADRATURE_AUTO : TVI_TRAPEZOID};
        if (choose(r, 8) == 0) options.degree = 0, options.order = 1 + choose(r, 2);
        if (!defines(of, &options) || tvi_integrator_create(&integrator, system, &options) != TVI_OK) integrator = NULL;
    }
    options = *tvi_integrator_options(integrator);
    tvi_integrator_free(integrator);
    return options;
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

void print_problem(FILE *to, const problem *x)
{
    static const char *const names[] = {
        "q0", "q1", "q2", "q3", "q4", "q5", "q6", "q7", "q8", "q9",  "q10", "q11", "r0",
        "r1", "r2", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "t",
    };
    static const char *const forms[] = {"force -dV/dq of V", "potential V", "Lagrangian L, r = v,",
                                        "Hamiltonian H, r = p,"};
    fprintf(to, "  n = %d, %s%s = ", x->n, x->rescales ? "rescaled " : x->is_driven ? "driven " : "", forms[x->form]);
    print_formula(to, &x->f, x->energy, names);
    fprintf(to, "\n  t = %.17g, %d numbers of it parameters\n", x->t, x->parameters);
    for (int i = 0; i < x->n; i++)
        fprintf(to, "  q%d = %.17g, p%d = %.17g, mass %.17g\n", i, x->q[i], i, x->p[i], x->mass[i]);
}

const char *describe(const tvi_options *options)
{
    static char text[160];
    snprintf(text, sizeof text, "%s, %s, degree %d, order %d, quadrature %d with %d%s", tvi_find_method(options)->title,
             options->nodes == TVI_NODES_TRUNCATED ? "truncated" : "on-curve", options->degree, options->order,
             (int)options->quadrature, options->quadrature_points, options->compose_adjoint ? ", composed" : "");
    return text;
}
