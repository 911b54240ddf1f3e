/* state_text.c - writes a state as text, and reads it. Both go through the words of one list, for instance
 *
 *     tvi state 1
 *     n 2
 *     parameters 1
 *     value 0x1.8p+0
 *     t 0x1.9p+5 -0x1p-50
 *     q 0x1.06f48c7a1p-2 0x1.8p-56
 *     q -0x1.5f34d6a161e4fp-1 0x0p+0
 *     p 0x1p-1 0x0p+0
 *     p 0x1.4p-1 0x0p+0
 *     end 9ae16a3b2f90404f
 *
 * Numbers are as printf writes them by %a, with a point in every locale. Any blanks may stand between words, so that a
 * text may go through systems that end lines in other ways. The last word is FNV-1a of all words before it, each with a
 * blank behind it. The rows are those of the members of tvi_state_text. */
#include "run/state_text.h"
#include "tape.h"
#include "algebra/sizes.h"

#include <stdlib.h>
#include <string.h>

enum { LONGEST = 31, MANTISSA = 13, DIGITS = 20 }; /* of a word, and hexadecimal and decimal digits in one */

static const char NO_STATE[] = "the text is no state", DAMAGED[] = "the text of the state is damaged or cut short";

bool tvi_state_text_open(tvi_state_text *x, int n, int parameters)
{
    *x = (tvi_state_text){.n = n, .parameters = parameters};
    x->value = calloc((size_t)parameters + 4 * ((size_t)n + 1), sizeof *x->value);
    x->state = x->value + parameters;
    return x->value != NULL;
}

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

/* Writes so many digits at least, and returns where they end. */
static char *write_digits(char *at, uint64_t x, unsigned base, int least)
{
    char digit[DIGITS];
    int count = 0;
    for (; x > 0 || count < least; x /= base) digit[count++] = "0123456789abcdef"[x % base];
    while (count > 0) *at++ = digit[--count];
    *at = '\0';
    return at;
}

/* (-1)^sign 2^exponent 1.mantissa, or 0.mantissa where the exponent is the least one. */
static void write_double(char *at, double x)
{
    const uint64_t bits = tvi_bits(x), mantissa = bits << 12 >> 12;
    const int biased = (int)(bits >> 52 & 0x7ff), exponent = biased > 0 ? biased - 1023 : mantissa > 0 ? -1022 : 0;
    if (bits >> 63) *at++ = '-';
    *at++ = '0', *at++ = 'x', *at++ = biased > 0 ? '1' : '0';
    if (mantissa > 0) {
        *at++ = '.';
        at = write_digits(at, mantissa, 16, MANTISSA);
        while (at[-1] == '0') at--;
    }
    *at++ = 'p', *at++ = exponent < 0 ? '-' : '+';
    (void)write_digits(at, (uint64_t)abs(exponent), 10, 1);
}

/* Goes past up to `most` digits from *at on; as many less give a number that is as much too small. */
static uint64_t read_digits(const char **at, unsigned base, int most, int *count)
{
    uint64_t x = 0;
    for (*count = 0; *count < most && **at; ++*count, ++*at) {
        const char *const digits = "0123456789abcdef", *digit = memchr(digits, **at, base);
        if (!digit) break;
        x = x * base + (uint64_t)(digit - digits);
    }
    return x;
}

