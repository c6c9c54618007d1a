# Completion of relamp for bash. Verbs are known; options are asked of the program itself.
_relamp() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb="" i
    local verbs="check plan solve render export paint compare report merge-hdr scan stress info edit"
    for ((i = 1; i < COMP_CWORD; i++)); do
        [[ " $verbs " == *" ${COMP_WORDS[i]} "* ]] && verb=${COMP_WORDS[i]} && break
    done
    COMPREPLY=()
    case $before in
        --quality) mapfile -t COMPREPLY < <(compgen -W "draft standard fine" -- "$word") && return ;;
        --mode) mapfile -t COMPREPLY < <(compgen -W "near-field distant-only" -- "$word") && return ;;
        --bounce | --against-distant) mapfile -t COMPREPLY < <(compgen -W "auto on off" -- "$word") && return ;;
        --ratio) mapfile -t COMPREPLY < <(compgen -W "quotient difference" -- "$word") && return ;;
        --naming) mapfile -t COMPREPLY < <(compgen -W "blender arnold" -- "$word") && return ;;
        --view) mapfile -t COMPREPLY < <(compgen -W "standard auto raw" -- "$word") && return ;;
        --progress) mapfile -t COMPREPLY < <(compgen -W "auto bar json none" -- "$word") && return ;;
        --basis) mapfile -t COMPREPLY < <(compgen -W "built-in wide lambert" -- "$word") && return ;;
        --photometric) mapfile -t COMPREPLY < <(compgen -W "auto off" -- "$word") && return ;;
        --layers)
            mapfile -t COMPREPLY < <(compgen -W "all groups albedo correction residual normal position depth \
                cryptomatte" -- "$word") && return ;;
    esac
    if [[ -z $verb && $word != -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$verbs" -- "$word")
    elif [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" $verb --help 2>/dev/null |
            grep -oE -- '--[a-z][a-z-]*' | sort -u)" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    fi
}
complete -o filenames -F _relamp relamp

_relamp_editor() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
    COMPREPLY=()
    case $before in
        --quality) mapfile -t COMPREPLY < <(compgen -W "draft standard fine" -- "$word") && return ;;
        --gpu) mapfile -t COMPREPLY < <(compgen -W "auto on off" -- "$word") && return ;;
    esac
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "--solve --quality --scale --width --height --gpu --help --version" \
            -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -d -- "$word")
    fi
}
complete -o filenames -F _relamp_editor relamp-editor
