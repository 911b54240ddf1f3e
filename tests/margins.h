/* margins.h - Keeps the least margin of every comparison in an assertion, and adds the list of them to the file that
 * TVI_MARGINS names when a process ends. The copies of the tests that margins.py makes include this file. */
#ifndef TESTS_MARGINS_H
#define TESTS_MARGINS_H

#include <stdio.h>
#include <stdlib.h>

typedef struct margin_site {
    const char *place, *text, *sign;
    double value, bound, least; /* where the ratio of the bound and the value was least; least is 0 before the first */
    const struct margin_site *next;
} margin_site;

/* One list for all the objects of a program. */
__attribute__((weak)) const margin_site *margin_sites;

__attribute__((weak)) void margin_list(void)
{
    const char *path = getenv("TVI_MARGINS");
    FILE *file = path ? fopen(path, "a") : NULL;
    if (!file) return;
    for (const margin_site *site = margin_sites; site; site = site->next)
        fprintf(file, "%s\t%s\t%s\t%.6g\t%.6g\n", site->place, site->text, site->sign, site->value, site->bound);
    fclose(file);
}

__attribute__((weak)) void margin_keep(margin_site *site, double value, double bound)
{
    if (!(value * bound > 0)) return;
    const double ratio = (*site->sign == '>') == (bound > 0) ? value / bound : bound / value;
    if (site->least > 0 && !(ratio < site->least)) return;
    if (site->least == 0) {
        if (!margin_sites) atexit(margin_list);
        site->next = margin_sites;
        margin_sites = site;
    }
    site->least = ratio;
    site->value = value;
    site->bound = bound;
}

#define MARGIN_DISTANCE(a, b)                                                                                          \
    __extension__({                                                                                                    \
        const __typeof__((a) - (b)) margin_difference_ = (a) - (b);                                                    \
        margin_difference_ < 0 ? -margin_difference_ : margin_difference_;                                             \
    })
/* The address of something has no margin. */
#define MARGIN_NUMBER(x) ((double)__builtin_choose_expr(__builtin_classify_type(x) == 5, 0, x))
#define MARGIN(a, sign_, b, place_)                                                                                    \
    __extension__({                                                                                                    \
        static margin_site margin_site_ = {.place = place_, .text = #a " " #sign_ " " #b, .sign = #sign_};             \
        const __typeof__(a) margin_a_ = (a);                                                                           \
        const __typeof__(b) margin_b_ = (b);                                                                           \
        margin_keep(&margin_site_, MARGIN_NUMBER(margin_a_), MARGIN_NUMBER(margin_b_));                                \
        margin_a_ sign_ margin_b_;                                                                                     \
    })

#endif
