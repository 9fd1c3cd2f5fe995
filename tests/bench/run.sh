#!/bin/sh
# The benchmarks: builds eskel as it is released, installs its peers from Debian, measures ours and theirs in turn, round
# after round, and prints one table. Ten to fifteen minutes; each part alone takes up to four:
#
#     sh tests/bench/run.sh [partition|atlas|growth|match|search|decode|mesh|fit|enroll|serve|start]...
#
# start is not among those that run unless asked for: it fills 4.4 GB with a million shapes, which takes two minutes.
# ROUNDS=5 takes five rounds in place of three. Everything is one thread, but for the server and rows that say so. Programs,
# inputs and results are in build-bench/. README.md beside this file says how to read the table.
set -eu

cd "$(dirname "$0")/../.."
parts=${*:-partition atlas growth match search decode mesh fit enroll serve}
for part in $parts; do
	case $part in
	partition | atlas | growth | match | search | decode | mesh | fit | enroll | serve | start) ;;
	*) echo "run.sh: $part is none of partition, atlas, growth, match, search, decode, mesh, fit, enroll, serve, start" >&2; exit 2 ;;
	esac
done
sh deploy/packages.sh build bench
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

folder=build-bench
ours=$folder/tests/bench
inputs=$folder/inputs
results=$folder/results
peers=tests/bench/peers
atlases=/usr/share/mricron/templates # of mricron-data

# ---- build

cmake -S . -B $folder -G Ninja -DCMAKE_BUILD_TYPE=Release -DESKEL_TESTS=ON >/dev/null
cmake --build $folder --target eskeld bench_partition bench_skeleton bench_match bench_search bench_decode bench_enroll \
	bench_filter bench_inputs bench_fill bench_mesh bench_fit -- --quiet
c++ -O2 $peers/matching.cpp -o $folder/peer_matching -llemon
cc -O2 -D_GNU_SOURCE -I/usr/include/nifti $peers/decoding.c -o $folder/peer_decoding -lniftiio -lisal -lz

# ---- inputs, made once: delete the folder to make them anew

need() { # KIND
	[ -e "$inputs/$1.made" ] && return
	echo "making inputs: $1" >&2
	mkdir -p $inputs
	$ours/bench_inputs "$1" $inputs
	touch "$inputs/$1.made"
}

# ---- parts: each runs ours, then the peers, once

partition() {
	need shapes
	for shape in hamate femur large; do
		$ours/bench_partition $inputs/$shape.nii.gz
		/usr/bin/python3 $peers/clustering.py partition/$shape $inputs/$shape.nii.gz
	done
}

atlas() {
	aal=$atlases/aal.nii.gz
	for threads in 1 2; do
		$ours/bench_skeleton atlas/aal-116 $aal 16 $threads whole
		$ours/bench_skeleton atlas/aal-116 $aal 10 $threads whole
	done
	/usr/bin/python3 $peers/clustering.py atlas/aal-116 $aal
}

growth() {
	need shapes
	for voxels in 20000 200000 2000000 20000000; do
		$ours/bench_skeleton growth/voxels=$voxels $inputs/voxels=$voxels.nii.gz 10 1
		[ $voxels -gt 2000000 ] || /usr/bin/python3 $peers/clustering.py growth/voxels=$voxels $inputs/voxels=$voxels.nii.gz
	done
	for levels in 4 8 16 32 64; do
		$ours/bench_skeleton growth/levels=$levels $inputs/femur.nii.gz $levels 1
	done
}

match() {
	need costs
	for k in 4 10 16 32 64; do
		for kind in classes uniform; do
			$ours/bench_match $inputs/$kind-$k 2>/dev/null
			/usr/bin/python3 $peers/matching.py $inputs/$kind-$k
			$folder/peer_matching $inputs/$kind-$k
		done
	done
}

search() {
	for shapes in 1000 10000 100000 1000000; do
		$ours/bench_search $shapes
		/usr/bin/python3 $peers/faiss_flat.py $shapes
	done
	$ours/bench_filter 100000
}

