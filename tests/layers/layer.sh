#!/bin/sh
# layer.sh COMPILER ALLOWED "FORBIDDEN ..." -IFOLDER...: whether these folders let a source include just what it may.
compiler=$1 allowed=$2 forbidden=$3
shift 3

compiles() { # HEADER -IFOLDER...
	header=$1
	shift
	echo "#include <$header>" | "$compiler" -std=c17 -D_GNU_SOURCE "$@" -x c -fsyntax-only - 2>/dev/null
}

failed=0
compiles "$allowed" "$@" || { echo "$allowed does not compile"; failed=1; }
for header in $forbidden; do
	if compiles "$header" "$@"; then
		echo "$header compiles"
		failed=1
	fi
done
exit $failed
