#include <fmt/format.h>

#include <limits>

#include "core/base/error.hpp"
#include "core/export/foam_file.hpp"
#include "core/export/hex_from_faces.hpp"
#include "core/export/read_mesh.hpp"

namespace flowcage {
namespace {

namespace fs = std::filesystem;
constexpr const char* inspect = "run OpenFOAM's checkMesh on it, and write it again";

fs::path polymesh_folder(const fs::path& path) {
  std::error_code ignored;
  if (path.extension() == ".foam" && !fs::is_directory(path, ignored)) {
    return path.parent_path() / "constant/polyMesh";
  }
  if (!fs::exists(path, ignored)) throw input_error(path.string(), 0, "no such folder", "check the name");
  for (const fs::path& folder : {path, path / "constant/polyMesh", path / "polyMesh"}) {
    for (const char* name : {"faces", "faces.gz"}) {
      if (fs::exists(folder / name, ignored)) return folder;
    }
  }
  throw input_error(path.string(), 0, "holds no OpenFOAM mesh (constant/polyMesh/faces)",
                    "name a case folder, its polyMesh folder, or a .foam file in the case folder");
}

PatchType patch_type(const FoamFile& file, const FoamFile::Entry& entry) {
  const auto value = [&](const char* key) {
    const auto it = entry.values.find(key);
    return it == entry.values.end() ? std::string() : it->second;
  };
  const std::string type = value("type"), physical = value("physicalType");
  if (type.starts_with("processor")) {
    file.fail(entry.position, fmt::format("patch {} joins parts of a decomposed mesh", entry.name),
              "put the parts together first: reconstructParMesh");
  }
  if (type == "wall") return PatchType::wall;
  if (type == "symmetryPlane" || type == "symmetry") return PatchType::symmetry;
  if (physical == "inlet") return PatchType::inlet;
  if (physical == "outlet") return PatchType::outlet;
  return PatchType::farfield;
}

class PolyMeshReader {
 public:
  explicit PolyMeshReader(const fs::path& folder) : folder_(folder) {}

  HexMesh read() {
    points_ = FoamFile(folder_ / "points").read_points();
    read_faces();
    read_cells_of_faces();
    std::vector<BoundaryPatch> patches = read_patches();
    std::vector<HexPoints> cells = build_cells();
    return {std::move(points_), std::move(cells), std::move(patches)};
  }

 private:
  void read_faces() {
    FoamFile file(folder_ / "faces");
    faces_ = file.read_quads();
    const auto count = static_cast<Index>(points_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (const Index p : faces_[f]) {
        if (p < 0 || p >= count) {
          file.fail(0, fmt::format("face {} uses point {}, but there are {} points", f, p, count), inspect);
        }
      }
    }
  }

  void read_cells_of_faces() {
    FoamFile owner_file(folder_ / "owner"), neighbour_file(folder_ / "neighbour");
    owner_ = owner_file.read_labels();
    neighbour_ = neighbour_file.read_labels();
    if (owner_.size() != faces_.size()) {
      owner_file.fail(0, fmt::format("{} owners for {} faces", owner_.size(), faces_.size()), inspect);
    }
    // Old meshes list -1 for the boundary's faces.
    while (!neighbour_.empty() && neighbour_.back() == -1) neighbour_.pop_back();
    if (neighbour_.size() > faces_.size()) {
      neighbour_file.fail(0, fmt::format("{} neighbours for {} faces", neighbour_.size(), faces_.size()),
                          inspect);
    }
    const std::size_t sides = owner_.size() + neighbour_.size();
    if (sides == 0 || sides % 6 != 0) {
      owner_file.fail(0,
                      fmt::format("{} faces, {} of them inner, are not those of hexes (six each)",
                                  faces_.size(), neighbour_.size()),
                      "flowcage reads meshes of hexes only");
    }
    cells_ = sides / 6;
    const auto check = [&](const FoamFile& file, const std::vector<Index>& labels) {
      for (std::size_t f = 0; f < labels.size(); ++f) {
        if (labels[f] >= 0 && static_cast<std::size_t>(labels[f]) < cells_) continue;
        file.fail(0, fmt::format("face {} is of cell {}, but the faces make {} hexes", f, labels[f], cells_),
                  "flowcage reads meshes of hexes only");
      }
    };
    check(owner_file, owner_);
    check(neighbour_file, neighbour_);
  }

