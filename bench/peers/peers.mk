# This library beside REBOUND and heyoka: a table of docs/performance.md, the picture of README.md. Included by the
# Makefile, after bench.mk.

PEERS         = $(BUILD)/bench/peers
PEERS_OBJECTS = $(PEERS)/peers.o $(PEERS)/tvi.o $(BUILD)/bench/adaptive/solution.o $(EXPERIMENTS_DIR)/experiment.o

# REBOUND=DIR: a folder with rebound.h and librebound.so, or one whose src/ has them. The user has built it.
REBOUND_DIR = $(patsubst %/rebound.h,%,$(firstword $(wildcard $(REBOUND:%=%/rebound.h) $(REBOUND:%=%/src/rebound.h))))
REBOUND_LIB = -L$(REBOUND_DIR) -lrebound -Wl,-rpath,$(abspath $(REBOUND_DIR))

# HEYOKA=DIR: the prefix where the user has installed heyoka.
HEYOKA_LIB = -L$(HEYOKA)/lib -lheyoka -Wl,-rpath,$(abspath $(HEYOKA))/lib

peers: need-bench
	$(if $(REBOUND),$(if $(REBOUND_DIR),,$(error no rebound.h in $(REBOUND) or $(REBOUND)/src)))
	$(if $(HEYOKA),$(if $(wildcard $(HEYOKA)/include/heyoka),,$(error no include/heyoka in $(HEYOKA))))
	@$(MAKE) --no-print-directory $(PEERS)/peers
	OPENBLAS_NUM_THREADS=1 $(PEERS)/peers $(PEERS)
	gnuplot -c bench/peers/peers.gp $(PEERS) bench/experiments
	@cat $(PEERS)/peers.md
.PHONY: peers

# always anew: the folders may be others
$(PEERS)/rebound.o: bench/peers/rivals/rebound.c always
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TOOL) $(CFLAGS) -isystem $(REBOUND_DIR) -c -o $@ $<
$(PEERS)/heyoka.o: bench/peers/rivals/heyoka.cpp always
	@mkdir -p $(@D)
	$(call SAY,CXX $<)$(CXX) -std=c++20 $(WARNINGS) -Ibench $(CFLAGS) -isystem $(HEYOKA)/include -c -o $@ $<
PEERS_LINKED = $(if $(REBOUND),$(PEERS)/rebound.o) $(if $(HEYOKA),$(PEERS)/heyoka.o)
PEERS_LIBS   = $(if $(REBOUND),$(REBOUND_LIB)) $(if $(HEYOKA),$(HEYOKA_LIB) -lstdc++)
$(PEERS)/peers: always $(PEERS_OBJECTS) $(PEERS_LINKED) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -pthread -o $@ $(filter %.o %.a,$^) $(PEERS_LIBS) $(BASELINE_LIBS) $(LIBS)
