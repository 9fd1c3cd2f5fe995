#!/bin/sh
# Installs the Debian packages that eskel needs: sh deploy/packages.sh SET...
#   build   to build and run it
#   trial   for the quick start: real anatomy, and a way to look at answers
#   test    for tests/run.sh: the second compiler, the test library and the oracles in Python
#   bench   for tests/bench/run.sh: the programs that eskel is measured beside
# Says nothing and needs no rights when all are there.
set -eu

build='build-essential cmake ninja-build pkg-config python3 python3-yaml libsqlite3-dev libmicrohttpd-dev libjansson-dev
	liblapacke-dev libisal-dev zlib1g-dev libbz2-dev libcurl4-gnutls-dev nettle-dev libmeshoptimizer-dev dcmtk'
trial='mricron-data curl'
test='clang libclang-rt-14-dev libcmocka-dev mricron-data curl chromium-driver python3-numpy python3-scipy
	python3-nibabel python3-jsonschema python3-pydicom teem-apps python3-vtk9 assimp-utils'
bench='libcmocka-dev mricron-data wrk liblemon-dev libnifti-dev python3-numpy python3-scipy python3-nibabel
	python3-sklearn python3-faiss python3-vtk9 python3-skimage'

missing=
for set in "$@"; do
	case $set in
	build) packages=$build ;;
	trial) packages=$trial ;;
	test) packages=$test ;;
	bench) packages=$bench ;;
	*) echo "packages.sh: $set is none of build, trial, test, bench" >&2; exit 2 ;;
	esac
	for package in $packages; do
		[ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
	done
done
[ "$missing" ] || exit 0

echo "Installing:$missing"
root=
[ "$(id -u)" -eq 0 ] || root=sudo
$root apt-get update -qq
# shellcheck disable=SC2086 # a list of words
$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
