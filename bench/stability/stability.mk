# The hard cases: docs/stability.md. Included by the Makefile, after bench.mk and baselines.mk.

STABILITY_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(wildcard bench/stability/*.c) bench/baselines/gauss_tableau.c)
STABILITY         = $(BUILD)/bench/stability

stability: need-bench
	@$(MAKE) --no-print-directory $(STABILITY)/break
	$(STABILITY)/break --out $(STABILITY)
	gnuplot -c bench/stability/plot.gp $(STABILITY)
	@echo "Tables and plots: $(STABILITY)/*.md, *.csv, *.png, *.svg"

# its table of the steps that are refused alone
guard: need-bench
	@$(MAKE) --no-print-directory $(STABILITY)/break
	$(STABILITY)/break --out $(STABILITY) --only guard
	@cat $(STABILITY)/guard.md
.PHONY: guard

.PHONY: stability

$(BUILD)/check/stability: CHECK_LIBS += $(BASELINE_LIBS)

$(STABILITY)/break: $(STABILITY_OBJECTS) $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(LIBS)
