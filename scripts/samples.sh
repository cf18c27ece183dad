#!/usr/bin/env bash
# Makes the pictures of docs/samples.md and prints its tables. With a folder as its argument it leaves all drawings there.
set -euo pipefail
cd "$(dirname "$0")/.."
drawings=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$drawings"' EXIT
cargo run --release --locked --quiet --example samples -- "$drawings"
mkdir -p docs/pictures
cp "$drawings"/samples-{1,2,without}.png "$drawings"/samples-energies.svg docs/pictures/
cargo build --release --locked --quiet
openwork() { target/release/openwork fill --quiet "$@"; }
openwork fixtures/samples/branches.svg --domain rect:150x100mm --components 1 --frame 2mm --process fdm-0.4 --enforce \
  --view iso --pixels 1100 -o docs/pictures/samples-lace.png -o "$drawings/lace.stl"
openwork fixtures/samples/rings.svg --domain fixtures/curves/heart.svg --components 1 --frame 1.6mm \
  --pixels 800 -o docs/pictures/samples-heart.png
openwork fixtures/samples/leaves.svg --domain band --along ring:70mm --width 24mm --components 1 --frame 1.6mm \
  --view iso --pixels 800 -o docs/pictures/samples-ring.png
openwork fixtures/samples/branches.svg --domain rect:120x80mm --keep fixtures/curves/begun.svg --seed 4 \
  --pixels 700 -o docs/pictures/samples-keep.png
openwork fixtures/samples/leaves.svg --domain rect:120x80mm --clone '0,0,40x30->40,25' --seed 3 \
  --pixels 700 -o docs/pictures/samples-clone.png
