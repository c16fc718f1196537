#include "core/export/write_polymesh.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/export/face_stream.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/write_ranges.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/foam_metrics.hpp"

namespace flowcage {
namespace {

constexpr Offset point_grain = 32768;

struct FoamFile {
  const char* class_name;
  const char* location;
  const char* object;
  std::string note = {};
};

std::string header(const FoamFile& file, bool binary) {
  std::string text =
      fmt::format("FoamFile\n{{\n    version     2.0;\n    format      {};\n", binary ? "binary" : "ascii");
  if (binary) text += "    arch        \"LSB;label=32;scalar=64\";\n";
  text += fmt::format("    class       {};\n", file.class_name);
  if (!file.note.empty()) text += fmt::format("    note        \"{}\";\n", file.note);
  text += fmt::format("    location    \"{}\";\n    object      {};\n}}\n\n", file.location, file.object);
  return text;
}

void check_finite(const HexView& mesh) {
  const auto points = mesh.points();
  const Offset none = static_cast<Offset>(points.size());
  const Offset first = parallel_reduce(
      none, point_grain, none,
      [&](Offset begin, Offset end) {
        for (Offset p = begin; p < end; ++p) {
          if (!points[p].allFinite()) return p;
        }
        return none;
      },
      [](Offset a, Offset b) { return std::min(a, b); });
  if (first == none) return;
  throw Error(ErrorKind::gate,
              fmt::format("point {} of the mesh is not finite: {}", first, place(points[first])),
              "the mesh cannot be written as a polyMesh");
}

// OpenFOAM stops at a symmetryPlane whose unit face normals differ from their mean by 3e-8.
bool is_flat(const HexView& mesh, const BoundaryPatch& patch) {
  Vec3 sum = Vec3::Zero();
  const auto normal_of = [&](const std::array<Index, 4>& q) {
    const auto p = mesh.points();
    return Vec3(face_geometry({p[q[0]], p[q[1]], p[q[2]], p[q[3]]}).area.normalized());
  };
  for (const auto& quad : patch.quads) sum += normal_of(quad);
  const Vec3 mean = sum.normalized();
  return std::all_of(patch.quads.begin(), patch.quads.end(),
                     [&](const auto& quad) { return (normal_of(quad) - mean).squaredNorm() <= 1e-15; });
}

std::string physical_type(PatchType type) {
  switch (type) {
    case PatchType::farfield:
      return "farfield";
    case PatchType::inlet:
      return "inlet";
    case PatchType::outlet:
      return "outlet";
    case PatchType::wall:
    case PatchType::symmetry:
      break;
  }
  return {};
}

class PolyMeshWriter {
 public:
  PolyMeshWriter(AtomicFolder& folder, const HexView& mesh, const HexAdjacency& adjacency,
                 const PolyMeshSettings& settings)
      : folder_(folder), mesh_(mesh), adjacency_(adjacency), settings_(settings) {
    faces_ = adjacency.internal_faces + adjacency.boundary_faces();
  }

  void points() {
    const auto points = mesh_.points();
    const auto stored = folder_.create("points");
    OutputFile& file = *stored;
    file << header({"vectorField", location, "points"}, settings_.binary);
    open_list(file, static_cast<Offset>(points.size()));
    write_ranges(file, static_cast<Offset>(points.size()), point_grain,
                 [&](Offset begin, Offset end, std::string& text) {
                   if (settings_.binary) {
                     static_assert(sizeof(Vec3) == 3 * sizeof(double));
                     text.append(reinterpret_cast<const char*>(points.data() + begin),
                                 static_cast<std::size_t>(end - begin) * sizeof(Vec3));
                     return;
                   }
                   for (Offset p = begin; p < end; ++p) {
                     for (int d = 0; d < 3; ++d) {
                       text += d == 0 ? '(' : ' ';
                       append_number(text, points[p][d]);
                     }
                     text += ")\n";
                   }
                 });
    file << ")\n";
    file.close();
  }

