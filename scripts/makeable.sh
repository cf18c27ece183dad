#!/usr/bin/env bash
# Makes every exemplar along a line, round a circle and in a rectangle, in all formats that machines take, hands the files
# to other people's programs, and prints the table of docs/makeable.md.
#
#   scripts/makeable.sh OUT_DIR EXEMPLAR.svg... > docs/makeable.md
#
# OUT_DIR keeps every file, and parts that it has already are not made again: take another for another build. What is
# not installed is skipped, and the table says so.
#
#   COUNTER   a command that counts an STL, DXF or SVG and prints JSON ("shells" and "euler", or "components" and
#             "holes"); for an SVG of cut lines it gets --cutlines as well
#   PYTHON    a Python with ezdxf, which audits every DXF (python3)
#   SLICER    PrusaSlicer, which makes G-code of every STL and 3MF (prusa-slicer)
#   DOMAINS   what to make, of "line short circle rect" ("line circle rect"); the table has what OUT_DIR has of the others, too
#   JOBS      runs at a time (2)
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,17p' "$0" >&2
  exit 0
fi
out=$1
shift
exemplars=$(realpath "$@")
mkdir -p "$out"
out=$(realpath "$out")
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
counter=${COUNTER:-}
python=${PYTHON:-python3}
slicer=${SLICER:-prusa-slicer}
"$python" -c 'import ezdxf' 2> /dev/null || python=
command -v "$slicer" > /dev/null || slicer=

openwork() { target/release/openwork "$@" --quiet; }

field() { # FILE NAME: the first value of a JSON field
  sed -nE "s/^ *\"$2\": ([^,{[]+),?$/\1/p" "$1" | head -n 1
}

reason() { # LOG: the first line of a message, short enough for a table
  sed -nE 's/^(error|openwork): //; s/\|/\//g; 1p' "$1" | sed "s|$out/||g" | cut -c 1-110
}

warned() { # REPORT WORDS: whether Openwork said so before
  grep -q "\"warning: .*$2" "$1" 2> /dev/null
}

counted() { # REPORT FILE COMPONENTS HOLES [OPTION]: what the counter says
  [ -n "$counter" ] || return 0
  local report=$1
  shift
  local said=$1.count.json
  # shellcheck disable=SC2086
  $counter "$1" ${4:-} > "$said" 2> /dev/null || { echo "**counter cannot read it**"; return; }
  local reasons
  reasons=$(tr -d '\n' < "$said" | sed -E 's/.*"invalid_reasons": \[([^]]*)\].*/\1/; s/ +/ /g' | cut -c 1-160)
  if [[ $1 != *.stl && $reasons =~ ^\ *\"[0-9]+\ parts\ or\ holes\ have\ an\ area\ below\ 0.01\"\ *$ ]] && warned "$report" "smaller than 0.01 mm2" \
    && [ "$(field "$said" components) $(field "$said" holes)" = "$2 $3" ]; then
    echo "counted, specks as warned"
    return 0
  fi
  case $1 in
    *.stl) [ "$(field "$said" shells) $(field "$said" euler)" = "$2 $((2 * $2 - 2 * $3))" ] && [ "$(field "$said" ok)" = true ] ;;
    *) [ "$(field "$said" components) $(field "$said" holes)" = "$2 $3" ] && [ "$(field "$said" ok)" = true ] ;;
  esac && echo "counted" || echo "**counter: $reasons**"
}

sliced() { # REPORT FILE: whether it becomes G-code
  [ -n "$slicer" ] || return 0
  local report=$1
  shift
  # One perimeter and no infill: what is tried is whether layers come out closed, not how they are filled.
  local options="--dont-arrange --center 100,100 --perimeters 1 --fill-density 0 --resolution 0.05"
  # shellcheck disable=SC2086
  if "$slicer" --export-gcode $options --output "$1.gcode" "$1" > "$1.slicer.log" 2>&1 && [ -s "$1.gcode" ]; then
    echo "sliced"
  elif warned "$report" "nozzle of 0.4 mm" && grep -qE "^(There is an object with no extrusions|The print is empty)" "$1.slicer.log"; then
    echo "thin parts left out, as warned"
  else
    echo "**slicer: $(grep -E '^(There is|The print|error)' "$1.slicer.log" | tail -n 1 | cut -c 1-110)**"
  fi
}

audited() { # FILE...: what ezdxf finds in each, a line for each
  [ -n "$python" ] || return 0
  "$python" - "$@" <<'PYTHON' || echo "**ezdxf cannot read it**"
import os, sys, ezdxf
for file in sys.argv[1:]:
    if not os.path.exists(file):
        print()
        continue
    document = ezdxf.readfile(file)
    audit = document.audit()
    faults = len(audit.errors) + len(audit.fixes)
    unit = {0: "no unit", 4: "mm"}.get(document.header.get("$INSUNITS", 0), "**wrong unit**")
    print(f"audited, {unit}" if faults == 0 else f"**{faults} faults for ezdxf**")
PYTHON
}

listed() { # WORDS...: those that are not empty, with commas
  local text=
  for word in "$@"; do if [ -n "$word" ]; then text=${text:+$text, }$word; fi; done
  echo "${text:-written}"
}

