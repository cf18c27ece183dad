#!/usr/bin/env bash
# Makes every picture that the documentation shows, from the exemplars in fixtures/.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
openwork=target/release/openwork
exemplars=fixtures/exemplars pictures=docs/pictures
mkdir -p "$pictures"
band() { "$openwork" band "$@" --quiet; }

band $exemplars/vine.svg --along circle:65mm --width 14mm --components 1 --closed-pattern -o $pictures/bracelet.png
band $exemplars/lace.svg --along path:fixtures/curves/wave.svg --width 14mm --components 1 -o $pictures/lace.png
band $exemplars/strokes.svg --along path:fixtures/curves/oval.svg#oval --width 14mm --components 1 --closed-pattern -o $pictures/oval.png
"$openwork" rect $exemplars/filigree.svg --size 120x80mm --components 1 -o $pictures/panel.png --quiet
row=$(mktemp -d)
trap 'rm -rf "$row"' EXIT
for exemplar in filigree vine; do
  one="$exemplars/$exemplar.svg --components 1"
  # shellcheck disable=SC2086
  {
    band $one --along line:240mm --width 20mm -o "$row/$exemplar-1.svg"
    band $one --along circle:80mm --width 20mm -o "$row/$exemplar-2.svg"
    band $one --along path:fixtures/curves/heart.svg#heart --round 14mm --width 14mm -o "$row/$exemplar-3.svg"
    "$openwork" rect $one --size 120x80mm -o "$row/$exemplar-4.svg" --quiet
  }
done
cargo run --release --locked --quiet --example contact_sheet -- $pictures/wall.png 4 "$row"/*.svg
cargo run --release --locked --quiet --example stitching -- --pictures $pictures/stitching.png > /dev/null
"$openwork" analyze $exemplars/vine.svg -o $pictures/analysis.png --quiet
cargo run --release --locked --quiet --example persistences -- $exemplars/vine.svg $pictures/persistences.png

# What makers see.
scripts/sign.sh
thin="$exemplars/strokes.svg --along line:40mm --width 6mm --show thin --pixels 1200"
# shellcheck disable=SC2086
{
  band $thin -o $pictures/thin.png
  band $thin --min-feature 0.6mm --min-gap 0.3mm --enforce -o $pictures/enforced.png
}
band $exemplars/vine.svg --along circle:65mm --width 14mm --components 1 --closed-pattern --chamfer 0.3mm --view iso \
  --pixels 1200 -o $pictures/solid.png
# In space.
band $exemplars/vine.svg --along ring:65mm --width 14mm --components 1 --closed-pattern --view iso --pixels 1200 -o $pictures/ring.png
band $exemplars/lace.svg --along ring:62mm --gap 24mm --width 18mm --components 1 --view iso --pixels 1200 -o $pictures/cuff.png
band $exemplars/lace.svg --along line:60mm --width 14mm --components 1 --show seams,thin -o $pictures/seams.png
# Where the beam goes: its way in red, as wide as the kerf, with its middle, over the part.
kerf=0.5mm
band $exemplars/vine.svg --along line:42mm --width 16mm -o "$row/part.svg"
"$openwork" extrude "$row/part.svg" --cut --kerf $kerf -o "$row/cut.svg" --quiet
lines() { # WIDTH COLOUR OPACITY: the cut lines, drawn so
  sed -n '/<g /,/<\/g>/p' "$row/cut.svg" \
    | sed -E "s/stroke=\"[^\"]*\"/stroke=\"$2\"/; s/stroke-width=\"[^\"]*\"/stroke-width=\"$1\" stroke-opacity=\"$3\"/"
}
{
  sed '/<\/svg>/d; s/fill="#000"/fill="#22304e"/' "$row/part.svg"
  lines "${kerf%mm}" "#ff5a4d" 0.65
  lines 0.06 "#8f1212" 1
  echo '</svg>'
} > "$row/kerf.svg"
cargo run --release --locked --quiet --example contact_sheet -- $pictures/kerf.png 1x1400 "$row/kerf.svg"
