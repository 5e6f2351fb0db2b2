#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the scripts of pictures, NAME_pictures.sh BIN DATA OUT, have in common; they source it. Sets bin, data and out, font, and png,
# which makes files without a palette or a date. Works in a folder of its own.
[ $# -eq 3 ] || { echo "usage: $(basename -- "$0") BIN DATA OUT" >&2; exit 2; }
bin=$(realpath -- "$1") data=$(realpath -- "$2")
mkdir -p -- "$3"
out=$(realpath -- "$3")
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
cd -- "$work"
font=$(fc-match -f '%{file}' sans)
# shellcheck disable=SC2034
png=(-define png:color-type=2 -define png:compression-level=9 -define 'png:exclude-chunks=date,time')
