/* An ensemble of two threads where no more threads may be made: OpenMP ends the whole process. Right: the run is
 * made by fewer threads, or is refused. Root may always make threads, so that the program goes on as the user 65534
 * where it is root, as `setpriv --reuid 65534 --clear-groups prlimit --nproc=1 ./a.out` has it, and takes one
 * process as its limit. */
#define _DEFAULT_SOURCE
#include <math.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <tvi.h>
#include <unistd.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

int main(void)
{
    enum { MEMBERS = 64 };
    tvi_system *system;
    tvi_ensemble *ensemble = NULL;
    double t[MEMBERS] = {0}, q[MEMBERS] = {1}, p[MEMBERS] = {0};
    tvi_status each[MEMBERS];
    if (geteuid() == 0 && setuid(65534) != 0) return perror("setuid"), 1;
    if (setrlimit(RLIMIT_NPROC, &(struct rlimit){1, 1}) != 0) return perror("setrlimit"), 1;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    tvi_status status = tvi_ensemble_create(&ensemble, system, NULL, MEMBERS, 2);
    if (status == TVI_OK) status = tvi_ensemble_integrate(ensemble, 0.1, 3, t, q, p, each, NULL, NULL);
    row(status != TVI_OK || fabs(q[0] - cos(0.3)) < 1e-12, "status %d, q = %g", status, q[0]);
    tvi_ensemble_free(ensemble), tvi_system_free(system);
    return verdict();
}
