/* expression.c - Implements expression.h. */
#include "expression.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (!memory) abort();
    return memory;
}

/* ---- Making ------------------------------------------------------------------------------------------------------ */

static bool is_binary(operation op) { return op >= X_ADD && op <= X_DIV; }

static double value_of(operation op, double a, double b, double c)
{
    switch (op) {
    case X_NUMBER: return c;
    case X_ADD: return a + b;
    case X_SUB: return a - b;
    case X_MUL: return a * b;
    case X_DIV: return a / b;
    case X_POW: return pow(a, c);
    case X_NEG: return -a;
    case X_SQR: return a * a;
    case X_SQRT: return sqrt(a);
    case X_EXP: return exp(a);
    case X_LOG: return log(a);
    case X_SIN: return sin(a);
    case X_COS: return cos(a);
    case X_TAN: return tan(a);
    case X_ASIN: return asin(a);
    case X_ACOS: return acos(a);
    case X_ATAN: return atan(a);
    case X_SINH: return sinh(a);
    case X_COSH: return cosh(a);
    default: return tanh(a);
    }
}

static int add_node(formula *f, operation op, int a, int b, double c)
{
    if (f->count == NODES_MOST) abort();
    const formula_node *nodes = f->nodes;
    f->nodes[f->count] = (formula_node){op, a, b, c, value_of(op, nodes[a].value, nodes[b].value, c), 0};
    return f->count++;
}

formula formula_of(int inputs, const double value[])
{
    formula f = {inputs, inputs, allocate(NODES_MOST, sizeof(formula_node))};
    for (int i = 0; i < inputs; i++) f.nodes[i].value = value[i];
    return f;
}

int number_of(formula *f, double number) { return add_node(f, X_NUMBER, 0, 0, number); }
int power(formula *f, int a, double exponent) { return add_node(f, X_POW, a, a, exponent); }

/* Both nodes of a pair whose derivatives are each other; the first of them. */
static int add_pair(formula *f, operation op, operation partner, int a)
{
    const int z = add_node(f, op, a, a, 0), w = add_node(f, partner, a, z, 0);
    f->nodes[z].b = w;
    return z;
}

/* sqrt(1 - a^2), the w of asin and acos. */
static int root_of_complement(formula *f, int a)
{
    return apply(f, X_SQRT, apply(f, X_SUB, number_of(f, 1), apply(f, X_MUL, a, a)), 0);
}

int apply(formula *f, operation op, int a, int b)
{
    int w = a;
    switch (op) {
    case X_SIN: return add_pair(f, X_SIN, X_COS, a);
    case X_COS: return add_pair(f, X_COS, X_SIN, a);
    case X_SINH: return add_pair(f, X_SINH, X_COSH, a);
    case X_COSH: return add_pair(f, X_COSH, X_SINH, a);
    case X_SQR: w = apply(f, X_MUL, a, a); break;
    case X_TAN:
        w = apply(f, X_SIN, a, 0);
        w = apply(f, X_DIV, w, f->nodes[w].b);
        break;
    case X_TANH:
        w = apply(f, X_SINH, a, 0);
        w = apply(f, X_DIV, w, f->nodes[w].b);
        break;
    case X_ASIN:
    case X_ACOS: w = root_of_complement(f, a); break;
    case X_ATAN: w = apply(f, X_ADD, number_of(f, 1), apply(f, X_MUL, a, a)); break;
    default: w = is_binary(op) ? b : a;
    }
    return add_node(f, op, a, w, 0);
}

static int place_of(int base, const formula *other, const int input[], int z)
{
    return z < other->inputs ? input[z] : base + z - other->inputs;
}

int append_formula(formula *f, const formula *other, const int input[], int z)
{
    const int base = f->count;
    for (int i = other->inputs; i < other->count; i++) {
        const formula_node x = other->nodes[i];
        if (f->count == NODES_MOST) abort();
        f->nodes[f->count] = x;
        f->nodes[f->count].a = place_of(base, other, input, x.a);
        f->nodes[f->count++].b = place_of(base, other, input, x.b);
    }
    return place_of(base, other, input, z);
}

/* ---- Random formulas --------------------------------------------------------------------------------------------- */

