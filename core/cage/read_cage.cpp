#include "core/cage/read_cage.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <system_error>

#include "core/base/error.hpp"
#include "core/cage/orient_faces.hpp"
#include "core/mesh/manifold_check.hpp"

namespace flowcage {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{1} << 30;
constexpr std::string_view blanks = " \t\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// Takes the next word off the front of `rest`; empty at the end.
std::string_view next_word(std::string_view& rest) {
  rest = trimmed(rest);
  const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
  rest.remove_prefix(word.size());
  return word;
}

/// How a message shows a piece of the file: short and printable.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > 40 ? "...\"" : "\"");
}

/// Logical lines of a text: comments removed, continued lines joined.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line that is not empty, trimmed; valid until the next call.
  std::optional<std::string_view> next() {
    while (!rest_.empty()) {
      line_ = next_physical_line_;
      std::string_view line = take_physical_line();
      if (line.ends_with('\\')) {
        joined_.clear();
        while (line.ends_with('\\')) {
          joined_.append(line.substr(0, line.size() - 1)).append(" ");
          line = rest_.empty() ? std::string_view() : take_physical_line();
        }
        line = joined_.append(line);
      }
      line = trimmed(without_comment(line));
      if (!line.empty()) return line;
    }
    return std::nullopt;
  }
  long line() const { return line_; }  ///< where the line that next() returned begins, from 1

 private:
  std::string_view take_physical_line() {
    ++next_physical_line_;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    std::size_t taken = line.size();
    if (end != std::string_view::npos) taken += rest_.substr(end).starts_with("\r\n") ? 2 : 1;
    rest_.remove_prefix(taken);
    return line;
  }
  /// A '#' inside of a word ("wing#1") starts no comment.
  static std::string_view without_comment(std::string_view line) {
    for (std::size_t i = line.find('#'); i != std::string_view::npos; i = line.find('#', i + 1)) {
      if (i == 0 || blanks.find(line[i - 1]) != std::string_view::npos) return line.substr(0, i);
    }
    return line;
  }

  std::string_view rest_;
  std::string joined_;
  long line_ = 0, next_physical_line_ = 1;
};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& source) : lines_(text) { cage_.source = source; }

  /// With `mended`, faces that run against their neighbours are reversed and reported there.
  Cage parse(LintReport* mended) {
    while (const std::optional<std::string_view> line = lines_.next()) {
      std::string_view rest = *line;
      const std::string_view keyword = next_word(rest);
      parse_statement(keyword, rest);
    }
    if (cage_.points.empty() && cage_.faces.size() == 0) {
      throw input_error(cage_.source, 0, "no cage: the file has no vertices and no faces",
                        "a cage is an OBJ file with `v` and `f` lines (docs/cages.md)");
    }
    if (cage_.patch_names.empty()) cage_.patch_names.emplace_back();
    std::optional<CageDefect> defect = find_manifold_defect(cage_);
    if (defect && defect->kind == CageDefect::Kind::inconsistent_faces && mended != nullptr) {
      if (const auto reversed = faces_to_reverse(cage_.faces)) {
        report_reversed(*reversed, *mended);
        reverse_faces(*reversed, cage_.faces);
        defect = find_manifold_defect(cage_);
      }
    }
    if (defect) {
      throw input_error(cage_.source, line_of(*defect), defect->message, defect->remedy);
    }
    return std::move(cage_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, std::string remedy) const {
    throw input_error(cage_.source, lines_.line(), what, std::move(remedy));
  }

  void report_reversed(const std::vector<Index>& faces, LintReport& mended) const {
    LintFinding finding{"face_direction", LintFinding::Severity::mended, {}, {}, {}};
    for (const Index f : faces) {
      Vec3 centre = Vec3::Zero();
      for (const Index v : cage_.faces[f]) centre += cage_.points[v] / cage_.faces.row_size(f);
      finding.places.push_back(centre);
    }
    finding.message = fmt::format(
        "{}:{}: {} face{} ran against the neighbours and {} reversed (the first is face {} at {})",
        cage_.source, face_lines_[faces.front()], faces.size(), faces.size() > 1 ? "s" : "",
        faces.size() > 1 ? "were" : "was", faces.front() + 1, place(finding.places.front()));
    finding.remedy =
        "draw all faces counter-clockwise seen from the fluid (\"recalculate outside\" of a modeller)";
    mended.push_back(std::move(finding));
  }

  void parse_statement(std::string_view keyword, std::string_view rest) {
    static constexpr std::array skipped{"vt",  "vn",     "vp",     "s",          "mtllib",
                                        "p",   "mg",     "bevel",  "c_interp",   "d_interp",
                                        "lod", "usemap", "maplib", "shadow_obj", "trace_obj"};
    static constexpr std::array free_form{"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                          "parm",   "trim", "hole", "scrv", "sp",   "end",   "con"};
    if (keyword == "v") return parse_vertex(rest);
    if (keyword == "f") return parse_face(rest);
    if (keyword == "l") return parse_polyline(rest);
    if (keyword == "t") return parse_tag(rest);
    if (keyword == "g") return set_name(group_, rest);
    if (keyword == "usemtl") return set_name(material_, rest);
    if (keyword == "o") return set_name(object_, rest);
    if (std::find(skipped.begin(), skipped.end(), keyword) != skipped.end()) return;
    if (std::find(free_form.begin(), free_form.end(), keyword) != free_form.end()) {
      fail(fmt::format("free-form geometry ({}) is no part of a cage", quoted(keyword)),
           "export the polyhedron as plain polygons");
    }
    if (keyword.starts_with("ISO-10303-21")) {
      fail("this is a STEP file, no cage", "give it as CAD, and an OBJ file as the cage");
    }
    fail(fmt::format("unknown statement {}", quoted(keyword)),
         "a cage is an OBJ file with `v` and `f` lines (docs/cages.md)");
  }

  double parse_number(std::string_view word, const char* what) const {
    double value = 0;
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (code == std::errc::result_out_of_range) {
      fail(fmt::format("{} {} is outside of the range of double precision", what, quoted(word)),
           "write a number between 1e-307 and 1e307");
    }
    if (code != std::errc() || end != digits.data() + digits.size()) {
      fail(word.empty() ? fmt::format("{} is missing", what)
                        : fmt::format("{} {} is no number", what, quoted(word)),
           "write numbers like -1.25 or 3e-4, separated by spaces");
    }
    if (!std::isfinite(value)) {
      fail(fmt::format("{} {} is not finite", what, quoted(word)), "write finite numbers");
    }
    return value;
  }

  Offset parse_integer(std::string_view word, const char* what) const {
    Offset value = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc() || end != word.data() + word.size()) {
      fail(word.empty() ? fmt::format("{} is missing", what)
                        : fmt::format("{} {} is no whole number", what, quoted(word)),
           "name vertices by whole numbers");
    }
    return value;
  }

  Index checked_index(Offset zero_based, std::string_view word) const {
    if (zero_based < 0 || zero_based >= std::numeric_limits<Index>::max()) {
      fail(fmt::format("vertex {} does not exist", quoted(word)), "name vertices that exist");
    }
    return static_cast<Index>(zero_based);
  }

  /// "a", "a/t", "a//n" or "a/t/n"; negative counts back from the latest vertex.
  Index parse_reference(std::string_view word) const {
    const std::size_t slash = word.find('/');
    const Offset number = parse_integer(word.substr(0, slash), "vertex number");
    if (slash != std::string_view::npos) {
      std::string_view rest = word.substr(slash + 1);
      const std::size_t second = rest.find('/');
      const std::string_view texture = rest.substr(0, second);
      if (!texture.empty() || second == std::string_view::npos) parse_integer(texture, "texture number");
      if (second != std::string_view::npos) parse_integer(rest.substr(second + 1), "normal number");
    }
    if (number == 0) fail("vertex number 0: faces and polylines count from 1", "the first vertex is 1");
    const Offset count = static_cast<Offset>(cage_.points.size());
    return checked_index(number > 0 ? number - 1 : count + number, word);
  }

  void parse_vertex(std::string_view rest) {
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = parse_number(next_word(rest), "coordinate");
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      parse_number(word, "value");
    }
    cage_.points.push_back(point);
    vertex_lines_.push_back(lines_.line());
    check_count(cage_.points.size());
  }

  void parse_face(std::string_view rest) {
    std::vector<Index> face;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      face.push_back(parse_reference(word));
    }
    cage_.faces.push_row(face);
    cage_.face_patch.push_back(current_patch());
    face_lines_.push_back(lines_.line());
    check_count(cage_.faces.values.size());
  }

  void parse_polyline(std::string_view rest) {
    Index previous = no_index;
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const Index vertex = parse_reference(word);
      if (count++ > 0) add_crease({previous, vertex, infinitely_sharp});
      previous = vertex;
    }
    if (count < 2) fail("a polyline of fewer than two vertices", "list the vertices along the crease");
  }

  /// "NAME #ints/#floats/#strings", then so many values: the tags of OpenSubdiv's shapes.
  void parse_tag(std::string_view rest) {
    const std::string_view name = next_word(rest);
    const std::string_view counts = next_word(rest);
    // How the boundary behaves is no choice here: always as an infinitely sharp crease with sharp corners.
    if (name == "interpolateboundary" || name == "facevaryinginterpolateboundary" ||
        name == "facevaryingpropagatecorners") {
      return;
    }
    if (name != "crease" && name != "corner") {
      fail(fmt::format("tag {} is not supported", quoted(name)),
           "only `t crease 2/1/0 A B SHARPNESS` and `t corner 1/1/0 A SHARPNESS` are: remove the line");
    }
    const std::size_t vertices_each = name == "crease" ? 2 : 1;
    const std::size_t first = counts.find('/'), second = counts.find('/', first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos) {
      fail(fmt::format("tag counts {} are malformed", quoted(counts)),
           "write 2/1/0 for a crease, 1/1/0 for a corner");
    }
    const auto count_at = [&](std::size_t begin, std::size_t end, const char* what) {
      const Offset count = parse_integer(counts.substr(begin, end - begin), what);
      if (count < 0 || count > std::numeric_limits<Index>::max()) {
        fail(fmt::format("tag counts {} are out of range", quoted(counts)), "count the values that follow");
      }
      return static_cast<std::size_t>(count);
    };
    const std::size_t integers = count_at(0, first, "number of vertices");
    const std::size_t floats = count_at(first + 1, second, "number of sharpnesses");
    const std::size_t strings = count_at(second + 1, counts.size(), "number of strings");
    const std::size_t tagged = integers / vertices_each;
    if (tagged == 0 || integers % vertices_each != 0 || (floats != 1 && floats != tagged) || strings != 0) {
      fail(fmt::format("tag counts {} do not suit a {}", quoted(counts), name),
           "write 2/1/0 for a crease, 1/1/0 for a corner");
    }
    // Not reserved: the counts may promise more than the line holds.
    std::vector<Index> vertices;
    for (std::size_t i = 0; i < integers; ++i) {
      const std::string_view word = next_word(rest);
      vertices.push_back(checked_index(parse_integer(word, "vertex number of the tag"), word));
    }
    std::vector<double> sharpness;
    for (std::size_t i = 0; i < floats; ++i) {
      const std::string_view word = next_word(rest);
      sharpness.push_back(parse_number(word, "sharpness"));
      if (sharpness.back() < 0) {
        fail(fmt::format("sharpness {} is negative", quoted(word)),
             "give a sharpness of 0 or more; 10 is infinitely sharp");
      }
    }
    if (!trimmed(rest).empty()) {
      fail(fmt::format("{} follows the tag", quoted(trimmed(rest))), "let the counts match the values");
    }
    for (std::size_t i = 0; i < tagged; ++i) {
      const double s = sharpness[floats == 1 ? 0 : i];
      if (name == "crease") {
        add_crease({vertices[2 * i], vertices[2 * i + 1], s});
      } else {
        cage_.corners.push_back({vertices[i], s});
        corner_lines_.push_back(lines_.line());
      }
    }
  }

  void add_crease(const Cage::Crease& crease) {
    cage_.creases.push_back(crease);
    crease_lines_.push_back(lines_.line());
  }

  void set_name(std::string& which, std::string_view rest) {
    which = trimmed(rest);
    patch_is_current_ = false;
  }

  Index current_patch() {
    if (!patch_is_current_) {
      const std::string& name = !group_.empty() ? group_ : !material_.empty() ? material_ : object_;
      const auto [entry, added] = patch_numbers_.try_emplace(name, static_cast<Index>(patch_numbers_.size()));
      if (added) cage_.patch_names.push_back(name);
      current_patch_ = entry->second;
      patch_is_current_ = true;
    }
    return current_patch_;
  }

  void check_count(std::size_t count) const {
    if (count >= static_cast<std::size_t>(std::numeric_limits<Index>::max()) / 4) {
      fail("too many vertices or faces", "a cage is coarse: some ten to some thousand faces");
    }
  }

  long line_of(const CageDefect& defect) const {
    switch (defect.element) {
      case CageDefect::Element::vertex:
        return vertex_lines_[defect.index];
      case CageDefect::Element::face:
        return face_lines_[defect.index];
      case CageDefect::Element::crease:
        return crease_lines_[defect.index];
      case CageDefect::Element::corner:
        return corner_lines_[defect.index];
      case CageDefect::Element::cage:
        break;
    }
    return 0;
  }

  LineReader lines_;
  Cage cage_;
  std::vector<long> vertex_lines_, face_lines_, crease_lines_, corner_lines_;
  std::string group_, material_, object_;
  std::map<std::string, Index> patch_numbers_;
  bool patch_is_current_ = false;
  Index current_patch_ = 0;
};

