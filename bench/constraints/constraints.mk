# Steps on constraints: docs/constraints.md. Included by the Makefile, after performance.mk.

CONSTRAINTS         = $(BUILD)/bench/constraints
CONSTRAINTS_OBJECTS = $(CONSTRAINTS)/constraints.o $(CONSTRAINTS)/chain.o $(PERFORMANCE_DIR)/turns.o \
                      $(PERFORMANCE_DIR)/stepping.o $(EXPERIMENTS_DIR)/experiment.o

constraints: need-bench
	@$(MAKE) --no-print-directory -s $(CONSTRAINTS)/constraints
	OPENBLAS_NUM_THREADS=1 $(CONSTRAINTS)/constraints $(CONSTRAINTS)
	@cat $(CONSTRAINTS)/constraints.md $(CONSTRAINTS)/kept.md
.PHONY: constraints

$(CONSTRAINTS)/constraints: $(CONSTRAINTS_OBJECTS) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)
