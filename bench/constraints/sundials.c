/* sundials.c - Runs IDA and CVODE of SUNDIALS (libsundials-dev) on constraints. Not symplectic. */
#include "hand.h"

#ifdef CONSTRAINTS_SUNDIALS
#include <cvode/cvode.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

const bool has_sundials = true;
static const long STEPS_MOST = 1000000;
/* Of multipliers: Newton's iteration is judged by q and v, and so are the steps. */
static const double NO_TOLERANCE = 1e30;

enum { Q, V, LAMBDA, MU };

/* The unknowns are q, v, lambda and, of index 2, mu. Those of a chain stand link by link: its Jacobian is a band. */
typedef struct {
    const hand *p;
    sundials_kind kind;
} equations;

static INLINE bool is_chain(const hand *p) { return p->n == 2 * p->m; }
static INLINE int sizes_of(const hand *p, sundials_kind kind)
{
    return kind == SUNDIALS_ADAMS ? 2 * p->n : 2 * p->n + (kind == SUNDIALS_IDA_2 ? 2 : 1) * p->m;
}

static INLINE int slot(const hand *p, sundials_kind kind, int what, int i)
{
    static const int before[] = {[Q] = 0, [V] = 2, [LAMBDA] = 4, [MU] = 5};
    if (kind == SUNDIALS_ADAMS) return what == Q ? i : p->n + i;
    if (!is_chain(p)) return i + (what > Q) * p->n + (what > V) * p->n + (what > LAMBDA) * p->m;
    const int width = sizes_of(p, kind) / p->m;
    return what == Q || what == V ? i / 2 * width + before[what] + i % 2 : i * width + before[what];
}

static INLINE void take(const hand *p, sundials_kind kind, int what, int count, const double y[], double x[])
{
    for (int i = 0; i < count; i++) x[i] = y[slot(p, kind, what, i)];
}

static INLINE void put(const hand *p, sundials_kind kind, int what, int count, const double x[], double y[])
{
    for (int i = 0; i < count; i++) y[slot(p, kind, what, i)] = x[i];
}

/* S lambda = G W F + v phi_qq v, the multipliers of a motion. */
static INLINE void find_lambda(const hand *p, const double q[], const double v[], double lambda[])
{
    double a[WORK_NUMBERS], g[WORK_NUMBERS], phi[MU_MOST], bent[MU_MOST], S[S_MOST] = {0};
    p->accelerate(q, a);
    p->evaluate(q, phi, g);
    p->bend(v, bent);
    p->apply_G(g, a, lambda);
    for (int k = 0; k < p->m; k++) lambda[k] += bent[k];
    p->set_S(g, g, S);
    hand_factor(p, S);
    hand_solve(p, S, lambda);
}

/* a = W (F - G^T lambda) */
static INLINE void accelerate(const hand *p, const double q[], const double g[], const double lambda[], double a[])
{
    double impulse[WORK_NUMBERS];
    p->accelerate(q, a);
    p->apply_WGT(g, lambda, impulse);
    for (int i = 0; i < p->n; i++) a[i] -= impulse[i];
}

/* ---- CVODE ------------------------------------------------------------------------------------------------------- */

static INLINE void slope(const hand *p, const double y[], double out[])
{
    double lambda[MU_MOST], phi[MU_MOST], g[WORK_NUMBERS];
    find_lambda(p, y, y + p->n, lambda);
    p->evaluate(y, phi, g);
    memcpy(out, y + p->n, (size_t)p->n * sizeof *out);
    accelerate(p, y, g, lambda, out + p->n);
}

/* ---- IDA --------------------------------------------------------------------------------------------------------- */

/* q' - v (+ W G^T mu), v' - a, and phi'' = G a + v phi_qq v or phi and G v. */
static INLINE void residual(const hand *p, sundials_kind kind, const double y[], const double rate[], double out[])
{
    double q[WORK_NUMBERS], v[WORK_NUMBERS], a[WORK_NUMBERS], x[WORK_NUMBERS], g[WORK_NUMBERS];
    double lambda[MU_MOST], mu[MU_MOST], phi[MU_MOST], hidden[MU_MOST];
    take(p, kind, Q, p->n, y, q), take(p, kind, V, p->n, y, v), take(p, kind, LAMBDA, p->m, y, lambda);
    p->evaluate(q, phi, g);
    accelerate(p, q, g, lambda, a);
    take(p, kind, V, p->n, rate, x);
    for (int i = 0; i < p->n; i++) x[i] -= a[i];
    put(p, kind, V, p->n, x, out);
    take(p, kind, Q, p->n, rate, x);
    for (int i = 0; i < p->n; i++) x[i] -= v[i];
    p->apply_G(g, kind == SUNDIALS_IDA_2 ? v : a, hidden);
    if (kind == SUNDIALS_IDA_2) {
        double across[WORK_NUMBERS];
        take(p, kind, MU, p->m, y, mu);
        p->apply_WGT(g, mu, across);
        for (int i = 0; i < p->n; i++) x[i] += across[i];
        put(p, kind, MU, p->m, phi, out);
    } else {
        p->bend(v, phi);
        for (int k = 0; k < p->m; k++) hidden[k] += phi[k];
    }
    put(p, kind, Q, p->n, x, out);
    put(p, kind, LAMBDA, p->m, hidden, out);
}

