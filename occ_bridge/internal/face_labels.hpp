#pragma once
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <unordered_map>
#include <vector>

#include "occ_bridge/cad_model.hpp"

namespace flowcage::occ {

/// What the files say of each face, kept through the operations that replace faces. Precondition: no two
/// faces of the model share their geometry's handle (read_cad_file sees to that).
class FaceLabels {
 public:
  void set(const TopoDS_Shape& face, CadFace label);
  /// An empty label where there is none. Location and orientation of `face` do not matter.
  const CadFace& of(const TopoDS_Shape& face) const;
  /// Faces of `to` that have no label yet take that of `from`.
  void inherit(const TopoDS_Shape& from, const TopoDS_Shape& to);
  /// Faces labelled by number() so far.
  Index count() const { return count_; }
  /// Labels a face of a file with the next number.
  void number(const TopoDS_Shape& face, CadFace label);
  /// "face 12": the number that `inspect` shows.
  std::string word_for(const TopoDS_Shape& face) const;

 private:
  struct Entry {
    Handle(TopoDS_TShape) key;  // keeps the address taken for as long as it is a key
    CadFace label;
  };
  std::unordered_map<const TopoDS_TShape*, Entry> labels_;
  Index count_ = 0;
};

std::vector<TopoDS_Shape> listed(const TopTools_IndexedMapOfShape& shapes);
/// The faces of a shape in the order of exploration, each once.
std::vector<TopoDS_Shape> faces_of(const TopoDS_Shape& shape);

/// A name as people wrote it: one line of valid UTF-8 without blanks around it; "" for the placeholders that
/// CAD systems write where nobody gave a name ("NONE", the entity's own number).
std::string clean_name(const std::string& raw);

/// Chooses each face's group, the patch name that it offers: the first of its own name, its solid's, its
/// part's, its layer, its colour, its file that it has and that does not say the same of every face. (A
/// product name around a coloured solid tells nothing apart; its colours do.) Else its name, solid or part.
void choose_groups(std::vector<CadFace>& faces);

}  // namespace flowcage::occ
