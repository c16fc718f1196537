#include "occ_bridge/internal/face_labels.hpp"

#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <algorithm>
#include <array>
#include <string_view>

namespace flowcage::occ {

namespace {

/// Bytes of the UTF-8 sequence that starts here; 0 where none does.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  if (length > 2) {  // overlong forms, surrogates, beyond U+10FFFF
    const unsigned second = byte(1);
    if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
        (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F)) {
      return 0;
    }
  }
  return length;
}

}  // namespace

void FaceLabels::set(const TopoDS_Shape& face, CadFace label) {
  labels_[face.TShape().get()] = {face.TShape(), std::move(label)};
}

const CadFace& FaceLabels::of(const TopoDS_Shape& face) const {
  static const CadFace none;
  const auto found = labels_.find(face.TShape().get());
  return found == labels_.end() ? none : found->second.label;
}

void FaceLabels::inherit(const TopoDS_Shape& from, const TopoDS_Shape& to) {
  const auto found = labels_.find(from.TShape().get());
  if (found == labels_.end() || to.IsNull()) return;
  const CadFace label = found->second.label;  // set() may move the table
  for (TopExp_Explorer it(to, TopAbs_FACE); it.More(); it.Next()) {
    if (!labels_.contains(it.Current().TShape().get())) set(it.Current(), label);
  }
}

void FaceLabels::number(const TopoDS_Shape& face, CadFace label) {
  label.number = ++count_;
  set(face, std::move(label));
}

std::string FaceLabels::word_for(const TopoDS_Shape& face) const {
  const Index number = of(face).number;
  return number > 0 ? "face " + std::to_string(number) : std::string("a face");
}

std::vector<TopoDS_Shape> listed(const TopTools_IndexedMapOfShape& shapes) {
  std::vector<TopoDS_Shape> result;
  for (int i = 1; i <= shapes.Extent(); ++i) result.push_back(shapes(i));
  return result;
}

std::vector<TopoDS_Shape> faces_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return listed(faces);
}

std::string clean_name(const std::string& raw) {
  std::string name;
  for (std::string_view rest = raw; !rest.empty();) {
    const std::size_t length = sequence_length(rest);
    if (length == 0) {
      name += "\xEF\xBF\xBD";  // the replacement character
    } else if (length == 1 && (static_cast<unsigned char>(rest[0]) < 0x20 || rest[0] == 0x7F)) {
      name += ' ';
    } else {
      name += rest.substr(0, length);
    }
    rest.remove_prefix(std::max<std::size_t>(1, length));
  }
  name.erase(0, name.find_first_not_of(' '));
  name.erase(name.find_last_not_of(' ') + 1);
  static constexpr std::array<std::string_view, 3> exact{"NONE", "UNNAMED", "Unnamed"};
  static constexpr std::array<std::string_view, 2> starts{"Open CASCADE STEP translator", "=>["};
  if (std::ranges::find(exact, name) != exact.end()) return {};
  if (std::ranges::any_of(starts, [&](std::string_view start) { return name.starts_with(start); })) return {};
  const bool entity_number =
      name.size() > 1 && name[0] == '#' && name.find_first_not_of("0123456789", 1) == std::string::npos;
  return entity_number ? std::string() : name;
}

void choose_groups(std::vector<CadFace>& faces) {
  static constexpr std::array fields{&CadFace::name,  &CadFace::solid, &CadFace::part,
                                     &CadFace::layer, &CadFace::color, &CadFace::file};
  for (CadFace& face : faces) face.group.clear();
  const auto fill = [&](std::string CadFace::*field) {
    for (CadFace& face : faces) {
      if (face.group.empty()) face.group = face.*field;
    }
  };
  for (const auto field : fields) {
    const bool same =
        std::ranges::all_of(faces, [&](const CadFace& face) { return face.*field == faces.front().*field; });
    if (!same) fill(field);
  }
  for (const auto field : {&CadFace::name, &CadFace::solid, &CadFace::part}) fill(field);
}

}  // namespace flowcage::occ
