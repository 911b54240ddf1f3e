/* columns.c - Moves the tangent vectors of a run by its steps, and by parts of them. The integrator's tangent keeps the
 * vectors before and after the last step, so that every part of the step starts from the same ones. */
#include "run/columns.h"

#include <string.h>

static size_t count_of(const tvi_integrator *it, const tvi_columns *c)
{
    return (2 * (size_t)it->system->n + (size_t)tvi_system_parameters(it->system)) * (size_t)c->columns;
}

static void load(const tvi_integrator *it, const tvi_columns *c, double to[])
{
    for (size_t i = 0; i < count_of(it, c); i++) to[i] = c->D[i * c->spacing];
}

static void store(const tvi_integrator *it, const tvi_columns *c, const double from[])
{
    for (size_t i = 0; i < count_of(it, c); i++) c->D[i * c->spacing] = from[i];
}

bool tvi_columns_have_last_step(const tvi_integrator *it, const tvi_columns *c)
{
    const tvi_tangent *tangent = it->tangent;
    if (!c->D) return true;
    if (!tangent || tangent->step == 0 || tangent->step != it->stats.steps || tangent->moved != c->columns)
        return false;
    for (size_t i = 0; i < count_of(it, c); i++)
        if (tvi_bits(c->D[i * c->spacing]) != tvi_bits(tangent->end[i])) return false;
    return true;
}

void tvi_columns_begin(const tvi_integrator *it, const tvi_columns *c)
{
    if (tvi_columns_have_last_step(it, c)) return;
    load(it, c, it->tangent->end);
    it->tangent->step = 0;
}

tvi_status tvi_columns_step(const tvi_integrator *it, const tvi_columns *c)
{
    if (!c->D) return TVI_OK;
    tvi_tangent *tangent = it->tangent;
    const tvi_columns start = {tangent->start, c->columns, 1}, end = {tangent->end, c->columns, 1};
    load(it, c, start.D);
    memcpy(end.D, start.D, count_of(it, c) * sizeof *end.D);
    tangent->step = 0;
    tvi_status status = tvi_columns_check(it, &start);
    if (status == TVI_OK)
        status = tvi_columns_move(it, &(tvi_lifted_step){&it->start, it->parameters, it->h}, &start, &end);
    if (status != TVI_OK) return status;
    tangent->step = it->stats.steps;
    tangent->moved = c->columns;
    store(it, c, end.D);
    return TVI_OK;
}

tvi_status tvi_columns_show(const tvi_integrator *it, const tvi_columns *c, double part, const double parameters[])
{
    if (!c->D) return TVI_OK;
    const tvi_columns start = {it->tangent->start, c->columns, 1};
    tvi_columns_to_end(it, c);
    if (part == it->h) return TVI_OK;
    tvi_columns_to_start(it, c);
    if (part == 0) return TVI_OK;
    const tvi_status status = tvi_columns_move(it, &(tvi_lifted_step){&it->start, parameters, part}, &start, c);
    if (status != TVI_OK) tvi_columns_to_end(it, c);
    return status;
}

void tvi_columns_to_end(const tvi_integrator *it, const tvi_columns *c)
{
    if (c->D) store(it, c, it->tangent->end);
}

void tvi_columns_to_start(const tvi_integrator *it, const tvi_columns *c)
{
    if (c->D) store(it, c, it->tangent->start);
}