  /// The three files of the faces, made in one pass over the cells.
  void faces_owner_and_neighbour() {
    const std::string note =
        fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", mesh_.points().size(),
                    mesh_.cell_count(), faces_, adjacency_.internal_faces);
    const auto faces = folder_.create("faces");
    const auto owner = folder_.create("owner");
    const auto neighbour = folder_.create("neighbour");
    *faces << header({settings_.binary ? "faceCompactList" : "faceList", location, "faces"},
                     settings_.binary);
    begin_faces(*faces);
    *owner << header({"labelList", location, "owner", note}, settings_.binary);
    open_list(*owner, faces_);
    *neighbour << header({"labelList", location, "neighbour", note}, settings_.binary);
    open_list(*neighbour, adjacency_.internal_faces);
    const std::array<std::ostream*, 3> files{faces.get(), owner.get(), neighbour.get()};
    write_ranges(files, mesh_.cell_count(), cell_grain,
                 [&](Offset begin, Offset end, std::span<std::string> texts) {
                   std::vector<InternalFace> internal;
                   internal.reserve(static_cast<std::size_t>(3 * (end - begin)));
                   read_internal_faces(mesh_, adjacency_, begin, end, internal);
                   for (const InternalFace& face : internal) {
                     append_face(texts[0], face.points);
                     append_label(texts[1], face.owner);
                     append_label(texts[2], face.neighbour);
                   }
                 });
    for (const BoundaryPatch& patch : mesh_.patches()) {
      write_ranges(*faces, static_cast<Offset>(patch.quads.size()), point_grain,
                   [&](Offset begin, Offset end, std::string& text) {
                     for (Offset q = begin; q < end; ++q) append_face(text, patch.quads[q]);
                   });
    }
    write_labels(*owner, adjacency_.boundary_owner);
    for (OutputFile* file : {faces.get(), owner.get(), neighbour.get()}) {
      *file << ")\n";
      file->close();
    }
  }

  std::vector<std::string> boundary() {
    auto [names, notes] = legal_patch_names(mesh_);
    const auto stored = folder_.create("boundary");
    OutputFile& file = *stored;
    file << header({"polyBoundaryMesh", location, "boundary"}, false);
    file << fmt::format("{}\n(\n", names.size());
    Offset start = adjacency_.internal_faces;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const BoundaryPatch& patch = mesh_.patches()[i];
      const std::string type = foam_patch_type(mesh_, patch), physical = physical_type(patch.type);
      if (type == "symmetry") {
        notes.push_back(
            fmt::format("patch \"{}\" is not flat: written as symmetry, not as symmetryPlane", names[i]));
      }
      file << fmt::format("    {}\n    {{\n        type            {};\n", names[i], type);
      if (!physical.empty()) file << fmt::format("        physicalType    {};\n", physical);
      file << fmt::format("        nFaces          {};\n        startFace       {};\n    }}\n",
                          patch.quads.size(), start);
      start += static_cast<Offset>(patch.quads.size());
    }
    file << ")\n";
    file.close();
    return notes;
  }

  void cell_zones() {
    // Cells by block; within a block ascending, as OpenFOAM keeps them.
    std::vector<Offset> first(static_cast<std::size_t>(mesh_.block_count()) + 1, 0);
    for (Offset c = 0; c < mesh_.cell_count(); ++c) ++first[mesh_.block_of(c) + 1];
    for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
    std::vector<Index> cells(static_cast<std::size_t>(mesh_.cell_count()));
    std::vector<Offset> next(first.begin(), first.end() - 1);
    for (Offset c = 0; c < mesh_.cell_count(); ++c) {
      cells[next[mesh_.block_of(c)]++] = static_cast<Index>(c);
    }
    const auto stored = folder_.create("cellZones");
    OutputFile& file = *stored;
    file << header({"regIOobject", location, "cellZones"}, settings_.binary);
    file << fmt::format("{}\n(\n", mesh_.block_count());
    for (Index b = 0; b < mesh_.block_count(); ++b) {
      file << fmt::format("block{}\n{{\n    type            cellZone;\n    cellLabels      List<label> ", b);
      open_list(file, first[b + 1] - first[b]);
      write_labels(file, std::span(cells).subspan(first[b], first[b + 1] - first[b]));
      file << (settings_.binary ? ");\n}\n" : "\n);\n}\n");
    }
    file << ")\n";
    file.close();
  }

  static constexpr const char* location = "constant/polyMesh";

 private:
  void open_list(OutputFile& file, Offset count) const {
    file << fmt::format(fmt::runtime(settings_.binary ? "{}\n(" : "{}\n(\n"), count);
  }
  void append_label(std::string& text, Index value) const {
    if (settings_.binary) {
      append_raw(text, value);
    } else {
      append_number(text, value);
      text += '\n';
    }
  }
  void write_labels(OutputFile& file, std::span<const Index> labels) const {
    write_ranges(file, static_cast<Offset>(labels.size()), point_grain,
                 [&](Offset begin, Offset end, std::string& text) {
                   for (Offset i = begin; i < end; ++i) append_label(text, labels[i]);
                 });
  }
  void append_face(std::string& text, const std::array<Index, 4>& quad) const {
    if (settings_.binary) {
      append_raw(text, quad);
      return;
    }
    for (int i = 0; i < 4; ++i) {
      text += i == 0 ? "4(" : " ";
      append_number(text, quad[i]);
    }
    text += ")\n";
  }
  /// Up to where the faces' own points begin.
  void begin_faces(OutputFile& file) const {
    if (!settings_.binary) {
      open_list(file, faces_);
      return;
    }
    // A compact list is two lists: where each face begins, and all point numbers.
    if (4 * faces_ > std::numeric_limits<Index>::max()) {
      throw Error(ErrorKind::output,
                  fmt::format("{} faces are more than a binary polyMesh with 32-bit labels holds", faces_),
                  "write the ASCII form");
    }
    open_list(file, faces_ + 1);
    write_ranges(file, faces_ + 1, point_grain, [&](Offset begin, Offset end, std::string& text) {
      for (Offset f = begin; f < end; ++f) append_raw(text, static_cast<Index>(4 * f));
    });
    file << ")\n";
    open_list(file, 4 * faces_);
  }

