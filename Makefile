# make demo and make test are all that a newcomer needs; both install what is missing (scripts/setup).
.PHONY: help demo test bench clean

help:
	@echo 'make demo    build, refine a creased cage with a 1-form on it, check d S = S d, draw it'
	@echo 'make test    every test: Rust, documentation, SciPy reader, examples, memory check'
	@echo 'make bench   time building and applying the operators, against OpenSubdiv alone'
	@echo 'make clean   remove what the above made'

demo:
	@scripts/setup
	@scripts/demo

test:
	@scripts/setup --test
	@scripts/test

bench:
	@scripts/setup
	cargo bench

clean:
	cargo clean
	rm -rf demo-out .venv
