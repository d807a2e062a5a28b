#compdef todbench
# SPDX-License-Identifier: GPL-3.0-or-later
# Zsh completion of todbench: the program itself lists the candidates.
local -a offered
local files=
offered=("${(@f)$("${words[1]}" complete "${(@)words[2,CURRENT-1]}" "$PREFIX" 2>/dev/null)}")
if [[ "${offered[-1]}" == ":files" ]]; then
  files=yes
  offered[-1]=()
fi
# Camera names are untrusted and become part of a command: skip candidates with unsafe characters.
offered=(${offered:#*[^A-Za-z0-9:._/-]*})
(( $#offered )) && compadd -- $offered
[[ -n "$files" ]] && _files
return 0
