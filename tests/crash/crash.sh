#!/bin/sh
# Kills a program that changes a database, at random moments, and checks that nothing it acknowledged is gone.
#
#	crash.sh SURVIVOR ROUNDS kill     SIGKILL alone: the operating system keeps what was written
#	crash.sh SURVIVOR ROUNDS power    what was not synced is lost as well
#	crash.sh SURVIVOR ROUNDS lying    and syncs do nothing: the check has to fail, or it could not find a loss
set -u
survivor=$1 rounds=$2 mode=$3
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
database=$folder/shapes.db acknowledged=$folder/acknowledged
[ "$mode" = kill ] && vfs= || vfs=$mode
: >"$acknowledged"

# 30 to 530 ms.
random_pause() {
	sleep "$(od -An -N2 -tu2 /dev/urandom | awk '{ print 0.03 + $1 / 131072 }')"
}

round=0
while [ "$round" -lt "$rounds" ]; do
	# shellcheck disable=SC2086 # no mode is no argument
	"$survivor" change "$database" $((round * 10000)) $vfs >>"$acknowledged" &
	pid=$!
	random_pause
	kill -KILL "$pid" 2>/dev/null || exit 1 # it ended by itself
	wait "$pid" 2>/dev/null
	"$survivor" check "$database" "$acknowledged" || {
		[ "$mode" = lying ] && exit 0
		[ -s "$acknowledged" ] && exit 1
	}
	round=$((round + 1))
done
[ "$mode" != lying ]
