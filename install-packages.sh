#!/bin/sh
# Installs the packages of the named groups of packages.txt that are missing. Needs root or sudo only if any is.
#   ./install-packages.sh build test
# Group "build" must succeed; of the others, what cannot be installed is named and left out.
set -eu
cd "$(dirname "$0")"

packages_of() { awk -v group="$1" '$1 == group { print $2 }' packages.txt; }
is_installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q '^install ok installed'; }
missing_of() { for package in $(packages_of "$1"); do is_installed "$package" || echo "$package"; done; }

missing=
for group in "$@"; do missing="$missing $(missing_of "$group")"; done
missing=$(echo $missing | tr ' ' '\n' | sort -u)
[ -n "$missing" ] || exit 0

if ! command -v apt-get >/dev/null; then
  echo "install-packages.sh: this is no Debian; please install the like of:" $missing >&2
  exit 0
fi
as_root=
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "install-packages.sh: run as root, or install:" $missing >&2; exit 1; }
  as_root=sudo
fi
apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 "$@"; }

echo "installing:" $missing
apt update >/dev/null || echo "install-packages.sh: apt-get update failed; trying with the lists that are here" >&2
if ! apt install -y --no-install-recommends $missing >/dev/null; then
  for package in $missing; do apt install -y --no-install-recommends "$package" >/dev/null || true; done
fi
for group in "$@"; do
  left=$(missing_of "$group")
  [ -z "$left" ] && continue
  echo "install-packages.sh: not installed ($group):" $left >&2
  [ "$group" != build ] || exit 1
done
