#!/bin/sh
# Runs a program on a disk of 8 MB, in a mount namespace of its own so that nobody else sees it.
#
#	full_disk.sh FULL_DISK
folder=$(mktemp -d) || exit 1
trap 'rmdir "$folder"' EXIT
if ! unshare --map-root-user --mount true 2>/dev/null; then
	echo "skipped: this user may not mount a disk of its own"
	exit 77
fi
unshare --map-root-user --mount sh -c 'mount -t tmpfs -o size=8m tmpfs "$1" && "$2" "$1"' sh "$folder" "$1"
