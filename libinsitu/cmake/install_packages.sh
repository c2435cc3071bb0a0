#!/usr/bin/env bash
# Installs what dpkg says is missing of packages.txt. Needs no rights and no network when everything is there.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
mapfile -t wanted < <(awk '!/^#/ && NF { print $1 }' "$here/packages.txt")

if ! command -v dpkg-query > /dev/null; then
  echo "Not a Debian system: going on with the libraries that are there (the list: $here/packages.txt)."
  exit 0
fi

missing=()
for package in "${wanted[@]}"; do
  # A removed package whose configuration stayed behind is known to dpkg too, hence the status.
  status="$(dpkg-query -W -f='${db:Status-Status}' "$package" 2> /dev/null || true)"
  [[ "$status" == installed ]] || missing+=("$package")
done
(( ${#missing[@]} )) || exit 0

as_root=()
if (( EUID != 0 )); then
  if ! command -v sudo > /dev/null; then
    echo "Missing packages, and neither root nor sudo to install them. Ask for:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@"
}
install_missing() {
  apt_get install --no-install-recommends "${missing[@]}"
}

echo "Installing ${missing[*]}"
# A fresh image has no package lists; an old one may have lists that name files which are gone. Both are cured by one
# update, and nobody else has to wait for it.
give_up() {
  echo "apt-get could not install: ${missing[*]}" >&2
  exit 1
}
if ! compgen -G '/var/lib/apt/lists/*_Packages*' > /dev/null; then
  apt_get update || give_up
  install_missing || give_up
elif ! install_missing; then
  echo "Trying again with new package lists"
  apt_get update || give_up
  install_missing || give_up
fi
