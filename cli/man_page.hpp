#pragma once
#include <string>

namespace flowcage {

/// The manual page flowcage(1) in the man(7) macros, made from command_table() and option_table().
std::string man_page();

}  // namespace flowcage