static uint64_t next(random_source *r)
{
    uint64_t z = r->state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

double uniform(random_source *r, double from, double to)
{
    return from + (to - from) * (double)(next(r) >> 11) * 0x1p-53;
}
int choose(random_source *r, int count) { return (int)(next(r) >> 33) % count; }

static double value_at(const formula *f, int i) { return f->nodes[i].value; }
static int times(formula *f, double factor, int a) { return apply(f, X_MUL, number_of(f, factor), a); }

/* Positive, and away from 0: where a is not, 1/2 + a^2. */
static int positive(formula *f, int a)
{
    return value_at(f, a) > 0.3 ? a : apply(f, X_ADD, number_of(f, 0.5), apply(f, X_SQR, a, 0));
}

/* Between -most and most: where a is not, most sin a. */
static int bounded(formula *f, int a, double most)
{
    return fabs(value_at(f, a)) < most ? a : times(f, most, apply(f, X_SIN, a, 0));
}

static int operand_of(formula *f, operation op, int a)
{
    switch (op) {
    case X_SQRT:
    case X_LOG:
    case X_POW: return positive(f, a);
    case X_EXP:
    case X_SINH:
    case X_COSH: return bounded(f, a, 2);
    case X_TAN: return bounded(f, a, 1);
    case X_ASIN:
    case X_ACOS: return bounded(f, a, 0.7);
    default: return a;
    }
}

static int random_leaf(formula *f, random_source *r, int first, int count)
{
    const int input = first + choose(r, count);
    return choose(r, 3) ? input : apply(f, X_ADD, times(f, uniform(r, -2, 2), input), number_of(f, uniform(r, -1, 1)));
}

int random_term(formula *f, random_source *r, int first, int count, int depth)
{
    static const double exponents[] = {-7, -3, -2.5, -2, -1.5, -1, -0.5, 0.5, 1.5, 2, 2.5, 3, 4, 7};
    if (depth == 0) return random_leaf(f, r, first, count);
    const operation op = (operation)(X_ADD + choose(r, X_COUNT - X_ADD));
    int z = operand_of(f, op, random_term(f, r, first, count, depth - 1));
    if (is_binary(op)) {
        const int other = random_term(f, r, first, count, depth - 1);
        const bool good = op != X_DIV || fabs(value_at(f, other)) > 0.3;
        z = apply(f, op, z, good ? other : positive(f, other));
    } else {
        z = op == X_POW ? power(f, z, choose(r, 4) ? exponents[choose(r, 14)] : uniform(r, -3, 3)) : apply(f, op, z, 0);
    }
    const double size = fabs(value_at(f, z));
    return size < 20 ? z : times(f, 1 / size, z);
}

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

/* sum += factor * a; 0 stands for no node yet, which is never one that is added to. */
static void add_to(formula *f, int *sum, int factor, int a)
{
    const int product = apply(f, X_MUL, factor, a);
    *sum = *sum ? apply(f, X_ADD, *sum, product) : product;
}

/* dz/da of an operation of a alone. */
static int slope_of(formula *f, int z)
{
    const formula_node x = f->nodes[z];
    switch (x.op) {
    case X_POW: return times(f, x.number, power(f, x.a, x.number - 1));
    case X_NEG: return number_of(f, -1);
    case X_SQR: return times(f, 2, x.a);
    case X_SQRT: return apply(f, X_DIV, number_of(f, 0.5), z);
    case X_EXP: return z;
    case X_LOG: return apply(f, X_DIV, number_of(f, 1), x.a);
    case X_COS: return apply(f, X_NEG, x.b, 0);
    case X_TAN: return apply(f, X_ADD, number_of(f, 1), apply(f, X_SQR, z, 0));
    case X_TANH: return apply(f, X_SUB, number_of(f, 1), apply(f, X_SQR, z, 0));
    case X_ASIN:
    case X_ATAN: return apply(f, X_DIV, number_of(f, 1), x.b);
    case X_ACOS: return apply(f, X_DIV, number_of(f, -1), x.b);
    default: return x.b; /* sin, sinh, cosh */
    }
}

/* By reverse accumulation. */
void gradient_of(formula *f, int out, int inputs, int gradient[])
{
    int *bar = allocate((size_t)out + 1, sizeof *bar);
    const int minus = number_of(f, -1);
    bar[out] = number_of(f, 1);
    for (int z = out; z >= f->inputs; z--) {
        const formula_node x = f->nodes[z];
        if (!bar[z] || x.op == X_NUMBER) continue;
        if (x.op == X_ADD || x.op == X_SUB) {
            add_to(f, &bar[x.a], number_of(f, 1), bar[z]);
            add_to(f, &bar[x.b], x.op == X_ADD ? number_of(f, 1) : minus, bar[z]);
        } else if (x.op == X_MUL) {
            add_to(f, &bar[x.a], x.b, bar[z]);
            add_to(f, &bar[x.b], x.a, bar[z]);
        } else if (x.op == X_DIV) {
            const int part = apply(f, X_DIV, bar[z], x.b);
            add_to(f, &bar[x.a], number_of(f, 1), part);
            add_to(f, &bar[x.b], minus, apply(f, X_MUL, part, z));
        } else {
            add_to(f, &bar[x.a], slope_of(f, z), bar[z]);
        }
    }
    for (int i = 0; i < inputs; i++) gradient[i] = bar[i] ? bar[i] : number_of(f, 0);
    free(bar);
}

/* ---- Jets -------------------------------------------------------------------------------------------------------- */

static jet number_jet(const formula_node *x, jet of)
{
    return x->parameter ? jet_parameter(of, x->parameter - 1, 0.25 + 1.25 * x->number) : jet_const(x->number);
}

static jet jet_of(const formula_node *x, jet a, jet b)
{
    static const jet_function functions[X_COUNT] = {
        [X_NEG] = JET_NEG,   [X_SQR] = JET_SQR,   [X_SQRT] = JET_SQRT, [X_EXP] = JET_EXP,   [X_LOG] = JET_LOG,
        [X_SIN] = JET_SIN,   [X_COS] = JET_COS,   [X_TAN] = JET_TAN,   [X_ASIN] = JET_ASIN, [X_ACOS] = JET_ACOS,
        [X_ATAN] = JET_ATAN, [X_SINH] = JET_SINH, [X_COSH] = JET_COSH, [X_TANH] = JET_TANH,
    };
    switch (x->op) {
    case X_ADD: return jet_add(a, b);
    case X_SUB: return jet_sub(a, b);
    case X_MUL: return jet_mul(a, b);
    case X_DIV: return jet_div(a, b);
    case X_POW: return jet_pow(a, x->number);
    default: return jet_record_function(functions[x->op], a);
    }
}

void record(const formula *f, const jet input[], int count, const int out[], jet value[])
{
    bool *needed = allocate((size_t)f->count, sizeof *needed);
    jet *jets = allocate((size_t)f->count, sizeof *jets);
    for (int i = 0; i < count; i++) needed[out[i]] = true;
    for (int z = f->count - 1; z >= f->inputs; z--) {
        const formula_node *x = &f->nodes[z];
        if (!needed[z] || x->op == X_NUMBER) continue;
        needed[x->a] = true;
        if (is_binary(x->op)) needed[x->b] = true;
    }
    for (int z = 0; z < f->count; z++) {
        const formula_node *x = &f->nodes[z];
        if (z < f->inputs) jets[z] = input[z];
        else if (needed[z] && x->op == X_NUMBER) jets[z] = number_jet(x, input[0]);
        else if (needed[z]) jets[z] = jet_of(x, jets[x->a], jets[is_binary(x->op) ? x->b : x->a]);
    }
    for (int i = 0; i < count; i++) value[i] = jets[out[i]];
    free(jets);
    free(needed);
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

void print_formula(FILE *to, const formula *f, int out, const char *const names[])
{
    static const char *const signs[] = {[X_ADD] = " + ", [X_SUB] = " - ", [X_MUL] = " * ", [X_DIV] = " / "};
    static const char *const words[X_COUNT] = {
        [X_NEG] = "-",     [X_SQR] = "sqr",   [X_SQRT] = "sqrt", [X_EXP] = "exp",   [X_LOG] = "log",
        [X_SIN] = "sin",   [X_COS] = "cos",   [X_TAN] = "tan",   [X_ASIN] = "asin", [X_ACOS] = "acos",
        [X_ATAN] = "atan", [X_SINH] = "sinh", [X_COSH] = "cosh", [X_TANH] = "tanh", [X_POW] = "pow",
    };
    const formula_node *x = &f->nodes[out];
    if (out < f->inputs) {
        fputs(names[out], to);
    } else if (x->op == X_NUMBER) {
        fprintf(to, "%.17g", x->number);
    } else {
        fprintf(to, "%s(", is_binary(x->op) ? "" : words[x->op]);
        print_formula(to, f, x->a, names);
        if (is_binary(x->op)) {
            fputs(signs[x->op], to);
            print_formula(to, f, x->b, names);
        } else if (x->op == X_POW) {
            fprintf(to, ", %.17g", x->number);
        }
        fputc(')', to);
    }
}
