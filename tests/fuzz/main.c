/* main.c - Defines the plain driver: PROGRAMS random programs from fixed seeds. `fuzz FIRST COUNT` runs others. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { PROGRAMS = 4000, BYTES = 256, LONGEST = 20 /* s, for one program */ };

/* xorshift64* */
static uint8_t random_byte(uint64_t *state)
{
    *state ^= *state >> 12, *state ^= *state << 25, *state ^= *state >> 27;
    return (uint8_t)(*state * UINT64_C(2685821657736338717) >> 56);
}

static long run_program(long number)
{
    uint8_t data[BYTES];
    uint64_t state = (uint64_t)number * UINT64_C(0x9e3779b97f4a7c15);
    for (int k = 0; k < BYTES; k++) data[k] = random_byte(&state);
    alarm(LONGEST); /* a hang ends the test */
    return fuzz_one(data, BYTES);
}

/* An event with a momentum that is NaN; steps that the guard's own start of Newton's method changed. */
static const long wrong_once[] = {14935, 44057};
enum { WRONG_ONCE = sizeof wrong_once / sizeof *wrong_once };

int main(int argc, char *argv[])
{
    const long first = argc > 1 ? strtol(argv[1], NULL, 10) : 1,
               count = argc > 2 ? strtol(argv[2], NULL, 10) : PROGRAMS;
    long steps = 0;
    for (int i = 0; argc == 1 && i < WRONG_ONCE; i++) steps += run_program(wrong_once[i]);
    for (long i = first; i < first + count; i++) {
        if (argc > 2 || i % 500 == 0) fprintf(stderr, "program %ld\n", i);
        steps += run_program(i);
    }
    printf("%ld random programs, %ld steps that succeeded\n", count, steps);
    return argc == 1 && steps < PROGRAMS / 4; /* else it tried nothing */
}
