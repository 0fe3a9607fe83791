# meniscus: build, install and test. `make help` lists the targets.
# A variant (release, asan, tsan, debug) has its own folder under build/; `make` builds release.

VERSION := $(shell cat VERSION)
VARIANT ?= release
BUILD := build/$(VARIANT)

ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := g++
endif

AR ?= ar
# what runs programs that are built for another processor; for the generators of tables
RUN ?=
PYTHON ?= python3
PKG_CONFIG ?= pkg-config
INSTALL ?= install
INSTALL_PROGRAM ?= $(INSTALL)
INSTALL_DATA ?= $(INSTALL) -m 644

PREFIX ?= /usr/local
prefix ?= $(PREFIX)
exec_prefix ?= $(prefix)
bindir ?= $(exec_prefix)/bin
datarootdir ?= $(prefix)/share
mandir ?= $(datarootdir)/man

# Embree 3 and 4 have no .pc file on Debian; set EMBREE_VERSION=4 where that is installed.
EMBREE_VERSION ?= 3
EMBREE_LIBS ?= -lembree$(EMBREE_VERSION)
FREETYPE_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags freetype2 2>/dev/null || echo -I/usr/include/freetype2)
FREETYPE_LIBS ?= -lfreetype
# Asked when they are needed, as `make deps check` installs them on its way.
CHAFA_CFLAGS ?= $(patsubst -I%,-isystem %,$(shell $(PKG_CONFIG) --cflags chafa))
CHAFA_LIBS ?= -lchafa -lglib-2.0
EXR_CFLAGS ?= -isystem /usr/include/OpenEXR
EXR_LIBS ?= -lOpenEXRCore
PNG_LIBS ?= -lpng -lz
JPEG_LIBS ?= -ljpeg
OCIO_LIBS ?= -lOpenColorIO
JANSSON_LIBS ?= -ljansson
# NanoVDB is headers only; its files may be compressed by zlib and Blosc.
BLOSC_LIBS ?= -lblosc -lz

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow \
  -Wundef -Wformat=2 -Wcast-qual -Wpointer-arith -Wwrite-strings -Wimplicit-fallthrough -Wvla
C_WARNINGS := -Wstrict-prototypes -Wmissing-prototypes -Wold-style-definition
# -ffp-contract=off: the same bits from every compiler; never -ffast-math. Measured in four examples, the time of rendering over
# that of -O3 alone: x86-64-v3 0.97 to 1.00, a build with a profile 0.95 to 1.09, -fno-tree-slp-vectorize 0.97
# to 1.04 for all files and 0.98 to 1.08 for those of one folder. None is worth a second build.
FLAGS_release := -O3
FLAGS_debug := -O0 -g
FLAGS_profile := -O3 -g
FLAGS_asan := -O1 -g -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_tsan := -O1 -g -fsanitize=thread
FLAGS_fuzz := -O1 -g -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize-recover=all \
  -fno-omit-frame-pointer
# every interior list grows at once
FLAGS_hostile := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -DNEST_INLINE=1
# the four lanes as plain C, as for a machine without SSE and NEON
FLAGS_plain := -O3 -DMEN_PLAIN_LANES
FLAGS_clang := -O3
FLAGS_arm64 := -O3
FLAGS := $(FLAGS_$(VARIANT)) -ffp-contract=off -fno-math-errno -fno-trapping-math
WERROR ?=
CPPFLAGS_ALL := -Isrc -I$(BUILD)/generated -D_POSIX_C_SOURCE=200809L -DMEN_VERSION='"$(VERSION)"' -DMEN_EMBREE=$(EMBREE_VERSION) \
  $(EXR_CFLAGS) $(patsubst -I%,-isystem %,$(FREETYPE_CFLAGS)) $(CPPFLAGS)
CFLAGS_ALL := -std=c11 $(FLAGS) $(WARNINGS) $(C_WARNINGS) $(WERROR) $(CFLAGS)
CXXFLAGS_ALL := -std=c++17 $(FLAGS) $(WARNINGS) $(WERROR) $(CXXFLAGS)
LIBS := $(EMBREE_LIBS) $(EXR_LIBS) $(PNG_LIBS) $(JPEG_LIBS) $(OCIO_LIBS) $(JANSSON_LIBS) $(FREETYPE_LIBS) $(BLOSC_LIBS) $(CHAFA_LIBS) -lstdc++ -lpthread -lm

