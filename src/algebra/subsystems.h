/* subsystems.h - Lists the subsystems of a system that do not interact. Tails compare components of one subsystem
 * only. */
#ifndef TVI_SRC_ALGEBRA_SUBSYSTEMS_H
#define TVI_SRC_ALGEBRA_SUBSYSTEMS_H

/* Components, each with its momentum, in the order of their subsystems. */
typedef struct {
    int count;
    /* [n] the components of the first subsystem, then those of the second one, and so on. */
    int *member;
    /* [count] the end of each subsystem in `member`. */
    int *end;
} tvi_subsystems;

/* Component number k of this list, and the end of subsystem k, of n components. With one subsystem compilers know
 * both. */
static inline int tvi_subsystems_member(const tvi_subsystems *parts, int k)
{
    return parts->count == 1 ? k : parts->member[k];
}
static inline int tvi_subsystems_end(const tvi_subsystems *parts, int k, int n)
{
    return parts->count == 1 ? n : parts->end[k];
}

#endif
