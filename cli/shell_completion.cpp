#include "cli/shell_completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "cli/command_table.hpp"
#include "core/base/error.hpp"
#include "core/base/suggestion.hpp"

namespace flowcage {
namespace {

using Words = std::vector<std::string>;

/// The words between single quotes that a shell takes as they are; `quote`: how it writes a single quote.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? quote : std::string(1, c);
  return out + "'";
}

/// Calls use(row, name) for every long option of a command, --no- forms included.
void for_options(const CommandSpec& spec,
                 const std::function<void(const OptionSpec&, const std::string&)>& use) {
  for (const OptionSpec& row : option_table()) {
    if (!row.belongs_to(spec.command)) continue;
    use(row, row.name);
    if (row.negatable) use(row, "no-" + row.name);
  }
}

Words input_words(const CommandSpec& spec) {
  return spec.command == Command::completion ? Words{"bash", "zsh", "fish"} : Words{};
}

Words command_names() {
  Words names;
  for (const CommandSpec& spec : command_table()) names.push_back(spec.name);
  return names;
}

std::string bash_script() {
  std::string options, values, inputs;
  for (const CommandSpec& spec : command_table()) {
    Words names{"--help"};
    if (!spec.output_name.empty()) names.insert(names.end(), {"-o", "--output"});
    for_options(spec, [&](const OptionSpec&, const std::string& name) { names.push_back("--" + name); });
    options += fmt::format("      {}) words=\"{}\" ;;\n", spec.name, fmt::join(names, " "));
    const Words words = input_words(spec);
    if (!words.empty()) inputs += fmt::format("    {}) words=\"{}\" ;;\n", spec.name, fmt::join(words, " "));
    if (spec.input_name.empty()) inputs += fmt::format("    {}) return ;;\n", spec.name);
  }
  for (const OptionSpec& row : option_table()) {
    if (row.is_flag() || takes_file(row)) continue;
    values += fmt::format("    --{}) COMPREPLY=($(compgen -W \"{}\" -- \"$cur\")); return ;;\n", row.name,
                          fmt::join(option_choices(row), " "));
  }
  return fmt::format(R"(# bash completion of flowcage, made by `flowcage completion bash`
_flowcage() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}} words=""
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "{} --help --version" -- "$cur"))
    return
  fi
  case $prev in
    -o | --output) COMPREPLY=($(compgen -f -- "$cur")); return ;;
{}  esac
  if [[ $cur == -* ]]; then
    case $command in
{}    esac
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
    return
  fi
  case $command in
{}    *) COMPREPLY=($(compgen -f -- "$cur")); return ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
}}
complete -o filenames -F _flowcage flowcage
)",
                     fmt::join(command_names(), " "), values, options, inputs);
}

/// A text inside of an _arguments specification.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(const OptionSpec& row) {
  const Words words = option_choices(row);
  if (!words.empty()) return fmt::format("({})", fmt::join(words, " "));
  return takes_file(row) ? "_files" : " ";
}

std::string zsh_script() {
  const auto quote = [](const std::string& text) { return quoted(text, "'\\''"); };
  std::string commands, cases;
  for (const CommandSpec& spec : command_table()) {
    commands += fmt::format("    {}\n", quote(zsh_text(spec.name) + ":" + spec.summary));
    Words arguments{"--help[this command's options]"};
    if (!spec.output_name.empty()) {
      arguments.push_back(
          fmt::format("*--output[{}]:{}:_files", zsh_text(spec.output_help), spec.output_name));
      arguments.push_back(fmt::format("*-o[{}]:{}:_files", zsh_text(spec.output_help), spec.output_name));
    }
    for_options(spec, [&](const OptionSpec& row, const std::string& name) {
      const std::string start = fmt::format("{}--{}", row.repeatable ? "*" : "", name);
      if (row.is_flag()) {
        arguments.push_back(fmt::format("{}[{}]", start, zsh_text(row.help)));
      } else {
        arguments.push_back(fmt::format("{}=[{}]:{}:{}", start, zsh_text(row.help), zsh_text(row.value_name),
                                        zsh_action(row)));
      }
    });
    const Words words = input_words(spec);
    if (!spec.input_name.empty()) {
      const std::string action = words.empty() ? "_files" : fmt::format("({})", fmt::join(words, " "));
      arguments.push_back(fmt::format("*:{}:{}", spec.input_name, action));
    }
    cases += fmt::format("    {})\n      _arguments \\\n", spec.name);
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      cases += fmt::format("        {}{}\n", quote(arguments[i]), i + 1 < arguments.size() ? " \\" : "");
    }
    cases += "      ;;\n";
  }
  return fmt::format(R"(#compdef flowcage
# zsh completion of flowcage, made by `flowcage completion zsh`
_flowcage() {{
  local -a commands
  commands=(
{})
  if ((CURRENT == 2)); then
    _describe -t commands command commands
    _arguments '--help[commands and options]' '--version[versions of flowcage and its libraries]'
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
if [[ $funcstack[1] == _flowcage ]]; then
  _flowcage "$@"
else
  compdef _flowcage flowcage
fi
)",
                     commands, cases);
}

std::string fish_script() {
  const auto quote = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('\\', at)) != std::string::npos; at += 2)
      text.insert(at, 1, '\\');
    return quoted(text, "\\'");
  };
  std::string out =
      "# fish completion of flowcage, made by `flowcage completion fish`\n"
      "complete -c flowcage -n __fish_use_subcommand -f\n"
      "complete -c flowcage -n __fish_use_subcommand -l help -d 'commands and options'\n"
      "complete -c flowcage -n __fish_use_subcommand -l version -d 'versions of flowcage and its "
      "libraries'\n";
  const auto append = std::back_inserter(out);
  for (const CommandSpec& spec : command_table()) {
    fmt::format_to(append, "complete -c flowcage -n __fish_use_subcommand -f -a {} -d {}\n", spec.name,
                   quote(spec.summary));
    const std::string here =
        fmt::format("complete -c flowcage -n '__fish_seen_subcommand_from {}'", spec.name);
    fmt::format_to(append, "{} -l help -d \"this command's options\"\n", here);
    if (!spec.output_name.empty()) {
      fmt::format_to(append, "{} -s o -l output -r -d {}\n", here, quote(spec.output_help));
    }
    const Words words = input_words(spec);
    if (!words.empty() || spec.input_name.empty()) {
      fmt::format_to(append, "{} -f -a {}\n", here, quote(fmt::format("{}", fmt::join(words, " "))));
    }
    for_options(spec, [&](const OptionSpec& row, const std::string& name) {
      const Words choices = option_choices(row);
      std::string value;
      if (!row.is_flag()) value = takes_file(row) ? " -r" : " -x";
      if (!choices.empty()) value += " -a " + quote(fmt::format("{}", fmt::join(choices, " ")));
      fmt::format_to(append, "{} -l {}{} -d {}\n", here, name, value, quote(row.help));
    });
  }
  return out;
}

}  // namespace

std::string completion_script(const std::string& shell) {
  if (shell == "bash") return bash_script();
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_script();
  const std::string meant = suggestion(shell, {"bash", "zsh", "fish"});
  throw Error(ErrorKind::usage, fmt::format("there is no completion for the shell \"{}\"", shell),
              meant.empty() ? "give bash, zsh or fish" : fmt::format("did you mean {}?", meant));
}

}  // namespace flowcage
