#!/usr/bin/env bash
# What cannot be had, and how soon that is said: every exemplar along a line and round a circle, with targets that most
# of them cannot meet. Prints docs/refusals.md.
#
#   scripts/refusals.sh EXEMPLAR.svg... > docs/refusals.md
#
# Only what is refused is listed, or not done in time. Seconds are those of the processor, so that what else the machine does changes
# little. Exemplars that are not there are left out.
#
#   OPENWORK      the program to measure (the release build)
#   OPTIONS       more options for every band, as "--width 20mm"
#   SECONDS_EACH  a run that keeps the processor longer is ended, and listed as such (120)
set -euo pipefail
if [ $# -lt 1 ]; then
  sed -n '2,13p' "$0" >&2
  exit 0
fi
root=$(cd "$(dirname "$0")/.." && pwd)
if [ -z "${OPENWORK:-}" ]; then
  (cd "$root" && cargo build --release --locked --quiet --bin openwork)
  OPENWORK=$root/target/release/openwork
fi
limit=${SECONDS_EACH:-120}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

run() { # EXEMPLAR ALONG TARGET: adds a row if it is refused
  local TIMEFORMAT='%U' status=0
  {
    time (
      ulimit -t "$limit"
      # shellcheck disable=SC2086
      "$OPENWORK" band "$1" --along "$2" $3 ${OPTIONS:-} --quiet -o "$work/band.svg" 2> "$work/log"
    )
  } 2> "$work/seconds" || status=$?
  local seconds
  seconds=$(tail -n 1 "$work/seconds")
  echo "$(basename "$1" .svg) $2 $3: exit $status, $seconds s" >&2
  case $status in
    0 | 2) return ;;
    3) echo "$seconds $(sed 's/^error: //; s/|/\//g; 1q' "$work/log")" > "$work/told" ;;
    137 | 152) echo "$seconds **not done after $limit s**" > "$work/told" ;;
    *) echo "$seconds **failed ($status)**" > "$work/told" ;;
  esac
  printf '| %s | %s | `%s` | %s | %s |\n' "$(basename "$1" .svg)" "${2%%:*}" "$3" "$seconds" \
    "$(cut -d ' ' -f 2- "$work/told")" >> "$work/rows"
}

for exemplar in "$@"; do
  [ -e "$exemplar" ] || continue
  for along in line:240mm circle:80mm; do
    for target in "--components 1 --holes 0" "--components 1 --holes 12" "--holes 500" "--components 300"; do
      run "$exemplar" "$along" "$target"
    done
  done
  run "$exemplar" circle:80mm --closed-pattern
done

rows() { # PATTERN: how many rows match
  grep -cE "$1" "$work/rows" || true
}

cat <<INTRO
# What cannot be had

Bands of every exemplar along a line of 240 mm and round a circle of 80 mm, with targets that most of them cannot meet.
Of $(rows '[|]$') rows $(rows 'the nearest that can be had is') name the nearest count with the proof that there is none nearer,
$(rows '; --[a-z]* [0-9]* can be had') one that can be had, $(rows 'leave out --') none, and $(rows 'given up') were given up without an answer. $(rows 'not done') runs were ended after $limit s.
Processor time in seconds, of the whole process: the longest refusal took $(grep -vE 'not done|given up' "$work/rows" | cut -d '|' -f 5 | sort -g | tail -n 1 | tr -d ' ').

Command: \`${OPTIONS:+OPTIONS="$OPTIONS" }${SECONDS_EACH:+SECONDS_EACH=$SECONDS_EACH }scripts/refusals.sh EXEMPLAR.svg... > docs/refusals.md\`. Exemplars c1 to c9 are real ornaments from
TeX packages under the LPPL (pgfornament, pgfornament-han, niceframe), not kept in this repository; the others are in
\`fixtures/exemplars\`.

| exemplar | along | target | s | refusal |
|---|---|---|---|---|
INTRO
cat "$work/rows"
