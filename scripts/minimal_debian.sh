# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash disable=SC2016,SC2154
# Sourced by scripts that need a fresh, minimal Debian of any release in a folder. Needs root and debootstrap.
#   make_debian RELEASE DIR                  a system of Debian's essential packages and apt, as bookworm or trixie
#   in_debian DIR [--mount SOURCE TARGET]... COMMAND...
#                                            runs COMMAND in it, as its root; SOURCE, a folder, is seen at TARGET, an
#                                            absolute path in the system
#   put_source DIR TARGET                    the last commit of the project in $root, in TARGET, an absolute path in the
#                                            system; what was built there of an earlier commit stays
#   remove_debian DIR                        deletes it
# Packages come from the mirror that this system's apt uses, or from $DEBIAN_MIRROR. With $DEBIAN_CACHE, a folder,
# downloaded packages are kept in it for the next system. What is mounted is gone when a command ends, however it ends.

# debian_mirror: the address from which this system's apt gets its packages.
debian_mirror() {
  local mirror=${DEBIAN_MIRROR-}
  # The archive of security updates has no whole system.
  [ -n "$mirror" ] || mirror=$(apt-get indextargets --format '$(LABEL) $(REPO_URI)' 'Created-By: Packages' |
    awk '$1 == "Debian" { print $2; exit }')
  if [ -z "$mirror" ]; then
    echo "apt here uses no mirror of Debian: name one in DEBIAN_MIRROR" >&2
    return 1
  fi
  printf '%s\n' "$mirror"
}

# make_debian RELEASE DIR
make_debian() {
  local release=$1 dir=$2 mirror log script=/usr/share/debootstrap/scripts/$1
  if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
    echo "A minimal Debian is made by root with debootstrap: scripts/setup.sh packages installs it" >&2
    return 1
  fi
  if [ -e "$dir" ] && [ -n "$(ls -A -- "$dir")" ]; then
    echo "$dir is not empty: name a new folder" >&2
    return 1
  fi
  mirror=$(debian_mirror) || return
  # Releases younger than this debootstrap are made as the newest one it knows.
  [ -e "$script" ] || script=${script%/*}/sid
  mkdir -p -- "$dir"
  # An ordinary user enters it, too.
  chmod 755 -- "$dir"
  log=$(mktemp -t debootstrap.XXXXXX)
  # debootstrap mounts /proc in the new system: in mounts of its own, so that none is left here.
  if ! unshare --mount debootstrap --variant=minbase "$release" "$dir" "$mirror" "$script" >"$log" 2>&1; then
    tail -n 20 -- "$log" >&2
    echo "debootstrap failed; the whole log is $log" >&2
    return 1
  fi
  rm -f -- "$log"
  # Proxies, and whether a mirror's files may be older than they state, are as in this system.
  apt-config dump | grep -E '^Acquire::(Check-|Retries|https?::Proxy)' >"$dir/etc/apt/apt.conf.d/90host" || true
  echo 'APT::Install-Recommends "false";' >"$dir/etc/apt/apt.conf.d/90small"
  # The system is thrown away, so no package needs to be on the disk before the next one is unpacked.
  echo force-unsafe-io >"$dir/etc/dpkg/dpkg.cfg.d/unsafe-io"
  # Nothing that is installed starts a service.
  printf '#!/bin/sh\nexit 101\n' >"$dir/usr/sbin/policy-rc.d"
  chmod 755 -- "$dir/usr/sbin/policy-rc.d"
  in_debian "$dir" apt-get -qq update
}

# in_debian DIR [--mount SOURCE TARGET]... COMMAND...
in_debian() {
  local dir=$1 mounts=() variable keep=()
  shift
  while [ "${1-}" = --mount ]; do
    mounts+=("$2" "$3")
    shift 3
  done
  if [ -n "${DEBIAN_CACHE-}" ]; then
    mkdir -p -- "$DEBIAN_CACHE"
    mounts+=("$DEBIAN_CACHE" /var/cache/apt/archives)
  fi
  for variable in http_proxy https_proxy no_proxy; do
    [ -z "${!variable-}" ] || keep+=("$variable=${!variable}")
  done
  [ ! -e /etc/resolv.conf ] || cp -L -- /etc/resolv.conf "$dir/etc/resolv.conf"
  # Processes that a command leaves behind end with it, as mounts do.
  unshare --mount --pid --fork --kill-child bash -euc '
    dir=$1 count=$2
    shift 2
    for ((; count > 0; count -= 2)); do
      mkdir -p -- "$dir$2"
      mount --bind -- "$1" "$dir$2"
      shift 2
    done
    mount -t proc proc "$dir/proc"
    mount -t sysfs -o ro sysfs "$dir/sys"
    mkdir -p "$dir/dev/pts"
    mount -t devpts -o newinstance,ptmxmode=0666 devpts "$dir/dev/pts"
    [ -e "$dir/dev/ptmx" ] || ln -s pts/ptmx "$dir/dev/ptmx"
    [ -c "$dir/dev/null" ] || mount --rbind /dev "$dir/dev"
    exec chroot "$dir" /usr/bin/env -i "$@"' \
    in_debian "$dir" ${#mounts[@]} ${mounts[@]+"${mounts[@]}"} ${keep[@]+"${keep[@]}"} \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive "$@"
}

# put_source DIR TARGET
put_source() {
  local at=$1$2
  if [ -e "$at/.git" ]; then
    git -C "$at" fetch --quiet "$root" HEAD
    git -C "$at" checkout --quiet --force --detach FETCH_HEAD
  else
    git clone --quiet --no-hardlinks "$root" "$at"
  fi
}

# remove_debian DIR
remove_debian() {
  if awk -v dir="$(realpath -- "$1")/" 'index($5, dir) == 1 { exit 1 }' /proc/self/mountinfo; then
    rm -rf --one-file-system -- "$1"
  else
    echo "$1 is left: something is mounted in it" >&2
    return 1
  fi
}
