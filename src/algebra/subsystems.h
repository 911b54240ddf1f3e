/* subsystems.h - Lists the components of subsystems that do not interact. The tails of a step (tail.h) compare only
 * components of one subsystem. */
#ifndef TVI_SRC_ALGEBRA_SUBSYSTEMS_H
#define TVI_SRC_ALGEBRA_SUBSYSTEMS_H

/* The subsystems of a system. A component is a coordinate with its momentum. */
typedef struct {
    int count;
    /* [n] The components of the first subsystem, then those of the second one, and so on. */
    int *component;
    /* [count] The end of each subsystem in `component`. */
    int *end;
} tvi_subsystems;

/* Return component number k of the list, and the end of subsystem k, of n components in all. If there is one
 * subsystem, compilers know both. */
static inline int tvi_subsystems_component(const tvi_subsystems *subsystems, int k)
{
    return subsystems->count == 1 ? k : subsystems->component[k];
}
static inline int tvi_subsystems_end(const tvi_subsystems *subsystems, int k, int n)
{
    return subsystems->count == 1 ? n : subsystems->end[k];
}

#endif
