/* turns.h - Declares pieces of work timed in turns, so that what else the machine does meets all of them. */
#ifndef TURNS_H
#define TURNS_H

typedef struct {
    void (*work)(void *ctx);
    void *ctx;
    double seconds; /* CPU time of one call: the least of the turns */
    long calls;     /* of a turn: set by turns_time */
} turn;

/* The clock on the wall, s, of what is no work of this process alone. */
double turns_wall(void);

/* Sets seconds of each. */
void turns_time(int count, turn of[]);

/* The instruction set of the systems made afterwards, as TVI_ISA asks for it. */
typedef enum { ISA_BASE, ISA_AVX2, ISA_WIDEST, ISAS } isa;
void isa_pin(isa which);
const char *isa_name(isa which); /* what the machine makes of it: "base", "avx2" or "avx512" */

#endif
