/* progress.c - Draws a progress bar on the terminal (tvi_progress). No other file of the library prints. */
#include "text.h"
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
        char line[2 * WIDTH];
        bar->shown = percent;
        (void)jet_format(line, sizeof line, "\r[%.*s%*s] %3d %%  t = %-12.6g%s", filled, full, WIDTH - filled, "",
                         percent, t, percent == 100 ? "\n" : "");
        if (isatty(STDERR_FILENO)) (void)fputs(line, stderr);
    }
    return bar->observer ? bar->observer(step, t, q, p, bar->ctx) : 0;
}
