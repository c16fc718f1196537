#pragma once
#include <TopoDS_Shape.hxx>
#include <limits>
#include <unordered_map>

#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

/// Shapes by geometry and place, whatever their orientation.
struct SameShape {
  std::size_t operator()(const TopoDS_Shape& shape) const {
    return static_cast<std::size_t>(shape.HashCode(std::numeric_limits<int>::max()));
  }
  bool operator()(const TopoDS_Shape& a, const TopoDS_Shape& b) const { return a.IsSame(b); }
};

/// Labels of faces where they stand: two instances of a part have the same geometry at two locations.
using PlacedLabels = std::unordered_map<TopoDS_Shape, CadFace, SameShape, SameShape>;

/// One file's content before its faces are numbered.
struct RawContent {
  FileContent content{};
  PlacedLabels labels{};
};

RawContent read_step(const std::string& file, Progress& progress);
RawContent read_iges(const std::string& file, Progress& progress);
RawContent read_brep(const std::string& file, const std::string& cad_unit, Progress& progress);

/// Our short name where we know the unit, else the file's in lower case.
std::string unit_name(const std::string& name);

/// ": " and the kernel's first complaint, for errors whose cause it knows better than we do.
std::string first_failure(const KernelScope& scope);

/// One warning for each face that could not be converted; `lost` says which.
void warn_of_lost_faces(const std::vector<std::string>& lost, FileContent& content);

}  // namespace flowcage::occ
