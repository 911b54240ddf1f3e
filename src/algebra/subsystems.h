/* subsystems.h - Lists the components of subsystems that do not interact. The tails of a step (tail.h) compare only
 * components of one subsystem. */
#ifndef TVI_SRC_ALGEBRA_SUBSYSTEMS_H
#define TVI_SRC_ALGEBRA_SUBSYSTEMS_H

/* The subsystems of a system. A component is a coordinate with its momentum. */
typedef struct {
    int count;
    /* [n] The components of the first subsystem, then those of the second one, and so on. */
    int *component;
    /* [count] The position in `component` after the last component of each subsystem. */
    int *end;
} tvi_subsystems;

/* Return the component at a position of the list, and the position after the last component of a subsystem. The system
 * has n components. If there is only one subsystem, the results are the position and n, so that the lists need not be
 * read. */
static inline int tvi_subsystems_component(const tvi_subsystems *subsystems, int position)
{
    return subsystems->count == 1 ? position : subsystems->component[position];
}
static inline int tvi_subsystems_end(const tvi_subsystems *subsystems, int subsystem, int n)
{
    return subsystems->count == 1 ? n : subsystems->end[subsystem];
}

#endif
