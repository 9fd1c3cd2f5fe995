#!/bin/sh
# The quick start: builds eskel, starts a server on this machine, stores real anatomy in it and recognises some of it.
#
#     sh deploy/quickstart.sh
#
# Needs Debian 12, git and apt (and sudo, unless run by root). Everything it makes is in build/: the programs, and in
# build/quickstart the database and the server's log. Run again, it goes on with that database.
set -eu

cd "$(dirname "$0")/.."
folder=build/quickstart
atlases=/usr/share/mricron/templates

# ---- build

sh deploy/packages.sh build trial
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build --target eskel eskeld

# ---- start

mkdir -p "$folder"
if pid=$(cat "$folder/eskeld.pid" 2>/dev/null) && [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = eskeld ]; then
	echo "Stopping the server of the last quick start"
	kill "$pid"
	while [ -e "/proc/$pid" ]; do sleep 0.1; done
fi

start() { # PORT
	nohup build/server/eskeld --database "$folder/shapes.db" --listen "127.0.0.1:$1" \
		</dev/null >"$folder/url" 2>"$folder/log" &
	pid=$!
	echo $pid >"$folder/eskeld.pid"
	tries=0
	until [ -s "$folder/url" ]; do
		tries=$((tries + 1))
		[ $tries -lt 600 ] && kill -0 $pid 2>/dev/null || return 1
		sleep 0.1
	done
}
start 8467 || start 0 || { cat "$folder/log" >&2; exit 1; } # 0: any free port, when 8467 is taken

ESKEL_SERVER=$(cat "$folder/url")
export ESKEL_SERVER
PATH=$PWD/build/server:$PATH

# ---- enroll

# "1 Precentral_L 2001" becomes "1,Precentral_L,Precentral,left"
awk 'BEGIN { print "label,name,class,side" }
	NF >= 2 { class = $2; side = "none" }
	NF >= 2 && sub(/_L$/, "", class) { side = "left" }
	NF >= 2 && sub(/_R$/, "", class) { side = "right" }
	NF >= 2 { print $1 "," $2 "," class "," side }' "$atlases/aal.nii.txt" >"$folder/aal.csv"

echo
echo "Storing the brain regions of the AAL atlas"
eskel enroll "$atlases/aal.nii.gz" --labels "$folder/aal.csv" --subject AAL >"$folder/aal.txt"
echo "$(grep -c ' AAL ' "$folder/aal.txt") regions"

bones=../shared/data
if [ -f "$bones/manifest.csv" ]; then
	echo "Storing the bones of $bones"
	awk -F, 'BEGIN { print "path,name,class,side,subject,sex,age" }
		NR > 1 { print $1 "," $3 "_" $6 "_" $7 "," $6 "," $7 "," $3 "," $4 "," $5 }' "$bones/manifest.csv" \
		>"$folder/bones.csv"
	# One after the other: what the README shows of them depends a little on their order.
	eskel enroll "$bones" --manifest "$folder/bones.csv" --parallel 1
	eskel show --limit 1000 >"$folder/bones.txt"
fi

# ---- recognise

ids() { # TABLE NAME...: their ids in a table that enroll printed
	table=$1
	shift
	for name; do
		awk -v name="$name" '$2 == name { print $1 }' "$table"
	done
}

cat <<'END'

Four regions of another atlas (JHU), posted from a file. One name says the wrong side:
END
printf '%s\n' label,name 77,Caudate_L 78,Caudate_R 79,Putamen_R 80,Putamen_R >"$folder/jhu.csv"
eskel recognize "$atlases/jhu189.nii.gz" --subject AAL --labels "$folder/jhu.csv" \
	--label 77 --label 78 --label 79 --label 80

cat <<'END'

Stored regions, each compared with all others. The nearest is the twin, whose mirrored form gives the side:
END
# shellcheck disable=SC2046 # a list of ids
eskel recognize --quiet $(ids "$folder/aal.txt" Caudate_L Putamen_R Thalamus_L Insula_R Cerebelum_Crus1_L)

if [ -s "$folder/bones.txt" ]; then
	echo
	echo "Bones of one person, compared with those of other people:"
	# shellcheck disable=SC2046
	eskel recognize --quiet --not-subject VHF $(ids "$folder/bones.txt" \
		VHF_talus_left VHF_calcaneus_right VHF_tibia_left VHF_patella_right VHF_navicular_left)

	echo
	echo "The label map of that person's feet, three names exchanged or wrong, checked against the others' bones:"
	sed -e 's/^2,[^,]*,/2,calcaneus_L,/' -e 's/^12,[^,]*,/12,talus_L,/' -e 's/^13,[^,]*,/13,navicular_R,/' \
		"$bones/maps/VHF_feet_labels.csv" | cut -d, -f1,2 >"$folder/feet.csv"
	eskel check --quiet --not-subject VHF --labels "$folder/feet.csv" "$bones/maps/VHF_feet.nii.gz" || [ $? -eq 1 ]
fi

# ---- go on

cat <<END

The server goes on: $ESKEL_SERVER   (open it in a browser)
  database  $folder/shapes.db     log  $folder/log
  stop it   kill \$(cat $folder/eskeld.pid)

Next, for example:
  export ESKEL_SERVER=$ESKEL_SERVER PATH=$PWD/build/server:\$PATH
  eskel show --class hippocampus
  eskel recognize YOUR_SEGMENTATION.nii.gz
  eskel check YOUR_LABEL_MAP.nii.gz --labels ITS_NAMES.csv
  eskel --help
END
