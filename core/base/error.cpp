#include "core/base/error.hpp"

#include <fmt/format.h>

namespace flowcage {

Error::Error(ErrorKind kind, const std::string& what, std::string remedy)
    : std::runtime_error(what), kind_(kind), remedy_(std::move(remedy)) {}

Error input_error(const std::string& file, long line, const std::string& what, std::string remedy) {
  const std::string where = line > 0 ? fmt::format("{}:{}", file, line) : file;
  return {ErrorKind::input, fmt::format("{}: {}", where, what), std::move(remedy)};
}

std::string place(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

}  // namespace flowcage
