#include "core/export/read_block_dict.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/patch_names.hpp"

namespace flowcage {
namespace {

constexpr const char* straight = "flowcage reads blocks with straight edges; the walls are fitted to the CAD";

class DictReader {
 public:
  explicit DictReader(const std::filesystem::path& file)
      : name_(file.string()), text_(read_whole_file(file)) {
    advance();
  }

  DictBlocks read() {
    while (!token_.empty()) {
      const std::string key = take();
      if (key == "vertices") {
        read_vertices();
      } else if (key == "blocks") {
        read_blocks();
      } else if (key == "edges") {
        read_edges();
      } else if (key == "boundary") {
        read_boundary();
      } else if (key == "patches") {
        read_old_patches();
      } else if (key == "convertToMeters" || key == "scale") {
        scale_ = take_real();
        if (!(scale_ > 0)) fail(fmt::format("{} must be positive", key), "give metres a unit of the file");
        in_metres_ = true;
        expect(";");
      } else if (key == "defaultPatch") {
        read_default_patch();
      } else if (key == "faces" || key == "mergePatchPairs") {
        expect("(");
        if (token_ != ")") fail(fmt::format("{} are not read", key), straight);
        advance();
        skip_semicolon();
      } else {
        skip_value(key);
      }
    }
    return finished();
  }

 private:
  void read_vertices() {
    expect("(");
    while (!accept(")")) {
      if (token_ != "(") fail(fmt::format("a vertex (x y z) is expected, not \"{}\"", token_), straight);
      points_.push_back(take_point());
    }
    skip_semicolon();
  }

  Vec3 take_point() {
    expect("(");
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = take_real();
    expect(")");
    return p;
  }

  void read_blocks() {
    expect("(");
    while (!accept(")")) {
      if (token_ != "hex") fail(fmt::format("a block \"hex\" is expected, not \"{}\"", token_), straight);
      advance();
      hexes_.push_back(take_vertices<8>());
      if (token_ != "(") advance();  // a zone's name
      expect("(");
      for (int a = 0; a < 3; ++a) {
        const double cells = take_real();
        if (!(cells >= 1) || cells != std::floor(cells)) {
          fail("a number of cells is expected", "give whole numbers from 1 on: (nx ny nz)");
        }
        divided_ = divided_ || cells > 1;
      }
      expect(")");
      if (token_ == "simpleGrading" || token_ == "edgeGrading") advance();
      if (token_ == "(") graded_ = skip_list() || graded_;
    }
    skip_semicolon();
  }

  void read_edges() {
    expect("(");
    while (!accept(")")) {
      const std::string kind = token_;
      if (kind != "line") {
        fail(fmt::format("the edge is \"{}\": only straight edges are read", kind),
             "leave curved edges out: the walls are fitted to the CAD");
      }
      advance();
      for (int end = 0; end < 2; ++end) take_vertex();
    }
    skip_semicolon();
  }

  void read_boundary() {
    expect("(");
    while (!accept(")")) {
      BoundaryPatch patch;
      patch.name = take();
      std::string type;
      expect("{");
      while (!accept("}")) {
        const std::string key = take();
        if (key == "type") {
          type = take();
          expect(";");
        } else if (key == "faces") {
          patch.quads = take_quads();
          skip_semicolon();
        } else {
          skip_value(key);
        }
      }
      patch.type = type_of(type, patch.name);
      patches_.push_back(std::move(patch));
    }
    skip_semicolon();
  }

  /// TYPE NAME (faces) ...
  void read_old_patches() {
    expect("(");
    while (!accept(")")) {
      const std::string type = take();
      BoundaryPatch patch;
      patch.name = take();
      patch.quads = take_quads();
      patch.type = type_of(type, patch.name);
      patches_.push_back(std::move(patch));
    }
    skip_semicolon();
  }

  void read_default_patch() {
    expect("{");
    std::string type;
    while (!accept("}")) {
      const std::string key = take();
      const std::string value = take();
      if (key == "name") default_.name = value;
      if (key == "type") type = value;
      expect(";");
    }
    default_.type = type_of(type, default_.name);
    skip_semicolon();
  }

  std::vector<std::array<Index, 4>> take_quads() {
    std::vector<std::array<Index, 4>> quads;
    expect("(");
    while (!accept(")")) quads.push_back(take_vertices<4>());
    return quads;
  }

  static PatchType type_of(const std::string& type, const std::string& name) {
    if (type == "wall") return PatchType::wall;
    if (type == "symmetryPlane" || type == "symmetry") return PatchType::symmetry;
    const PatchType by_name = foreign_patch_type(name);
    return by_name == PatchType::wall ? PatchType::farfield : by_name;
  }

  template <std::size_t N>
  std::array<Index, N> take_vertices() {
    std::array<Index, N> row{};
    expect("(");
    for (Index& v : row) v = take_vertex();
    expect(")");
    return row;
  }

  /// Vertices come before all that uses them, as blockMesh asks.
  Index take_vertex() {
    const std::string word = token_;
    Index v = no_index;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
    if (error != std::errc() || end != word.data() + word.size()) {
      fail(fmt::format("the number of a vertex is expected, not \"{}\"", word), straight);
    }
    if (v < 0 || v >= static_cast<Index>(points_.size())) {
      fail(fmt::format("there is no vertex {}: the file has {} before this line", word, points_.size()),
           "number vertices from 0 on, and give them before the blocks");
    }
    advance();
    return v;
  }

  /// Passes over a list; whether it has a number other than 1.
  bool skip_list() {
    bool other = false;
    int depth = 0;
    do {
      if (token_.empty()) fail("the file ends in a list", "complete the file");
      if (token_ == "(") {
        ++depth;
      } else if (token_ == ")") {
        --depth;
      } else {
        double value = 0;
        const auto [end, error] = std::from_chars(token_.data(), token_.data() + token_.size(), value);
        other = other || error != std::errc() || value != 1;
      }
      advance();
    } while (depth > 0);
    return other;
  }

