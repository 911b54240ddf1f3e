/* methods.c - see methods.h. */
#include "methods.h"

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
    for (int method = TVI_TYPE1; method <= TVI_STORMER_VERLET; method++)
        for (int expansion = TVI_AT_START; expansion <= TVI_AT_NODES; expansion++)
            for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++)
                for (int k = 0; k < count; k++) {
                    const tvi_options options = {.method = (tvi_method)method,
                                                 .expansion = (tvi_expansion)expansion,
                                                 .nodes = (tvi_nodes)nodes,
                                                 .compose_adjoint = composed};
                    add_method(system, degrees[k], options, list);
                }
    tvi_options svhd;
    if (composed && tvi_options_named("svhd", 2, &svhd) == TVI_OK) add_method(system, 1, svhd, list);
}

bool is_symmetric(const tvi_options *options)
{
    const tvi_options adjoint = adjoint_of(options);
    return options->compose_adjoint || options->method == TVI_STORMER_VERLET ||
           (options->method != TVI_TAYLOR && adjoint.expansion == options->expansion);
}

/* Start and end change places, and so do types II and III (docs/method.md section 4). */
tvi_options adjoint_of(const tvi_options *options)
{
    tvi_options adjoint = *options;
    if (options->expansion == TVI_AT_START) adjoint.expansion = TVI_AT_END;
    if (options->expansion == TVI_AT_END) adjoint.expansion = TVI_AT_START;
    if (options->method == TVI_TYPE2) adjoint.method = TVI_TYPE3;
    if (options->method == TVI_TYPE3) adjoint.method = TVI_TYPE2;
    return adjoint;
}

const char *describe(const tvi_options *options)
{
    static const char *const method[] = {"type I", "type II", "type III", "Poincare", "Taylor", "Stormer-Verlet"};
    static const char *const expansion[] = {"start", "midpoint", "end", "both ends", "nodes"};
    static char text[160];
    const bool by_order = options->degree == 0;
    snprintf(text, sizeof text, "%s, %s, %s, %s %d%s", method[options->method], expansion[options->expansion],
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
