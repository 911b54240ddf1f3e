/* texts.h - States as texts: writes them to memory of their size, loads them, and gives changed ones their hash. */
#ifndef TESTS_PROBLEMS_TEXTS_H
#define TESTS_PROBLEMS_TEXTS_H

#include "tvi.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline void insist_on_text(tvi_status status)
{
    if (status == TVI_OK) return;
    fprintf(stderr, "a text of a state: %s\n", tvi_last_error());
    abort();
}

/* The text of a state, which ends with a 0, and which the caller frees. */
static inline char *text_of_state(const tvi_integrator *it, double t, const double q[], const double p[])
{
    size_t size;
    insist_on_text(tvi_state_to_text(it, t, q, p, NULL, &size));
    char *text = calloc(size + 1, 1);
    insist_on_text(tvi_state_to_text(it, t, q, p, text, &size));
    return text;
}

static inline char *text_of_member(const tvi_ensemble *ensemble, int member, const double t[], const double q[],
                                   const double p[])
{
    size_t size;
    insist_on_text(tvi_ensemble_member_to_text(ensemble, member, t, q, p, NULL, &size));
    char *text = calloc(size + 1, 1);
    insist_on_text(tvi_ensemble_member_to_text(ensemble, member, t, q, p, text, &size));
    return text;
}

/* Each member of the one ensemble becomes that of the other. */
static inline void move_members(const tvi_ensemble *from, tvi_ensemble *to, int members, double t[], double q[],
                                double p[])
{
    for (int m = 0; m < members; m++) {
        char *text = text_of_member(from, m, t, q, p);
        insist_on_text(tvi_ensemble_member_from_text(to, m, text, strlen(text), t, q, p));
        free(text);
    }
}

/* Makes the last word of a text the hash of the words before it. */
static inline void sign_text(char *text)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    char *end = strstr(text, "\nend ") + 5;
    for (const char *c = text; c < end; c++)
        hash = (hash ^ (unsigned char)(*c == '\n' ? ' ' : *c)) * UINT64_C(0x100000001b3);
    char word[17];
    (void)snprintf(word, sizeof word, "%016llx", (unsigned long long)hash);
    memcpy(end, word, 16);
}

/* The hash of what the history of a text is of: the word after "history". */
static inline char *history_hash_in(char *text) { return strstr(text, "\nhistory ") + 9; }

#endif
