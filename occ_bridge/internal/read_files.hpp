#pragma once
#include <TopoDS_Shape.hxx>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "occ_bridge/internal/face_labels.hpp"

namespace flowcage::occ {

/// What one file holds.
struct FileContent {
  std::string file{};                      ///< as the user gave it
  std::string format{};                    ///< "STEP", "IGES" or "BREP"
  std::string unit{};                      ///< as the file says; "" where it says none (BREP)
  double unit_in_metres = 1;               ///< of `unit`, or of the user's unit where that overrules it
  double shape_unit = 1e-3;                ///< metres per length unit of `shape`
  TopoDS_Shape shape{};                    ///< solids, shells, faces; no two of its faces share geometry
  std::vector<std::string> solid_names{};  ///< those that are not empty
  std::vector<std::string> warnings{};
};

/// Metres in a unit as people and files write it (m, mm, in, ft, metre, INCH, ...; any case); 0 when unknown.
double metres_per_unit(const std::string& unit);

/// Reads one file, whatever its extension: STEP, IGES or OpenCASCADE's BREP by its content. `cad_unit` ""
/// takes the file's unit. Its faces are numbered on from `labels.count()`. Faces that cannot be converted
/// cost a warning each. Throws Error(input) for a file that is missing, a folder, empty, of another kind, cut
/// off, or without a surface.
FileContent read_cad_file(const std::string& file, const std::string& cad_unit, FaceLabels& labels,
                          Progress& progress);

/// The same for a shape that is there already.
FileContent content_of(const TopoDS_Shape& shape, FaceLabels& labels);

}  // namespace flowcage::occ