/* Whether the word is a finite number. */
static bool read_double(const char *at, double *x)
{
    int count;
    const bool is_negative = *at == '-';
    at += is_negative;
    if (strncmp(at, "0x0", 3) != 0 && strncmp(at, "0x1", 3) != 0) return false;
    const bool is_normal = at[2] == '1';
    uint64_t mantissa = 0;
    at += 3;
    if (*at == '.') {
        at++;
        mantissa = read_digits(&at, 16, MANTISSA, &count);
        if (count == 0) return false;
        mantissa <<= 4 * (MANTISSA - count);
    }
    if (strncmp(at, "p+", 2) != 0 && strncmp(at, "p-", 2) != 0) return false;
    const int sign = at[1] == '-' ? -1 : 1;
    at += 2;
    const int exponent = sign * (int)read_digits(&at, 10, 4, &count);
    const bool is_one = is_normal ? exponent >= -1022 && exponent <= 1023 : mantissa == 0 || exponent == -1022;
    if (count == 0 || *at || !is_one) return false;
    const uint64_t biased = is_normal ? (uint64_t)(exponent + 1023) : 0;
    const uint64_t bits = (uint64_t)is_negative << 63 | biased << 52 | mantissa;
    memcpy(x, &bits, sizeof *x);
    return true;
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

/* A text that is read, or else written, or else only counted. */
typedef struct {
    const char *from;
    char *to;
    size_t at, size;
    uint64_t hash;
    const char *fault; /* the first one */
} stream;

static void find_fault(stream *s, bool is_fault, const char *fault)
{
    if (is_fault && !s->fault) s->fault = fault;
}

static void skip_blanks(stream *s)
{
    while (s->at < s->size && s->from[s->at] && strchr(" \t\r\n", s->from[s->at])) s->at++;
}

/* A word that is longer than any of a state ends within one, and fits nothing. */
static void take_word(stream *s, char word[LONGEST + 1])
{
    size_t length = 0;
    skip_blanks(s);
    for (; s->at < s->size && length < LONGEST; s->at++) {
        if (strchr(" \t\r\n", s->from[s->at])) break; /* a 0, too */
        word[length++] = s->from[s->at];
    }
    word[length] = '\0';
}

static void put_word(stream *s, char before, const char *word)
{
    if (s->at > 0) {
        if (s->to) s->to[s->at] = before;
        s->at++;
    }
    if (s->to) memcpy(s->to + s->at, word, strlen(word));
    s->at += strlen(word);
}

/* Writes the word, or reads the one that stands there. */
static void exchange(stream *s, char before, char word[LONGEST + 1])
{
    if (s->from) take_word(s, word);
    else put_word(s, before, word);
    s->hash = jet_hash(jet_hash(s->hash, word, strlen(word)), " ", 1);
}

static void exchange_word(stream *s, char before, const char *wanted, const char *fault)
{
    char word[LONGEST + 1];
    memcpy(word, wanted, strlen(wanted) + 1);
    exchange(s, before, word);
    find_fault(s, strcmp(word, wanted) != 0, fault);
}

static void exchange_count(stream *s, const char *label, int count, const char *fault)
{
    char word[LONGEST + 1];
    exchange_word(s, '\n', label, NO_STATE);
    (void)write_digits(word, (uint64_t)count, 10, 1);
    exchange_word(s, ' ', word, fault);
}

static void exchange_rows(stream *s, const char *label, int rows, int columns, double *x)
{
    char word[LONGEST + 1];
    for (int i = 0; i < rows && !s->fault; i++) {
        exchange_word(s, '\n', label, DAMAGED);
        for (int k = 0; k < columns; k++, x++) {
            if (!s->from) write_double(word, *x);
            exchange(s, ' ', word);
            find_fault(s, s->from && !read_double(word, x), DAMAGED);
        }
    }
}

/* Whether e follows. */
static bool is_at_e(const stream *s)
{
    stream ahead = *s;
    char word[LONGEST + 1];
    take_word(&ahead, word);
    return strcmp(word, "e") == 0;
}

/* ---- The text ---------------------------------------------------------------------------------------------------- */

static void exchange_state(stream *s, tvi_state_text *x)
{
    const int n = x->n;
    char word[LONGEST + 1];
    exchange_word(s, ' ', "tvi", NO_STATE);
    exchange_word(s, ' ', "state", NO_STATE);
    exchange_word(s, ' ', "1", "the text is of a format that this version does not know");
    exchange_count(s, "n", n, "the text is of a system of another dimension");
    exchange_count(s, "parameters", x->parameters, "the text is of a system with other parameters");
    exchange_rows(s, "value", x->parameters, 1, x->value);
    exchange_rows(s, "t", 1, 2, x->state);
    exchange_rows(s, "q", n, 2, x->state + 2);
    exchange_rows(s, "p", n, 2, x->state + 2 * (n + 1));
    if (s->from) x->has_e = is_at_e(s);
    exchange_rows(s, "e", x->has_e, 2, x->state + 2 * (2 * n + 1));
    exchange_word(s, '\n', "end", DAMAGED);
    (void)write_digits(word, s->hash, 16, 16);
    exchange_word(s, ' ', word, DAMAGED);
}

size_t tvi_state_text_write(const tvi_state_text *x, char *text)
{
    stream s = {.to = text, .hash = JET_HASH_OF_NOTHING};
    tvi_state_text same = *x;
    exchange_state(&s, &same);
    if (text) text[s.at] = '\n';
    return s.at + 1;
}

const char *tvi_state_text_read(tvi_state_text *x, const char *text, size_t size)
{
    stream s = {.from = text, .size = size, .hash = JET_HASH_OF_NOTHING};
    exchange_state(&s, x);
    skip_blanks(&s);
    find_fault(&s, s.at < size, "something follows the end of the state's text");
    return s.fault;
}
