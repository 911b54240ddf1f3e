# analyse.mk - make cov and make analyse. Included by tests.mk.

.PHONY: cov run-cov run-covered analyse run-analyse tidy cppcheck

# Lines of ad and src that the tests run, without sanitizers, and the lines that they do not; fails below 95%. The suites
# that run little twice are enough. The library alone counts; the programs of the tests are those of make check.
WHOLE_COVERED := $(filter-out ad library generating,$(COVERED_FOLDERS))
cov: need-check do-coverage
check-coverage: ; $(REPORT) "95 of 100 lines of ad and src are run by the tests" $(DO)
do-coverage:
	rm -rf $(BUILD)/cov
	$(MAKE) -s --no-print-directory $(JOBS) BUILD=$(BUILD)/cov CFLAGS='-O1 --coverage' $(BUILD)/cov/libtvi.a
	$(MAKE) -s --no-print-directory $(JOBS) $(COVERED_FOLDERS:%=$(BUILD)/cov/check/%)
	$(MAKE) -s --no-print-directory run-covered >$(BUILD)/cov/tests.log 2>&1 || { tail -n 25 $(BUILD)/cov/tests.log; exit 1; }
	tests/coverage.sh 95 $(BUILD)/cov
run-covered:
	$(IN_ONE_GO) '' $(BUILD)/cov/check/ad
	$(IN_ONE_GO) 'input,faults,stepping,closed forms,products,linear' $(BUILD)/cov/check/library
	$(IN_ONE_GO) 'forms,serves,points,dense,galerkin,references,states,statements,geometry' $(BUILD)/cov/check/generating
	for folder in $(WHOLE_COVERED); do $(BUILD)/cov/check/$$folder || exit 1; done

# Static analysis of all that is compiled with clang: .clang-tidy, bench/.clang-tidy and tests/.clang-tidy name the checks
# and why some are off. Not tests/ad/test_record.c, whose macros nested twenty deep clang-tidy never ends with. SOURCES=files
# for some of them.
PACKAGES_ANALYSE := 'clang-tidy:command -v clang-tidy' 'cppcheck:command -v cppcheck'
SOURCES          ?= $(filter-out tests/ad/test_record.c $(patsubst $(BUILD)/%.o,%.c,$(NO_CLANG)),$(wildcard ad/*.c src/*/*.c bench/*/*.c tests/*/*.c))
# suppressed: arrays that a loop fills, which cppcheck believes may run no time
CPPCHECK         := cppcheck -q --std=c11 --error-exitcode=1 --inline-suppr --suppress=missingIncludeSystem \
                    --suppress=uninitvar:bench/baselines/solar_rows.h \
                    --suppress=uninitvar:ad/sum_products.c \
                    --suppress=uninitvar:tests/generating/test_references_quad.c \
                    --enable=warning,performance,portability -Iinclude -Iad -Isrc -Ibench -Ibench/scenes -Ibench/baselines -Itests

analyse: need-check
	$(call need,$(PACKAGES_ANALYSE))
	@$(MAKE) --no-print-directory -k $(JOBS) tidy cppcheck
	@echo "no findings"
tidy:
	@printf '%s\n' $(SOURCES) | xargs -P2 -n4 sh -c 'clang-tidy --quiet "$$@" -- $(TOOL) -Ibench/baselines -Itests \
	    $(CHECK_CFLAGS) -mavx2 -mfma 2>/dev/null' clang-tidy
cppcheck:
	@$(CPPCHECK) $(sort $(dir $(SOURCES)))

# The same bits for any number of BLAS threads: fetches OpenBLAS from Debian, half a minute.
.PHONY: blas-threads
blas-threads: need-library
	@$(MAKE) --no-print-directory $(BUILD)/libtvi.a
	$(CC) -std=c11 $(WARNINGS) $(CFLAGS) -Iinclude -o $(BUILD)/blas tests/threads/blas.c $(BUILD)/libtvi.a $(LIBS)
	tests/blas_threads.sh $(BUILD)/blas $(BUILD)/openblas