/* ---- The text for each problem ----------------------------------------------------------------------------------- */

#define FOR_PROBLEM(name)                                                                                              \
    static int slope_of_##name(sunrealtype t, N_Vector y, N_Vector out, void *user)                                    \
    {                                                                                                                  \
        (void)t, (void)user;                                                                                           \
        slope(&name, N_VGetArrayPointer(y), N_VGetArrayPointer(out));                                                  \
        return 0;                                                                                                      \
    }                                                                                                                  \
    static int residual_of_##name(sunrealtype t, N_Vector y, N_Vector rate, N_Vector out, void *user)                  \
    {                                                                                                                  \
        (void)t;                                                                                                       \
        const bool is_index_1 = ((const equations *)user)->kind == SUNDIALS_IDA_1;                                     \
        const double *const y_of = N_VGetArrayPointer(y), *const rate_of = N_VGetArrayPointer(rate);                   \
        if (is_index_1) residual(&name, SUNDIALS_IDA_1, y_of, rate_of, N_VGetArrayPointer(out));                       \
        else residual(&name, SUNDIALS_IDA_2, y_of, rate_of, N_VGetArrayPointer(out));                                  \
        return 0;                                                                                                      \
    }
FOR_PROBLEM(hand_pendulum)
FOR_PROBLEM(hand_double)
FOR_PROBLEM(hand_chain)
FOR_PROBLEM(hand_water)
FOR_PROBLEM(hand_top)

static const struct {
    const hand *p;
    CVRhsFn slope;
    IDAResFn residual;
} texts[] = {
    [WORK_PENDULUM] = {&hand_pendulum, slope_of_hand_pendulum, residual_of_hand_pendulum},
    [WORK_DOUBLE] = {&hand_double, slope_of_hand_double, residual_of_hand_double},
    [WORK_CHAIN] = {&hand_chain, slope_of_hand_chain, residual_of_hand_chain},
    [WORK_WATER] = {&hand_water, slope_of_hand_water, residual_of_hand_water},
    [WORK_TOP] = {&hand_top, slope_of_hand_top, residual_of_hand_top},
};

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

typedef struct {
    equations of;
    SUNContext context;
    N_Vector y, rate, id, absolute;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver fixed_point;
} solver;

/* A failure shows in what the functions return. */
static void say_nothing(int error, const char *module, const char *function, char *text, void *user)
{
    (void)error, (void)module, (void)function, (void)text, (void)user;
}

static bool go_adams(solver *s, const work_task *task)
{
    sunrealtype t = 0;
    void *memory = CVodeCreate(CV_ADAMS, s->context);
    s->fixed_point = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
    const bool is_over =
        memory && s->fixed_point && CVodeSetErrHandlerFn(memory, say_nothing, NULL) == 0 &&
        CVodeInit(memory, texts[task->problem].slope, 0, s->y) == 0 &&
        CVodeSStolerances(memory, task->tolerance, task->tolerance) == 0 &&
        CVodeSetNonlinearSolver(memory, s->fixed_point) == 0 && CVodeSetMaxNumSteps(memory, STEPS_MOST) == 0 &&
        CVodeSetStopTime(memory, task->duration) == 0 && CVode(memory, task->duration, s->y, &t, CV_NORMAL) >= 0;
    CVodeFree(&memory);
    return is_over;
}

