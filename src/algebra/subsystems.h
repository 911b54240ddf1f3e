/* subsystems.h - Lists the components of subsystems that do not interact. The tails of a step (tail.h) compare only
 * components of one subsystem. */
#ifndef TVI_SRC_ALGEBRA_SUBSYSTEMS_H
#define TVI_SRC_ALGEBRA_SUBSYSTEMS_H

/* The subsystems of a system. A component is a coordinate with its momentum. */
typedef struct {
    int count;
    /* [n] The components of the first subsystem, then those of the second one, and so on. */
    int *component_list;
    /* [count] The index in component_list after the last component of each subsystem. */
    int *end_in_component_list;
} tvi_subsystems;

/* Return the component at an index of component_list, and the index there after the last component of a subsystem. If
 * there is only one subsystem, the results are list_index and component_count, the number of components of the system,
 * and the lists are not read. */
static inline int tvi_subsystems_component_at(const tvi_subsystems *subsystems, int list_index)
{
    return subsystems->count == 1 ? list_index : subsystems->component_list[list_index];
}
static inline int tvi_subsystems_end(const tvi_subsystems *subsystems, int subsystem, int component_count)
{
    return subsystems->count == 1 ? component_count : subsystems->end_in_component_list[subsystem];
}

#endif
