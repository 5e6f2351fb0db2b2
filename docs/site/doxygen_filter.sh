#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Doxygen's view of a header: its names belong to the group of its module (docs/site/api.dox), and setters that a macro
# makes are written out. Lines keep their numbers.
#   sh docs/site/doxygen_filter.sh HEADER
case $1 in
  *.dox) exec cat -- "$1" ;;
  */filters/io/*) group=io ;;
  *) group=$(printf '%s\n' "$1" | sed 's|.*include/pcl_slim/||; s|/.*||; s|^version.h$|core|') ;;
esac
exec sed -E \
  -e "s#^namespace pcl_slim \{\$#& /** \\\\addtogroup $group */ /** \\\\{ */#" \
  -e 's#^\}  // namespace pcl_slim$#/** \\} */ &#' \
  -e 's#^  PCL_SLIM_PARAMETER\((.*), (.*), (.*)\)$#/** \\brief Sets \3, documented there. */ void set\2(\1 value); /** \\brief Returns \3. */ \1 get\2() const;#' \
  -- "$1"
