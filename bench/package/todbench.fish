# SPDX-License-Identifier: GPL-3.0-or-later
# Fish completion of todbench: the program itself lists the candidates.
function __todbench_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    for word in ($words[1] complete $words[2..-1] "$current" 2>/dev/null)
        if test "$word" = ":files"
            __fish_complete_path "$current"
        else if string match -qr '^[A-Za-z0-9:._/-]+$' -- $word
            # Camera names are untrusted and become part of a command: other characters are skipped.
            echo $word
        end
    end
end
complete -c todbench -f -a '(__todbench_complete)'