GENERATORS := src/optics/upsample_gen.c src/optics/microfacet_gen.c src/optics/layered_gen.c src/optics/stretched_gen.c
SOURCES := $(filter-out $(GENERATORS),$(sort $(wildcard src/*/*.c)))
CXX_SOURCES := $(sort $(wildcard src/*/*.cpp))
CLI_OBJECTS := $(patsubst src/%.c,$(BUILD)/%.o,$(filter src/cli/%,$(SOURCES)))
STD_FILES := $(sort $(wildcard src/std/*.mns))
GENERATED := $(BUILD)/generated/upsample_table.c $(BUILD)/generated/microfacet_table.c $(BUILD)/generated/layered_table.c $(BUILD)/generated/stretched_table.c $(BUILD)/generated/ocio_config.c $(BUILD)/generated/std_library.c
LIB_OBJECTS := $(patsubst src/%.c,$(BUILD)/%.o,$(filter-out src/cli/%,$(SOURCES))) \
  $(patsubst src/%.cpp,$(BUILD)/%.o,$(CXX_SOURCES)) $(GENERATED:.c=.o)
TRUTH_TESTS := $(patsubst tests/truth/%.c,$(BUILD)/truth/%,$(sort $(wildcard tests/truth/*_test.c)))
UNIT_TESTS := $(patsubst tests/unit/%.c,$(BUILD)/tests/%,$(sort $(wildcard tests/unit/*_test.c)))

# `make V=1` shows whole commands.
V ?= 0
ifeq ($(V),0)
SAY = @printf '  %s\n' '$@';
endif

.DELETE_ON_ERROR:
.SUFFIXES:
.PHONY: all help deps demo assets check lint format man install uninstall bench asan tsan hostile dist clean

all: $(BUILD)/meniscus build/meniscus ## build the program (build/meniscus)

help: ## list the targets
	@sed -n 's/^\([a-z -]*\):.*## \(.*\)/  \1	\2/p' Makefile | expand -t 16

# The program's usual place, whatever the variant that was built last.
build/meniscus: $(BUILD)/meniscus
	@ln -sf $(VARIANT)/meniscus $@

$(BUILD)/meniscus: $(CLI_OBJECTS) $(BUILD)/libmeniscus.a
	$(SAY) $(CC) $(FLAGS) $(LDFLAGS) -o $@ $(CLI_OBJECTS) $(BUILD)/libmeniscus.a $(LIBS)

$(BUILD)/libmeniscus.a: $(LIB_OBJECTS)
	@rm -f $@
	$(SAY) $(AR) rcs $@ $(LIB_OBJECTS)

# Objects are made again when the compiler or its flags change.
$(BUILD)/flags: force
	@mkdir -p $(BUILD)
	@echo '$(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) $(CXX) $(CXXFLAGS_ALL)' | cmp -s - $@ || \
	  echo '$(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) $(CXX) $(CXXFLAGS_ALL)' > $@
# So is the one that knows the data folder, and no other, so that `make install PREFIX=...` need not build all again.
$(BUILD)/data-folder: force
	@mkdir -p $(BUILD)
	@echo '$(datarootdir)/meniscus' | cmp -s - $@ || echo '$(datarootdir)/meniscus' > $@
$(BUILD)/lang/find.o: private CPPFLAGS_ALL += -DMEN_DATA_FOLDER='"$(datarootdir)/meniscus"'
$(BUILD)/lang/find.o: $(BUILD)/data-folder
.PHONY: force
$(BUILD)/preview/terminal_picture.o: private OWN_CPPFLAGS = $(CHAFA_CFLAGS)

$(BUILD)/%.o: src/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(OWN_CPPFLAGS) $(CFLAGS_ALL) -MMD -MP -c -o $@ $<

$(BUILD)/%.o: src/%.cpp $(BUILD)/flags
	@mkdir -p $(@D)
	$(SAY) $(CXX) $(CPPFLAGS_ALL) $(CXXFLAGS_ALL) -MMD -MP -c -o $@ $<

# The table of RGB to spectra is solved once, at build time (about a second).
$(BUILD)/upsample_gen: src/optics/upsample_gen.c src/optics/upsample_solve.c src/optics/observer.c $(wildcard src/optics/*.h) $(BUILD)/flags
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -o $@ $(filter %.c,$^) -lm

$(BUILD)/generated/upsample_table.c: $(BUILD)/upsample_gen
	@mkdir -p $(@D)
	$(RUN) $(BUILD)/upsample_gen $@

# What rough surfaces would lose is summed once, at build time (about ten seconds).
$(BUILD)/microfacet_gen: src/optics/microfacet_gen.c src/optics/fresnel.c $(wildcard src/optics/*.h) $(BUILD)/flags
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -o $@ $(filter %.c,$^) -lm

$(BUILD)/generated/microfacet_table.c: $(BUILD)/microfacet_gen
	@mkdir -p $(@D)
	$(RUN) $(BUILD)/microfacet_gen $@

# And what stretched facets do beyond round ones, which asks those tables (about fifteen seconds).
STRETCHED_OBJECTS := $(patsubst %,$(BUILD)/%.o,optics/bsdf_facets optics/stretched optics/microfacet optics/fresnel \
  generated/microfacet_table)
$(BUILD)/stretched_gen: src/optics/stretched_gen.c $(STRETCHED_OBJECTS) $(wildcard src/optics/*.h) $(BUILD)/flags
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -o $@ $(filter %.c %.o,$^) -lm

$(BUILD)/generated/stretched_table.c: $(BUILD)/stretched_gen
	@mkdir -p $(@D)
	$(RUN) $(BUILD)/stretched_gen $@

# And what layers do to what is under them, which asks those.
LAYERED_OBJECTS := $(patsubst %,$(BUILD)/%.o,optics/bsdf_layer optics/bsdf_diffuse optics/bsdf_facets optics/direction_grid optics/microfacet optics/fresnel \
  optics/stretched generated/microfacet_table generated/stretched_table)
$(BUILD)/layered_gen: src/optics/layered_gen.c $(LAYERED_OBJECTS) $(wildcard src/optics/*.h) $(BUILD)/flags
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -o $@ $(filter %.c %.o,$^) -lm

$(BUILD)/generated/layered_table.c: $(BUILD)/layered_gen
	@mkdir -p $(@D)
	$(RUN) $(BUILD)/layered_gen $@

$(BUILD)/generated/ocio_config.c: src/image/meniscus.ocio src/image/embed.awk
	@mkdir -p $(@D)
	awk -f src/image/embed.awk $< > $@

$(BUILD)/generated/std_library.c: $(STD_FILES) src/std/embed.sh
	@mkdir -p $(@D)
	sh src/std/embed.sh $(STD_FILES) > $@

$(BUILD)/generated/%.o: $(BUILD)/generated/%.c $(BUILD)/flags
	$(SAY) $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -MMD -MP -c -o $@ $<

TEST_COMPILE = $(CC) $(CPPFLAGS_ALL) -Itests/unit -Itests/truth $(CFLAGS_ALL) $(LDFLAGS) -MMD -MP -MF $@.d -o $@
$(BUILD)/tests/%: tests/unit/%.c $(BUILD)/libmeniscus.a
	@mkdir -p $(@D)
	$(SAY) $(TEST_COMPILE) $< $(BUILD)/libmeniscus.a -lcmocka $(LIBS)

$(BUILD)/truth/%: tests/truth/%.c tests/truth/truth.c $(BUILD)/libmeniscus.a
	@mkdir -p $(@D)
	$(SAY) $(TEST_COMPILE) $< tests/truth/truth.c $(BUILD)/libmeniscus.a -lcmocka $(LIBS)

# The entry points of the fuzzers: with replay.c, which gives them files, and with the fuzzer in the variant fuzz.
FUZZERS := $(patsubst tests/fuzz/%.c,%,$(filter-out tests/fuzz/replay.c,$(sort $(wildcard tests/fuzz/*.c))))
FUZZ_MAIN := $(if $(filter fuzz,$(VARIANT)),-fsanitize=fuzzer,tests/fuzz/replay.c)
OPTION_OBJECTS := $(filter $(BUILD)/cli/option%.o,$(CLI_OBJECTS))
$(BUILD)/fuzz/%: tests/fuzz/%.c tests/fuzz/replay.c $(wildcard tests/fuzz/*.h) $(OPTION_OBJECTS) $(BUILD)/libmeniscus.a
	@mkdir -p $(@D)
	$(SAY) $(TEST_COMPILE) -Itests/fuzz $< $(FUZZ_MAIN) $(OPTION_OBJECTS) $(BUILD)/libmeniscus.a $(LIBS)

-include $(LIB_OBJECTS:.o=.d) $(CLI_OBJECTS:.o=.d) $(UNIT_TESTS:=.d) $(TRUTH_TESTS:=.d)

# ---- packages ----

PACKAGES := gcc g++ make libc6-dev libembree-dev libopenexr-dev libopencolorio-dev libpng-dev libjpeg62-turbo-dev libjansson-dev libfreetype-dev libnanovdb-dev libblosc-dev libchafa-dev libglib2.0-dev pkg-config fonts-dejavu-core libcmocka-dev mandoc python3

deps: ## install the Debian packages that are missing (with sudo where not root)
	@missing=''; for p in $(PACKAGES); do \
	  dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$p"; done; \
	if [ -z "$$missing" ]; then echo "deps: all packages are there"; else \
	  echo "deps: installing$$missing"; \
	  sudo=''; [ "$$(id -u)" = 0 ] || sudo=sudo; \
	  $$sudo apt-get update -qq && DEBIAN_FRONTEND=noninteractive $$sudo apt-get install -y -qq --no-install-recommends $$missing; fi

# ---- the example ----

assets: examples/assets/studio.exr ## make the meshes and the studio that the examples use
examples/assets/studio.exr: examples/make-assets.py
	$(PYTHON) examples/make-assets.py examples/assets

demo: all assets ## render the main example to whisky.exr and whisky.png
	build/meniscus render examples/whisky.mns -o whisky.exr -o whisky.png

# ---- tests ----

CLI_TESTS := $(filter-out tests/cli/run.sh,$(wildcard tests/cli/*.sh))

check: check-program ## run all tests; the last line is "N passed, N failed"
	@sh tests/run.sh $(BUILD)/meniscus $(CLI_TESTS) $(UNIT_TESTS) tests/layers.sh tests/man.sh tests/tour.sh tests/fuzz.sh \
	  tests/grammar.sh tests/spec.sh tests/editor.sh tests/random.sh tests/lines.sh tests/render/run.sh $(TRUTH_TESTS)

check-quick: check-program ## the tests without the renders that hold it to physics
	@sh tests/run.sh $(BUILD)/meniscus $(CLI_TESTS) $(UNIT_TESTS) tests/layers.sh tests/man.sh tests/tour.sh tests/fuzz.sh

check-program: $(BUILD)/meniscus $(UNIT_TESTS) $(TRUTH_TESTS) $(FUZZERS:%=$(BUILD)/fuzz/%) assets
.PHONY: check-quick check-program

check-farm: $(BUILD)/meniscus ## the jobs of examples/farm under a Slurm of one node; needs root and Slurm's packages; minutes
	sh tests/farm.sh $(BUILD)/meniscus
.PHONY: check-farm

# About four minutes on two idle cores. Each part by itself: build/release/bench NAME [SCENE...]; without words it lists them.
BENCH_SCENES ?= $(BUILD)/peers/glass.mns $(addprefix examples/,$(addsuffix .mns,whisky aquarium glass-of-water half-submerged \
  snells-window soda cold-glass cut-glass diamond still-life tea light-bulb))
bench: $(BUILD)/bench assets $(BUILD)/peers/glass.mns ## measure speed, memory and noise, as ratios within one run
	$(BUILD)/bench paths $(BUILD)/peers/glass.mns
	$(BUILD)/bench limit $(BENCH_SCENES)
	$(BUILD)/bench nesting
	$(BUILD)/bench threads $(wordlist 1,4,$(BENCH_SCENES))
	$(BUILD)/bench scale
	$(BUILD)/bench rays
	$(BUILD)/bench caustics
	$(BUILD)/bench fireflies $(addprefix examples/,whisky-sun.mns diamond.mns candles.mns light-bulb.mns glass-of-water.mns)
	$(BUILD)/bench noise $(BENCH_SCENES)
	$(BUILD)/bench denoise $(addprefix examples/,whisky.mns cut-glass.mns tea.mns aquarium.mns half-submerged.mns)
	$(BUILD)/bench techniques $(addprefix examples/,whisky.mns tea.mns surfaces.mns diamond.mns candles.mns)

bench-fireflies: $(BUILD)/bench assets ## single pixels that are far too bright, in all examples; minutes
	$(BUILD)/bench fireflies 96 $(wildcard examples/*.mns)

bench-noise: $(BUILD)/bench assets $(BUILD)/peers/glass.mns ## ways to take samples, and the stated noise over the error that is there; minutes
	$(BUILD)/bench sampling $(BUILD)/peers/glass.mns $(addprefix examples/,whisky.mns tea.mns surfaces.mns still-life.mns \
	  cut-glass.mns round-solids.mns)
	$(BUILD)/bench stated $(addprefix examples/,surfaces.mns snells-window.mns whisky.mns tea.mns diamond.mns candles.mns whisky-sun.mns)

# MENISCUS_BENCH_OBJECTS=10000000 make bench-objects: that many objects instead of a million
bench-objects: $(BUILD)/bench $(BUILD)/meniscus ## very many objects, and how fast scene texts are read; minutes
	$(BUILD)/bench objects
	$(PYTHON) tests/bench/language.py $(BUILD)/meniscus

bench-instructions: assets ## what the interior list costs, in instructions; needs valgrind, minutes
	$(MAKE) VARIANT=profile build/profile/meniscus build/profile/peers/glass.mns
	sh tests/bench/instructions.sh build/profile/meniscus build/profile/peers/glass.mns examples/whisky.mns
.PHONY: bench-objects bench-fireflies bench-noise bench-instructions

# --wrap: limit.c notes the rays that a render casts
BENCH_SOURCES := $(wildcard tests/bench/*.c)
$(BUILD)/bench: $(BENCH_SOURCES) $(wildcard tests/bench/*.h) $(BUILD)/libmeniscus.a
	$(SAY) $(CC) $(CPPFLAGS_ALL) -Itests/bench $(CFLAGS_ALL) $(LDFLAGS) -Wl,--wrap=rtc_nearest,--wrap=rtc_all,--wrap=pool_run -o $@ \
	  $(BENCH_SOURCES) $(BUILD)/libmeniscus.a $(LIBS)

$(BUILD)/peers/glass.mns: tests/peers/glass.py
	$(PYTHON) $< $(@D)

peers: all ## compare with Cycles and POV-Ray, where they are installed (packages blender and povray); takes minutes
	$(PYTHON) tests/peers/run.py $(BUILD)/meniscus $(BUILD)/peers
.PHONY: peers

golden: all assets ## make one reference picture anew: make golden NAME=whisky
	sh tests/render/run.sh build/meniscus --make $(NAME)
.PHONY: golden

# make fuzz SECONDS=600 FUZZERS=eval; what is found stands in build/fuzz/found and belongs into tests/fuzz/corpus/NAME.
SECONDS ?= 60
fuzz: $(BUILD)/meniscus ## run each fuzzer for SECONDS (default 60); needs clang and libclang-rt-14-dev
	$(MAKE) VARIANT=fuzz CC=clang CXX=clang++ $(FUZZERS:%=build/fuzz/fuzz/%)
	$(PYTHON) tests/fuzz/seeds.py build/fuzz/seeds $(BUILD)/meniscus
	@mkdir -p build/fuzz/found
	@for name in $(FUZZERS); do mkdir -p build/fuzz/corpus/$$name build/fuzz/seeds/$$name tests/fuzz/corpus/$$name; echo "fuzz: $$name, $(SECONDS) s"; \
	  ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 build/fuzz/fuzz/$$name build/fuzz/corpus/$$name tests/fuzz/corpus/$$name \
	    build/fuzz/seeds/$$name -dict=grammar/meniscus.dict -max_total_time=$(SECONDS) -timeout=10 -rss_limit_mb=3000 \
	    -artifact_prefix=build/fuzz/found/$$name- -print_final_stats=1 > build/fuzz/$$name.log 2>&1 || \
	    { tail -40 build/fuzz/$$name.log; exit 1; }; \
	  grep -E 'number_of_executed|cov:' build/fuzz/$$name.log | tail -2; done
.PHONY: fuzz

asan hostile: ## the quick tests under sanitizers (hostile: every interior list grows at once)
	$(MAKE) VARIANT=$@ check-quick
tsan: assets ## a few scenes rendered by four threads, watched for races
	$(MAKE) VARIANT=tsan build/tsan/meniscus
	sh tests/tsan.sh build/tsan/meniscus $(addprefix examples/,$(addsuffix .mns,whisky tea surfaces light-bulb candles window)) \
	  'examples/soda.mns --frames 1..3'

# Builds whose pictures must be the same files: the scenes are those that render by themselves.
SAME_SCENES := $(filter-out examples/studio.mns,$(wildcard examples/*.mns))
check-plain-lanes: all assets ## the four lanes as plain C, without SSE or NEON: their tests, and the same pictures; minutes
	$(MAKE) VARIANT=plain build/plain/meniscus build/plain/tests/lanes_test
	build/plain/tests/lanes_test
	sh tests/same-bits.sh $(BUILD)/meniscus build/plain/meniscus $(SAME_SCENES)
check-clang: all assets ## built by clang, with warnings as errors: the same pictures; minutes
	$(MAKE) VARIANT=clang CC=clang CXX=clang++ WERROR=-Werror build/clang/meniscus
	sh tests/same-bits.sh $(BUILD)/meniscus build/clang/meniscus $(SAME_SCENES)
# For arm64 from another machine: gcc-aarch64-linux-gnu, g++-aarch64-linux-gnu and qemu-user, and in the folder ARM64_ROOT the
# arm64 libraries of PACKAGES, unpacked. Unit tests that take seconds there. Pictures are not the same files: Embree and the C
# library round otherwise; of the examples most are equal in all colours, the others but for single paths.
ARM64_TESTS ?= lanes num sampler lex parse fresnel nest spectrum color
ARM64_EXAMPLES ?= three-spheres ice diamond soda surfaces shapes
ARM64_RUN = qemu-aarch64 -L $(ARM64_ROOT)
ARM64_PATHS = $(ARM64_ROOT)/usr/lib/aarch64-linux-gnu:$(ARM64_ROOT)/lib/aarch64-linux-gnu
check-arm: all assets ## built for arm64, in an emulator: some tests, and small pictures; see here for what it needs; minutes
	@[ -n '$(ARM64_ROOT)' ] || { echo 'check-arm: ARM64_ROOT=FOLDER is missing: the folder of arm64 libraries' >&2; exit 2; }
	$(MAKE) VARIANT=arm64 CC='aarch64-linux-gnu-gcc --sysroot=$(ARM64_ROOT)' CXX='aarch64-linux-gnu-g++ --sysroot=$(ARM64_ROOT)' \
	  AR=aarch64-linux-gnu-ar RUN='$(ARM64_RUN)' EXR_CFLAGS='-isystem $(ARM64_ROOT)/usr/include/OpenEXR' \
	  FREETYPE_CFLAGS='-I$(ARM64_ROOT)/usr/include/freetype2' \
	  CHAFA_CFLAGS='$(foreach d,include/chafa lib/aarch64-linux-gnu/chafa/include include/glib-2.0 lib/aarch64-linux-gnu/glib-2.0/include,-isystem $(ARM64_ROOT)/usr/$d)' LDFLAGS='-Wl,-rpath-link,$(ARM64_PATHS)' \
	  build/arm64/meniscus $(ARM64_TESTS:%=build/arm64/tests/%_test)
	@for test in $(ARM64_TESTS); do $(ARM64_RUN) build/arm64/tests/$${test}_test || exit 1; done
	@for name in $(ARM64_EXAMPLES); do for program in '$(BUILD)/meniscus' '$(ARM64_RUN) build/arm64/meniscus'; do \
	    $$program render examples/$$name.mns --size 40x30 -s 4 --frames 1 -q -o build/arm64/$${program%%[ /]*}.exr || exit 1; done; \
	  $(BUILD)/meniscus compare build/arm64/build.exr build/arm64/qemu-aarch64.exr --max-rmse 1e-5 > build/arm64/compared || \
	    { echo "check-arm: $$name is another picture:" >&2; cat build/arm64/compared >&2; exit 1; }; echo "$$name: the same picture"; done
.PHONY: check-plain-lanes check-clang check-arm

# ---- looking after the source ----

FORMATTED := $(wildcard src/*/*.[ch] src/*/*.cpp tests/unit/*.[ch] tests/truth/*.[ch] tests/bench/*.[ch] tests/fuzz/*.[ch])
format: ## lay the source out with clang-format
	clang-format -i $(FORMATTED)

# What gcc makes of each file, for roundtrips.awk; clang drops no rounding.
DUMPS = $(if $(shell $(CC) --version | grep -i 'gcc\|free software foundation'),-fdump-tree-slp1 -fdump-tree-slp2 -fdump-tree-vect)
# Warnings are errors here, with both compilers where clang is installed; nothing is kept.
lint: ## warnings as errors, layers, manual pages
	$(MAKE) BUILD=build/lint WERROR=-Werror CFLAGS='$(CFLAGS) $(DUMPS)' build/lint/libmeniscus.a build/lint/meniscus
	$(if $(DUMPS),awk -f tests/roundtrips.awk $$(find build/lint -name '*.slp[12]' -o -name '*.vect') < /dev/null)
	@if command -v clang >/dev/null; then printf '%s\n' $(filter-out src/cli/%.cpp,$(SOURCES)) | xargs -n 8 -P "$$(nproc)" \
	  clang $(CPPFLAGS_ALL) $(CHAFA_CFLAGS) -Ibuild/lint/generated $(CFLAGS_ALL) -Werror -fsyntax-only && \
	  echo "lint: clang has nothing to say"; else echo "lint: no clang here, skipped"; fi
	@if clang-format --version 2>/dev/null | grep -q ' 14\.'; then clang-format --dry-run -Werror $(FORMATTED) && \
	  echo "lint: laid out as make format does"; else echo "lint: no clang-format 14 here, skipped"; fi
	sh tests/layers.sh
	sh tests/man.sh build/lint/meniscus

man: all ## make the generated sections of the manual pages and the editor files anew
	sh man/refresh.sh build/meniscus

# ---- install ----

MAN_PAGES := $(wildcard man/*.[157])
install: all assets ## install under PREFIX (default /usr/local), DESTDIR before it
	$(INSTALL) -d $(DESTDIR)$(bindir) $(foreach s,1 5 7,$(DESTDIR)$(mandir)/man$(s)) $(DESTDIR)$(datarootdir)/meniscus/examples/assets \
	  $(DESTDIR)$(datarootdir)/meniscus/std
	$(INSTALL_PROGRAM) $(BUILD)/meniscus $(DESTDIR)$(bindir)/meniscus
	for page in $(MAN_PAGES); do $(INSTALL_DATA) $$page $(DESTDIR)$(mandir)/man$${page##*.}/; done
	$(INSTALL_DATA) $(STD_FILES) $(DESTDIR)$(datarootdir)/meniscus/std/
	$(INSTALL_DATA) $(wildcard examples/*.mns) examples/make-assets.py $(DESTDIR)$(datarootdir)/meniscus/examples/
	$(INSTALL_DATA) examples/assets/* $(DESTDIR)$(datarootdir)/meniscus/examples/assets/
	$(INSTALL) -d $(DESTDIR)$(datarootdir)/meniscus/examples/farm
	$(INSTALL_PROGRAM) examples/farm/* $(DESTDIR)$(datarootdir)/meniscus/examples/farm/

uninstall: ## remove what install put there
	rm -f $(DESTDIR)$(bindir)/meniscus $(foreach page,$(MAN_PAGES),$(DESTDIR)$(mandir)/man$(subst .,,$(suffix $(page)))/$(notdir $(page)))
	rm -rf $(DESTDIR)$(datarootdir)/meniscus

dist: ## a source archive of the last commit
	git archive --prefix=meniscus-$(VERSION)/ -o meniscus-$(VERSION).tar.gz HEAD

clean: ## remove everything that was built
	rm -rf build examples/assets
