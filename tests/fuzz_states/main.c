/* main.c - Loads saved states that were changed and given a right checksum, into integrators and ensembles, likewise
 * states as text, and runs from those that are accepted: nothing is read outside of the bytes, whatever stands in them.
 * `fuzz_states SEED COUNT` tries others; make check-sanitizers tries a million. */
#include "problems/problems.h"
#include "problems/random.h"
#include "integrator/saved.h"
#include "tape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { STATES = 20000, MEMBERS = 9, STEPS = 40, N = 3, LONGEST = 60 /* s, for one system and method */ };

static void insist(bool good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_states: %s\n", what);
    abort();
}

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_add(jet_dot(q, q, N), 0.1), -0.5));
}

/* Stiff springs in a row. */
static jet chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_sqr(q[0]), jet_mul(50, jet_add(jet_sqr(jet_sub(q[1], q[0])), jet_sqr(jet_sub(q[2], q[1])))));
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet kinetic = jet_mul(jet_add(1, jet_sqr(q[0])), jet_dot(p, p, N));
    return jet_add(jet_mul(0.5, kinetic), jet_mul(jet_parameter(q[0], 1, 0.3), jet_sin(q[1])));
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(jet_add(1, jet_mul(0.25, jet_sin(q[0]))), jet_dot(v, v, N)), jet_dot(q, q, N));
}

static tvi_status make_potential(tvi_system **out) { return tvi_system_potential(out, N, NULL, potential, NULL); }
static tvi_status make_chain(tvi_system **out) { return tvi_system_potential(out, N, NULL, chain, NULL); }
static tvi_status make_hamiltonian(tvi_system **out) { return tvi_system_hamiltonian(out, N, hamiltonian, NULL); }
static tvi_status make_lagrangian(tvi_system **out) { return tvi_system_lagrangian(out, N, lagrangian, NULL); }
static tvi_status make_rescaled(tvi_system **out)
{
    static tvi_system *base; /* which lives as long as the program */
    const tvi_status status = base ? TVI_OK : make_potential(&base);
    return status == TVI_OK ? tvi_system_rescaled(out, base, NULL, NULL) : status;
}

static tvi_status (*const systems[])(tvi_system **) = {make_potential, make_chain, make_hamiltonian, make_lagrangian,
                                                       make_rescaled};
static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16}, {"galerkin", 8}, {"midpoint", 8},       {"taylor", 10},
               {"poincare", 4},  {"tvi", 4},      {"stormer-verlet", 2}, {"svhd", 2}};
enum { SYSTEMS = sizeof systems / sizeof *systems, METHODS = sizeof methods / sizeof *methods };

/* ---- Changes ----------------------------------------------------------------------------------------------------- */

static uint64_t below(uint64_t *bits, uint64_t count) { return (uint64_t)(number_of(bits) * (double)count); }

static void set_word(unsigned char *bytes, size_t at, const void *word) { memcpy(bytes + at, word, sizeof(uint64_t)); }

/* A number of eight bytes that a state may hold by accident or by intent. */
static uint64_t word_of(uint64_t *bits)
{
    const double reals[] = {NAN, INFINITY, -INFINITY, 1e308, 5e-324, -1, 0};
    uint64_t word = below(bits, 2000) - 1000;
    const uint64_t kind = below(bits, 4);
    if (kind == 0) memcpy(&word, &reals[below(bits, sizeof reals / sizeof *reals)], sizeof word);
    if (kind == 1) word = (uint64_t)INT64_MAX - below(bits, 3);
    if (kind == 2) word = below(bits, UINT64_C(1) << 53) << 11;
    return word;
}

/* Changes what stands from `first` on, but the checksum, which is made right. */
static void forge(uint64_t *bits, unsigned char *bytes, size_t first, size_t size)
{
    const size_t words = (size - sizeof(uint64_t) - first) / sizeof(uint64_t);
    const uint64_t kind = below(bits, 8), changes = kind == 0 ? words : 1 + below(bits, kind < 4 ? 2 : 12);
    for (uint64_t k = 0; k < changes; k++) {
        const uint64_t word = word_of(bits);
        const size_t index = kind == 0 ? (size_t)k : (size_t)below(bits, words);
        if (kind == 7) bytes[first + (size_t)below(bits, size - 8 - first)] = (unsigned char)below(bits, 256);
        else set_word(bytes, first + index * sizeof word, &word);
    }
    tvi_saved_add_checksum(bytes, size);
}

/* The same of a text, of `size` characters: some of its words are others, and so are some characters. Half of the texts
 * have other numbers alone, many of which are read. Returns the new size, of at most LONGEST_TEXT. */
