#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the site: all pages by Sphinx, the reference of the installed headers by Doxygen. Any warning is an error, and so
# is a link that leads nowhere.
#   scripts/site.sh [OUT]     OUT/index.html is the front page; build/site if not given
# Needs doxygen, python3-sphinx, furo and python3-myst-parser; scripts/setup.sh ci installs them.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
if [ $# -gt 1 ]; then
  echo "usage: scripts/site.sh [OUT]" >&2
  exit 2
fi
out=$(realpath -m -- "${1-$root/build/site}")
log=$root/build/log
for tool in doxygen sphinx-build; do
  command -v $tool >/dev/null || {
    echo "$tool is missing: run scripts/setup.sh ci, which installs it" >&2
    exit 1
  }
done
mkdir -p -- "$out" "$log"
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
cd -- "$root"

# Each of the two returns at its first failure: "quietly" runs them where set -e does not.
# reference: Doxygen's pages below OUT/api, and a list of their names for the other pages.
reference() {
  rm -rf -- "$out/api"
  # Its tabs lead back to the pages.
  doxygen -l "$work/layout.xml"
  sed -i 's|<tab type="mainpage".*|<tab type="user" url="../README.html" title="Pages"/>\n    &|' "$work/layout.xml"
  {
    cat docs/site/Doxyfile
    printf '%s\n' "PROJECT_NUMBER = $(sed -n 's/#define PCL_SLIM_VERSION "\(.*\)"/\1/p' modules/core/include/pcl_slim/version.h)" \
      "OUTPUT_DIRECTORY = \"$out\"" "HTML_OUTPUT = api" "GENERATE_TAGFILE = \"$work/api.tags\"" \
      "LAYOUT_FILE = \"$work/layout.xml\"" "WARN_LOGFILE = \"$work/warnings\""
    printf 'STRIP_FROM_INC_PATH += "%s"\n' modules/*/include
  } | doxygen - || return
  # Variables, aliases and members of classes may go without a comment: most are named by what they are.
  ! grep -v -E 'Member .* \((variable|typedef|friend)\) of .* is not documented|Member .* \(function\) of (class|struct) .* is not documented' \
    "$work/warnings"
}
pages() {
  rm -rf -- "$out/docs" "$out/benchmarks"
  PCL_SLIM_TAGS=$work/api.tags sphinx-build -q -W --keep-going -j "${JOBS:-$(nproc)}" -c docs/site -d "$work/doctrees" . "$out" || return
  # Browsers open index.html, the pages link to README.html.
  echo '<!DOCTYPE html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=README.html"><title>pcl_slim</title>' \
    >"$out/index.html"
  rm -f -- "$out/.buildinfo"
}
quietly "Reference" "$log/site_reference.log" reference
quietly "Pages" "$log/site_pages.log" pages
quietly "Links" "$log/site_links.log" python3 tests/site_test.py "$out" "$root"
tail -n 1 -- "$log/site_links.log"
