/* methods.c - Implements methods.h. */
#include "methods.h"
#include "method/list.h"
#include "method/method.h"

#include <check.h>
#include <stdarg.h>
#include <stdio.h>

static bool serves(const tvi_system *system, const tvi_options *options)
{
    return tvi_options_check(system, options, NULL) == TVI_OK;
}

/* Whether the library makes a method of these options with the degree, which they are given. */
static bool set_degree(const tvi_system *system, int degree, tvi_options *options)
{
    if (degree == LEAST) {
        for (options->order = 1; options->order < 2 && !serves(system, options);) options->order++;
    } else {
        options->degree = degree == HIGHEST ? TVI_MAX_DEGREE : degree;
        while (degree == HIGHEST && options->degree > 1 && !serves(system, options)) options->degree--;
    }
    return serves(system, options);
}

static void add_method(const tvi_system *system, int degree, tvi_options options, method_list *list)
{
    if (!set_degree(system, degree, &options)) return;
    ck_assert_int_lt(list->count, METHODS_MOST);
    list->options[list->count++] = options;
}

void add_methods(const tvi_system *system, int count, const int degrees[], bool composed, method_list *list)
{
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++)
            for (int k = 0; k < count; k++) {
                const tvi_options options = {.method = (*d)->method,
                                             .expansion = (*d)->expansion,
                                             .nodes = (tvi_nodes)nodes,
                                             .compose_adjoint = composed};
                add_method(system, degrees[k], options, list);
            }
    tvi_options svhd;
    if (composed && tvi_options_named("svhd", 2, &svhd) == TVI_OK) add_method(system, 1, svhd, list);
}

bool is_symmetric(const tvi_options *options)
{
    return options->compose_adjoint || options->method == TVI_STORMER_VERLET ||
           tvi_is_method_symmetric(tvi_find_method(options));
}

const char *describe(const tvi_options *options)
{
    static char text[160];
    const bool by_order = options->degree == 0;
    snprintf(text, sizeof text, "%s, %s, %s %d%s", tvi_find_method(options)->title,
             options->nodes == TVI_NODES_TRUNCATED ? "truncated" : "on-curve", by_order ? "order" : "degree",
             by_order ? options->order : options->degree, options->compose_adjoint ? ", composed" : "");
    return text;
}

/* ---- Complaints -------------------------------------------------------------------------------------------------- */

static void append(complaints *c, const char *format, va_list arguments)
{
    const size_t left = sizeof c->text - c->length;
    const int written = vsnprintf(c->text + c->length, left, format, arguments);
    if (written > 0 && (size_t)written < left) c->length += (size_t)written;
    else c->text[c->length] = 0; /* full */
}

complaints complaints_of(const char *format, ...)
{
    complaints c = {0};
    va_list arguments;
    va_start(arguments, format);
    append(&c, format, arguments);
    va_end(arguments);
    return c;
}

void complain(complaints *c, const char *format, ...)
{
    va_list arguments;
    if (c->count++ == 0 && c->length + 2 < sizeof c->text) c->length += (size_t)sprintf(c->text + c->length, ":\n");
    va_start(arguments, format);
    append(c, format, arguments);
    va_end(arguments);
}

void expect_none(const complaints *c) { ck_assert_msg(c->count == 0, "%s%d in all", c->text, c->count); }
