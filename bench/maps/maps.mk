# Maps of order and chaos by ensembles: docs/ensembles.md. Included by the Makefile, after bench.mk.

MAPS = $(BUILD)/bench/maps

maps: need-bench
	@$(MAKE) --no-print-directory -s $(MAPS)/maps
	OPENBLAS_NUM_THREADS=1 $(MAPS)/maps $(MAPS)
	gnuplot -c bench/maps/maps.gp $(MAPS) bench/experiments
.PHONY: maps

$(MAPS)/maps: $(MAPS)/maps.o $(EXPERIMENTS_DIR)/experiment.o $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)
