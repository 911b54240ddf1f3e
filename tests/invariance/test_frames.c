/* test_frames.c - Tests every motion in every frame with every method: no step is refused, and the orbit is that in the
 * motion's own coordinates. */
#include "invariance.h"
#include "methods.h"
#include "motions.h"

#include <float.h>
#include <math.h>

enum { STEPS = 20 };

/* How well an orbit in the frame agrees. ROUNDOFF: to one unit of it a step, which the motion then enlarges, of
 * positions of size |x| + move and of what cancels in the force. BIT_FOR_BIT: so do those of separable motions; the
 * pivots of the others' matrices depend on the units. ROUNDED: the step and the momenta are rounded in these units,
 * which is a shift in time. */
enum { ROUNDOFF, BIT_FOR_BIT, ROUNDED };

static const struct {
    frame frame;
    int agrees;
    double least; /* amplitude */
} rows[] = {
    {{"moved by 1", 1, 1, 1, 1, false}, ROUNDOFF, 0},
    {{"moved by 1e6", 1e6, 1, 1, 1, false}, ROUNDOFF, 0},
    {{"unit of length 2^40", 0, 0x1p40, 1, 1, false}, BIT_FOR_BIT, 0x1p-15},
    {{"unit of time 2^-30", 0, 1, 0x1p-30, 1, false}, BIT_FOR_BIT, 0x1p-15},
    {{"unit of mass 2^-24", 0, 1, 1, 0x1p-24, false}, BIT_FOR_BIT, 0x1p-15},
    {{"unit of mass 2^24", 0, 1, 1, 0x1p24, false}, BIT_FOR_BIT, 0x1p-15},
    {{"unit of mass 2^-50", 0, 1, 1, 0x1p-50, false}, BIT_FOR_BIT, 0x1p-15},
    {{"units of 2^-21, 2^30, 2^60", 0, 0x1p-21, 0x1p30, 0x1p60, false}, BIT_FOR_BIT, 0x1p-15},
    {{"units of 3, 0.7, 11", 0, 3, 0.7, 11, false}, ROUNDED, 0x1p-15},
    {{"exchanged", 0, 1, 1, 1, true}, ROUNDOFF, 0x1p-15},
};
enum { ROWS = sizeof rows / sizeof *rows };

static const double amplitudes[] = {1, 0x1p-10, 0x1p-17, 0x1p-27, 0x1p-40}; /* to 1e-12 */
enum { AMPLITUDES = sizeof amplitudes / sizeof *amplitudes };

/* In units of roundoff of what the frame adds positions and forces of. */
static double bound_of(const setting *own, int row)
{
    if (rows[row].agrees == BIT_FOR_BIT && (own->motion->potential || own->motion->force)) return 0;
    return growth_of(own, STEPS) * STEPS + (rows[row].agrees == ROUNDED ? STEPS * own->motion->h : 0);
}

static void compare(const setting *own, const method_list *list, const outcome ends[], int row, complaints *c)
{
    setting there = *own;
    there.frame = &rows[row].frame;
    tvi_system *system = system_of(&there);
    const outcome start = start_of(own);
    const double bound = bound_of(own, row);
    for (int i = 0; i < list->count; i++) {
        const outcome end = run_from(&there, system, &list->options[i], 1, STEPS, &start);
        const double size =
            fmax(size_of(own, &ends[i]), size_of(own, &start)) + there.frame->move + own->motion->cancels;
        const double error = distance(own, &ends[i], &end) / (DBL_EPSILON * size);
        if (end.status != TVI_OK)
            complain(c, "%s, %s: step %ld: %s\n", there.frame->name, describe(&list->options[i]), end.steps + 1,
                     tvi_status_string(end.status));
        else if (ends[i].status == TVI_OK && !(error <= bound))
            complain(c, "%s, %s: %.1e units of roundoff\n", there.frame->name, describe(&list->options[i]), error);
    }
    tvi_system_free(system);
}

START_TEST(the_same_in_every_frame)
{
    const motion *m = &motions[_i / AMPLITUDES];
    const double amplitude = amplitudes[_i % AMPLITUDES];
    static const int degrees[] = {LEAST, 2, 8}, composed[] = {LEAST};
    static outcome ends[METHODS_MOST];
    if (m->start && amplitude < 1) return;
    setting own = {m, &as_it_is, m->n, m->most * amplitude};
    complaints c = complaints_of("%s, amplitude %.0e", m->name, own.amplitude);
    method_list list = {0};
    tvi_system *system = system_of(&own);
    const outcome start = start_of(&own);
    add_methods(system, 3, degrees, false, &list);
    add_methods(system, 1, composed, true, &list);
    for (int i = 0; i < list.count; i++) {
        ends[i] = run_from(&own, system, &list.options[i], 1, STEPS, &start);
        if (ends[i].status != TVI_OK)
            complain(&c, "as it is, %s: step %ld: %s\n", describe(&list.options[i]), ends[i].steps + 1,
                     tvi_status_string(ends[i].status));
    }
    for (int row = 0; row < ROWS; row++)
        if (amplitude >= rows[row].least) compare(&own, &list, ends, row, &c);
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

/* ---- Controls ---------------------------------------------------------------------------------------------------- */

/* A step that is longer by 2^-40 of itself is seen in every motion, as the shift in time that it is: |x'| STEPS h
 * 2^-40, with the size of the motion for that of x', to a factor of 4. A start that is moved by 2^-40 is one, too, and
 * its image is not itself. */
START_TEST(other_orbits_are_told_apart)
{
    const motion *m = &motions[_i];
    const double part = 0x1p-40;
    setting own = {m, &as_it_is, m->n, m->most};
    tvi_system *system = system_of(&own);
    const tvi_options options = tvi_options_default();
    outcome start = start_of(&own), moved = start, image = {0};
    const outcome end = run_from(&own, system, &options, 1, STEPS, &start),
                  late = run_from(&own, system, &options, 1 + part, STEPS, &start);
    const double size = size_of(&own, &end), shift = distance(&own, &end, &late) / (part * STEPS * m->h * size);
    ck_assert_msg(shift > 0.25 && shift < 4, "%s: %g of the shift in time", m->name, shift);
    moved.x[0] += part * size;
    const outcome other = run_from(&own, system, &options, 1, STEPS, &moved);
    ck_assert_double_gt(distance(&own, &end, &other), 4 * bound_of(&own, 0) * DBL_EPSILON * size);
    for (int i = 0; i < m->n; i++) image.x[i] = end.x[m->n - 1 - i], image.p[i] = end.p[m->n - 1 - i];
    if (m->n > 1) ck_assert_double_gt(distance(&own, &end, &image), 1e-3 * size);
    tvi_system_free(system);
}
END_TEST

Suite *suite_frames(void)
{
    Suite *suite = suite_create("frames");
    TCase *tcase = tcase_create("frames");
    tcase_add_loop_test(tcase, the_same_in_every_frame, 0, MOTIONS * AMPLITUDES);
    tcase_add_loop_test(tcase, other_orbits_are_told_apart, 0, MOTIONS);
    suite_add_tcase(suite, tcase);
    return suite;
}
