#!/bin/sh
# samples_are_generated.sh MAKE_SAMPLES SAMPLES_DIR: the committed models against freshly made ones.
set -eu
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
mkdir "$fresh/spheres" "$fresh/sphere_on_flat" "$fresh/plateaus" "$fresh/ligament" "$fresh/knee" "$fresh/menisci" "$fresh/chain" "$fresh/osteotomy"
"$1" "$fresh"
for model in "$fresh"/*/*.*; do
  cmp "$model" "$2/${model#"$fresh"/}"
done
