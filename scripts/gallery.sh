#!/usr/bin/env bash
# Builds every scene in examples/scenes and makes the pictures of docs/gallery.md. With a folder as its argument it also leaves the
# solids there.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
solids=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$solids"' EXIT
mkdir -p "$solids" docs/pictures
for scene in examples/scenes/*.toml; do
  name=$(basename "$scene" .toml)
  target/release/openwork build "$scene" --quiet --pixels 560 -o "$solids/$name.stl" -o "docs/pictures/scene-$name.png"
done
