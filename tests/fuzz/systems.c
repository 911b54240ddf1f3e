/* systems.c - Goes from bytes to functions and systems. */
#include "world.h"

#include <limits.h>
#include <math.h>

/* ---- Bytes ------------------------------------------------------------------------------------------------------- */

int byte(bytes *b)
{
    if (b->left == 0) return 0;
    b->left--;
    return *b->data++;
}

int below(bytes *b, int count) { return byte(b) % count; }

double number(bytes *b)
{
    static const double extreme[] = {0,     1,    -1,       2,         0.5,         -0.5,   1e-300,   1e300,
                                     1e-12, 1e12, INFINITY, -INFINITY, (double)NAN, 5e-324, -1.7e308, 1e-8};
    const int first = byte(b);
    if (first % 16 == 15) return extreme[first / 16];
    return (first - 128) / 32.0 + byte(b) / 8192.0;
}

int integer(bytes *b, int usual)
{
    static const int odd[] = {-1, -2, INT_MIN, INT_MAX, 1000, 101};
    const int first = byte(b);
    return first >= 248 ? odd[first % 6] : first % usual;
}

double step_size(bytes *b)
{
    static const double odd[] = {1e-300, 1e300, 0, (double)NAN, INFINITY, 1e-17, 100, -1e6};
    const int first = byte(b);
    return first < 64 ? odd[first % 8] : (first - 160) / 256.0;
}

/* ---- Functions --------------------------------------------------------------------------------------------------- */

enum { OPERATIONS = 24, POOL = 2 * N_MAX + 1 + OPERATIONS };

/* Mostly one of a few, with the value that its index says, since another one is refused. */
static jet parameter(bytes *b, jet of)
{
    const int index = below(b, 16) ? below(b, 3) : integer(b, PARAMETERS_MOST);
    return jet_parameter(of, index, below(b, 32) ? 1 - index / 4.0 : number(b));
}

static jet operation(bytes *b, const jet pool[], int count)
{
    enum { FUNCTIONS = JET_FUNCTION_COUNT, ALL = FUNCTIONS + JET_FUNCTION2_COUNT, OTHERS = 11 };
    const int op = below(b, ALL + OTHERS);
    const jet x = pool[below(b, count)], y = pool[below(b, count)];
    if (op < FUNCTIONS) return jet_record_function((jet_function)op, x);
    if (op < ALL) return jet_record_function2((jet_function2)(op - FUNCTIONS), x, y);
    switch (op - ALL) {
    case 0: return jet_add(x, y);
    case 1: return jet_sub(x, y);
    case 2: return jet_div(x, y);
    case 3: return jet_pow(x, number(b));
    case 4: return jet_const(number(b));
    case 5: return jet_sum(pool, count);
    case 6: return jet_dot(pool, pool + count / 2, count / 2);
    case 7: return jet_mul(number(b), x);
    case 8: return jet_add(number(b), x);
    case 9: return parameter(b, x);
    default: return jet_mul(x, y);
    }
}

/* Operations on q, r (NULL: none) and t. */
static int record(const recorder *f, const jet q[], const jet r[], jet t, jet pool[POOL])
{
    int count = 0;
    for (int i = 0; i < f->n; i++) pool[count++] = q[i];
    for (int i = 0; r && i < f->n; i++) pool[count++] = r[i];
    pool[count++] = t;
    for (int left = below(f->b, OPERATIONS); left > 0; left--) {
        pool[count] = operation(f->b, pool, count);
        count++;
    }
    return count;
}

static void forces_of(const recorder *f, const jet q[], const jet r[], jet t, jet F[])
{
    jet pool[POOL];
    const int count = record(f, q, r, t, pool);
    for (int i = 0; i < f->n; i++) F[i] = pool[below(f->b, count)];
}

static void force(const jet q[], jet t, jet F[], void *ctx) { forces_of(ctx, q, NULL, t, F); }
static void drive(const jet q[], const jet v[], jet t, jet F[], void *ctx) { forces_of(ctx, q, v, t, F); }

static jet potential(const jet q[], jet t, void *ctx) { return scalar_of(ctx, q, NULL, t); }

jet scalar_of(const recorder *f, const jet q[], const jet r[], jet t)
{
    jet pool[POOL];
    const int count = record(f, q, r, t, pool);
    return pool[count - 1];
}

/* r^2 / 2 is added mostly, so that many of them are regular. */
static jet two_arguments(const jet q[], const jet r[], jet t, void *ctx)
{
    const recorder *f = ctx;
    const jet scalar = scalar_of(f, q, r, t);
    return below(f->b, 8) == 0 ? scalar : jet_add(scalar, jet_mul(0.5, jet_dot(r, r, f->n)));
}

static jet time_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const recorder *f = ctx;
    const jet scalar = scalar_of(f, q, p, t);
    return below(f->b, 4) ? jet_exp(jet_mul(0.25, scalar)) : scalar;
}

static tvi_status make_base(recorder f, tvi_system **system)
{
    bytes *b = f.b;
    double mass[N_MAX];
    const int form = below(b, 4), own = below(b, 4);
    for (int i = 0; i < N_MAX; i++) mass[i] = own ? 1 + i / 3.0 : number(b);
    switch (form) {
    case 0: return tvi_system_force(system, f.n, own == 1 ? NULL : mass, force, &f);
    case 1: return tvi_system_potential(system, f.n, own == 1 ? NULL : mass, potential, &f);
    case 2: return tvi_system_lagrangian(system, f.n, two_arguments, &f);
    default: return tvi_system_hamiltonian(system, f.n, two_arguments, &f);
    }
}

/* One in four with steps that adapt, one in five with a drive. */
tvi_status make_system(bytes *b, tvi_system **system, world *w)
{
    tvi_system *base;
    recorder f = {b, w->n = 1 + below(b, N_MAX)};
    tvi_status status = make_base(f, &base);
    const int changed = below(b, 20);
    *system = base;
    w->adapts = base && changed < 5;
    if (!base || changed > 8) return status;
    if (w->adapts) status = tvi_system_rescaled(system, base, below(b, 2) ? time_scale : NULL, &f);
    else status = tvi_system_driven(system, base, drive, &f);
    tvi_system_free(base);
    return status;
}
