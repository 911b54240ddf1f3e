/* sundials.c - Runs ARKODE ERKStep of order 8 and CVODE Adams of SUNDIALS (libsundials-dev). Not symplectic. */
#include "baseline.h"

#ifdef BASELINES_SUNDIALS
#include "first_order.h"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

static const long STEPS_MOST = 100000000;

static int slope(sunrealtype t, N_Vector y, N_Vector out, void *user)
{
    (void)t;
    first_order_slope(user, N_VGetArrayPointer(y), N_VGetArrayPointer(out));
    return 0;
}

typedef struct {
    first_order f;
    SUNContext context;
    N_Vector y;
} sundials;

static tvi_status watched(sundials *s, double t)
{
    return first_order_goes_on(&s->f, t, N_VGetArrayPointer(s->y)) ? TVI_OK : TVI_ESTOPPED;
}

/* ---- ERKStep ----------------------------------------------------------------------------------------------------- */

/* Fehlberg's 13 stages, the default of order 8. If the last node is 1, the ERKStep of Debian 12 (SUNDIALS 6.4.1)
 * takes the last stage's slope for that at the end of the step, which it is not, and the order falls below 7
 * (github.com/LLNL/sundials, issue 311). A node a little off 1 avoids it, and means nothing to a force without time. */
static bool erkstep_set_table(void *memory)
{
    ARKodeButcherTable table = ARKodeButcherTable_LoadERK(ARKODE_FEHLBERG_13_7_8);
    if (!table) return false;
    table->c[table->stages - 1] = 1 - 1e-8;
    const bool set = ERKStepSetTable(memory, table) == 0;
    ARKodeButcherTable_Free(table);
    return set;
}

static bool erkstep_set(void *memory, sundials *s, bool adaptive)
{
    const baseline_task *task = s->f.task;
    bool set = ERKStepSetUserData(memory, &s->f) == 0 && erkstep_set_table(memory);
    if (!adaptive) return set && ERKStepSetFixedStep(memory, task->h) == 0;
    set = set && ERKStepSetMaxNumSteps(memory, STEPS_MOST) == 0;
    set = set && ERKStepSetStopTime(memory, task->h * (double)task->steps) == 0;
    const double absolute = first_order_absolute(&s->f, N_VGetArrayPointer(s->y));
    return set && ERKStepSStolerances(memory, task->tolerance, absolute) == 0;
}

static tvi_status erkstep_steps(void *memory, sundials *s, bool adaptive)
{
    const baseline_task *task = s->f.task;
    const double t_end = task->h * (double)task->steps;
    double t = 0;
    tvi_status status = TVI_OK;
    while (status == TVI_OK && (adaptive ? t < t_end : s->f.steps < task->steps))
        status = ERKStepEvolve(memory, t_end, s->y, &t, ARK_ONE_STEP) < 0 ? TVI_ENOCONV : watched(s, t);
    return status;
}

static tvi_status erkstep(sundials *s, bool adaptive)
{
    void *memory = ERKStepCreate(slope, 0, s->y, s->context);
    if (!memory) return TVI_ENOMEM;
    tvi_status status = TVI_ENOMEM;
    if (erkstep_set(memory, s, adaptive)) status = erkstep_steps(memory, s, adaptive);
    ERKStepFree(&memory);
    return status;
}

/* ---- CVODE ------------------------------------------------------------------------------------------------------- */

static bool cvode_set(void *memory, sundials *s, SUNNonlinearSolver solver)
{
    const baseline_task *task = s->f.task;
    const double absolute = first_order_absolute(&s->f, N_VGetArrayPointer(s->y));
    return CVodeInit(memory, slope, 0, s->y) == 0 && CVodeSetUserData(memory, &s->f) == 0 &&
           CVodeSStolerances(memory, task->tolerance, absolute) == 0 && CVodeSetNonlinearSolver(memory, solver) == 0 &&
           CVodeSetMaxNumSteps(memory, STEPS_MOST) == 0 && CVodeSetStopTime(memory, task->h * (double)task->steps) == 0;
}

static tvi_status cvode_steps(void *memory, sundials *s)
{
    const double t_end = s->f.task->h * (double)s->f.task->steps;
    double t = 0;
    tvi_status status = TVI_OK;
    while (status == TVI_OK && t < t_end)
        status = CVode(memory, t_end, s->y, &t, CV_ONE_STEP) < 0 ? TVI_ENOCONV : watched(s, t);
    return status;
}

static tvi_status cvode_adams(sundials *s)
{
    void *memory = CVodeCreate(CV_ADAMS, s->context);
    SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
    tvi_status status = TVI_ENOMEM;
    if (memory && solver && cvode_set(memory, s, solver)) status = cvode_steps(memory, s);
    if (memory) CVodeFree(&memory);
    if (solver) SUNNonlinSolFree(solver);
    return status;
}

/* ---- The baselines ----------------------------------------------------------------------------------------------- */

enum { ERKSTEP, ADAMS };
static const int erkstep_solver = ERKSTEP, adams_solver = ADAMS;

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    sundials s = {.f = first_order_of(task)};
    if (SUNContext_Create(NULL, &s.context) != 0) return TVI_ENOMEM;
    tvi_status status = TVI_ENOMEM, end = TVI_OK;
    s.y = N_VNew_Serial(2 * s.f.n, s.context);
    if (s.y) {
        first_order_start(&s.f, q, p, N_VGetArrayPointer(s.y));
        status = self->data == &adams_solver ? cvode_adams(&s) : erkstep(&s, self->adaptive);
        end = first_order_end(&s.f, N_VGetArrayPointer(s.y), q, p, counts);
        N_VDestroy(s.y);
    }
    SUNContext_Free(&s.context);
    return status == TVI_OK ? end : status;
}

const baseline baselines_sundials[] = {
    {.name = "arkode-erkstep", .order = 8, .data = &erkstep_solver, .run = run},
    {.name = "arkode-erkstep-adaptive", .order = 8, .adaptive = true, .data = &erkstep_solver, .run = run},
    {.name = "cvode-adams", .order = 12, .adaptive = true, .data = &adams_solver, .run = run},
    {.name = NULL},
};

#endif
