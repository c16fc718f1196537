#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/vtk_xml_reader.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

namespace fs = std::filesystem;
constexpr const char* remake = "write the mesh again with the program that made it";
constexpr const char* merge = "in ParaView: filter Merge Blocks with Merge Points, then save as .vtu";

/// A piece's file with its arrays by "PARENT/NAME".
class Piece {
 public:
  Piece(const fs::path& file, const std::string& type) : xml_(file.string(), type) {
    for (const auto& element : xml_.elements()) {
      if (element.name == "Piece") {
        if (piece_) xml_.fail(element, "has several pieces", merge);
        piece_ = &element;
      }
      if (element.name != "DataArray") continue;
      arrays_.emplace(element.parent + "/" + element.attribute("Name"), &element);
      if (element.parent == "Points") points_ = &element;
    }
    if (!piece_ || !points_) xml_.fail(xml_.elements()[0], "holds no points", remake);
  }

  std::string attribute(const std::string& name) const { return piece_->attribute(name); }
  bool has(const std::string& key) const { return arrays_.count(key) != 0; }

  std::vector<std::int64_t> integers(const std::string& key) const {
    const auto it = arrays_.find(key);
    if (it == arrays_.end()) fail(fmt::format("array {} is missing", key), merge);
    return xml_.read_integers(*it->second);
  }

  std::vector<Vec3> points() const {
    const std::vector<double> values = xml_.read_reals(*points_);
    if (values.size() % 3 != 0) fail(fmt::format("has {} coordinates", values.size()), remake);
    std::vector<Vec3> points(values.size() / 3);
    for (std::size_t p = 0; p < points.size(); ++p) {
      points[p] = Vec3(values[3 * p], values[3 * p + 1], values[3 * p + 2]);
      if (!points[p].allFinite()) fail(fmt::format("point {} is not finite", p), remake);
    }
    return points;
  }

  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
    xml_.fail(piece_ ? *piece_ : xml_.elements()[0], what, remedy);
  }

 private:
  VtkXmlFile xml_;
  const VtkXmlFile::Element* piece_ = nullptr;
  const VtkXmlFile::Element* points_ = nullptr;
  std::map<std::string, const VtkXmlFile::Element*> arrays_;
};

/// A piece that the index names: "wing_vtm/block1.vts".
struct PieceName {
  std::string name;
  fs::path file;
};

class VtmReader {
 public:
  explicit VtmReader(const fs::path& file) {
    const VtkXmlFile index(file.string(), "vtkMultiBlockDataSet");
    for (const auto& element : index.elements()) {
      if (element.name != "DataSet") continue;
      const fs::path inside = element.attribute("file");
      const bool leaves = inside.is_absolute() || std::ranges::find(inside, "..") != inside.end();
      if (inside.empty() || leaves) {
        index.fail(element, fmt::format("names the piece \"{}\" outside of its folder", inside.string()),
                   "keep the pieces below the folder of the .vtm file");
      }
      const PieceName piece{element.attribute("name"), file.parent_path() / inside};
      if (inside.extension() == ".vts") {
        blocks_.push_back(piece);
      } else if (inside.extension() == ".vtp") {
        quads_.push_back(piece);
      } else {
        index.fail(element, fmt::format("has the piece {}, which is no .vts or .vtp file", inside.string()),
                   merge);
      }
    }
    if (blocks_.empty()) index.fail(index.elements()[0], "holds no structured blocks", merge);
  }

  HexMesh read() {
    for (const PieceName& name : blocks_) read_block(Piece(name.file, "StructuredGrid"));
    put_in_order();
    for (const PieceName& name : quads_) read_patch(name.name, Piece(name.file, "PolyData"));
    return complete_boundary(std::move(points_), std::move(hexes_), std::move(patches_));
  }

 private:
  /// The mesh's numbers of a piece's points or cells.
  std::vector<Index> ids(const Piece& piece, const std::string& key, std::size_t count) const {
    const auto given = piece.integers(key);
    if (given.size() != count) {
      piece.fail(fmt::format("array {} has {} values for {} places", key, given.size(), count), remake);
    }
    std::vector<Index> numbers;
    numbers.reserve(count);
    for (const std::int64_t id : given) {
      if (id < 0 || id >= std::numeric_limits<Index>::max()) {
        piece.fail(fmt::format("array {} has the number {}", key, id), remake);
      }
      numbers.push_back(static_cast<Index>(id));
    }
    return numbers;
  }

