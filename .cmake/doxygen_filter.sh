#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# doxygen_filter.sh FILE: the comments of a header as plain text, because they are written for people: tags, backslashes and number signs in
# a `///` comment are no markup of Doxygen. Everything else passes as it is.
case "$1" in
  *.md) exec cat "$1" ;;
  *) exec sed -E '/\/\/\//{
:more
s|(///.*)\\([a-z])|\1\&#92;\2|
s|(///<?[^<]*)<(/?[A-Za-z])|\1\&lt;\2|
s|(///.*)#([A-Za-z])|\1\&#35;\2|
t more
s|///&lt;|///<|
}' "$1" ;;
esac
