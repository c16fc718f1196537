#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/options.hpp"

namespace flowcage {

/// What the program was asked to do.
struct Request {
  std::optional<Command> command;  ///< none: only `text` is to be printed
  Options options;
  std::string text;  ///< of --help or --version
};

/// Reads the command line (without the program's name). Options come from option_table().
/// Throws Error(usage); an unknown word gets a "did you mean".
/// The file of --config is read as well: Error(input).
Request parse_command_line(const std::vector<std::string>& arguments);

/// "flowcage 0.1.0" and a line for each library whose version matters.
std::string version_text();

}  // namespace flowcage