one() { # EXEMPLAR DOMAIN: a row of the table
  local name file made plate row c h
  name=$(basename "$1" .svg)
  file=$out/$name-$2
  if [ -e "$file.row" ]; then return 0; fi
  case $2 in
    line) made="band $1 --along line:240mm --width 14mm" plate=260x40mm ;;
    short) made="band $1 --along line:100mm --width 14mm" plate=120x40mm ;;
    circle) made="band $1 --along circle:40mm --width 12mm" plate=80x80mm ;;
    rect) made="rect $1 --size 60x40mm" plate=80x60mm ;;
  esac
  local status=0
  # shellcheck disable=SC2086
  openwork $made --chord 0.05mm --thickness 0.6mm --memory-limit 256MB -o "$file.svg" -o "$file.stl" -o "$file.3mf" \
    -o "$file.obj" -o "$file.dxf" --report "$file.json" 2> "$file.log" || status=$?
  if [ $status != 0 ]; then
    # 3 is a constraint that cannot be met; anything else should not be.
    [ $status = 3 ] && row="refused: $(reason "$file.log")" || row="**exit $status: $(reason "$file.log")**"
    echo "| $name | $2 | $row | | | | | | |" > "$file.row"
    return 0
  fi
  openwork extrude "$file.svg" --dxf-version r12 -o "$file-r12.dxf" 2> "$file-r12.log" || true
  openwork extrude "$file.svg" --cut --kerf 0.1mm -o "$file-cut.svg" 2> "$file-cut.log" || true
  openwork extrude "$file.svg" --sheet $plate --carve -o "$file-sign.dxf" --json 2> "$file-sign.log" \
    | sed -n '/"laser": {/,$p' > "$file-sign.json" || true
  audited "$file.dxf" "$file-r12.dxf" "$file-sign.dxf" > "$file.audits"
  c=$(field "$file.json" components) h=$(field "$file.json" holes)
  row="| $name | $2 | $c, $h | $(listed "$(counted "$file.json" "$file.stl" "$c" "$h")" "$(sliced "$file.json" "$file.stl")") | $(listed "$(sliced "$file.json" "$file.3mf")")"
  row="$row | $(listed "$(sed -n 1p "$file.audits")" "$(counted "$file.json" "$file.dxf" "$c" "$h")")"
  if [ -e "$file-r12.dxf" ]; then
    row="$row | $(listed "$(sed -n 2p "$file.audits")" "$(counted "$file.json" "$file-r12.dxf" "$c" "$h")")"
  else
    row="$row | refused: $(reason "$file-r12.log")"
  fi
  if [ -e "$file-cut.svg" ]; then
    row="$row | $(listed "$(counted "$file.json" "$file-cut.svg" "$c" "$h" --cutlines)")"
  else
    row="$row | refused: $(reason "$file-cut.log")"
  fi
  if [ -e "$file-sign.dxf" ]; then
    c=$(field "$file-sign.json" components) h=$(field "$file-sign.json" holes)
    row="$row | $(listed "$(sed -n 3p "$file.audits")" "$(counted "$file.json" "$file-sign.dxf" "$c" "$h")"), $((c - 1)) fall out"
  else
    row="$row | refused: $(reason "$file-sign.log")"
  fi
  echo "$row |" > "$file.row"
  echo "$name $2" >&2
}

export -f openwork field reason warned counted sliced audited listed one
export out counter python slicer

for exemplar in $exemplars; do
  for domain in ${DOMAINS:-line circle rect}; do echo "$exemplar $domain"; done
done | xargs -P "${JOBS:-2}" -L 1 bash -c 'one "$@"' _

absent=
[ -n "$counter" ] || absent="$absent No counter was given."
[ -n "$python" ] || absent="$absent There was no ezdxf."
[ -n "$slicer" ] || absent="$absent There was no PrusaSlicer."
rows=$(
  for exemplar in $exemplars; do
    for domain in line short circle rect; do
      row=$out/$(basename "$exemplar" .svg)-$domain.row
      if [ -e "$row" ]; then cat "$row"; fi
    done
  done
)
cat <<INTRO
# What other people's programs say of the files

Exemplars along a line of 240 mm (*short*: 100 mm) and round a circle of 40 mm and in a rectangle of 60 x 40 mm, at a chord error of 0.05 mm, with
whatever components and holes come out, 0.6 mm thick. All files were read again by Openwork before they had their names; then

- *counted*: an independent program, built on other people's geometry libraries, finds the components and holes of the
  report, and no fault: every mesh closed and consistently oriented, every contour closed, none twice, none crossing;
- *sliced*: PrusaSlicer makes G-code of it; *audited*: ezdxf finds nothing to correct, and reads this unit (release 12 has
  none to read);
- *as warned*: the other program complains of what Openwork had warned of: components that are nowhere as wide as a nozzle of
  0.4 mm, for which \`--process fdm-0.4 --enforce\` is, and parts or holes of less than 0.01 mm²;
- cut lines as SVG have a kerf of 0.1 mm; a gap or feature that is narrower than that is refused, with its place;
- a sign is the pattern cut out of a plate that is larger by 10 mm or more on each side: how many pieces *fall out* stands in its report.

Commands: \`COUNTER=... PYTHON=... scripts/makeable.sh OUT_DIR fixtures/exemplars/*.svg\`, and with other exemplars and \`DOMAINS\` for the rest. Names with a
number are ornaments of TeX packages under the LPPL (pgfornament, pgfornament-han, niceframe), not kept in this repository; the
others are in \`fixtures/exemplars\`.

$(grep -c . <<< "$rows") parts, $(grep -c '| refused' <<< "$rows" || true) with something that was refused, $(grep -c '\*\*' <<< "$rows" || true) with something that another program found
and Openwork had not warned of (bold).$absent

| exemplar | where | components, holes | STL | 3MF | DXF R2000 | DXF R12 | cut SVG, kerf | sign, DXF |
|---|---|---|---|---|---|---|---|---|
INTRO
echo "$rows"
