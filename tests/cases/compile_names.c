/* The name that a user gives to written code is the name of a function in C. Identifiers that no header of the
 * written file has are refused for being words of C++ or of a library that is not used, and others that do harm are
 * accepted.
 * Right: tvi_compiled_write accepts every identifier that is no keyword of C11 and begins with none of the prefixes
 * tvi_, jet_, TVI_, JET_ and _, and refuses all else with TVI_EINVAL. The written file has no other names of its own
 * than those with a prefix; which names of C's library to avoid is the user's affair, and none of them is tried
 * here. */
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqr(q[0]);
}

static const char *const accepted[] = {"spring",    "kepler_3", "Henon_Heiles", "x",       "code", "step",   "final",
                                       "import",    "module",   "concept",      "err",     "warn", "end",    "etext",
                                       "daemon",    "class",    "template",     "new",     "this", "and",    "xor",
                                       "namespace", "co_await", "dgemm_",       "asmcode", "jets", "intern", "spring_"};
static const char *const refused[] = {
    "auto",     "break",  "case",  "char",   "const",    "continue", "default", "do",     "double",  "else",
    "enum",     "extern", "float", "for",    "goto",     "if",       "inline",  "int",    "long",    "register",
    "restrict", "return", "short", "signed", "sizeof",   "static",   "struct",  "switch", "typedef", "union",
    "unsigned", "void",   "while", "",       "volatile", "a b",      "1a",      "a-b",    "a.b",     "a;",
    "_x",       "__x",    "_Bool", "tvi_x",  "jet_x",    "TVI_X",    "JET_X",   "a\n",    "\xc3\xa4"};

int main(void)
{
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    for (unsigned i = 0; i < sizeof accepted / sizeof *accepted; i++)
        row(tvi_compiled_write(system, NULL, accepted[i], "/dev/null") == TVI_OK, "%s", accepted[i]);
    for (unsigned i = 0; i < sizeof refused / sizeof *refused; i++)
        row(tvi_compiled_write(system, NULL, refused[i], "/dev/null") == TVI_EINVAL, "'%s' refused", refused[i]);
    tvi_system_free(system);
    return verdict();
}