/* The equations of a link have numbers of its neighbours, and phi'' of their neighbours, too. */
static bool set_ida(void *memory, solver *s, const work_task *task)
{
    const hand *p = s->of.p;
    const int size = sizes_of(p, s->of.kind), links = s->of.kind == SUNDIALS_IDA_1 ? 2 : 1;
    const int reach = (links + 1) * size / p->m - 1;
    const bool is_band = is_chain(p) && 2 * reach + 1 < size;
    double tolerance[MU_MOST];
    N_VConst(task->tolerance, s->absolute);
    for (int k = 0; k < p->m; k++) tolerance[k] = NO_TOLERANCE;
    put(p, s->of.kind, LAMBDA, p->m, tolerance, N_VGetArrayPointer(s->absolute));
    if (s->of.kind == SUNDIALS_IDA_2) put(p, s->of.kind, MU, p->m, tolerance, N_VGetArrayPointer(s->absolute));
    s->matrix = is_band ? SUNBandMatrix(size, reach, reach, s->context) : SUNDenseMatrix(size, size, s->context);
    if (!s->matrix) return false;
    s->linear = is_band ? SUNLinSol_Band(s->y, s->matrix, s->context) : SUNLinSol_Dense(s->y, s->matrix, s->context);
    return s->linear && IDASetErrHandlerFn(memory, say_nothing, NULL) == 0 &&
           IDAInit(memory, texts[task->problem].residual, 0, s->y, s->rate) == 0 &&
           IDASetUserData(memory, &s->of) == 0 && IDASVtolerances(memory, task->tolerance, s->absolute) == 0 &&
           IDASetLinearSolver(memory, s->linear, s->matrix) == 0 && IDASetId(memory, s->id) == 0 &&
           IDASetSuppressAlg(memory, 1) == 0 && IDASetMaxNumSteps(memory, STEPS_MOST) == 0 &&
           IDASetStopTime(memory, task->duration) == 0;
}

static bool go_ida(solver *s, const work_task *task)
{
    sunrealtype t = 0;
    void *memory = IDACreate(s->context);
    const bool is_over =
        memory && set_ida(memory, s, task) && IDASolve(memory, task->duration, &t, s->y, s->rate, IDA_NORMAL) >= 0;
    IDAFree(&memory);
    return is_over;
}

/* A start whose rates are those of the motion. */
static void start(const solver *s, const double q[], const double v[])
{
    const hand *p = s->of.p;
    const sundials_kind kind = s->of.kind;
    double lambda[MU_MOST], phi[MU_MOST], g[WORK_NUMBERS], a[WORK_NUMBERS], ones[WORK_NUMBERS];
    N_VConst(0, s->y), N_VConst(0, s->rate), N_VConst(0, s->id);
    double *const y = N_VGetArrayPointer(s->y), *const rate = N_VGetArrayPointer(s->rate);
    put(p, kind, Q, p->n, q, y), put(p, kind, V, p->n, v, y);
    if (kind == SUNDIALS_ADAMS) return;
    find_lambda(p, q, v, lambda);
    p->evaluate(q, phi, g);
    accelerate(p, q, g, lambda, a);
    put(p, kind, LAMBDA, p->m, lambda, y), put(p, kind, Q, p->n, v, rate), put(p, kind, V, p->n, a, rate);
    for (int i = 0; i < p->n; i++) ones[i] = 1;
    put(p, kind, Q, p->n, ones, N_VGetArrayPointer(s->id)), put(p, kind, V, p->n, ones, N_VGetArrayPointer(s->id));
}

bool sundials_run(const work_task *task, sundials_kind kind, double q[], double v[])
{
    solver s = {.of = {texts[task->problem].p, kind}};
    const hand *p = s.of.p;
    if (SUNContext_Create(NULL, &s.context) != 0) return false;
    s.y = N_VNew_Serial(sizes_of(p, kind), s.context);
    s.rate = N_VClone(s.y), s.id = N_VClone(s.y), s.absolute = N_VClone(s.y);
    start(&s, q, v);
    const bool is_over = kind == SUNDIALS_ADAMS ? go_adams(&s, task) : go_ida(&s, task);
    take(p, kind, Q, p->n, N_VGetArrayPointer(s.y), q), take(p, kind, V, p->n, N_VGetArrayPointer(s.y), v);
    if (s.linear) SUNLinSolFree(s.linear);
    if (s.matrix) SUNMatDestroy(s.matrix);
    if (s.fixed_point) SUNNonlinSolFree(s.fixed_point);
    N_VDestroy(s.y), N_VDestroy(s.rate), N_VDestroy(s.id), N_VDestroy(s.absolute);
    SUNContext_Free(&s.context);
    return is_over;
}
#else
const bool has_sundials = false;

bool sundials_run(const work_task *task, sundials_kind kind, double q[], double v[])
{
    (void)task, (void)kind, (void)q, (void)v;
    return false;
}
#endif
