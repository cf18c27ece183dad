#!/usr/bin/env bash
# Makes bands with every kind of wall, panels, and cut lines of every kind of curve, hands the files to other people's programs,
# and prints docs/makeable-shapes.md. Beside scripts/makeable.sh, which makes all exemplars in every format, with upright walls and arcs.
#
#   scripts/makeable-shapes.sh OUT_DIR EXEMPLAR.svg... > docs/makeable-shapes.md
#
#   OPENWORK  the program (target/release/openwork)
#   COUNTER   a command that counts an STL or DXF and prints JSON with "ok" and "invalid_reasons"; a DXF with --cutlines
#   PYTHON    a Python with ezdxf (python3)
#   SLICER    PrusaSlicer (prusa-slicer)
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,11p' "$0" >&2
  exit 0
fi
out=$1
shift
mkdir -p "$out"
openwork=${OPENWORK:-$(dirname "$0")/../target/release/openwork}
counter=${COUNTER:?a command that counts}
python=${PYTHON:-python3}
slicer=${SLICER:-prusa-slicer}

counted() { # FILE [OPTION]
  # shellcheck disable=SC2086
  $counter "$1" ${2:-} > "$1.count.json" 2> /dev/null || true
  if grep -qE '"ok": true' "$1.count.json"; then
    echo counted
  else
    echo "**$(tr -d '\n' < "$1.count.json" | sed -E 's/.*"invalid_reasons": \[([^]]*)\].*/\1/; s/ +/ /g' | cut -c 1-120)**"
  fi
}

sliced() { # FILE
  if "$slicer" --export-gcode --dont-arrange --center 100,100 --perimeters 1 --fill-density 0 --resolution 0.05 \
    --output "$1.gcode" "$1" > "$1.log" 2>&1 && [ -s "$1.gcode" ]; then echo sliced; else echo "**not sliced**"; fi
}

audited() { # FILE
  "$python" - "$1" <<'PYTHON' || echo "**ezdxf cannot read it**"
import sys, ezdxf
audit = ezdxf.readfile(sys.argv[1]).audit()
faults = len(audit.errors) + len(audit.fixes)
print("audited" if faults == 0 else f"**{faults} faults for ezdxf**")
PYTHON
}

made() { # ARGUMENTS: runs the program, or tells why it would not
  if "$openwork" "$@" --quiet 2> "$out/log"; then return 0; fi
  echo "refused: $(sed -E 's/^error: //; s/\|/\//g; 1q' "$out/log" | sed "s|$out/||g" | cut -c 1-90)"
  return 1
}

mesh_row() { # NAME WALLS COMMAND
  local file=$out/$1-${2// /_} why
  # shellcheck disable=SC2086
  if why=$(made $3 $2 --chord 0.05mm --thickness 2mm -o "$file.stl" -o "$file.3mf"); then
    echo "| $1 | ${2:-upright} | $(counted "$file.stl"), $(sliced "$file.stl") | $(sliced "$file.3mf") |"
  else
    echo "| $1 | ${2:-upright} | $why | |"
  fi
}

cut_row() { # NAME COMMAND
  local row="| $1" file why
  for kind in "arcs r2000" "polyline r2000" "spline r2000" "arcs r12" "polyline r12"; do
    file=$out/$1-${kind// /-}.dxf
    # shellcheck disable=SC2086
    if why=$(made $2 --curves ${kind% *} --dxf-version ${kind#* } --chord 0.05mm -o "$file"); then
      row="$row | $(audited "$file"), $(counted "$file" --cutlines)"
    else
      row="$row | $why"
    fi
  done
  echo "$row |"
}

cat <<'INTRO'
# What other people's programs say of other walls and curves

Beside [makeable.md](makeable.md): *counted* by an independent program without any fault (facets of less than 1e-10 mm² are one), *sliced* to
G-code by PrusaSlicer, *audited* by ezdxf without any fault. Bands go round a circle of 50 mm and are 10 mm wide, panels are 60 x 40 mm,
all are 2 mm thick at a chord error of 0.05 mm. What is in bold is a fault. Command:
`COUNTER=... PYTHON=... scripts/makeable-shapes.sh OUT_DIR fixtures/exemplars/{filigree,vine,leaves}.svg`

| shape | walls | STL | 3MF |
|---|---|---|---|
INTRO
for exemplar in "$@"; do
  name=$(basename "$exemplar" .svg)
  for walls in "" "--chamfer 0.1mm" "--taper 3" "--taper 3 --chamfer 0.1mm"; do
    mesh_row "$name" "$walls" "band $exemplar --along circle:50mm --width 10mm"
  done
  mesh_row "$name panel" "--chamfer 0.05mm" "rect $exemplar --size 60x40mm"
done
echo
echo "| cut lines | arcs, R2000 | polyline, R2000 | spline, R2000 | arcs, R12 | polyline, R12 |"
echo "|---|---|---|---|---|---|"
for exemplar in "$@"; do
  name=$(basename "$exemplar" .svg)
  cut_row "$name" "band $exemplar --along circle:50mm --width 10mm"
  cut_row "$name sign" "band $exemplar --along circle:50mm --width 10mm --sheet 90x90mm --carve"
done
