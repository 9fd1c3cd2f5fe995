#!/bin/sh
# Whatever vectors a mesh is made with, its bytes are the same: mesh_widths.sh PROGRAM..., of print_width.c, the first for
# any processor.
set -u
expected=$($1) || exit 1
echo "$expected"
for program; do
	found=$($program)
	case $? in
	0) [ "$found" = "$expected" ] || { echo "$program: $found"; exit 1; } ;;
	77) echo "$program: not on this processor" ;;
	*) exit 1 ;;
	esac
done