enum { LONGEST_TEXT = 4000, NUMBERS = 4 };
static size_t forge_text(uint64_t *bits, const char *text, char forged[LONGEST_TEXT])
{
    static const char *const others[] = {"0x1p+1023", "-0x1.fffffffffffffp+1023",
                                         "0x0p+0",    "0x0.0000000000001p-1022",
                                         "0x1p+1024", "0x1.p+0",
                                         "0x1p+",     "nan",
                                         "-inf",      "1.5",
                                         "0x2p+0",    "e",
                                         "q",         "end",
                                         "tvi",       "3",
                                         "-1",        "0x1.00000000000000000000000000000000000p+0"};
    const bool is_mild = below(bits, 2) == 0;
    const uint64_t choice = is_mild ? NUMBERS : sizeof others / sizeof *others;
    uint64_t hash = JET_HASH_OF_NOTHING, changes = 1 + below(bits, 3);
    size_t size = 0;
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, " \n");
        const bool is_end = strncmp(at, "end ", 4) == 0, is_open = !is_mild || strncmp(at, "0x", 2) == 0 || *at == '-';
        const bool is_changed = changes > 0 && is_open && below(bits, is_mild ? 8 : 20) == 0;
        const char *const word = is_changed ? others[below(bits, choice)] : at;
        const size_t count = is_changed ? strlen(word) : length;
        changes -= is_changed;
        memcpy(forged + size, word, count);
        if (!is_changed && !is_mild && changes > 0 && below(bits, 60) == 0) forged[size] = (char)below(bits, 256);
        hash = jet_continue_hash(jet_continue_hash(hash, forged + size, count), " ", 1);
        size += count;
        forged[size++] = at[length];
        at += length + 1;
        if (is_end) break;
    }
    return size + (size_t)sprintf(forged + size, "%016llx\n", (unsigned long long)hash);
}

/* ---- Trials ------------------------------------------------------------------------------------------------------ */

/* How many states were loaded, and how many refused. */
typedef struct {
    long loaded, refused;
} counts;

static void start(double t[], double q[], double p[], int members)
{
    for (int m = 0; m < members; m++) t[m] = 0;
    for (int k = 0; k < N * members; k++) {
        q[k] = 0.9 - 0.11 * (k / members) + 0.01 * (k % members);
        p[k] = 0.3 + 0.07 * (k / members);
    }
}

static bool is_finite(const double x[], int count)
{
    for (int k = 0; k < count; k++)
        if (!isfinite(x[k])) return false;
    return true;
}

static void *copy_of(const void *bytes, size_t size)
{
    void *copy = malloc(size); /* exactly: what is read behind it is seen */
    insist(copy != NULL, "no memory");
    return memcpy(copy, bytes, size);
}

static void run_integrator(tvi_integrator *it)
{
    double t, q[N], p[N];
    if (tvi_state_last(it, &t, q, p) != TVI_OK) return;
    for (int k = 0; k < 3; k++) {
        const tvi_status status = tvi_step(it, 0.05, &t, q, p);
        insist(status < TVI_STATUS_COUNT, "a step has no such status");
        insist(status != TVI_OK || (is_finite(q, N) && is_finite(p, N)), "a step is TVI_OK, and not finite");
        if (status != TVI_OK) return;
    }
}

/* One of four is cut short, too, and counts as neither loaded nor refused. One that is as it was is not tried: what was
 * forged is counted. */
static void try_texts(uint64_t *bits, tvi_integrator *it, long count, counts *sum)
{
    double t, q[N], p[N];
    char text[LONGEST_TEXT] = "", forged[LONGEST_TEXT];
    size_t size = sizeof text - 1;
    insist(tvi_state_last(it, &t, q, p) == TVI_OK, tvi_last_error());
    insist(tvi_state_to_text(it, t, q, p, text, &size) == TVI_OK, tvi_last_error());
    for (long k = 0; k < count; k++) {
        size = forge_text(bits, text, forged);
        const bool is_cut = below(bits, 4) == 0;
        if (is_cut) size = (size_t)below(bits, size);
        else if (size == strlen(text) && memcmp(forged, text, size) == 0) continue;
        char *copy = copy_of(forged, size + 1); /* which the last character is no part of */
        const tvi_status status = tvi_state_from_text(it, copy, size, &t, q, p);
        insist(status < TVI_STATUS_COUNT && is_finite(q, N) && is_finite(p, N), "a text is read as no state");
        if (status == TVI_OK) run_integrator(it);
        if (!is_cut) *(status == TVI_OK ? &sum->loaded : &sum->refused) += 1;
        free(copy);
    }
}

