#include "cli/man_page.hpp"

#include <fmt/format.h>

#include <iterator>

#include "cli/command_table.hpp"

namespace flowcage {
namespace {

/// When the page's own text last changed: its tables change with the program.
constexpr const char* page_date = "2026-11-30";

/// Text that roff shows as it is.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '~':
        out += "\\(ti";
        break;
      default:
        out += c;
    }
  }
  return out.empty() || (out[0] != '.' && out[0] != '\'') ? out : "\\&" + out;
}

/// "--snap, --no-snap" or "--levels N", bold and italic.
std::string heading(const OptionSpec& row) {
  std::string out = "\\fB" + roff("--" + row.name) + "\\fR";
  if (row.negatable) out += ", \\fB" + roff("--no-" + row.name) + "\\fR";
  if (!row.is_flag()) out += " \\fI" + roff(row.value_name) + "\\fR";
  return out;
}

std::string commands_of(const OptionSpec& row) {
  std::string out;
  for (const CommandSpec& spec : command_table()) {
    if (row.belongs_to(spec.command)) out += (out.empty() ? "" : ", ") + spec.name;
  }
  return out;
}

struct ExitCode {
  int code;
  const char* meaning;
};
constexpr ExitCode exit_codes[]{
    {0, "Done; every gate holds."},
    {2, "Wrong usage: unknown option, missing argument, impossible value."},
    {3, "An input cannot be read or is not usable."},
    {4, "A mesh was made but misses a gate; nothing is written at OUT without --force."},
    {5, "Cannot write; no partial file stays."},
    {70, "A defect of flowcage, or out of memory."},
    {130, "Interrupted; no partial file stays."}};

}  // namespace

std::string man_page() {
  std::string out = fmt::format(
      ".TH FLOWCAGE 1 {} \"flowcage {}\" \"User Commands\"\n.SH NAME\nflowcage \\- CAD to all\\-hexahedral "
      "block\\-structured meshes for flow simulation\n.SH SYNOPSIS\n",
      page_date, FLOWCAGE_VERSION);
  const auto append = std::back_inserter(out);
  bool first = true;
  for (const CommandSpec& spec : command_table()) {
    if (!first) out += ".br\n";
    first = false;
    fmt::format_to(append, "\\fBflowcage {}\\fR", spec.name);
    if (!spec.input_name.empty()) {
      fmt::format_to(append, " \\fI{}\\fR{}", spec.input_name, spec.many_inputs ? " ..." : "");
    }
    if (!spec.output_name.empty()) fmt::format_to(append, " \\fB\\-o\\fR \\fI{}\\fR", spec.output_name);
    out += " [\\fIoptions\\fR]\n";
  }
  out += ".SH COMMANDS\n";
  for (const CommandSpec& spec : command_table()) {
    fmt::format_to(append, ".TP\n\\fB{}\\fR\n{}.\n", spec.name, roff(spec.summary));
    if (!spec.input_name.empty()) {
      fmt::format_to(append, "\\fI{}\\fR: {}.\n", spec.input_name, roff(spec.input_help));
    }
    if (!spec.output_name.empty()) {
      fmt::format_to(append, "\\fI{}\\fR: {}.\n", spec.output_name, roff(spec.output_help));
    }
  }
  out += ".SH OPTIONS\n";
  std::string group;
  for (const OptionSpec& row : option_table()) {
    if (row.group != group) fmt::format_to(append, ".SS {}\n", roff(group = row.group));
    fmt::format_to(append, ".TP\n{}\n{}.\n({})\n", heading(row), roff(option_notes(row)),
                   roff(commands_of(row)));
  }
  out += ".SH EXIT STATUS\n";
  for (const ExitCode& code : exit_codes) {
    fmt::format_to(append, ".TP\n\\fB{}\\fR\n{}\n", code.code, roff(code.meaning));
  }
  out += ".SH EXAMPLES\n";
  for (const CommandSpec& spec : command_table()) {
    fmt::format_to(append, ".TP\n{}:\n{}\n", roff(spec.summary), roff(spec.example));
  }
  return out;
}

}  // namespace flowcage
