# Steps that adapt: docs/adaptive.md. Included by the Makefile, after bench.mk.

ADAPTIVE         = $(BUILD)/bench/adaptive
ADAPTIVE_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(wildcard bench/adaptive/*.c)) $(EXPERIMENTS_DIR)/experiment.o

adaptive: need-bench
	@$(MAKE) --no-print-directory $(ADAPTIVE)/adaptive
	OPENBLAS_NUM_THREADS=1 $(ADAPTIVE)/adaptive $(ADAPTIVE)
	gnuplot -c bench/adaptive/adaptive.gp $(ADAPTIVE) bench/experiments
.PHONY: adaptive

$(ADAPTIVE)/adaptive: $(ADAPTIVE_OBJECTS) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -pthread -o $@ $^ $(BASELINE_LIBS) $(LIBS)