  /// Passes over what follows a keyword: a dictionary, or all to the semicolon.
  void skip_value(const std::string& key) {
    int depth = 0;
    const bool dictionary = token_ == "{";
    while (depth > 0 || (dictionary || token_ != ";")) {
      if (token_.empty()) fail(fmt::format("the file ends in \"{}\"", key), "complete the file");
      if (token_ == "{" || token_ == "(") ++depth;
      if (token_ == "}" || token_ == ")") --depth;
      advance();
      if (dictionary && depth == 0) return;
    }
    advance();
  }

  DictBlocks finished() {
    if (hexes_.empty()) throw input_error(name_, 0, "holds no blocks", "give a blockMeshDict with blocks");
    std::vector<Index> number(points_.size(), no_index);
    std::vector<Vec3> used;
    for (const HexPoints& hex : hexes_) {
      for (const Index v : hex) {
        number[v] = 0;
      }
    }
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (number[v] == no_index) continue;
      number[v] = static_cast<Index>(used.size());
      used.emplace_back(points_[v] * scale_);
    }
    for (HexPoints& hex : hexes_) {
      for (Index& v : hex) v = number[v];
    }
    for (BoundaryPatch& patch : patches_) {
      for (auto& quad : patch.quads) {
        for (Index& v : quad) {
          if (number[v] == no_index) {
            throw input_error(name_, 0,
                              fmt::format("patch {} uses vertex {}, which no block has", patch.name, v),
                              "give faces of blocks");
          }
          v = number[v];
        }
      }
    }
    const std::size_t named = patches_.size();
    HexMesh mesh = complete_boundary(std::move(used), std::move(hexes_), std::move(patches_));
    if (mesh.patches().size() > named && !default_.name.empty()) {
      std::vector<BoundaryPatch> patches = mesh.patches();
      patches.back().name = default_.name;
      patches.back().type = default_.type;
      std::vector<HexPoints> cells(mesh.cell_count());
      mesh.read_cells(0, cells);
      mesh = HexMesh({mesh.points().begin(), mesh.points().end()}, std::move(cells), std::move(patches));
    }
    std::vector<std::string> notes;
    if (divided_ || graded_) {
      notes.push_back(
          fmt::format("{}: numbers of cells{} of the blocks are passed over: --levels, --cells "
                      "and --first-height rule",
                      name_, graded_ ? " and grading" : ""));
    }
    return {std::move(mesh), in_metres_, std::move(notes)};
  }

  std::string take() {
    if (token_.empty()) fail("the file ends too early", "complete the file");
    std::string word = token_;
    advance();
    return word;
  }
  double take_real() {
    double value = 0;
    const auto [end, error] = std::from_chars(token_.data(), token_.data() + token_.size(), value);
    if (error != std::errc() || end != token_.data() + token_.size() || !std::isfinite(value)) {
      fail(fmt::format("a number is expected, not \"{}\"", token_), "correct the file");
    }
    advance();
    return value;
  }
  bool accept(const char* token) {
    if (token_.empty()) fail(fmt::format("the file ends before \"{}\"", token), "complete the file");
    if (token_ != token) return false;
    advance();
    return true;
  }
  void expect(const char* token) {
    if (token_ != token)
      fail(fmt::format("\"{}\" is expected, not \"{}\"", token, token_), "correct the file");
    advance();
  }
  void skip_semicolon() {
    if (token_ == ";") advance();
  }

  /// Moves to the next token: a word, or one of ( ) { } [ ] ; alone. Empty at the end.
  void advance() {
    skip_space();
    start_ = at_;
    token_.clear();
    if (at_ >= text_.size()) return;
    constexpr std::string_view single = "(){}[];";
    if (text_[at_] == '$' || text_[at_] == '#') {
      fail("macros and directives ($, #) are not read", "write the numbers out");
    }
    if (text_[at_] == '"') {
      const std::size_t close = text_.find('"', at_ + 1);
      if (close == std::string::npos) fail("a text in \"\" does not end", "complete the file");
      token_ = text_.substr(at_, close + 1 - at_);
      at_ = close + 1;
    } else if (single.find(text_[at_]) != std::string_view::npos) {
      token_ = text_[at_++];
    } else {
      const std::size_t end = text_.find_first_of("(){}[]; \t\r\n\f\v", at_);
      token_ = text_.substr(at_, end == std::string::npos ? end : end - at_);
      at_ += token_.size();
    }
  }
  void skip_space() {
    while (at_ < text_.size()) {
      if (std::string_view(" \t\r\n\f\v").find(text_[at_]) != std::string_view::npos) {
        ++at_;
      } else if (text_.compare(at_, 2, "//") == 0) {
        at_ = std::min(text_.size(), text_.find('\n', at_));
      } else if (text_.compare(at_, 2, "/*") == 0) {
        const std::size_t close = text_.find("*/", at_ + 2);
        at_ = close == std::string::npos ? text_.size() : close + 2;
      } else {
        return;
      }
    }
  }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
    throw input_error(name_, line_of(text_, std::min(start_, text_.size())), what, remedy);
  }

  std::string name_, text_, token_;
  std::size_t at_ = 0, start_ = 0;  ///< behind the token, and where it begins
  double scale_ = 1;
  bool in_metres_ = false, divided_ = false, graded_ = false;
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::vector<BoundaryPatch> patches_;
  BoundaryPatch default_;
};

}  // namespace

DictBlocks read_block_dict(const std::filesystem::path& file) {
  return naming_file(file, [&] { return DictReader(file).read(); });
}

}  // namespace flowcage
