#!/usr/bin/env bash
# Runs the program on real ornaments and prints the table of docs/real-inputs.md.
#
#   scripts/real-inputs.sh OUT_DIR CURVE.svg EXEMPLAR.svg... > docs/real-inputs.md
#
# OUT_DIR keeps every file that was written, to look at. If COUNTER names a command that counts an SVG or STL
# and prints JSON ("components" and "holes", or "shells" and "euler"), it judges every file as well; without
# one that column says "-". Needs the exemplars and nothing else: it is no part of the tests.
set -euo pipefail
if [ $# -lt 3 ]; then
  sed -n '2,8p' "$0" >&2
  exit 0
fi
out=$1 curve=$2
shift 2
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
openwork=target/release/openwork
mkdir -p "$out"

field() { # FILE NAME: the first value of a JSON field
  sed -nE "s/^ *\"$2\": ([^,{[]+),?$/\1/p" "$1" | head -n 1
}

# judged FILE COMPONENTS HOLES: what the independent counter says
judged() {
  [ -n "${COUNTER:-}" ] || { echo "-"; return; }
  local said=$out/counter.json
  $COUNTER "$1" > "$said" 2>/dev/null || { echo "cannot read"; return; }
  case $1 in
    *.svg) [ "$(field "$said" components) $(field "$said" holes)" = "$2 $3" ] && echo agrees || echo "SVG: $(field "$said" components), $(field "$said" holes)" ;;
    *.stl) [ "$(field "$said" shells) $(field "$said" euler)" = "$2 $((2 * $2 - 2 * $3))" ] && echo agrees || echo "STL: $(field "$said" shells) shells, euler $(field "$said" euler)" ;;
  esac
}

cat <<INTRO
# Real inputs

Twelve ornaments that were drawn for other purposes (TeX packages under the LPPL: pgfornament, pgfornament-han,
niceframe), not kept in this repository. Every run ends in files that were read again and verified, or in exit
code 3 with its reason. "Counter" is an independent program built on other people's geometry libraries; it
judged both files of each run.

Command: \`COUNTER=... scripts/real-inputs.sh OUT_DIR open_spline.svg EXEMPLAR.svg... > docs/real-inputs.md\`

## Solids of the drawings as they are

| drawing | shells | genus | facets | seconds | counter |
|---|---|---|---|---|---|
INTRO

seconds() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", b - a }'; }

for exemplar in "$@"; do
  name=$(basename "$exemplar" .svg)
  stl=$out/$name.stl
  start=$(date +%s.%N)
  if "$openwork" extrude "$exemplar" -o "$stl" --json > "$out/$name.json" 2> "$out/$name.log"; then
    end=$(date +%s.%N)
    components=$(field "$out/$name.json" components) holes=$(field "$out/$name.json" holes)
    echo "| $name | $components | $holes | $(field "$out/$name.json" triangles) | $(seconds "$start" "$end") | $(judged "$stl" "$components" "$holes") |"
  else
    echo "| $name | - | - | - | - | $(head -n 1 "$out/$name.log") |"
  fi
done

cat <<INTRO

## Bands

| exemplar | along | asked for | components | holes | pieces | jumps | cost gap | narrowest ink, gap (mm) | seam before, after (deg) | seconds | counter: SVG, STL |
|---|---|---|---|---|---|---|---|---|---|---|---|
INTRO

for exemplar in "$@"; do
  name=$(basename "$exemplar" .svg)
  for along in line:240mm circle:80mm "path:$curve"; do
    kind=${along%%:*}
    for components in 1 any; do
      base=$out/$name-$kind-$components
      wanted=() asked="anything"
      if [ "$components" != any ]; then wanted=(--components "$components") asked="$components component"; fi
      start=$(date +%s.%N)
      code=0
      "$openwork" band "$exemplar" --along "$along" "${wanted[@]}" \
        -o "$base.svg" -o "$base.stl" -o "$base.png" --report "$base.json" > /dev/null 2> "$base.log" || code=$?
      end=$(date +%s.%N)
      shown=${along/$curve/open_spline.svg}
      if [ $code -eq 0 ]; then
        c=$(field "$base.json" components) h=$(field "$base.json" holes)
        widths=$(sed -nE 's/^ *"width_mm": ([0-9.e-]+),?$/\1/p' "$base.json" | tail -n 2 | awk '{ printf "%s%.3f", sep, $1; sep = ", " }')
        echo "| $name | $shown | $asked | $c | $h | $(field "$base.json" pieces_in_result) | $(field "$base.json" jumps) | $(field "$base.json" cost_gap) | $widths | $(field "$base.json" worst_angle_before_deg | cut -c1-5), $(field "$base.json" worst_angle_after_deg | cut -c1-5) | $(seconds "$start" "$end") | $(judged "$base.svg" "$c" "$h"), $(judged "$base.stl" "$c" "$h") |"
      else
        echo "| $name | $shown | $asked | exit $code: $(head -n 1 "$base.log" | sed 's/^error: //; s/|/\\|/g') | | | | | | | $(seconds "$start" "$end") | |"
      fi
    done
  done
done
