#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The photographs of docs/web_page.md: web_pictures.sh BIN DATA OUT, folders of the built programs, of real scans and
# for the pictures. Needs node, Chromium and ImageMagick.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=benchmarks/render/picture_folders.sh
source "$here/picture_folders.sh"
for chromium in chromium chromium-browser google-chrome; do
  ! command -v "$chromium" > /dev/null || break
done

# photograph SCAN NAME PICTURE WIDTHxHEIGHT "STEP..." OPTIONS...: the page of a scan's surface after keys and clicks.
photograph() {
  local steps
  read -ra steps <<< "$5"
  "$bin/pcl_slim_fit" "$1" "$2.slim" -quiet 1
  "$bin/pcl_slim_render" "$2.slim" "$2.html" -quiet 1 "${@:6}"
  node "$here/page_photograph.mjs" "$chromium" "$2.html" "$2.png" "${4%x*}" "${4#*x}" "${steps[@]}"
  convert "$2.png" "${png[@]}" "$out/$3"
}
"$bin/pcl_slim_demo_scan" scan.pcd -quiet 1
photograph scan.pcd amphora web_page.png 800x600 "430,290" -mode mean -unit m
photograph "$data/lion_takanawa.pcd" lion web_page_color.png 800x520 "m 330,330 445,330 385,160 340,315 m 400,250"
