/* subsystems.h - the parts of a system that know nothing of each other: nothing is a size in the one for the other. */
#ifndef TVI_SRC_ALGEBRA_SUBSYSTEMS_H
#define TVI_SRC_ALGEBRA_SUBSYSTEMS_H

/* Components, each with its momentum, in the order of the subsystems that they belong to. */
typedef struct {
    int count;
    int *member; /* [n] of the first subsystem, in their order; then of the second one, ... */
    int *end;    /* [count] of each among the members */
} tvi_subsystems;

/* Number k of them all, and the end of subsystem k, of n components; of one subsystem compilers know both. */
static inline int tvi_subsystems_member(const tvi_subsystems *parts, int k)
{
    return parts->count == 1 ? k : parts->member[k];
}
static inline int tvi_subsystems_end(const tvi_subsystems *parts, int k, int n)
{
    return parts->count == 1 ? n : parts->end[k];
}

#endif
