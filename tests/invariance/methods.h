/* methods.h - Declares the methods, as the library itself says which there are, and what they did wrong. */
#ifndef TESTS_INVARIANCE_METHODS_H
#define TESTS_INVARIANCE_METHODS_H

#include "tvi.h"

/* Degrees that depend on the method: that of its lowest order, and its highest. */
enum { LEAST = -1, HIGHEST = -2, METHODS_MOST = 256 };

typedef struct {
    int count;
    tvi_options options[METHODS_MOST];
} method_list;

/* Every method of the library with every node rule that tvi_options_check accepts for the system, with each of the
 * degrees; composed: composed with its adjoint, "svhd" among them. Added to the list. */
void add_methods(const tvi_system *system, int count, const int degrees[], bool composed, method_list *list);

bool is_symmetric(const tvi_options *options);

/* Text that lives until the next call. */
const char *describe(const tvi_options *options);

/* The failures, a line each; the test fails with them at the end. */
typedef struct {
    int count;
    size_t length;
    char text[4000];
} complaints;

/* The first line, which says of what they are. */
complaints complaints_of(const char *format, ...) __attribute__((format(printf, 1, 2)));
void complain(complaints *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
void expect_none(const complaints *c);

#endif
