# The figures of the paper: one program and one picture script each. Included by the Makefile after bench.mk.

EXPERIMENTS        := almost_symplectic derivatives pendulum kepler henon_heiles fpu solar
EXPERIMENTS_DIR     = $(BUILD)/bench/experiments
EXPERIMENT_PROGRAMS = $(EXPERIMENTS:%=$(EXPERIMENTS_DIR)/%)

# ONE=name for one of them
experiments: need-bench
	@$(MAKE) --no-print-directory -s $(EXPERIMENT_PROGRAMS)
	@for name in $(or $(ONE),$(EXPERIMENTS)); do \
	    echo "$$name" && OPENBLAS_NUM_THREADS=1 $(EXPERIMENTS_DIR)/$$name $(EXPERIMENTS_DIR) && \
	    gnuplot -c bench/experiments/$$name.gp $(EXPERIMENTS_DIR) bench/experiments || exit 1; \
	done
	@echo "Wrote:" && ls $(EXPERIMENTS_DIR)/*.csv $(EXPERIMENTS_DIR)/*.md $(EXPERIMENTS_DIR)/*.png $(EXPERIMENTS_DIR)/*.svg

.PHONY: experiments

$(EXPERIMENT_PROGRAMS): $(EXPERIMENTS_DIR)/%: $(EXPERIMENTS_DIR)/%.o $(EXPERIMENTS_DIR)/experiment.o $(SWEEP_OBJECTS) \
                        $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)
