# The hard cases: docs/stability.md. Included by the Makefile, after bench.mk and baselines.mk.

STABILITY_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(wildcard bench/stability/*.c) bench/baselines/gauss_tableau.c)
STABILITY         = $(BUILD)/bench/stability

stability: need-bench
	@$(MAKE) --no-print-directory $(BUILD)/bench/break
	$(BUILD)/bench/break --out $(STABILITY)
	gnuplot -c bench/stability/plot.gp $(STABILITY)
	@echo "Tables and plots: $(STABILITY)/*.md, *.csv, *.png, *.svg"
.PHONY: stability

$(BUILD)/check/stability: CHECK_LIBS += $(BASELINE_LIBS)

$(BUILD)/bench/break: $(STABILITY_OBJECTS) $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -o $@ $^ $(LIBS)