  void read_block(const Piece& piece) {
    std::array<Offset, 6> extent{};
    std::istringstream words(piece.attribute("Extent"));
    for (Offset& end : extent) words >> end;
    std::array<Offset, 3> size{};
    for (int d = 0; d < 3; ++d) size[d] = extent[2 * d + 1] - extent[2 * d] + 1;
    const bool sound = words && std::ranges::all_of(size, [](Offset n) { return n >= 2 && n < 1 << 30; });
    const std::vector<Vec3> points = piece.points();
    // By division: the product of three claimed sizes may be more than an Offset holds.
    const auto count = static_cast<Offset>(points.size());
    if (!sound || count % (size[0] * size[1]) != 0 || count / (size[0] * size[1]) != size[2]) {
      piece.fail(fmt::format("the extent \"{}\" does not fit {} points", piece.attribute("Extent"), count),
                 remake);
    }
    const std::vector<Index> point = ids(piece, "PointData/pointId", points.size());
    const auto cells = static_cast<std::size_t>((size[0] - 1) * (size[1] - 1) * (size[2] - 1));
    const std::vector<Index> cell = ids(piece, "CellData/cellId", cells);
    for (std::size_t p = 0; p < points.size(); ++p) point_at_.emplace_back(point[p], points[p]);
    std::size_t n = 0;
    for (Offset k = 0; k + 1 < size[2]; ++k) {
      for (Offset j = 0; j + 1 < size[1]; ++j) {
        for (Offset i = 0; i + 1 < size[0]; ++i) {
          HexPoints hex{};
          for (int c = 0; c < 8; ++c) {
            const auto& [di, dj, dk] = hex_corner_ijk[c];
            hex[c] = point[i + di + size[0] * (j + dj + size[1] * (k + dk))];
          }
          cell_at_.emplace_back(cell[n++], hex);
        }
      }
    }
  }

  /// From numbered points and cells of all blocks to lists. Blocks repeat the points that they share.
  void put_in_order() {
    const auto by_number = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto fail = [this](const std::string& what) {
      throw input_error(blocks_.front().file.string(), 0, what, merge);
    };
    std::ranges::stable_sort(point_at_, by_number);
    for (const auto& [number, position] : point_at_) {
      if (numbers_.empty() || number != numbers_.back()) {
        numbers_.push_back(number);
        points_.push_back(position);
      } else if (position != points_.back()) {
        fail(fmt::format("the blocks have different places for pointId {}", number));
      }
    }
    std::ranges::stable_sort(cell_at_, by_number);
    for (auto& [number, hex] : cell_at_) {
      if (number != static_cast<Index>(hexes_.size())) {
        fail(fmt::format("cellId {} is there twice, or one before it is missing", number));
      }
      for (Index& p : hex) p = *place_of(p);
      hexes_.push_back(hex);
    }
  }

  /// Where the point of a pointId is in the list: ids may leave numbers out.
  std::optional<Index> place_of(Index id) const {
    const auto it = std::ranges::lower_bound(numbers_, id);
    if (it == numbers_.end() || *it != id) return std::nullopt;
    return static_cast<Index>(it - numbers_.begin());
  }

  void read_patch(const std::string& name, const Piece& piece) {
    const std::vector<Index> point = ids(piece, "PointData/pointId", piece.points().size());
    const auto corners = piece.integers("Polys/connectivity"), ends = piece.integers("Polys/offsets");
    BoundaryPatch patch{name, PatchType::wall, {}, {}};
    for (std::size_t q = 0; q < ends.size(); ++q) {
      if (ends[q] != static_cast<std::int64_t>(4 * (q + 1)) || 4 * (q + 1) > corners.size()) {
        piece.fail(fmt::format("polygon {} is no quad", q), "give patches of quads");
      }
      std::array<Index, 4> quad{};
      for (std::size_t c = 0; c < 4; ++c) {
        const std::int64_t corner = corners[4 * q + c];
        const bool inside = corner >= 0 && corner < static_cast<std::int64_t>(point.size());
        const std::optional<Index> place = inside ? place_of(point[corner]) : std::nullopt;
        if (!place) piece.fail(fmt::format("quad {} uses the unknown point {}", q, corner), remake);
        quad[c] = *place;
      }
      patch.quads.push_back(quad);
    }
    const std::string id_key = "FieldData/patch:" + name;
    if (piece.has(id_key) && piece.has("FieldData/patchTypes")) {
      const auto id = piece.integers(id_key), types = piece.integers("FieldData/patchTypes");
      const bool known = id.size() == 1 && id[0] >= 0 && id[0] < static_cast<std::int64_t>(types.size()) &&
                         types[id[0]] >= 0 && types[id[0]] <= static_cast<int>(PatchType::outlet);
      if (known) patch.type = static_cast<PatchType>(types[id[0]]);
    }
    patches_.push_back(std::move(patch));
  }

  std::vector<PieceName> blocks_, quads_;
  std::vector<std::pair<Index, Vec3>> point_at_;
  std::vector<std::pair<Index, HexPoints>> cell_at_;
  std::vector<Index> numbers_;  ///< the pointId of each point, ascending
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::vector<BoundaryPatch> patches_;
};

}  // namespace

HexMesh read_vtm(const std::filesystem::path& file) {
  return naming_file(file, [&] { return VtmReader(file).read(); });
}

}  // namespace flowcage
