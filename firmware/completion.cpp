#include "firmware/completion.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace touchline {
namespace {

enum class ValueKind : std::uint8_t { kNone, kText, kFile, kFolder, kWords };

struct Value {
  ValueKind kind = ValueKind::kNone;
  bool is_optional = false;
  std::string type;                // the type that the help shows
  std::vector<std::string> words;  // the words to choose from, if the kind is kWords
  bool continues = false;          // more text follows the word directly, without a blank
};

// Splits a type name: "{a,b}=MS" gives the words "a=" and "b=", which MS follows.
Value words_of_type(const std::string& type, std::size_t open) {
  const std::size_t close = type.find('}', open);
  const bool needs_value = type.compare(close + 1, 1, "=") == 0;
  Value value{ValueKind::kWords, false, "", {}, close + 1 < type.size()};
  for (std::size_t from = open + 1; from < close;) {
    const std::size_t end = std::min(type.find(',', from), close);
    value.words.push_back(type.substr(from, end - from) + (needs_value ? "=" : ""));
    from = end + 1;
  }
  return value;
}

Value value_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {};
  const std::string type = option.get_type_name();
  const auto begins = [&](std::string_view word) {
    return type.substr(type.starts_with('[') ? 1 : 0).starts_with(word);
  };
  Value value{ValueKind::kText, false, "", {}, false};
  if (const std::size_t open = type.find('{'); open != std::string::npos && type.find('}', open) != std::string::npos) {
    value = words_of_type(type, open);
  } else if (begins("FILE") || begins("PATH") || begins("DEVICE")) {
    value.kind = ValueKind::kFile;
  } else if (begins("DIR")) {
    value.kind = ValueKind::kFolder;
  }
  value.is_optional = option.get_items_expected_min() == 0;
  value.type = type;
  return value;
}

bool is_hidden(const CLI::Option& option) { return option.get_group().empty(); }

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<const CLI::Option*> options_shown(const CLI::App& app) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : app.get_options()) {
    if (option->nonpositional() && !is_hidden(*option)) options.push_back(option);
  }
  return options;
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& app) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->nonpositional() && !is_hidden(*option)) options.push_back(option);
  }
  return options;
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : separator).append(word);
  return text;
}

// Returns the program's name as a function's name: not every shell permits the hyphen of "touchline-calibrate".
std::string function_name(const CLI::App& program) {
  std::string name = "_" + program.get_name();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// Returns the first line of an explanation, up to the end of its first clause.
std::string brief(std::string text) {
  text = text.substr(0, text.find('\n'));
  for (const char* end : {". ", ": ", "; ", " ("}) text = text.substr(0, text.find(end));
  while (text.ends_with(',') || text.ends_with('.')) text.pop_back();
  return text;
}

// Escapes a text for use between single quotes in a shell.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return "'" + out + "'";
}

// Returns the bash statement that sets the possible values.
std::string bash_value(const Value& value) {
  switch (value.kind) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kText:
      return "kind=text";
    case ValueKind::kFile:
      return "kind=file";
    case ValueKind::kFolder:
      return "kind=folder";
    case ValueKind::kWords:
      return "kind=words words=" + quoted(joined(value.words, " ")) + (value.continues ? " ends=nospace" : "");
  }
  return "";
}

// Returns the bash code that completes the values of a command's options.
std::string bash_option_values(const CLI::App& app, const std::string& command) {
  std::string cases;
  for (const CLI::Option* option : options_shown(app)) {
    const Value value = value_of(*option);
    // If the value may be missing, anything can follow the option.
    if (value.kind == ValueKind::kNone || (value.is_optional && value.kind == ValueKind::kText)) continue;
    std::string patterns;
    for (const std::string& name : names_of(*option)) {
      patterns.append(patterns.empty() ? "'" : " | '").append(command).append(" ").append(name).append("'");
    }
    cases.append("    ").append(patterns).append(") ").append(bash_value(value)).append(" ;;\n");
  }
  return cases;
}

// Returns bash code that offers the command's option names and completes its positional arguments.
std::string bash_words(const CLI::App& app, const std::string& command) {
  std::vector<std::string> options;
  for (const CLI::Option* option : options_shown(app)) {
    for (const std::string& name : names_of(*option)) options.push_back(name);
  }
  std::string text = "    '" + command + "')\n        options=" + quoted(joined(options, " ")) + "\n";
  const std::vector<const CLI::Option*> positionals = positionals_of(app);
  Value value = positionals.empty() ? Value{} : value_of(*positionals.front());
  if (const std::vector<const CLI::App*> commands = app.get_subcommands(nullptr); !commands.empty()) {
    value.kind = ValueKind::kWords;
    for (const std::string& name : names_of(commands)) value.words.push_back(name);
  }
  const std::string other = bash_value(value);
  if (!other.empty()) text += "        [[ $kind ]] || { " + other + "; }\n";
  return text + "        ;;\n";
}

// Returns the action in "[help]:type:action" of zsh's _arguments.
std::string zsh_action(const Value& value) {
  switch (value.kind) {
    case ValueKind::kNone:
    case ValueKind::kText:
      return "";
    case ValueKind::kFile:
      return "_files";
    case ValueKind::kFolder:
      return "_files -/";
    case ValueKind::kWords:
      return value.continues ? "{compadd -S \"\" -- " + joined(value.words, " ") + "}"
                             : "(" + joined(value.words, " ") + ")";
  }
  return "";
}

