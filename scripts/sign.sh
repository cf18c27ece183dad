#!/usr/bin/env bash
# Carves one sign out of a plate, without and with the constraint on holes, and an ornament of rings without and with
# bridges, and writes pictures of the plates to docs/pictures: what falls out of them is orange, and its number is printed.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --quiet
pictures=docs/pictures cuts=$(mktemp -d)
trap 'rm -rf "$cuts"' EXIT
mkdir -p "$pictures"

sign() { # NAME EXEMPLAR LENGTH HEIGHT OPTIONS...: a pattern of that size in millimetres, on a plate larger by 20 mm
  local name=$1 exemplar=fixtures/exemplars/$2.svg length=$3 height=$4
  shift 4
  target/release/openwork band "$exemplar" --along "line:${length}mm" --width "${height}mm" --components 1 "$@" \
    --sheet "$((length + 20))x$((height + 20))mm" --carve -o "$cuts/$name.dxf" -o "$pictures/$name.png" 2>&1 \
    | sed -nE "s/^(warning: )?(.* out of the plate)(.*)?/$name: \2/p"
}
sign sign-any vine 160 22
sign sign-whole vine 160 22 --holes 0
sign rings-any chain 120 20
sign rings-bridged chain 120 20 --holes 0 --bridge 1mm
