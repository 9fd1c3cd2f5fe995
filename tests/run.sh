#!/bin/sh
# All tests, in three builds; warnings are errors:
#   gcc       optimised, as it is released
#   clang     with the address and undefined-behaviour sanitizers, and zlib in place of ISA-L: all that is not labelled slow
#   threads   with the thread sanitizer: the tests labelled threads or http
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

# FOLDER COMPILER SANITIZERS ISAL, then CTest's options
test_build() {
	folder=$1 compiler=$2 sanitizers=$3 isal=$4
	shift 4
	printf '\n== %s\n' "$folder"
	cmake -S . -B "$folder" -G Ninja -DCMAKE_C_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
		-DESKEL_TESTS=ON -DESKEL_WERROR=ON -DESKEL_SANITIZE="$sanitizers" -DESKEL_ISAL="$isal" $launcher >/dev/null
	cmake --build "$folder" -- --quiet
	ctest --test-dir "$folder" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@" 2>&1 |
		tee "$folder/report"
	# "99% tests passed, 1 tests failed out of 80"; without that line, CTest itself failed
	# shellcheck disable=SC2046 # two numbers
	set -- $(sed -n 's/.* tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$/\1 \2/p' "$folder/report") 1 1
	failed=$((failed + $1))
	passed=$((passed + $2 - $1))
}

[ $# -gt 0 ] || set -- gcc clang threads
for build; do
	case $build in
	gcc) test_build build-test-gcc gcc '' ON ;;
	clang) test_build build-test-clang clang address,undefined OFF --label-exclude slow ;;
	threads) test_build build-test-threads gcc thread ON --label-regex 'threads|http' ;;
	*) echo "run.sh: $build is none of gcc, clang, threads" >&2; exit 2 ;;
	esac
done

printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ]
