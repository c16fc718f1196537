#pragma once
#include <string>

namespace flowcage {

/// The script that teaches a shell ("bash", "zsh" or "fish") the commands, their options, and the values of
/// those that have a choice; files are offered where files are meant. Made from command_table() and
/// option_table(). Throws Error(usage) for another shell.
std::string completion_script(const std::string& shell);

}  // namespace flowcage
