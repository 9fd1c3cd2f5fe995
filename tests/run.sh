#!/bin/sh
# All tests, in four builds; warnings are errors:
#   gcc       optimised, as it is released
#   clang     with the address and undefined-behaviour sanitizers, and zlib in place of ISA-L: all that is not labelled slow or readme
#   threads   with the thread sanitizer: the tests labelled threads or http that make threads meet
#   fuzz      the same sanitizers as clang: each fuzzer for a minute or less
#
# Tests labelled sweep take minutes each and run when asked for: ctest --test-dir build-test-gcc -L sweep
#
#     sh tests/run.sh [BUILD...]
#
# The last line counts them all. The exit code is not 0 if one failed.
set -eu

cd "$(dirname "$0")/.."
sh deploy/packages.sh build test
launcher=
if command -v ccache >/dev/null; then launcher=-DCMAKE_C_COMPILER_LAUNCHER=ccache; fi
passed=0
failed=0

# FOLDER COMPILER SANITIZERS ISAL FUZZ, then CTest's options. One test more than processors: some wait for deadlines.
test_build() {
	folder=$1 compiler=$2 sanitizers=$3 isal=$4 fuzz=$5
	shift 5
	printf '\n== %s\n' "$folder"
	cmake -S . -B "$folder" -G Ninja -DCMAKE_C_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
		-DESKEL_TESTS="$([ "$fuzz" = ON ] && echo OFF || echo ON)" -DESKEL_FUZZ="$fuzz" -DESKEL_WERROR=ON \
		-DESKEL_SANITIZE="$sanitizers" -DESKEL_ISAL="$isal" $launcher >/dev/null
	cmake --build "$folder" -- --quiet
	ctest --test-dir "$folder" --output-on-failure --no-tests=error --parallel $(($(nproc) + 1)) "$@" 2>&1 |
		tee "$folder/report"
	# "99% tests passed, 1 tests failed out of 80"; without that line, CTest itself failed
	# shellcheck disable=SC2046 # two numbers
	set -- $(sed -n 's/.* tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$/\1 \2/p' "$folder/report") 1 1
	failed=$((failed + $1))
	passed=$((passed + $2 - $1))
}

[ $# -gt 0 ] || set -- gcc clang threads fuzz
for build; do
	case $build in
	gcc) test_build build-test-gcc gcc '' ON OFF --label-exclude sweep ;;
	clang) test_build build-test-clang clang address,undefined OFF OFF --label-exclude 'slow|sweep|readme' ;;
	threads) test_build build-test-threads gcc thread ON OFF --label-regex 'threads|http' \
		--exclude-regex 'http_(contract|limits|page)' ;;
	fuzz) test_build build-test-fuzz clang address,undefined ON ON --tests-regex '^fuzz_' ;;
	*) echo "run.sh: $build is none of gcc, clang, threads, fuzz" >&2; exit 2 ;;
	esac
done

printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ]