  AtomicFolder& folder_;
  const HexView& mesh_;
  const HexAdjacency& adjacency_;
  const PolyMeshSettings& settings_;
  Offset faces_ = 0;
};

}  // namespace

std::string foam_header(const std::string& kind, const std::string& location, const std::string& object) {
  return header({kind.c_str(), location.c_str(), object.c_str()}, false);
}

std::string foam_patch_type(const HexView& mesh, const BoundaryPatch& patch) {
  if (patch.type == PatchType::wall) return "wall";
  if (patch.type == PatchType::symmetry) return is_flat(mesh, patch) ? "symmetryPlane" : "symmetry";
  return "patch";
}

std::vector<std::string> polymesh_entries() {
  return {"points",    "faces",      "owner",    "neighbour",    "boundary",   "cellZones",
          "faceZones", "pointZones", "sets",     "level0Edge",   "cellLevel",  "pointLevel",
          "points.gz", "faces.gz",   "owner.gz", "neighbour.gz", "boundary.gz"};
}

std::vector<std::string> write_polymesh(AtomicFolder& folder, const HexView& mesh,
                                        const HexAdjacency& adjacency, const PolyMeshSettings& settings,
                                        Progress* progress) {
  const auto step = [&](double fraction) {
    if (progress) progress->step("write polyMesh", fraction);
  };
  check_finite(mesh);
  PolyMeshWriter writer(folder, mesh, adjacency, settings);
  step(0);
  writer.points();
  step(0.3);
  writer.faces_owner_and_neighbour();
  step(0.9);
  std::vector<std::string> notes = writer.boundary();
  if (settings.block_zones) writer.cell_zones();
  step(1);
  return notes;
}

void write_case_files(const std::filesystem::path& case_folder, const std::string& foam_file) {
  const auto write_missing = [&](const std::filesystem::path& file, const std::string& text) {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return;
    AtomicFile stored(file);
    stored.stream() << text;
    stored.commit();
  };
  const auto system = case_folder / "system";
  std::error_code failed;
  std::filesystem::create_directories(system, failed);
  if (failed) {
    throw Error(ErrorKind::output,
                fmt::format("{}: cannot make the folder: {}", system.string(), failed.message()),
                "choose another place with -o");
  }
  const auto dictionary = [&](const char* name, const std::string& body) {
    write_missing(system / name, foam_header("dictionary", "system", name) + body);
  };
  dictionary("controlDict",
             "application     potentialFoam;\nstartFrom       startTime;\nstartTime       0;\n"
             "stopAt          endTime;\nendTime         1;\ndeltaT          1;\n"
             "writeControl    timeStep;\nwriteInterval   1;\nwriteFormat     binary;\n"
             "writePrecision  12;\n");
  dictionary("fvSchemes",
             "ddtSchemes { default steadyState; }\ngradSchemes { default Gauss linear; }\n"
             "divSchemes { default none; div(phi,U) Gauss linear; div(div(phi,U)) Gauss linear; }\n"
             "laplacianSchemes { default Gauss linear corrected; }\n"
             "interpolationSchemes { default linear; }\nsnGradSchemes { default corrected; }\n");
  dictionary("fvSolution",
             "solvers\n{\n    Phi { solver GAMG; smoother DIC; tolerance 1e-8; relTol 0.01; }\n"
             "    p { $Phi; }\n}\npotentialFlow { nNonOrthogonalCorrectors 10; }\n");
  write_missing(case_folder / foam_file, "");
}

std::vector<std::string> write_openfoam_case(const std::filesystem::path& case_folder, const HexView& mesh,
                                             const HexAdjacency& adjacency, const PolyMeshSettings& settings,
                                             Progress* progress) {
  AtomicFolder folder(case_folder, "constant/polyMesh", polymesh_entries());
  std::vector<std::string> notes = write_polymesh(folder, mesh, adjacency, settings, progress);
  folder.commit();
  write_case_files(case_folder, "case.foam");
  return notes;
}

}  // namespace flowcage
