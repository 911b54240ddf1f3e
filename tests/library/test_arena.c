/* test_arena.c - Tests pieces of an arena, aligned, apart, as many bytes as were measured (with the address sanitizer,
 * nothing but the pieces may be touched). */
#include "algebra/arena.h"
#include "suites.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

enum { PIECES = 5 };
static const size_t sizes[PIECES] = {1, 8, 64, 100, 12};

typedef struct {
    tvi_arena arena;
    char *memory, *piece[PIECES], *history[PIECES], *uncopied[PIECES];
} open_arena;

static void take_all(open_arena *x)
{
    for (int i = 0; i < PIECES; i++) {
        x->piece[i] = tvi_arena_allocate(&x->arena, sizes[i]);
        x->uncopied[i] = tvi_arena_allocate_uncopied(&x->arena, sizes[i]);
        x->history[i] = tvi_arena_allocate_copied(&x->arena, sizes[PIECES - 1 - i]);
    }
}

static open_arena open_all(void)
{
    open_arena x = {.memory = NULL};
    take_all(&x);
    for (int i = 0; i < PIECES; i++) ck_assert(!x.piece[i] && !x.history[i] && !x.uncopied[i]);
    const tvi_arena measured = x.arena;
    x.memory = tvi_arena_obtain_memory(&x.arena);
    ck_assert_ptr_nonnull(x.memory);
    take_all(&x);
    ck_assert(x.arena.bytes_outside_history == measured.bytes_outside_history &&
              x.arena.copied_history_bytes == measured.copied_history_bytes);
    ck_assert(x.arena.uncopied_history_bytes == measured.uncopied_history_bytes);
    return x;
}

static bool may_touch(const char *byte)
{
#ifdef ARENA_HAS_GAPS
    return !__asan_address_is_poisoned(byte);
#else
    return byte != NULL;
#endif
}

/* Each of its bytes may be touched, and none from its end to that of the gap. */
static void check_piece(char *piece, size_t bytes, size_t alignment, const char *next)
{
    ck_assert_uint_eq((uintptr_t)piece % alignment, 0);
    ck_assert(piece + bytes + ARENA_GAP <= next);
    for (size_t i = 0; i < bytes; i++) ck_assert(may_touch(piece + i));
    for (const char *byte = piece + bytes; ARENA_GAP > 0 && byte < next; byte++) ck_assert(!may_touch(byte));
}

START_TEST(pieces_are_apart)
{
    open_arena x = open_all();
    char *const end = x.memory + x.arena.bytes_outside_history,
                *const end_of_copied = end + x.arena.copied_history_bytes,
                *const end_of_uncopied = end + tvi_arena_history_bytes(&x.arena);
    for (int i = 0; i < PIECES; i++) {
        const bool is_last = i + 1 == PIECES;
        check_piece(x.piece[i], sizes[i], ARENA_ALIGNMENT, is_last ? end : x.piece[i + 1]);
        check_piece(x.history[i], sizes[PIECES - 1 - i], ARENA_COPIED_ALIGNMENT,
                    is_last ? end_of_copied : x.history[i + 1]);
        check_piece(x.uncopied[i], sizes[i], ARENA_ALIGNMENT, is_last ? end_of_uncopied : x.uncopied[i + 1]);
    }
    free(x.memory);
}
END_TEST

/* A history is copied and cleared as a whole; what is beside it is not. */
START_TEST(histories_are_copied)
{
    open_arena x = open_all();
    const size_t remembered = tvi_arena_history_bytes(&x.arena);
    char *copy = malloc(remembered + 1);
    memset(copy, 7, remembered + 1);
    for (int i = 0; i < PIECES; i++) memset(x.history[i], 1 + i, sizes[PIECES - 1 - i]);
    for (int i = 0; i < PIECES; i++) memset(x.uncopied[i], 11 + i, sizes[i]);
    tvi_arena_copy_history(copy, x.arena.history, remembered);
    tvi_arena_copy_history(x.arena.history, NULL, remembered);
    for (int i = 0; i < PIECES; i++)
        ck_assert(x.history[i][sizes[PIECES - 1 - i] - 1] == 0 && x.uncopied[i][sizes[i] - 1] == 0);
    tvi_arena_copy_history(x.arena.history, copy, remembered);
    for (int i = 0; i < PIECES; i++) ck_assert_int_eq(x.history[i][sizes[PIECES - 1 - i] - 1], 1 + i);
    for (int i = 0; i < PIECES; i++) ck_assert_int_eq(x.uncopied[i][sizes[i] - 1], 11 + i);
    ck_assert_int_eq(copy[remembered], 7);
    free(copy);
    free(x.memory);
}
END_TEST

Suite *suite_arena(void)
{
    Suite *suite = suite_create("arena");
    TCase *tcase = tcase_create("arena");
    tcase_add_test(tcase, pieces_are_apart);
    tcase_add_test(tcase, histories_are_copied);
    suite_add_tcase(suite, tcase);
    return suite;
}
