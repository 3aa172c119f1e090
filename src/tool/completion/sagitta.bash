# SPDX-License-Identifier: MIT
# Completion of sagitta for bash.  It asks the command itself (`sagitta --help options`), so it knows what the
# command that is called knows.

_sagitta()
{
    local program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} word=${COMP_WORDS[COMP_CWORD]}
    local before=${COMP_WORDS[COMP_CWORD - 1]} names="" name value words rest
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        names=$("$program" --help options 2>/dev/null | cut -f1)
        mapfile -t COMPREPLY < <(compgen -W "$names --help --version" -- "$word")
        return
    fi
    [[ $before == -o ]] && before=--output
    while IFS=$'\t' read -r name value words rest; do
        names+=" $name"
        [[ $name == "$before" ]] || continue
        [[ $name == --help ]] && words="all options"
        if [[ $name == --columns && $words != - ]]; then # a list with commas
            compopt -o nospace
            [[ $word == *,* ]] && rest=${word%,*}, || rest=""
            mapfile -t COMPREPLY < <(compgen -P "$rest" -W "$words" -- "${word##*,}")
            return
        fi
        if [[ $name == --surface && $words != - ]]; then # a type, in a map and in quotes
            rest=${word#[\'\"]} rest=${rest#"{type: "}
            mapfile -t COMPREPLY < <(for name in $(compgen -W "$words" -- "$rest"); do
                [[ $word == [\'\"]* ]] && echo "{type: $name}" || echo "'{type: $name}'"; done)
            return
        fi
        if [[ $words != - ]]; then
            mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
            return
        fi
        case $value in
        -) ;;
        FILE | PATH | LENS | NEW | PART)
            compopt -o filenames
            mapfile -t COMPREPLY < <(compgen -f -- "$word")
            return
            ;;
        *) return ;;
        esac
    done < <("$program" "$command" --help options 2>/dev/null)
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$names" -- "$word")
    elif [[ $command == join ]]; then
        compopt -o filenames
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    else # a lens
        compopt -o filenames
        mapfile -t COMPREPLY < <(for name in yaml yml zmx ZMX seq SEQ; do compgen -f -X "!*.$name" -- "$word"; done
                                 compgen -d -- "$word")
    fi
}

complete -F _sagitta sagitta
