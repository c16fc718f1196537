#include "core/cage/write_cage.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "core/base/atomic_file.hpp"

namespace flowcage {
namespace {

std::string legal_name(std::string name) {
  char before = ' ';
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
    if (c == '#' && before == ' ') c = '_';  // would start a comment
    before = c;
  }
  if (name.ends_with('\\')) name.back() = '_';  // would continue the line
  return name;
}

}  // namespace

void write_cage(const Cage& cage, std::ostream& out) {
  fmt::memory_buffer text;
  const auto append = [&text]<typename... Args>(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
  };
  const auto flush = [&](std::size_t above) {
    if (text.size() <= above) return;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  };
  constexpr std::size_t block = std::size_t{1} << 16;

  for (const Vec3& p : cage.points) {
    append("v {} {} {}\n", p.x(), p.y(), p.z());  // the shortest digits that give the same double
    flush(block);
  }
  Index patch = no_index;
  for (Index f = 0; f < cage.faces.size(); ++f) {
    if (!cage.face_patch.empty() && cage.face_patch[f] != patch) {
      const bool first = patch == no_index;
      patch = cage.face_patch[f];
      const std::string name = legal_name(cage.patch_names[patch]);
      if (!name.empty()) append("g {}\n", name);
      if (name.empty() && !first) append("g\n");
    }
    append("f");
    for (const Index v : cage.faces[f]) append(" {}", v + 1);
    append("\n");
    flush(block);
  }
  for (const Cage::Crease& crease : cage.creases) {
    append("t crease 2/1/0 {} {} {}\n", crease.a, crease.b, crease.sharpness);
    flush(block);
  }
  for (const Cage::Corner& corner : cage.corners) {
    append("t corner 1/1/0 {} {}\n", corner.vertex, corner.sharpness);
    flush(block);
  }
  flush(0);
}

void write_cage(const Cage& cage, const std::filesystem::path& file) {
  AtomicFile target(file);
  write_cage(cage, target.stream());
  target.commit();
}

}  // namespace flowcage
