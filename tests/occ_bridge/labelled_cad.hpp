#pragma once
#include <TopoDS_Shape.hxx>
#include <array>
#include <string>
#include <vector>

#include "core/base/types.hpp"
#include "occ_bridge/shapes.hpp"

namespace flowcage {

/// A name, colour and layer for a part or a face; "" for none.
struct Tag {
  std::string name{}, color{}, layer{};
};

/// A part of an assembly and where its instances are.
struct TaggedPart {
  Shape shape;
  Tag tag{};
  std::vector<Tag> faces{};  ///< in the order of exploration; may be shorter than the part has faces
  std::vector<Vec3> places{Vec3::Zero()};
  std::vector<Tag> instances{};  ///< one a place, or none
};

/// Writes an assembly of these parts (in metres) with the kernel's document writers: .step or .igs.
void write_tagged(const std::vector<TaggedPart>& parts, const std::string& file,
                  const std::string& unit = "MM");

/// A faceted body: the polygons of a polyhedron, sewn into a shell, or loose faces where `sewn` is false.
Shape make_faces(const std::vector<std::vector<Vec3>>& polygons, bool sewn = true);

/// A prism, z = 0 to 1, over the triangle (0,0), (2,0), (1,1): its first face is one B-spline that is C0
/// along the ridge x = 1, then two gables and the floor. Each gable has one edge that runs over the ridge.
Shape make_folded_roof();

}  // namespace flowcage
