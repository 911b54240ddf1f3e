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

# fits in Python beside those by differences: two tables of docs/fits.md, ten seconds
fits: need-library all
	$(call need,$(foreach package,numpy cffi,'python3-$(package):$(HAS_PYTHON)') \
	    'python3-scipy:/usr/bin/python3 -c "import scipy"')
	@mkdir -p $(GRADIENT)
	OPENBLAS_NUM_THREADS=1 $(PYTHON_HERE) /usr/bin/python3 bench/gradient/fit.py $(GRADIENT)
	@cat $(GRADIENT)/least_squares.md $(GRADIENT)/one_gradient.md
.PHONY: fits
