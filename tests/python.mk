# python.mk - the tests and the gallery of the module tvi of Python. Included by tests.mk.

# The environment of a program in Python that uses the module from here, with the library that was built.
PYTHON_HERE = TVI_LIBRARY='$(abspath $(BUILD))/libtvi.so' PYTHONPATH='$(CURDIR)/src/python:$(CURDIR)/tests/python' \
              PYTHONDONTWRITEBYTECODE=1 XDG_CACHE_HOME='$(abspath $(BUILD))/check/python' CC='$(CC)'

check-python: ; $(REPORT) "Python: bits of C, refusals, threads, memory, Ctrl-C, the page and its doctests" $(DO)
do-python: all
	@mkdir -p $(BUILD)/check/python
	$(PYTHON_HERE) CXX='$(CXX)' $(PYTHON) -W error::ResourceWarning -m unittest discover -s tests/python

# what is refused, and what is not, with a library that has the address sanitizer, which sees Python's own memory, too
PYTHON_SANITIZED = $(PYTHON_HERE) LD_PRELOAD="$$($(CC) -print-file-name=libasan.so)" PYTHONMALLOC=malloc \
                   ASAN_OPTIONS=detect_leaks=0 $(PYTHON) -W ignore -m unittest \
                   test_refusals test_jets test_gravity test_rigid test_results.Many test_results.Solve.test_ways test_results.Solve.test_events

# tests/python/mistakes.md anew; BEFORE=DIR takes the texts of 0.2.0 from a built checkout of it
mistakes: need-check all
	$(PYTHON_HERE) CXX='$(CXX)' $(PYTHON) tests/python/mistakes.py write
.PHONY: mistakes

# the programs of docs/python, which take half a minute; make gallery puts their pictures into the documents
check-gallery: ; $(REPORT) "Python: the gallery" $(DO)
GALLERY = for program in $(basename $(notdir $(wildcard docs/python/*.py))); do \
              $(PYTHON_HERE) MPLBACKEND=Agg $(PYTHON) $(CURDIR)/docs/python/$$program.py && \
              test -s $$program.png || { echo "$$program: no picture"; exit 1; }; done
do-gallery: all
	@rm -rf $(BUILD)/check/gallery && mkdir -p $(BUILD)/check/gallery
	cd $(BUILD)/check/gallery && $(GALLERY)
gallery: need-check all
	cd docs/python && $(GALLERY)
.PHONY: gallery
