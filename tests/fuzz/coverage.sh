#!/bin/sh
# What share of the lines of each decoder its corpus reaches, together with fixtures/volumes. Builds in build-coverage; needs the
# Debian packages clang and llvm.
#
#     sh tests/fuzz/coverage.sh
set -eu

cd "$(dirname "$0")/../.."
folder=build-coverage
tools=$(find /usr/lib -maxdepth 1 -name 'llvm-*' | sort -V | tail -n 1)/bin
programs='nifti nrrd metaimage mgh mesh gzip data_set cloud skeleton signature surface'
sources=$(find engine api/dicom -name '*_codec.c' -o -path '*/volume/*.c' -o -path '*/solid/*.c' \
	-o -path '*/dicom/*.c' | grep -Ev 'writ|confine|intake|tool' | sort -u)

cmake -S . -B $folder -G Ninja -DCMAKE_C_COMPILER="$tools/clang" -DCMAKE_BUILD_TYPE=Debug -DESKEL_TESTS=ON \
	-DCMAKE_C_FLAGS='-fprofile-instr-generate -fcoverage-mapping' >/dev/null
for program in $programs; do
	cmake --build $folder --target "replay_$program" -- --quiet >/dev/null
	fixtures=fixtures/volumes
	case $program in data_set | cloud | skeleton | signature | surface) fixtures= ;; esac
	# shellcheck disable=SC2086 # a folder or none
	LLVM_PROFILE_FILE=$folder/$program.profile $folder/tests/fuzz/"replay_$program" "tests/fuzz/corpus/$program" $fixtures >/dev/null
done
# shellcheck disable=SC2046,SC2086 # lists
"$tools/llvm-profdata" merge -o $folder/merged $(printf "$folder/%s.profile " $programs)
# shellcheck disable=SC2046,SC2086 # lists
"$tools/llvm-cov" report -instr-profile $folder/merged $folder/tests/fuzz/replay_nifti \
	$(printf -- "-object $folder/tests/fuzz/replay_%s " $programs) $sources |
	awk '$1 ~ /\.c$/ { printf "%7s of %4d lines  %s\n", $10, $8, $1 }'
