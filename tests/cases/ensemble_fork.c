/* A process runs an ensemble of two threads and forks; the child, which runs one too, waits for ever, since the
 * threads of OpenMP are not forked. Right: the child ends with the same end of the run, or with a refusal. */
#include <math.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <tvi.h>
#include <unistd.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

/* The status of the run; a wrong end of the run counts as right nowhere, and ends the process. */
static tvi_status run(const tvi_system *system)
{
    enum { MEMBERS = 64 };
    tvi_ensemble *ensemble;
    double t[MEMBERS] = {0}, q[MEMBERS] = {1}, p[MEMBERS] = {0};
    tvi_status each[MEMBERS], status = tvi_ensemble_create(&ensemble, system, NULL, MEMBERS, 2);
    if (status == TVI_OK) status = tvi_ensemble_integrate(ensemble, 0.1, 3, t, q, p, each, NULL, NULL);
    if (status == TVI_OK && fabs(q[0] - cos(0.3)) > 1e-12) _exit(3);
    tvi_ensemble_free(ensemble);
    return status;
}

int main(void)
{
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    row(run(system) == TVI_OK, "parent");
    const pid_t child = fork();
    if (child == 0) {
        alarm(5);
        _exit(run(system) == TVI_OK || *tvi_last_error() ? 0 : 2);
    }
    int status = -1;
    waitpid(child, &status, 0);
    row(WIFEXITED(status) && WEXITSTATUS(status) == 0, "child %s",
        WIFSIGNALED(status) ? "hung until its alarm" : "ended");
    tvi_system_free(system);
    return verdict();
}
