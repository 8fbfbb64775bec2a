PREFIX = /usr/local

# make demo and make test are all that a newcomer needs; both install what is missing (scripts/setup).
.PHONY: help demo figures test bench lib install clean

help:
	@echo 'make demo    build, refine a creased cage with a 1-form on it, check d S = S d, write a page and a picture of it'
	@echo 'make figures draw characteristic maps and basis forms, and put them on one page, figures/index.html'
	@echo 'make test    every test: Rust, documentation, SciPy reader, examples, memory check'
	@echo 'make bench   time building and applying the operators, against OpenSubdiv alone'
	@echo 'make install PREFIX=/usr/local    the C++ API: headers, library, CMake package, pkg-config file'
	@echo 'make clean   remove what the above made'

demo:
	@scripts/setup
	@scripts/demo

figures:
	@scripts/setup
	@scripts/figures

test:
	@scripts/setup --test
	@scripts/test

bench:
	@scripts/setup
	cargo bench
	cargo bench -p formwork-capi --bench tables

lib:
	@scripts/setup
	cargo build --release -p formwork-capi

install:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' scripts/install

clean:
	cargo clean
	rm -rf demo-out figures .venv
