# SPDX-License-Identifier: MIT
# Completion of sagitta for fish.  It asks the command itself (`sagitta --help options`), so it knows what the
# command that is called knows.

function __sagitta_rows
    set -l words (commandline -opc)
    $words[1] $words[2] --help options 2>/dev/null
end

# What may stand at the cursor, each with its help behind a tab.
function __sagitta_words
    set -l words (commandline -opc)
    set -l before $words[-1]
    test "$before" = -o; and set before --output
    if test (count $words) -eq 1
        $words[1] --help options 2>/dev/null
        printf '%s\n' --help --version
        return
    end
    for row in (__sagitta_rows)
        set -l field (string split \t -- $row)
        test "$field[1]" = "$before"; or continue
        test "$before" = --help; and set field[3] "all options"
        if test "$before" = --columns; and test "$field[3]" != - # a list with commas
            set -l begun (string match -r '^.*,' -- (commandline -ct))
            printf '%s\n' "$begun"(string split ' ' -- $field[3])
            return
        end
        if test "$before" = --surface; and test "$field[3]" != - # a type, in a map
            printf '{type: %s}\n' (string split ' ' -- $field[3])
            return
        end
        if test "$field[3]" != -
            string split ' ' -- $field[3]
            return
        end
        switch "$field[2]"
            case -
            case FILE PATH LENS NEW PART
                __fish_complete_path (commandline -ct)
                return
            case '*'
                return
        end
    end
    if string match -q -- '-*' (commandline -ct)
        for row in (__sagitta_rows)
            set -l field (string split \t -- $row)
            printf '%s\t%s\n' $field[1] $field[4]
        end
    else
        __fish_complete_path (commandline -ct)
    end
end

complete -c sagitta -f -a '(__sagitta_words)'
