#!/usr/bin/env bash
# The wall of ornaments: every exemplar along a line, a circle and a heart and in a rectangle, with four targets,
# without and with bridges. Prints the table of docs/wall.md.
#
#   scripts/wall.sh OUT_DIR EXEMPLAR.svg... > docs/wall.md
#
# OUT_DIR keeps every drawing and report that was written, and wall.png, the contact sheet of what is in one
# component. With bridges only what was refused without them is run again, as everything else comes out the
# same. It takes a while, and is no part of the tests.
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,9p' "$0" >&2
  exit 0
fi
out=$1
shift
exemplars=$(realpath "$@")
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet --bin openwork --example contact_sheet
mkdir -p "$out"
out=$(realpath "$out")

run() { # EXEMPLAR DOMAIN TARGET BRIDGE: one piece of the wall; leaves NAME.svg or NAME.log, and NAME.exit
  local name domain target options start status
  name=$(basename "$1" .svg)-$2-$3-$4
  case $2 in
    line) domain="band $1 --along line:240mm --width 20mm" ;;
    circle) domain="band $1 --along circle:80mm --width 20mm" ;;
    heart) domain="band $1 --along path:fixtures/curves/heart.svg#heart --round 14mm --width 14mm" ;;
    rect) domain="rect $1 --size 120x80mm" ;;
  esac
  case $3 in
    one) target="--components 1" ;;
    one-no-holes) target="--components 1 --holes 0" ;;
    twelve-holes) target="--holes 12" ;;
    any) target="" ;;
  esac
  options="--memory-limit 256MB --quiet"
  [ "$4" = bridged ] && options="$options --bridge 0.8mm"
  start=$(date +%s.%N)
  status=0
  # shellcheck disable=SC2086
  target/release/openwork $domain $target $options -o "$out/$name.svg" --report "$out/$name.json" \
    2> "$out/$name.log" || status=$?
  echo "$status $(awk -v a="$start" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }')" > "$out/$name.exit"
}
export -f run
export out

for exemplar in $exemplars; do
  for domain in line circle heart rect; do
    for target in one one-no-holes twelve-holes any; do
      echo "$exemplar $domain $target plain"
    done
  done
done > "$out/runs.txt"
xargs -P 2 -L 1 bash -c 'run "$@"' _ < "$out/runs.txt"
while read -r exemplar domain target _; do
  read -r status _ < "$out/$(basename "$exemplar" .svg)-$domain-$target-plain.exit"
  if [ "$status" = 3 ]; then echo "$exemplar $domain $target bridged"; fi
done < "$out/runs.txt" > "$out/again.txt"
xargs -P 2 -L 1 bash -c 'run "$@"' _ < "$out/again.txt"

told() { # NAME: the outcome in a cell of the table
  [ -e "$out/$1.exit" ] || { echo "as before"; return; }
  read -r status seconds < "$out/$1.exit"
  case $status in
    0)
      field() { sed -nE "s/^ *\"$2\": ([^,{[]+),?$/\1/p" "$out/$1.json" | head -n 1; }
      echo "verified: $(field "$1" components) c, $(field "$1" holes) h, $seconds s" ;;
    3) echo "refused: $(sed -nE 's/^openwork: //; s/\|/\//g; 1p' "$out/$1.log" | cut -c 1-160), $seconds s" ;;
    *) echo "**FAILED ($status)**: $(head -n 1 "$out/$1.log" | cut -c 1-160)" ;;
  esac
}

count() { # STATUS PATTERN: how many ended so
  cat "$out"/*-"$2".exit 2> /dev/null | awk -v s="$1" '$1 == s' | wc -l
}
failed=$(cat "$out"/*.exit | awk '$1 != 0 && $1 != 3' | wc -l)

cat <<INTRO
# The wall of ornaments

Every exemplar × {line 240 mm, circle 80 mm, heart, rectangle 120 x 80 mm} × {one component; one component and no
holes; twelve holes; any}, without bridges and, where that was refused, with \`--bridge 0.8mm\`. Every search has
256 MB. *Verified* files were read again and counted when they were written: components (c) and holes (h).

Command: \`scripts/wall.sh OUT_DIR EXEMPLAR.svg... > docs/wall.md\`. Real ornaments are TeX packages under the LPPL
(pgfornament, pgfornament-han, niceframe), not kept in this repository; the others are in \`fixtures/exemplars\`.

Without bridges $(count 0 plain) verified, $(count 3 plain) refused; of these with bridges $(count 0 bridged) verified,
$(count 3 bridged) refused, of which $(cat "$out"/*-one-bridged.exit 2> /dev/null | awk '$1 == 3' | wc -l) for one component. Failed: $failed.

| exemplar | where | target | without bridges | with bridges |
|---|---|---|---|---|
INTRO
while read -r exemplar domain target _; do
  name=$(basename "$exemplar" .svg)
  echo "| $name | $domain | $target | $(told "$name-$domain-$target-plain") | $(told "$name-$domain-$target-bridged") |"
done < "$out/runs.txt"

sheet=()
for exemplar in $exemplars; do
  for domain in line circle heart rect; do
    for way in plain bridged; do
      file=$out/$(basename "$exemplar" .svg)-$domain-one-$way.svg
      if [ -e "$file" ]; then sheet+=("$file"); fi
    done
  done
done
target/release/examples/contact_sheet "$out/wall.png" 4 "${sheet[@]}"
