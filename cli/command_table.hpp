#pragma once
#include <string>
#include <vector>

#include "core/options.hpp"

namespace flowcage {

/// One row of the table of commands: the command line, its help, the shells' completion and the manual page
/// come from it and from option_table().
struct CommandSpec {
  Command command;
  std::string name, summary;
  std::string input_name, input_help;    ///< of the arguments; empty: the command takes none
  std::string output_name, output_help;  ///< of -o; empty: the command has no -o
  std::string example;
  bool many_inputs = false;

  /// Whether --out-dir can stand for -o.
  bool has_out_dir() const { return command == Command::mesh; }
};

/// Every command, in the order of the help.
const std::vector<CommandSpec>& command_table();

/// The meaning of an option with range, unit and default: "... [0 < T <= 1; default: 0.0001]".
std::string option_notes(const OptionSpec& row);

/// The words that an option takes ("box", "sphere", "bullet"); empty where its value is free.
std::vector<std::string> option_choices(const OptionSpec& row);

/// Whether an option's value is a file or a folder.
bool takes_file(const OptionSpec& row);

}  // namespace flowcage
