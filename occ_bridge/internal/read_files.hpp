#pragma once
#include <TopoDS_Shape.hxx>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/progress.hpp"

namespace flowcage::occ {

/// Names given by the file to faces, kept through the operations that replace faces.
class FaceNames {
 public:
  void set(const TopoDS_Shape& face, std::string name);
  /// "" where there is none. Location and orientation of `face` do not matter.
  const std::string& of(const TopoDS_Shape& face) const;
  /// Faces of `to` that have no name yet take that of `from`.
  void inherit(const TopoDS_Shape& from, const TopoDS_Shape& to);

 private:
  struct Named {
    Handle(TopoDS_TShape) key;  // keeps the address taken for as long as it is a key
    std::string name;
  };
  std::unordered_map<const TopoDS_TShape*, Named> names_;
};

/// What one file holds.
struct FileContent {
  std::string file{};                      ///< as the user gave it
  std::string format{};                    ///< "STEP", "IGES" or "BREP"
  std::string unit{};                      ///< as the file says; "" where it says none (BREP)
  double unit_in_metres = 1;               ///< of `unit`, or of the user's unit where that overrules it
  double shape_unit = 1e-3;                ///< metres per length unit of `shape`
  TopoDS_Shape shape{};                    ///< solids, shells, faces
  std::vector<std::string> solid_names{};  ///< those that are not empty
  std::vector<std::string> warnings{};
};

/// Metres in a unit as people and files write it (m, mm, in, ft, metre, INCH, ...; any case); 0 when unknown.
double metres_per_unit(const std::string& unit);

/// Reads one file, whatever its extension: STEP, IGES or OpenCASCADE's BREP by its content. `cad_unit` ""
/// takes the file's unit. Faces that cannot be converted cost a warning each. Throws Error(input) for a file
/// that is missing, a folder, empty, of another kind, cut off, or without a surface.
FileContent read_cad_file(const std::string& file, const std::string& cad_unit, FaceNames& names,
                          Progress& progress);

}  // namespace flowcage::occ
