#include "cases/keys/completion.h"

#include <algorithm>
#include <set>

#include "cases/keys/book.h"
#include "geometry/text.h"

namespace flexmorph::cases {
namespace {

using Kind = io::Form::Kind;

/// A key that can be set on the command line, with its allowed words; none for numbers and texts.
struct Settable {
  std::string key;
  std::vector<std::string> words;
};

std::vector<std::string> text_of(const io::Key& key) {
  std::vector<std::string> out;
  for (const io::Form& form : key.forms) {
    if (form.kind == Kind::boolean) out.insert(out.end(), {"true", "false"});
    if (form.kind != Kind::word || form.is_list) continue;
    for (const std::string& word : form.words()) out.push_back(word);
  }
  return out;
}

std::vector<Settable> settable_keys() {
  std::vector<Settable> out;
  for (const KeyTable& table : key_book())
    for (const std::string& path : table.paths)
      for (const io::Key* key : table.keys) {
        const bool has_value = std::any_of(
            key->forms.begin(), key->forms.end(),
            [](const io::Form& f) { return f.kind != Kind::table && f.kind != Kind::tables; });
        if (!has_value || key->name == "*" || path.find('*') != std::string::npos) continue;
        const std::string full = (path.empty() ? "" : path + ".") + key->name;
        const auto old = std::find_if(out.begin(), out.end(),
                                      [&](const Settable& each) { return each.key == full; });
        Settable& location = old == out.end() ? out.emplace_back() : *old;
        location.key = full;
        for (std::string& word : text_of(*key))
          if (std::find(location.words.begin(), location.words.end(), word) == location.words.end())
            location.words.push_back(std::move(word));
      }
  return out;
}

/// Returns shell functions that print words, for scripts of both shells.
std::string shared_functions(const std::vector<CommandWords>& commands) {
  std::string out = "_flexmorph_candidates() {  # of a key\n  case \"$1\" in\n";
  std::string keys;
  for (const Settable& each : settable_keys()) {
    keys += " " + each.key + "=";
    if (!each.words.empty())
      out += "    " + each.key + ") echo " + joined(each.words, " ") + " ;;\n";
  }
  out += "  esac\n}\n_flexmorph_keys() { echo" + keys + "; }\n";
  out += "_flexmorph_tables() { echo " + joined(key_table_names(), " ") + "; }\n";
  std::string names, options, positionals;
  std::set<std::string> valued;
  for (const CommandWords& command : commands) {
    names += " " + command.name;
    options += "    " + command.name + ") echo " + joined(command.options, " ") + " ;;\n";
    positionals += "    " + command.name + ") echo \"" + command.positional + "\" ;;\n";
    valued.insert(command.valued.begin(), command.valued.end());
  }
  out += "_flexmorph_commands() { echo" + names + " --help --version; }\n";
  out += "_flexmorph_options() {  # of a command\n  case \"$1\" in\n" + options + "  esac\n}\n";
  out += "_flexmorph_follows() {  # a command\n  case \"$1\" in\n" + positionals + "  esac\n}\n";
  out += "_flexmorph_is_valued() {\n  case \"$1\" in\n    " + joined(valued, "|") +
         ") return 0 ;;\n  esac\n  return 1\n}\n";
  return out;
}

constexpr const char* kBash = R"sh(_flexmorph() {
  # Words as they stand on the line: COMP_WORDS are split at "=".
  local line="${COMP_LINE:0:COMP_POINT}" cur prev words found=""
  read -ra words <<< "$line"
  [[ $line == *[[:space:]] ]] && words+=("")
  local n=${#words[@]}
  cur="${words[n-1]}"
  prev="${words[n-2]}"
  COMPREPLY=()
  if ((n == 2)); then
    found="$(_flexmorph_commands)"
  elif [[ $prev == --set || $prev == --vary ]]; then
    if [[ $cur == *=* ]]; then
      local word
      for word in $(_flexmorph_candidates "${cur%%=*}"); do found+=" ${cur%%=*}=$word"; done
    else
      found="$(_flexmorph_keys)"
      compopt -o nospace 2> /dev/null
    fi
  elif [[ $prev == --part && $cur == *=* ]]; then
    COMPREPLY=($(compgen -P "${cur%%=*}=" -f -- "${cur#*=}"))
  elif _flexmorph_is_valued "$prev"; then
    COMPREPLY=($(compgen -f -- "$cur"))
    return
  elif [[ $cur == -* ]]; then
    found="$(_flexmorph_options "${words[1]}")"
  else
    case "$(_flexmorph_follows "${words[1]}")" in
      case)
        found="$("${words[0]}" cases 2> /dev/null | cut -d ' ' -f 1)"
        COMPREPLY=($(compgen -f -X '!*.toml' -- "$cur"))
        ;;
      run) COMPREPLY=($(compgen -d -- "$cur")) ;;
      run_or_case)
        found="$("${words[0]}" cases 2> /dev/null | cut -d ' ' -f 1)"
        COMPREPLY=($(compgen -f -X '!*.toml' -- "$cur") $(compgen -d -- "$cur"))
        ;;
      word) found="$(_flexmorph_tables)" ;;
      shell) found="bash zsh" ;;
    esac
  fi
  COMPREPLY+=($(compgen -W "$found" -- "$cur"))
  # Readline replaces what follows the last "=" only.
  if [[ $cur == *=* && $COMP_WORDBREAKS == *=* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"${cur%"${cur##*=}"}"}")
  fi
}
complete -F _flexmorph flexmorph
)sh";

constexpr const char* kZsh = R"sh(_flexmorph() {
  local before="${words[CURRENT-1]}"
  if ((CURRENT == 2)); then
    compadd -- $(_flexmorph_commands)
  elif [[ $before == --set || $before == --vary ]]; then
    if [[ $PREFIX == *=* ]]; then
      local key="${PREFIX%%=*}"
      compset -P '*='
      compadd -- $(_flexmorph_candidates "$key")
    else
      compadd -S '' -- $(_flexmorph_keys)
    fi
  elif [[ $before == --part ]]; then
    compset -P '*='
    _files
  elif _flexmorph_is_valued "$before"; then
    _files
  elif [[ $PREFIX == -* ]]; then
    compadd -- $(_flexmorph_options "${words[2]}")
  else
    case "$(_flexmorph_follows "${words[2]}")" in
      case)
        compadd -- $("${words[1]}" cases 2> /dev/null | cut -d ' ' -f 1)
        _files -g '*.toml'
        ;;
      run) _files -/ ;;
      run_or_case)
        compadd -- $("${words[1]}" cases 2> /dev/null | cut -d ' ' -f 1)
        _files -/
        _files -g '*.toml'
        ;;
      word) compadd -- $(_flexmorph_tables) ;;
      shell) compadd -- bash zsh ;;
    esac
  fi
}
compdef _flexmorph flexmorph
)sh";

}  // namespace

std::string completion_script(const std::string& shell, const std::vector<CommandWords>& commands) {
  return "# Completion of flexmorph for " + shell + ": source <(flexmorph completion " + shell +
         ")\n" + shared_functions(commands) + (shell == "zsh" ? kZsh : kBash);
}

}  // namespace flexmorph::cases