std::string file_content(const std::filesystem::path& path) {
  const std::string shown_as = path.string();
  const auto fail = [&](int code) {
    throw input_error(shown_as, 0, fmt::format("cannot read: {}", std::generic_category().message(code)),
                      code == EISDIR   ? "give a file, not a folder"
                      : code == EACCES ? "allow reading it"
                                       : "check the name of the file");
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) fail(errno);
  struct stat status {};
  if (::fstat(::fileno(file.get()), &status) != 0) fail(errno);
  if (S_ISDIR(status.st_mode)) fail(EISDIR);
  std::string text;
  std::vector<char> block(std::size_t{1} << 16);
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    text.append(block.data(), count);
    if (text.size() > max_file_bytes) {
      throw input_error(shown_as, 0, "larger than 1 GiB: this is no cage",
                        "a cage is coarse: some ten to some thousand faces");
    }
  }
  if (std::ferror(file.get()) != 0) fail(errno);
  return text;
}

Cage parse(std::string_view text, const std::string& source, LintReport* mended) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    const long line =
        1 + static_cast<long>(std::count(text.begin(), text.begin() + static_cast<long>(zero), '\n'));
    throw input_error(source, line, "binary data, no cage", "a cage is an OBJ text file in ASCII or UTF-8");
  }
  if (trimmed(text).empty()) {
    throw input_error(source, 0, "the file is empty",
                      "a cage is an OBJ file with `v` and `f` lines (docs/cages.md)");
  }
  return ObjParser(text, source).parse(mended);
}

}  // namespace

Cage parse_cage(std::string_view text, const std::string& source) {
  return parse(text, source, nullptr);
}

Cage read_cage(const std::filesystem::path& file) {
  return parse_cage(file_content(file), file.string());
}

MendedCage parse_mended_cage(std::string_view text, const std::string& source) {
  MendedCage result;
  result.cage = parse(text, source, &result.mended);
  return result;
}

MendedCage read_mended_cage(const std::filesystem::path& file) {
  return parse_mended_cage(file_content(file), file.string());
}

Cage scale_cage(Cage cage, double factor) {
  for (Vec3& point : cage.points) {
    point *= factor;
    if (!point.allFinite()) {
      throw input_error(cage.source, 0, fmt::format("a vertex overflows when scaled by {:g}", factor),
                        "check the coordinates and --cage-unit");
    }
  }
  return cage;
}

}  // namespace flowcage
