#pragma once
#include <functional>
#include <string>

#include "core/options.hpp"

namespace flowcage {

/// Options of a command in a TOML file: long names as keys ("first-height = 1e-5"), numbers, true or false
/// for flags ("snap = false" is --no-snap), text in quotes, a list where an option may be repeated. Names of
/// files count from the working folder, as on the command line. Inputs and -o are not part of it.

/// Sets what options.config names, except where `given` says that the command line has it. Every value is
/// checked, those that the command line replaces too. Throws Error(input) with file and line: no TOML, an
/// unknown key ("did you mean"), a wrong type, a value out of range.
void read_config(Command command, const std::function<bool(const OptionSpec&)>& given, Options& options);

/// The options in force as such a file: reading it back gives the same options.
std::string config_text(Command command, const Options& options);

}  // namespace flowcage