  std::vector<BoundaryPatch> read_patches() {
    FoamFile file(folder_ / "boundary");
    std::vector<BoundaryPatch> patches;
    std::size_t next = neighbour_.size();
    for (const FoamFile::Entry& entry : file.read_entries()) {
      const auto number = [&](const char* key) {
        const auto it = entry.values.find(key);
        std::size_t value = 0, used = 0;
        try {
          if (it != entry.values.end()) value = std::stoul(it->second, &used);
        } catch (const std::exception&) {
          used = 0;
        }
        if (used == 0 || used != it->second.size()) {
          file.fail(entry.position, fmt::format("patch {} has no usable {}", entry.name, key), inspect);
        }
        return value;
      };
      const std::size_t count = number("nFaces"), start = number("startFace");
      if ((start != next && count > 0) || count > faces_.size() - next) {
        file.fail(entry.position,
                  fmt::format("patch {} has {} faces from {}, but {} of {} faces is the next", entry.name,
                              count, start, next, faces_.size()),
                  inspect);
      }
      BoundaryPatch patch{entry.name, patch_type(file, entry), {}, {}};
      const auto from = static_cast<std::ptrdiff_t>(next), to = static_cast<std::ptrdiff_t>(next + count);
      patch.quads.assign(faces_.begin() + from, faces_.begin() + to);
      patch.owner.assign(owner_.begin() + from, owner_.begin() + to);
      next += count;
      patches.push_back(std::move(patch));
    }
    if (next != faces_.size()) {
      file.fail(0, fmt::format("{} outer faces are in no patch", faces_.size() - next), inspect);
    }
    return patches;
  }

  std::vector<HexPoints> build_cells() const {
    // The faces of each cell, ascending; a neighbour sees them from behind.
    std::vector<std::array<std::int64_t, 6>> sides(cells_);
    std::vector<std::uint8_t> known(cells_, 0);
    const auto add = [&](Index cell, std::int64_t side, std::size_t face) {
      if (known[cell] == 6) {
        throw input_error((folder_ / "owner").string(), 0,
                          fmt::format("cell {} has more than six faces (face {})", cell, face),
                          "flowcage reads meshes of hexes only");
      }
      sides[cell][known[cell]++] = side;
    };
    for (std::size_t f = 0; f < owner_.size(); ++f) {
      add(owner_[f], static_cast<std::int64_t>(f), f);
      if (f < neighbour_.size()) add(neighbour_[f], ~static_cast<std::int64_t>(f), f);
    }
    std::vector<HexPoints> cells(cells_);
    for (std::size_t c = 0; c < cells_; ++c) {
      // As many sides as six times the cells, and none has more: each has six.
      std::array<std::array<Index, 4>, 6> quads;
      for (int i = 0; i < 6; ++i) {
        const std::int64_t side = sides[c][i];
        quads[i] = faces_[side >= 0 ? side : ~side];
        if (side < 0) std::reverse(quads[i].begin(), quads[i].end());
      }
      const auto hex = hex_from_faces(quads);
      if (!hex) {
        Vec3 centre = Vec3::Zero();
        for (const auto& quad : quads) {
          for (const Index p : quad) centre += points_[p] / 24;
        }
        throw input_error(
            (folder_ / "faces").string(), 0,
            fmt::format("the faces of cell {}, near {}, do not close to a hex with normals from "
                        "owner to neighbour",
                        c, place(centre)),
            inspect);
      }
      cells[c] = *hex;
    }
    return cells;
  }

  fs::path folder_;
  std::vector<Vec3> points_;
  std::vector<std::array<Index, 4>> faces_;
  std::vector<Index> owner_, neighbour_;
  std::size_t cells_ = 0;
};

}  // namespace

HexMesh read_polymesh(const fs::path& path) {
  return PolyMeshReader(polymesh_folder(path)).read();
}

}  // namespace flowcage
