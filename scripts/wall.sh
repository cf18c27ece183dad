#!/usr/bin/env bash
# The wall of ornaments: every exemplar along a line, a circle and a heart and in a rectangle, with four targets,
# without and with bridges. Prints the table of docs/wall.md.
#
#   scripts/wall.sh OUT_DIR EXEMPLAR.svg... > docs/wall.md
#
# OUT_DIR keeps every drawing and report that was written, and wall.png, the contact sheet of what is in one
# component. With bridges only what was refused without them is run again, as everything else comes out the
# same. It takes a while, and is no part of the tests. What OUT_DIR has already is not run again: stop it and start
# it as you like, and take another OUT_DIR for another build.
#
#   DOMAINS   what to run, of "line circle heart rect" (all)
#   SECONDS_EACH   a run that keeps a processor longer has failed (120)
#   JOBS   runs at a time (2)
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,15p' "$0" >&2
  exit 0
fi
out=$1
shift
exemplars=$(realpath "$@")
domains=${DOMAINS:-line circle heart rect}
limit=${SECONDS_EACH:-120}
jobs=${JOBS:-2}
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet --bin openwork --example contact_sheet
mkdir -p "$out"
out=$(realpath "$out")

run() { # EXEMPLAR DOMAIN TARGET BRIDGE: one piece of the wall; leaves NAME.svg or NAME.log, and NAME.exit
  local name domain target options status
  name=$(basename "$1" .svg)-$2-$3-$4
  if [ -e "$out/$name.exit" ]; then return; fi
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
  status=0
  options="--memory-limit 256MB --quiet"
  [ "$4" = bridged ] && options="$options --bridge 0.8mm"
  # The time of the processor, so that what else the machine does changes nothing.
  local TIMEFORMAT='%U'
  {
    time (
      ulimit -t "$limit"
      # shellcheck disable=SC2086
      target/release/openwork $domain $target $options -o "$out/$name.svg" --report "$out/$name.json" \
        2> "$out/$name.log"
    )
  } 2> "$out/$name.seconds" || status=$?
  if [ "$status" = 152 ] || [ "$status" = 137 ]; then
    status=124
    echo "not done after $limit s" > "$out/$name.log"
  fi
  echo "$status $(tail -n 1 "$out/$name.seconds")" > "$out/$name.tmp"
  rm "$out/$name.seconds"
  # The result counts once it is whole.
  mv "$out/$name.tmp" "$out/$name.exit"
  echo "$name: exit $(cat "$out/$name.exit") s" >&2
}
export -f run
export out limit

for exemplar in $exemplars; do
  for domain in $domains; do
    for target in one one-no-holes twelve-holes any; do
      echo "$exemplar $domain $target plain"
    done
  done
done > "$out/runs.txt"
xargs -P "$jobs" -L 1 bash -c 'run "$@"' _ < "$out/runs.txt"

outcome() { # EXEMPLAR DOMAIN TARGET BRIDGE: the exit code, or nothing
  local file
  file=$out/$(basename "$1" .svg)-$2-$3-$4.exit
  if [ -e "$file" ]; then cut -d ' ' -f 1 "$file"; fi
}
while read -r exemplar domain target _; do
  if [ "$(outcome "$exemplar" "$domain" "$target" plain)" = 3 ]; then echo "$exemplar $domain $target bridged"; fi
done < "$out/runs.txt" > "$out/again.txt"
xargs -r -P "$jobs" -L 1 bash -c 'run "$@"' _ < "$out/again.txt"

told() { # NAME: the outcome in a cell of the table
  [ -e "$out/$1.exit" ] || { echo "as before"; return; }
  read -r status seconds < "$out/$1.exit"
  case $status in
    0)
      field() { sed -nE "s/^ *\"$2\": ([^,{[]+),?$/\1/p" "$out/$1.json" | head -n 1; }
      echo "verified: $(field "$1" components) c, $(field "$1" holes) h, $seconds s" ;;
    3) echo "refused: $(sed -nE 's/^openwork: //; s/\|/\//g; 1p' "$out/$1.log" | cut -c 1-160), $seconds s" ;;
    *) echo "**FAILED ($status)**: $(head -n 1 "$out/$1.log" | sed "s|$out/||g" | cut -c 1-160)" ;;
  esac
}

# What is listed may be less than what OUT_DIR keeps: only what is listed counts.
while read -r exemplar domain target way; do
  echo "$way $target $(outcome "$exemplar" "$domain" "$target" "$way")"
done < <(cat "$out/runs.txt" "$out/again.txt") > "$out/outcomes.txt"
count() { # PATTERN: how many outcomes match
  grep -cE "$1" "$out/outcomes.txt" || true
}

cat <<INTRO
# The wall of ornaments

Every exemplar × {line 240 mm, circle 80 mm, heart, rectangle 120 x 80 mm} × {one component; one component and no
holes; twelve holes; any}, without bridges and, where that was refused, with \`--bridge 0.8mm\`. Every search has
256 MB, and what keeps a processor for more than $limit s has failed. *Verified* files were read again and counted when they were
written: components (c) and holes (h).

Command: \`scripts/wall.sh OUT_DIR EXEMPLAR.svg... > docs/wall.md\`. Real ornaments are TeX packages under the LPPL
(pgfornament, pgfornament-han, niceframe), not kept in this repository; the others are in \`fixtures/exemplars\`.

Without bridges $(count '^plain .* 0$') verified, $(count '^plain .* 3$') refused; of these with bridges
$(count '^bridged .* 0$') verified, $(count '^bridged .* 3$') refused, of which $(count '^bridged one 3$') for one component.
Failed: $(grep -cvE ' [03]$' "$out/outcomes.txt" || true).

| exemplar | where | target | without bridges | with bridges |
|---|---|---|---|---|
INTRO
while read -r exemplar domain target _; do
  name=$(basename "$exemplar" .svg)
  echo "| $name | $domain | $target | $(told "$name-$domain-$target-plain") | $(told "$name-$domain-$target-bridged") |"
done < "$out/runs.txt"

sheet=()
for exemplar in $exemplars; do
  for domain in $domains; do
    for way in plain bridged; do
      file=$out/$(basename "$exemplar" .svg)-$domain-one-$way.svg
      if [ -e "$file" ]; then sheet+=("$file"); fi
    done
  done
done
target/release/examples/contact_sheet "$out/wall.png" 4 "${sheet[@]}"
