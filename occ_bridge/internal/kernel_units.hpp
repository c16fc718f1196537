#pragma once
#include <map>
#include <string>

#include "core/base/error.hpp"

namespace flowcage {

/// The name that the kernel's writers know m, mm, in or ft by. Throws Error(usage) for another unit.
inline std::string kernel_unit(const std::string& unit) {
  static const std::map<std::string, std::string> names{
      {"m", "M"}, {"mm", "MM"}, {"in", "INCH"}, {"ft", "FT"}};
  const auto known = names.find(unit);
  if (known == names.end()) throw Error(ErrorKind::usage, "unknown unit " + unit, "use m, mm, in or ft");
  return known->second;
}

}  // namespace flowcage