std::string zsh_escaped(const std::string& text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

// Returns one argument of zsh's _arguments.
std::string zsh_argument(const std::string& argument, const std::string& indent) {
  return " \\\n" + indent + quoted(argument);
}

// Returns the arguments of zsh's _arguments for the options of a command.
std::string zsh_options(const CLI::App& app, const std::string& indent) {
  std::string text;
  for (const CLI::Option* option : options_shown(app)) {
    const Value value = value_of(*option);
    const bool repeats =
        option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll || option->get_expected_max() > 1;
    for (const std::string& name : names_of(*option)) {
      std::string argument = (repeats ? "*" : "") + name;
      if (value.kind != ValueKind::kNone && name.starts_with("--")) argument += "=";
      argument += "[" + zsh_escaped(brief(option->get_description()), "\\[]") + "]";
      if (value.kind != ValueKind::kNone) {
        argument += value.is_optional ? "::" : ":";
        argument +=
            zsh_escaped(value.kind == ValueKind::kWords ? "choice" : value.type, "\\:") + ":" + zsh_action(value);
      }
      text += zsh_argument(argument, indent);
    }
  }
  return text;
}

// Returns the arguments of zsh's _arguments for the options and the positional arguments of a command.
std::string zsh_arguments(const CLI::App& app, const std::string& indent) {
  std::string text = zsh_options(app, indent);
  for (const CLI::Option* option : positionals_of(app)) {
    text += zsh_argument((option->get_items_expected_max() > 1 ? "*:" : ":") + zsh_escaped(option->get_name(), "\\:") +
                             ":" + zsh_action(value_of(*option)),
                         indent);
  }
  return text;
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  const std::string &name = program.get_name(), function = function_name(program);
  const std::vector<const CLI::App*> commands = program.get_subcommands(nullptr);
  std::string text = "# Completion of " + name + " for bash, made from its options: " + name + " --completion bash\n" +
                     function + R"(() {
    local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]} command='' options='' kind='' words='' ends='' i
    # Bash takes --option=value for three words.
    if [[ $word == '=' ]]; then
        word=''
    elif [[ $option == '=' ]]; then
        option=${COMP_WORDS[COMP_CWORD-2]}
    fi
)";
  if (!commands.empty()) {
    text += "    for ((i = 1; i < COMP_CWORD; i++)); do\n        case ${COMP_WORDS[i]} in\n        " +
            joined(names_of(commands), " | ") + ") command=${COMP_WORDS[i]} && break ;;\n        esac\n    done\n";
  }
  text += "    case \"$command $option\" in\n" + bash_option_values(program, "");
  for (const CLI::App* command : commands) text += bash_option_values(*command, command->get_name());
  text += "    esac\n    case $command in\n" + bash_words(program, "");
  for (const CLI::App* command : commands) text += bash_words(*command, command->get_name());
  text += R"(    esac
    [[ $word != -* && $kind ]] || kind=words words=$options ends=''
    case $kind in
    file) mapfile -t COMPREPLY < <(compgen -f -- "$word") && compopt -o filenames 2>/dev/null ;;
    folder) mapfile -t COMPREPLY < <(compgen -d -- "$word") && compopt -o filenames 2>/dev/null ;;
    words) mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word") ;;
    *) COMPREPLY=() ;;
    esac
    [[ ! $ends ]] || compopt -o nospace 2>/dev/null
}
complete -F )";
  return text + function + " " + name + "\n";
}

std::string zsh_completion(const CLI::App& program) {
  const std::string &name = program.get_name(), function = function_name(program);
  const std::vector<const CLI::App*> commands = program.get_subcommands(nullptr);
  std::string text = "#compdef " + name + "\n# Completion of " + name + " for zsh, made from its options: " + name +
                     " --completion zsh\n" + function + "() {\n";
  if (commands.empty()) {
    text += "    _arguments -S" + zsh_arguments(program, "        ") + "\n}\n";
  } else {
    text +=
        "    local curcontext=$curcontext context state state_descr\n    local -a line commands\n    typeset -A "
        "opt_args\n"
        "    _arguments -S -C" +
        zsh_options(program, "        ") +
        " \\\n        '1:command:->command' '*::argument:->argument'\n"
        "    case $state in\n    command)\n        commands=(\n";
    for (const CLI::App* command : commands) {
      text += "            " + quoted(command->get_name() + ":" + brief(command->get_description())) + "\n";
    }
    // A program with commands may do something else if the first word is none of them.
    for (const CLI::Option* option : positionals_of(program)) {
      for (const std::string& word : value_of(*option).words) text += "            " + quoted(word) + "\n";
    }
    text +=
        "        )\n        _describe -t commands command commands\n        ;;\n    argument)\n        case $words[1] "
        "in\n";
    for (const CLI::App* command : commands) {
      text += "        " + command->get_name() + ")\n            _arguments -S" +
              zsh_arguments(*command, "                ") + "\n            ;;\n";
    }
    text += "        *)\n            _arguments -S" + zsh_options(program, "                ") +
            "\n            ;;\n        esac\n        ;;\n    esac\n}\n";
  }
  // The script may be called as a function that zsh found in fpath, or read with `source`.
  return text + "if [[ ${funcstack[1]} == _" + name + " ]]; then\n    " + function + " \"$@\"\nelse\n    compdef " +
         function + " " + name + "\nfi\n";
}

}  // namespace touchline
