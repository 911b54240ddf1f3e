/* rigid.c - Makes runs of rigid bodies for the suites (rigid.h). */
#include "rigid.h"

rigid_run rigid_begin(const tvi_rigid *r, const tvi_rigid_motion motion[], const tvi_options *options)
{
    rigid_run run = {.r = r};
    ck_assert_int_eq(tvi_rigid_system(&run.system, r, NULL, NULL), TVI_OK);
    for (int b = 0; b < r->bodies; b++) ck_assert_int_eq(tvi_rigid_state(r, b, &motion[b], run.q, run.p), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&run.integrator, run.system, options), TVI_OK);
    return run;
}

void rigid_go_on(rigid_run *run, double h, long steps, tvi_observer *observer, void *ctx)
{
    const tvi_status status = tvi_integrate(run->integrator, h, steps, &run->t, run->q, run->p, observer, ctx);
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
}

tvi_rigid_motion rigid_motion_of(const rigid_run *run, int body)
{
    tvi_rigid_motion motion = {0};
    ck_assert_int_eq(tvi_rigid_of(run->r, body, run->q, run->p, &motion), TVI_OK);
    return motion;
}

double rigid_energy_of(const rigid_run *run)
{
    double H;
    ck_assert_int_eq(tvi_energy(run->system, run->t, run->q, run->p, &H), TVI_OK);
    return H;
}

void rigid_end(rigid_run *run)
{
    tvi_integrator_free(run->integrator);
    tvi_system_free(run->system);
}