static void try_integrator(uint64_t *bits, const tvi_system *system, const tvi_options *options, long count,
                           counts *sum, counts *texts)
{
    tvi_integrator *it;
    double t, q[N], p[N];
    size_t size;
    if (tvi_integrator_create(&it, system, options) != TVI_OK) return;
    start(&t, q, p, 1);
    for (int k = 0; k < STEPS; k++) insist(tvi_step(it, 0.05, &t, q, p) == TVI_OK, tvi_last_error());
    insist(tvi_state_save(it, NULL, &size) == TVI_OK, tvi_last_error());
    void *whole = malloc(size);
    insist(tvi_state_save(it, whole, &size) == TVI_OK, tvi_last_error());
    for (long k = 0; k < count; k++) {
        int n;
        unsigned char *bytes = copy_of(whole, size);
        forge(bits, bytes, below(bits, 8) == 0 ? 8 : sizeof(tvi_saved_identity), size);
        const tvi_status seen = tvi_state_peek(bytes, size, &n, &t, NULL, NULL);
        insist(seen == TVI_OK || seen == TVI_EINVAL, "tvi_state_peek has no such status");
        const bool is_loaded = tvi_state_load(it, bytes, size) == TVI_OK;
        if (is_loaded) run_integrator(it);
        *(is_loaded ? &sum->loaded : &sum->refused) += 1;
        free(bytes);
    }
    insist(tvi_state_load(it, whole, size) == TVI_OK, tvi_last_error());
    free(whole);
    try_texts(bits, it, count, texts);
    tvi_integrator_free(it);
}

static void run_ensemble(tvi_ensemble *e)
{
    double t[MEMBERS], q[N * MEMBERS], p[N * MEMBERS];
    tvi_status status[MEMBERS];
    if (tvi_ensemble_last(e, t, q, p, status) != TVI_OK) return;
    insist(tvi_ensemble_integrate(e, 0.05, 2, t, q, p, status, NULL, NULL) == TVI_OK, tvi_last_error());
    for (int m = 0; m < MEMBERS; m++) {
        insist(status[m] < TVI_STATUS_COUNT, "a member has no such status");
        for (int k = m; k < N * MEMBERS; k += MEMBERS)
            insist(status[m] != TVI_OK || (isfinite(q[k]) && isfinite(p[k])), "a member is TVI_OK, and not finite");
    }
}

static void try_ensemble(uint64_t *bits, const tvi_system *system, const tvi_options *options, long count, counts *sum)
{
    tvi_ensemble *e;
    double t[MEMBERS], q[N * MEMBERS], p[N * MEMBERS];
    tvi_status status[MEMBERS];
    size_t size;
    if (tvi_ensemble_create(&e, system, options, MEMBERS, 1) != TVI_OK) return;
    start(t, q, p, MEMBERS);
    insist(tvi_ensemble_integrate(e, 0.05, STEPS, t, q, p, status, NULL, NULL) == TVI_OK, tvi_last_error());
    insist(tvi_ensemble_save(e, NULL, &size) == TVI_OK, tvi_last_error());
    void *whole = malloc(size);
    insist(tvi_ensemble_save(e, whole, &size) == TVI_OK, tvi_last_error());
    for (long k = 0; k < count; k++) {
        unsigned char *bytes = copy_of(whole, size);
        forge(bits, bytes, below(bits, 8) == 0 ? 8 : sizeof(tvi_saved_identity), size);
        const bool is_loaded = tvi_ensemble_load(e, bytes, size) == TVI_OK;
        if (is_loaded) run_ensemble(e);
        *(is_loaded ? &sum->loaded : &sum->refused) += 1;
        free(bytes);
    }
    insist(tvi_ensemble_load(e, whole, size) == TVI_OK, tvi_last_error());
    free(whole);
    tvi_ensemble_free(e);
}

/* Nine in ten are states of integrators, whose bytes are fewer. */
static counts try_all(uint64_t seed, long count, counts *texts)
{
    const long each = count / (SYSTEMS * METHODS) + 1;
    counts sum = {0, 0};
    for (int s = 0; s < SYSTEMS; s++)
        for (int k = 0; k < METHODS; k++) {
            tvi_system *system;
            tvi_options options;
            uint64_t bits = seed * 1000003 + (uint64_t)(s * METHODS + k);
            insist(systems[s](&system) == TVI_OK, tvi_last_error());
            if (tvi_options_named(methods[k].name, methods[k].order, &options) == TVI_OK) {
                alarm(LONGEST * (unsigned)(1 + each / 2000)); /* a hang ends the test */
                try_integrator(&bits, system, &options, each - each / 10, &sum, texts);
                try_ensemble(&bits, system, &options, each / 10, &sum);
            }
            tvi_system_free(system);
        }
    return sum;
}

int main(int argc, char *argv[])
{
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    const long count = argc > 2 ? strtol(argv[2], NULL, 10) : STATES;
    counts texts = {0, 0};
    const counts sum = try_all(seed, count, &texts);
    printf("%ld forged states: %ld loaded, %ld refused\n", sum.loaded + sum.refused, sum.loaded, sum.refused);
    printf("%ld forged texts: %ld read, %ld refused\n", texts.loaded + texts.refused, texts.loaded, texts.refused);
    /* else it tried nothing: 9929 and 6512 states of 20000 were seen, and 4701 texts read or refused, the least */
    return sum.loaded < count / 4 || sum.refused < count / 5 || texts.loaded < count / 8 || texts.refused < count / 8;
}
