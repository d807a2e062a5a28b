#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# completion_test.sh PROGRAM SOURCE: what the program offers the shell, and what bash makes of it. Exit code 77: bash-completion is missing.
set -u
program=$1 source=$2
failed=0
is() {
  [ "$2" = "$3" ] && return
  printf '%s: expected\n%s\nfound\n%s\n' "$1" "$3" "$2"
  failed=1
}
offered() { "$program" complete "$@" | tr '\n' ' '; }

is "a name that is shipped, or a file" "$(offered simulate --sensor '')" "$(cd "$source/sim_devices/sensors" && ls ./*.toml | sed 's|./\(.*\).toml|\1|' | tr '\n' ' '):files "
is "plans" "$(offered measure '')" "$(cd "$source/bench/plans" && ls ./*.toml | sed 's|./\(.*\).toml|\1|' | tr '\n' ' '):files "
is "words of an option" "$(offered fit --form '')" "size acuity "
is "words of a key" "$(offered simulate --accuracy x)" "draft normal reference auto "
is "behind an option and its value" "$(offered measure --out x '')" "$(offered measure '')"
is "files" "$(offered compare a '')" ":files "
is "a number" "$(offered render --size-pitch '')" ""
is "no argument more" "$(offered verify a b)" ""
is "unknown command" "$(offered nonsense '')" ""
is "nothing typed" "$(offered | wc -w)" "$(offered '' | wc -w)"
case " $(offered fit --) " in *" --lapse "*) ;; *) is "options of a command" "$(offered fit --)" "... --lapse ..." ;; esac
case " $(offered '') " in *" manual "* | *" complete "*) is "what help does not list" yes no ;; esac

# Zsh and fish, where they are installed. The stubs of zsh print what its completion would add.
if command -v zsh >/dev/null; then
  zsh_offers() {
    (cd "$source" && PATH=$(dirname "$program"):$PATH zsh -f -c '
      compadd() { shift; print -rl -- "$@"; }
      _files() { print FILES; }
      _todbench() { source bench/package/todbench.zsh; }
      words=("$@") CURRENT=$# PREFIX=${@[-1]}
      _todbench' zsh "$@" | tr '\n' ' ')
  }
  is "zsh: words" "$(zsh_offers todbench fit --form '')" "size acuity "
  is "zsh: files" "$(zsh_offers todbench compare a '')" "FILES "
  case " $(zsh_offers todbench '') " in *" judge "*) ;; *) is "zsh: commands" no yes ;; esac
else
  echo "skipped: zsh is not installed"
fi
if command -v fish >/dev/null; then
  fish_offers() {
    (cd "$source" && PATH=$(dirname "$program"):$PATH HOME=$(mktemp -d) fish -c 'source bench/package/todbench.fish; complete -C $argv[1]' "$1" | cut -f 1 | tr '\n' ' ')
  }
  is "fish: commands" "$(fish_offers 'todbench mea')" "measure "
  is "fish: words" "$(fish_offers 'todbench render --apex l')" "left "
  is "fish: files" "$(fish_offers 'todbench verify CHANGE')" "CHANGELOG.md "
else
  echo "skipped: fish is not installed"
fi

bash_completion=/usr/share/bash-completion/bash_completion
[ $failed -eq 0 ] || exit 1
[ -e $bash_completion ] || { echo "skipped: bash-completion is not installed"; exit 77; }
PATH=$(dirname "$program"):$PATH
set +u
. $bash_completion
. "$source/bench/package/todbench.bash"
# What is offered for a line whose last word is unfinished.
typed() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMP_LINE="$*" COMPREPLY=()
  COMP_POINT=${#COMP_LINE}
  _todbench 2>/dev/null
  echo "${COMPREPLY[*]}"
}
is "bash: commands" "$(typed todbench mea)" "measure"
is "bash: options" "$(typed todbench simulate --sens)" "--sensor"
is "bash: words" "$(typed todbench render --apex l)" "left"
hostile=$(mktemp)
printf '#!/bin/sh\nprintf "%%s\\n" "gige:FLIR-1" "gige:x;reboot" "gige:\$(id)" "gige:a b"\n' >"$hostile"
chmod +x "$hostile"
is "bash: names that are commands" "$(typed "$hostile" record gi)" "gige:FLIR-1"
rm "$hostile"
cd "$source"
is "bash: files beside names" "$(typed todbench verify CHANGE)" "CHANGELOG.md"
exit $failed
