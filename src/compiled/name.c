/* name.c - which names the function of generated code may have: all but those that C, C++ and the text itself have a
 * use for. Other words of the text are renamed where they are the function's (generate.c). */
#include "compiled/compiled.h"

#include <string.h>

static const char small[] = "abcdefghijklmnopqrstuvwxyz", large[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
                  digits[] = "0123456789";

/* Each between blanks. */
static const char words[] =
    " alignas aligned alignof always_inline and and_eq asm auto bitand bitor bool break case catch char class compl"
    " const const_cast constexpr continue decltype default defined delete do double dynamic_cast else enum explicit"
    " export extern false float for friend goto if inline int long may_alias mutable namespace new noexcept noinline"
    " not not_eq nullptr operator or or_eq private protected public register reinterpret_cast restrict return short"
    " signed sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef"
    " typeid typename typeof union unsigned using vector_size virtual void volatile wchar_t while xor xor_eq ",
                  library[] =
                      " abort abs acos acosh asin asinh atan atan2 atanh calloc cbrt ceil copysign cos cosh erf erfc"
                      " exit exp exp2 expm1 fabs fdim floor fma fmax fmin fmod free frexp hypot ilogb isfinite isinf"
                      " isnan ldexp lgamma llrint llround log log10 log1p log2 logb lrint lround main malloc memchr"
                      " memcmp memcpy memmove memset modf nan nearbyint nextafter pow printf puts realloc remainder"
                      " remquo rint round scalbn signbit sin sinh size_t sqrt strcmp strlen tan tanh tgamma trunc"
                      " uint64_t ",
                  *const own[] = {"tvi_", "jet_", "TVI_", "JET_"};

static bool is_among(const char *name, const char *list)
{
    const size_t size = strlen(name);
    for (const char *at = list; (at = strstr(at, name)); at++)
        if (at[-1] == ' ' && at[size] == ' ') return true;
    return false;
}

static bool is_identifier(const char *name)
{
    if (!*name || strchr(digits, *name)) return false;
    for (; *name; name++)
        if (*name != '_' && !strchr(small, *name) && !strchr(large, *name) && !strchr(digits, *name)) return false;
    return true;
}

const char *tvi_compiled_misnamed(const char *name)
{
    if (!is_identifier(name)) return "is no identifier";
    if (is_among(name, words)) return "is a word of C or C++";
    if (is_among(name, library)) return "is a name of the C library";
    if (*name == '_') return "begins with _, as the names of the compiler do";
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (!strncmp(name, own[i], strlen(own[i]))) return "begins as the names of this library do";
    return strpbrk(name, small) ? NULL : "is in capitals, as macros are";
}
