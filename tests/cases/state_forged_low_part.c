/* A text of a state, with its right check sum, whose low-order part of q is half of q: no run makes it, as a
 * low-order part is below a unit of the last place. It is read, with q = 1, and a step of 0.001 jumps to q = 1.5.
 * Right: TVI_EINVAL, t, q and p as they were, and a step from q = 2 goes to 2 cos 0.001. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

int main(void)
{
    char text[400] = "tvi state 1\nn 1\nparameters 0\nt 0x0p+0 0x0p+0\nq 0x1p+0 0x1p-1\np 0x0p+0 0x0p+0\nend ";
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a, with blanks for new lines */
    for (const char *c = text; *c; c++) hash = (hash ^ (unsigned char)(*c == '\n' ? ' ' : *c)) * 0x100000001b3u;
    snprintf(text + strlen(text), 20, "%016llx\n", (unsigned long long)hash);
    tvi_system *system;
    tvi_integrator *it;
    double t = 0, q = 2, p = 0;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    const tvi_status status = tvi_state_from_text(it, text, strlen(text), &t, &q, &p);
    row(status == TVI_EINVAL && q == 2, "status %d, q = %g", status, q);
    TVI_OR_EXIT(tvi_step(it, 1e-3, &t, &q, &p));
    row(fabs(q - 2 * cos(1e-3)) < 1e-14, "after a step of 0.001: q = %g", q);
    tvi_integrator_free(it), tvi_system_free(system);
    return verdict();
}
