/* kernel_loops.h - the part of kernel.h's text that loops.h names. */

OWN void NAME(start)(const galerkin_nodes *nodes, int n, const tvi_origin *origin)
{
    EACH_VECTOR(NAME(start_half)(nodes, 0, n, origin->q, origin->q_low, s, here));
    EACH_VECTOR(NAME(start_half)(nodes, n, n, origin->p, origin->p_low, s, here));
}

OWN void NAME(start_drifting)(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin, double *drift,
                              double *drift_low)
{
    const int width = MEMBERS ? nodes->width : 1;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int at = u * width; at < (u + 1) * width; at++) {
            drift[at] = nodes->scale[u] * origin->p[at];
            drift_low[at] = fma(nodes->scale[u], origin->p[at], -drift[at]) + nodes->scale[u] * origin->p_low[at];
        }
    for (int u = 0; u < nodes->unknowns; u++)
        EACH_VECTOR(NAME(start_drift)(nodes, u, c, origin, drift, drift_low, s, here));
}

OWN void NAME(predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    EACH_VECTOR(NAME(predict_all)(nodes, by, s, here));
}

OWN void NAME(set_sizes)(const galerkin_nodes *nodes, int n)
{
    const tvi_subsystems parts = nodes->parts;
    for (int k = 0, first = 0, end; k < parts.count; k++, first = end) {
        end = tvi_subsystems_end(&parts, k, n);
        EACH_VECTOR(NAME(set_sizes_of)(nodes, n, first, end, s, here));
    }
}

OWN void NAME(move)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                    double moved[])
{
    EACH_VECTOR(NAME(move_all)(nodes, matrix, drives, slot, moved, s, here));
}

OWN void NAME(integrate)(const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums)
{
    EACH_VECTOR(NAME(integrate_all)(nodes, weights, sums, s, here));
}

OWN void NAME(end_drifting)(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,
                            const double *drift_low, const tvi_increments *by)
{
    const int width = MEMBERS ? nodes->width : 1;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int at = u * width; at < (u + 1) * width; at++) {
            by->dq[at] = galerkin_rise(drift[at], drift_low[at], nodes->scale[u], sums->twice[at], sums->twice_low[at],
                                       &by->dq_low[at]);
            by->dp[at] = sums->once[at];
            by->dp_low[at] = sums->once_low[at];
        }
}

OWN void NAME(end)(const galerkin_nodes *nodes, const galerkin_sums *sums, int n, const tvi_increments *by)
{
    const int width = MEMBERS ? nodes->width : 1, half = n * width;
    for (int i = 0; i < n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            by->dq[at] = nodes->scale[i] * sums->once[at];
            by->dq_low[at] = nodes->scale[i] * sums->once_low[at];
            by->dp[at] = nodes->scale[n + i] * sums->once[half + at];
            by->dp_low[at] = nodes->scale[n + i] * sums->once_low[half + at];
        }
}

OWN void NAME(tail)(const galerkin_motion *motion, int members, double *restrict share, double *restrict ratio,
                    double tail[])
{
    const galerkin_motion of = *motion;
    const int width = MEMBERS ? members : 1;
    for (int i = 0; i < of.n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const size_t momentum = (size_t)(of.is_separable ? at : at + of.n * width);
            const tvi_tail_part part =
                galerkin_tail_part(&of, of.is_separable, of.scale[i], of.per_scale[i], (size_t)at, momentum);
            share[at] = tvi_tail_share(&part, of.is_separable || of.has_masses);
            ratio[at] = tvi_tail_ratio(&part);
        }
    tvi_tails_of_members(&of.parts, of.n, width, share, ratio, tail);
}

#if MEMBERS
OWN int NAME(judge)(galerkin_verdicts *of, const tvi_passes_rule *by, int width, int count)
{
    const tvi_passes_rule rule = *by;
    long long left = 0;
    for (int m = 0; m < width; m += NUMBERS_OF(V)) {
        const JET_MASK(jet_widest) moves = *(const JET_MASK(jet_widest) *)(of->is_moving + m);
        const V moved = *(const V *)(of->moved + m), infinite = INFINITY - (V){0}, slowest = *(V *)(of->slowest + m);
        members_passes passes = {.count = count - 1,
                                 .size = *(V *)(of->size + m),
                                 .before = *(V *)(of->before + m),
                                 .part = *(V *)(of->part + m),
                                 .slowest = slowest,
                                 .shown = *(V *)(of->shown + m),
                                 .slack = 1 - (V){0},
                                 .roundoff = {0}};
        JET_MASK(jet_widest) is_stuck;
        const JET_MASK(jet_widest) may_end = members_judge(&passes, &rule, moved, &is_stuck),
                                   is_finite = moved < infinite;
        *(V *)(of->size + m) = passes.size;
        *(V *)(of->before + m) = passes.before;
        *(V *)(of->part + m) = passes.part;
        *(V *)(of->shown + m) = passes.shown;
        *(V *)(of->slowest + m) = JET_CHOOSE(V, moves, passes.slowest, slowest);
        if (count == 1) *(V *)(of->first + m) = moved;
        *(V *)(of->count + m) = JET_CHOOSE(V, moves, count - (V){0}, *(V *)(of->count + m));
        *(JET_MASK(jet_widest) *)(of->has_ended + m) |= moves & is_finite & may_end;
        *(JET_MASK(jet_widest) *)(of->is_moving + m) = moves & is_finite & ~(may_end | is_stuck);
    }
    for (int m = 0; m < width; m++) left -= of->is_moving[m];
    return (int)left;
}
#endif

#if !MEMBERS
OWN double NAME(move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *drives,
                               const int slot[], double *ways)
{
    NAME(weigh)(nodes, drives, slot, SHAPE_OF(nodes), 0);
    return NAME(follow)(nodes, matrix, ways, SHAPE_OF(nodes), 0);
}

OWN double NAME(move_both)(const galerkin_nodes *nodes, const double *matrix, const double *drives,
                           const double *changes, const int slot[])
{
    for (int u = 0; u < nodes->unknowns; u++)
        weigh_both(nodes->weight, drives + slot[u] * LANES, changes + u * LANES, nodes->impulse + u * LANES, LANES);
    return NAME(follow)(nodes, matrix, NULL, SHAPE_OF(nodes), 0);
}

OWN void NAME(place)(const galerkin_places *p, const double *table, const double *impulses, double *out)
{
    place_lanes(p, table, impulses, out, LANES);
}
#endif

#undef V
