# Gradients of runs: docs/fits.md. Included by the Makefile, after performance.mk.

GRADIENT         = $(BUILD)/bench/gradient
GRADIENT_OBJECTS = $(GRADIENT)/gradient.o $(GRADIENT)/systems.o $(PERFORMANCE_DIR)/turns.o \
                   $(EXPERIMENTS_DIR)/experiment.o

gradient: need-bench
	@$(MAKE) --no-print-directory -s $(GRADIENT)/gradient
	OPENBLAS_NUM_THREADS=1 $(GRADIENT)/gradient $(GRADIENT)
	@cat $(GRADIENT)/gradient.md $(GRADIENT)/memory.md
.PHONY: gradient

$(GRADIENT)/gradient: $(GRADIENT_OBJECTS) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)

# what columns of D cost at once: docs/chaos.md
columns: need-bench
	@$(MAKE) --no-print-directory -s $(GRADIENT)/columns
	OPENBLAS_NUM_THREADS=1 $(GRADIENT)/columns $(GRADIENT)
	@cat $(GRADIENT)/columns.md $(GRADIENT)/jacobian.md
.PHONY: columns

$(GRADIENT)/columns: $(patsubst %/gradient.o,%/columns.o,$(GRADIENT_OBJECTS)) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)
