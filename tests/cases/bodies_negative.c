/* Systems of a number of bodies that is 0, negative, or whose product with axes wraps around to a small number. If
 * it wraps the count is not noticed, and masses are read beyond their array. Right: TVI_EINVAL for all, and no
 * system. */
#include <limits.h>
#include <tvi_bodies.h>
#include "verdict.h"

int main(void)
{
    static const double mass[] = {1, 1};
    static const int counts[] = {0, -1, -1431655765, -1431655760, -1431652500, INT_MIN, INT_MAX, 1431655766, 715827883};
    for (int i = 0; i < (int)(sizeof counts / sizeof *counts); i++) {
        tvi_system *system = NULL;
        const tvi_bodies bodies = {.bodies = counts[i], .axes = 3, .mass = mass};
        const tvi_status status = tvi_bodies_system(&system, &bodies);
        row(status == TVI_EINVAL && !system, "%d bodies: status %d, %d unknowns", counts[i], status,
            system ? tvi_system_dimension(system) : 0);
        tvi_system_free(system);
    }
    return verdict();
}
