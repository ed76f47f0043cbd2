#!/bin/sh
# cases/cmake/packages.sh [FOLDER] : builds Flexmorph in FOLDER (default build-packages) and makes
# its Debian packages there. Compiling needs the packages that cases/run.sh installs.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${1-$root/build-packages}
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DFLEXMORPH_TESTS=OFF \
  -DCMAKE_INSTALL_PREFIX=/usr -DFLEXMORPH_PYTHON_DIR=lib/python3/dist-packages
cmake --build "$build"
(cd "$build" && cpack)
ls -l "$build"/*.deb
