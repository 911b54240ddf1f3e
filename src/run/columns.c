/* columns.c - Updates the tangent vectors of a run (columns.h). The integrator stores the vectors before and after its
 * last step (tvi_tangent.start and .end). The vectors at a point inside the step are computed from those before it. */
#include "run/columns.h"

#include <string.h>

static size_t count_elements(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    return (2 * (size_t)it->system->n + (size_t)tvi_system_parameters(it->system)) * (size_t)columns->count;
}

static void copy_columns_from_user(const tvi_integrator *it, const tvi_tangent_columns *columns, double elements[])
{
    for (size_t i = 0; i < count_elements(it, columns); i++)
        elements[i] = columns->elements[i * columns->element_spacing];
}

static void copy_columns_to_user(const tvi_integrator *it, const tvi_tangent_columns *columns, const double elements[])
{
    for (size_t i = 0; i < count_elements(it, columns); i++)
        columns->elements[i * columns->element_spacing] = elements[i];
}

bool tvi_columns_match_last_step_end(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    const tvi_tangent *tangent = it->tangent;
    if (!columns->elements) return true;
    if (!tangent || tangent->step_number == 0 || tangent->step_number != it->stats.steps ||
        tangent->propagated_column_count != columns->count)
        return false;
    for (size_t i = 0; i < count_elements(it, columns); i++)
        if (tvi_double_bits(columns->elements[i * columns->element_spacing]) != tvi_double_bits(tangent->end[i]))
            return false;
    return true;
}

void tvi_columns_store_run_start(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (tvi_columns_match_last_step_end(it, columns)) return;
    copy_columns_from_user(it, columns, it->tangent->end);
    it->tangent->step_number = 0;
}

tvi_status tvi_columns_propagate_by_last_step(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (!columns->elements) return TVI_OK;
    tvi_tangent *tangent = it->tangent;
    const tvi_tangent_columns start = {tangent->start, columns->count, 1}, end = {tangent->end, columns->count, 1};
    copy_columns_from_user(it, columns, start.elements);
    memcpy(end.elements, start.elements, count_elements(it, columns) * sizeof *end.elements);
    tangent->step_number = 0;
    tvi_status status = tvi_columns_check_finite(it, &start);
    if (status == TVI_OK)
        status = tvi_columns_multiply_by_jacobian(it, &(tvi_step_to_differentiate){&it->start, it->parameters, it->h},
                                                  &start, &end);
    if (status != TVI_OK) return status;
    tangent->step_number = it->stats.steps;
    tangent->propagated_column_count = columns->count;
    copy_columns_to_user(it, columns, end.elements);
    return TVI_OK;
}

tvi_status tvi_columns_propagate_to_offset(const tvi_integrator *it, const tvi_tangent_columns *columns, double offset,
                                           const double parameters[])
{
    if (!columns->elements) return TVI_OK;
    const tvi_tangent_columns start = {it->tangent->start, columns->count, 1};
    tvi_columns_restore_step_end(it, columns);
    if (offset == it->h) return TVI_OK;
    tvi_columns_restore_step_start(it, columns);
    if (offset == 0) return TVI_OK;
    const tvi_status status = tvi_columns_multiply_by_jacobian(
        it, &(tvi_step_to_differentiate){&it->start, parameters, offset}, &start, columns);
    if (status != TVI_OK) tvi_columns_restore_step_end(it, columns);
    return status;
}

void tvi_columns_restore_step_end(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (columns->elements) copy_columns_to_user(it, columns, it->tangent->end);
}

void tvi_columns_restore_step_start(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (columns->elements) copy_columns_to_user(it, columns, it->tangent->start);
}
