#!/usr/bin/env bash
# Prints the tables of docs/variety.md: what the cost of a jump does to repetition.
#
#   scripts/variety.sh EXEMPLAR.svg...
#
# Every exemplar is made into a band of 240 x 20 mm for several values of --jump-cost. Set TOPOLOGY to options such
# as "--components 1" for bands of a topology; what cannot be had is left out. Needs the exemplars and nothing else.
set -euo pipefail
if [ $# -lt 1 ]; then
  sed -n '2,7p' "$0" >&2
  exit 0
fi
costs="0 0.1 0.3 1 3 10"
root=$(cd "$(dirname "$0")/.." && pwd)
(cd "$root" && cargo build --release --locked --quiet)
openwork=$root/target/release/openwork
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

field() { # NAME: the first value of a field of the report
  sed -nE "s/^ *\"$1\": ([^,{[]+),?$/\1/p" "$work/report.json" | head -n 1
}

jumps() { # of the seams, which are on one line or several
  tr -d '\n' < "$work/report.json" | sed -nE 's/.*"jumps": *([0-9]+).*/\1/p'
}

printf '| exemplar | pieces |'
for cost in $costs; do printf ' λ = %s |' "$cost"; done
printf '\n|---|---|'
for cost in $costs; do printf -- '---|'; done
printf '\n'
for exemplar in "$@"; do
  row="" pieces=""
  for cost in $costs; do
    # shellcheck disable=SC2086
    if timeout 60 "$openwork" band "$exemplar" --along line:240mm --width 20mm --jump-cost "$cost" ${TOPOLOGY:-} \
      --quiet -o "$work/band.svg" --report "$work/report.json" 2> /dev/null; then
      pieces=$(field pieces_in_exemplar)
      echo "$cost $(field longest_repeat) $(field pieces_in_result) $(field evenness) $(jumps)" >> "$work/all"
      row="$row $(field longest_repeat) of $(field pieces_in_result), $(printf %.2f "$(field evenness)"), $(jumps) |"
    else
      row="$row - |"
    fi
  done
  echo "| $(basename "$exemplar" .svg) | $pieces |$row"
done

cat <<'HEAD'

| λ | bands | longest repeat, part of the band, mean | greatest | evenness, mean | least | collapsed | jumps in all |
|---|---|---|---|---|---|---|---|
HEAD
for cost in $costs; do
  awk -v cost="$cost" '$1 == cost {
    n++; part = $2 / $3; parts += part; evens += $4; jumps += $5
    if (part > most) most = part
    if (n == 1 || $4 < least) least = $4
    if ($4 < 0.5) collapsed++
  } END {
    if (n) printf "| %s | %d | %.2f | %.2f | %.2f | %.2f | %d | %d |\n", cost, n, parts / n, most, evens / n, least, collapsed, jumps
  }' "$work/all"
done
