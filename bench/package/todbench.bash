# SPDX-License-Identifier: GPL-3.0-or-later
# Bash completion of todbench: the program itself lists the candidates.
_todbench() {
  local cur words cword
  _get_comp_words_by_ref -n := cur words cword
  local offered files=""
  mapfile -t offered < <("${words[0]}" complete "${words[@]:1:cword-1}" "$cur" 2>/dev/null)
  if [ "${#offered[@]}" -gt 0 ] && [ "${offered[-1]}" = ":files" ]; then
    files=yes
    unset 'offered[-1]'
  fi
  COMPREPLY=()
  local word
  for word in "${offered[@]}"; do
    # Camera names are untrusted and become part of a command: skip candidates with unsafe characters.
    [[ "$word" == *[!A-Za-z0-9:._/-]* ]] && continue
    [[ "$word" == "$cur"* ]] && COMPREPLY+=("$word")
  done
  __ltrim_colon_completions "$cur"
  [ -n "$files" ] && _filedir
  return 0
}
complete -F _todbench todbench
