/* emit_eights.h - eight sums z_i = sum_t c_ti x_ti in slots z .. z + 7 of generated code, by exchanges between whole
 * vectors: what is stored as single numbers and loaded as a vector soon after waits until it is in the cache. */
#ifndef TVI_AD_EMIT_EIGHTS_H
#define TVI_AD_EMIT_EIGHTS_H

#include "tape.h"
#include "text.h"

/* Terms that some of the sums lack have a coefficient of 0. */
enum { JET_EIGHT = 8, JET_EIGHT_TERMS = 6 };
typedef struct {
    int z, terms;
    int slot[JET_EIGHT_TERMS][JET_EIGHT];
    double coefficient[JET_EIGHT_TERMS][JET_EIGHT];
} jet_eight;

/* Of a tape whose sums stand alone. */
static inline bool jet_is_sum(const jet_run *run) { return run->op == OP_LINEAR && run->count == 1; }

/* Whether the sum reads this slot or a later one. */
static inline bool jet_reads_from(const jet_tape *tape, const jet_run *run, int slot)
{
    for (int term = run->term; term < run->term + run->terms; term++)
        if (tape->term_slot[term] >= slot) return true;
    return false;
}

/* The sums from this run on, of which none reads another; how many they are, so that what is left of eight slots is
 * nobody's. 0: they stand apart. */
int jet_find_eight(const jet_tape *tape, const jet_run *run, jet_eight *sums);
/* What the sums of the runs before `end` hand on to eight slots. false: these stand apart. */
bool jet_find_eight_back(const jet_tape *tape, const jet_run *first, const jet_run *end, int slot, jet_eight *sums);

/* The statement that makes them in the block x, or adds them to what is there. */
void jet_emit_eight(jet_text *text, const jet_eight *sums, const char *x, bool adds);

#endif
