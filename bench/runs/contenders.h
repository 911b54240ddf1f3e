/* contenders.h - Declares who takes part in a sweep: methods of the library over ranges of orders, and the baselines.
 */
#ifndef CONTENDERS_H
#define CONTENDERS_H

#include "run.h"

/* The orders first, first + step, ..., last of a named method of the library. */
typedef struct {
    const char *name;
    int first, last, step;
    bool symplectic;
} method_range;

enum { CONTENDERS_MOST = 256 };
typedef struct {
    contender of[CONTENDERS_MOST];
    int count;
} contenders;

/* Each adds to the list; an order that the method does not have is left out. */
void contenders_add_methods(contenders *list, const method_range ranges[], int count);
void contenders_add_baselines(contenders *list);
/* A method with code that is generated for each scene, under a name of its own. */
void contenders_add_compiled(contenders *list, const char *name, const char *method, int order);

/* Falling orders: high orders end soon, at roundoff. */
void contenders_sort(contenders *list);

#endif
