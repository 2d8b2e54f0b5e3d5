#!/bin/sh
# outside_program.sh BUILD SOURCE DEA CMAKE COMPILER FLAGS: installs the library, builds tests/outside against what was installed, and compares
# its plot file with that of `dea run`, byte by byte.
set -eu
build=$1 source=$2 dea=$3 cmake=$4 compiler=$5 flags=$6
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --prefix "$folder/prefix" >"$folder/install.log"
# All that is installed belongs to one of the components that packages are made of.
"$cmake" --install "$build" --prefix "$folder/rest" --component Unspecified >"$folder/rest.log"
[ ! -e "$folder/rest" ] || { echo "files of no package:"; find "$folder/rest" -type f; exit 1; }
ls "$folder/prefix/share/man/man1/dea-run.1"* "$folder/prefix/share/bash-completion/completions/dea" \
  "$folder/prefix/share/febiodea/source/CMakeLists.txt" >/dev/null
# The library's name in programs that are linked with it: major.minor.
version=$("$dea" --version | sed -n 's/^FEBioDEA \([0-9]*\.[0-9]*\)\..*/\1/p')
[ -n "$(find "$folder/prefix" -name "libfebiodea.so.$version")" ] || { echo "no libfebiodea.so.$version"; exit 1; }
generator=$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' "$build/CMakeCache.txt")
# With the library's own compiler and sanitizers: clang links what they need into programs alone.
"$cmake" -S "$source/tests/outside" -B "$folder/build" -G "$generator" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$folder/prefix" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  >"$folder/configure.log"
"$cmake" --build "$folder/build" >"$folder/build.log" || { cat "$folder/build.log"; exit 1; }
"$folder/build/outside" "$source/samples/hip/hip_walking.feb" "$folder/outside.xplt"
"$folder/build/outside_static" "$source/samples/spheres/one_layer.feb" "$folder/static.xplt"
"$dea" run "$source/samples/hip/hip_walking.feb" -o "$folder/dea.xplt" --overwrite -q >/dev/null
cmp "$folder/outside.xplt" "$folder/dea.xplt"
"$dea" run "$source/samples/spheres/one_layer.feb" -o "$folder/dea.xplt" --overwrite -q >/dev/null
cmp "$folder/static.xplt" "$folder/dea.xplt"
