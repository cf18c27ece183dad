#!/usr/bin/env bash
# Carves one sign out of a plate, without and with the constraint on holes, and an ornament of rings without and with
# bridges, and writes pictures of the plates to docs/pictures: what falls out of them is orange.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
pictures=docs/pictures cuts=$(mktemp -d)
trap 'rm -rf "$cuts"' EXIT
mkdir -p "$pictures"

sign() { # NAME EXEMPLAR OPTIONS...: a plate of 140 x 40 mm
  local name=$1 exemplar=fixtures/exemplars/$2.svg
  shift 2
  target/release/openwork band "$exemplar" --along line:120mm --width 20mm "$@" --sheet 140x40mm --carve --quiet \
    -o "$cuts/$name.dxf" -o "$pictures/$name.png"
}
sign sign-any strokes
sign sign-whole strokes --components 1 --holes 0
sign rings-any chain
sign rings-bridged chain --holes 0 --bridge 1mm
