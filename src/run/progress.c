/* progress.c - Draws a progress bar on the terminal (tvi_progress). No other file of the library prints. */
#include "tvi.h"

#include <stdio.h>
#include <unistd.h>

enum { WIDTH = 50 };

/* The bar is drawn only when the percentage changes, so that most calls cost one division. */
int tvi_progress(long step, double t, const double q[], const double p[], void *ctx)
{
    static const char full[] = "##################################################";
    tvi_progress_bar *bar = ctx;
    if (!bar) return 0;
    const int percent = step >= bar->steps ? 100 : step > 0 ? (int)((double)step / (double)bar->steps * 100) : 0;
    if (percent != bar->shown) {
        const int filled = percent * WIDTH / 100;
        bar->shown = percent;
        if (isatty(STDERR_FILENO))
            (void)fprintf(stderr, "\r[%.*s%*s] %3d %%  t = %-12.6g%s", filled, full, WIDTH - filled, "", percent, t,
                          percent == 100 ? "\n" : "");
    }
    return bar->observer ? bar->observer(step, t, q, p, bar->ctx) : 0;
}