decode() {
	need maps
	for map in $inputs/uint8 $inputs/uint16 $atlases/aal $atlases/jhu189; do
		figure=decode/${map##*/}
		$ours/bench_decode "$figure" "$map.nii.gz"
		for peer in isal zlib nifti; do
			$folder/peer_decoding $peer "$figure" "$map.nii.gz"
		done
		/usr/bin/python3 $peers/decoding.py "$figure" "$map.nii.gz"
	done
}

mesh() {
	for steps in 128 256; do
		$ours/bench_mesh mesh/steps=$steps $steps $folder/grid
		/usr/bin/python3 $peers/meshing.py mesh/steps=$steps $folder/grid
	done
}

fit() {
	$ours/bench_fit $folder/fit
	/usr/bin/python3 $peers/fitting.py $folder/fit
}

enroll() {
	rm -f $folder/enroll.db*
	$ours/bench_enroll $folder/enroll.db
}

# eskeld on a database, on any free port; its address into $url, its number into $server.
start_server() { # DATABASE
	begun=$(date +%s%N)
	rm -f $folder/url
	$folder/server/eskeld --database "$1" --listen 127.0.0.1:0 --rate 1000000 >$folder/url 2>$folder/log &
	server=$!
	trap 'kill "$server"' EXIT
	until [ -s $folder/url ]; do
		kill -0 "$server" || { cat $folder/log >&2; exit 1; }
		sleep 0.01
	done
	ready=$((($(date +%s%N) - begun) / 1000000))
	url=$(cat $folder/url)
}

stop_server() { # FIGURE
	printf '%s\teskeld\t%s\tMB\n' "$1" $(($(sed -n 's/VmHWM:[^0-9]*\([0-9]*\) kB/\1/p' "/proc/$server/status") / 1024))
	kill "$server"
	wait "$server" || true
	trap - EXIT
}

ask() { # FIGURE CLIENTS SECONDS, then what serve.lua takes
	FIGURE=$1 wrk -t 1 -c "$2" -d "$3" --timeout 10 -s tests/bench/serve.lua "$url" -- "$4" "${5:-}" "${6:-}" >$folder/wrk
	grep "^$1" $folder/wrk
}

fill() { # NAME SHAPES [LEVELS]: a database and its ids
	[ -e "$inputs/$1.ids" ] && return
	echo "filling a database with $2 shapes" >&2
	mkdir -p $inputs
	rm -f "$inputs/$1".db*
	$ours/bench_fill "$inputs/$1.db" "$2" ${3:+"$3"} >$inputs/ids
	mv $inputs/ids "$inputs/$1.ids"
}

# Shapes that no recognition has met are read from the database; the last two figures are of shapes that were met before.
serve() {
	need posts
	fill fill 100000
	head -n 10000 $inputs/fill.ids >$inputs/met.ids
	start_server $inputs/fill.db
	printf 'serve/start-100000-shapes\teskeld\t%s\tms\n' $ready
	ask serve/healthz-32-clients 32 2 health
	ask serve/recognize-unmet-32-clients 32 4 recognize $inputs/fill.ids
	ask serve/recognize-32-clients 32 8 recognize $inputs/met.ids >/dev/null
	ask serve/recognize-32-clients 32 4 recognize $inputs/met.ids
	ask serve/recognize-side-32-clients 32 4 recognize $inputs/met.ids '&side=left'
	ask serve/recognize-class-32-clients 32 4 recognize $inputs/met.ids '&class=class1'
	stop_server serve/recognize-32-clients
	rm -f $folder/posts.db*
	start_server $folder/posts.db
	ask serve/enroll-8-clients 8 4 enroll $inputs 4000
	stop_server serve/enroll-8-clients
}

start() {
	fill million 1000000 1
	start_server $inputs/million.db
	printf 'serve/start-1000000-shapes\teskeld\t%s\tms\n' $ready
	stop_server serve/start-1000000-shapes
}

# ---- rounds

: >$results
round=1
while [ $round -le "${ROUNDS:-3}" ]; do
	for part in $parts; do
		echo "round $round: $part" >&2
		$part >>$results
	done
	round=$((round + 1))
done
/usr/bin/python3 tests/bench/table.py $results
