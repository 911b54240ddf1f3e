/* state.c - Saves everything that an integrator holds between steps as bytes, and loads it, so that a run goes on as
 * if it had not been interrupted (tvi_state_save, tvi_state_load). The bytes are
 *
 *     identity | t | q | p | counts | parameters | stop | history | checksum
 *
 * The identity describes the format, the method and the system; bytes with another identity are refused (saved.h). The
 * counts are the tvi_stats of the integrator. t, q and p are saved apart from the history for tvi_state_peek, which has
 * no integrator. The history contains everything that one step leaves to the next one (algebra/arena.h). */
#include "integrator/saved.h"
#include "system/refuse.h"

#include <stdlib.h>
#include <string.h>

/* The indices of the pieces of a saved integrator, in the order of the bytes. */
enum { TIME, COORDINATES, MOMENTA, COUNTS, PARAMETERS, STOP, HISTORY };

static void list_saved_pieces(const tvi_integrator *it, tvi_stats *stats, tvi_saved_pieces *pieces)
{
    const size_t n = (size_t)it->system->n, number = sizeof(double);
    pieces->piece_count = 0;
    tvi_saved_pieces_add(pieces, &it->state.q[n], number);
    tvi_saved_pieces_add(pieces, it->state.q, n * number);
    tvi_saved_pieces_add(pieces, it->state.p, n * number);
    tvi_saved_pieces_add(pieces, stats, sizeof *stats);
    tvi_saved_pieces_add(pieces, it->parameters, (size_t)tvi_system_parameters(it->system) * number);
    tvi_saved_pieces_add(pieces, it->stop, tvi_stop_bytes(it->system->n));
    tvi_saved_pieces_add(pieces, it->history, it->history_bytes);
}

tvi_status tvi_state_save(const tvi_integrator *it, void *buffer, size_t *size)
{
    if (!it || !size) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "size" : "integrator");
    tvi_stats stats = it->stats;
    tvi_saved_pieces pieces;
    list_saved_pieces(it, &stats, &pieces);
    const tvi_saved_identity own = tvi_saved_identity_of_integrator(it, tvi_saved_size_in_bytes(&pieces));
    return tvi_saved_write(&own, &pieces, buffer, size);
}

/* Loads the history, which contains t, q and p a second time. If a run cannot go on from the loaded history, the
 * integrator's former history is restored, and the call is refused. */
static tvi_status load_history(tvi_integrator *it, const tvi_saved_pieces *pieces, const void *buffer)
{
    char *own = malloc(it->history_bytes + 1);
    if (!own) return jet_explain_out_of_memory(TVI_ENOMEM);
    tvi_arena_copy_history(own, it->history, it->history_bytes);
    tvi_saved_load_piece(pieces, HISTORY, buffer);
    const bool is_sound = tvi_loaded_history_is_valid(it);
    if (!is_sound) tvi_arena_copy_history(it->history, own, it->history_bytes);
    free(own);
    return is_sound ? TVI_OK : jet_refuse(TVI_EINVAL, "the state is damaged");
}

tvi_status tvi_state_load(tvi_integrator *it, const void *buffer, size_t size)
{
    if (!it || !buffer) return jet_refuse(TVI_EINVAL, "%s is NULL", it ? "buffer" : "integrator");
    if (it->is_in_observer)
        return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not load a state");
    tvi_stats stats = it->stats;
    tvi_saved_pieces pieces;
    list_saved_pieces(it, &stats, &pieces);
    const tvi_saved_identity own = tvi_saved_identity_of_integrator(it, tvi_saved_size_in_bytes(&pieces));
    const char *const mismatch = tvi_saved_find_mismatch(&own, buffer, size);
    if (mismatch) return jet_refuse(TVI_EINVAL, "%s", mismatch);
    if (!tvi_saved_stats_are_valid(tvi_saved_piece_address(&pieces, COUNTS, buffer)) ||
        !tvi_saved_stops_are_valid(tvi_saved_piece_address(&pieces, STOP, buffer), it->system->n, 1) ||
        !tvi_numbers_are_finite(tvi_saved_piece_address(&pieces, PARAMETERS, buffer), pieces.piece[PARAMETERS].bytes))
        return jet_refuse(TVI_EINVAL, "the state is damaged");
    const tvi_status status = load_history(it, &pieces, buffer);
    if (status != TVI_OK) return status;
    for (int i = COUNTS; i < HISTORY; i++) tvi_saved_load_piece(&pieces, i, buffer);
    stats.bytes = it->stats.bytes;
    stats.is_compiled = it->stats.is_compiled;
    it->stats = stats;
    tvi_integrator_apply_parameters(it);
    it->has_dense_output = false;
    return TVI_OK;
}

tvi_status tvi_state_peek(const void *buffer, size_t size, int *n, double *t, double q[], double p[])
{
    tvi_saved_identity who;
    if (!buffer || !n) return jet_refuse(TVI_EINVAL, "%s is NULL", buffer ? "n" : "buffer");
    const char *reason = tvi_saved_find_damage(buffer, size, &who), *at = (const char *)buffer + sizeof who;
    const bool has_room = !reason && who.n >= 1 && who.n <= TVI_MAX_DIMENSION &&
                          (1 + 2 * (size_t)who.n) * sizeof(double) <= size - sizeof who - sizeof(uint64_t);
    if (!reason && !has_room) reason = "the state is damaged";
    if (!reason && who.member_count > 0) reason = "the state is of an ensemble";
    if (reason) return jet_refuse(TVI_EINVAL, "%s", reason);
    if (!who.has_stepped && (t || q || p)) return jet_refuse(TVI_EINVAL, "the state is of an integrator before a step");
    const size_t bytes = (size_t)who.n * sizeof(double);
    *n = (int)who.n;
    if (t) memcpy(t, at, sizeof *t);
    if (q) memcpy(q, at + sizeof *t, bytes);
    if (p) memcpy(p, at + sizeof *t + bytes, bytes);
    return TVI_OK;
}

tvi_status tvi_state_last(const tvi_integrator *it, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p || !*it->is_state_from_step)
        return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1},
                                                "the integrator has made no step, or was reset");
    tvi_integrator_copy_state(it, t, q, p);
    return TVI_OK;
}
