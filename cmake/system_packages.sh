#!/bin/sh
# Install the Debian packages that a build needs, as far as they are missing. With --dev: clang, its
# formatter and linter too; with --bench: Google Benchmark.
set -eu

wanted="g++ cmake ninja-build libeigen3-dev libhwy-dev libfftw3-dev doctest-dev python3-venv python3-dev"
[ "${1:-}" = "--dev" ] && wanted="$wanted clang clang-format clang-tidy gfortran pkg-config"
[ "${1:-}" = "--bench" ] && wanted="$wanted libbenchmark-dev"

command -v dpkg-query >/dev/null 2>&1 || {
    echo "This is not a Debian system. Install the counterparts of these packages, then call pip and cmake" >&2
    echo "as the README says: $wanted" >&2
    exit 1
}

missing=""
for package in $wanted; do
    state=$(dpkg-query --show --showformat='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
    [ "$state" = "ii " ] || missing="$missing $package"
done
[ -z "$missing" ] && exit 0

if [ "$(id -u)" = 0 ]; then
    as_root=""
elif command -v sudo >/dev/null 2>&1; then
    as_root="sudo"
else
    echo "These Debian packages are missing, and you are neither root nor is sudo installed:$missing" >&2
    echo "Ask an administrator to run: apt-get install$missing" >&2
    exit 1
fi
echo "Installing$missing"
$as_root apt-get update -qq
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $missing
