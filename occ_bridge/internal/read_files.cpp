#include "occ_bridge/internal/read_files.hpp"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <unordered_set>

#include "occ_bridge/internal/file_readers.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/sniff.hpp"

namespace flowcage::occ {

namespace {

constexpr const char* formats_hint =
    "give a STEP (.step, .stp), IGES (.iges, .igs) or OpenCASCADE BREP (.brep) file";

struct LengthUnit {
  double metres;
  std::array<const char*, 5> names;  ///< the first is ours
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

const LengthUnit* known_unit(const std::string& name) {
  static constexpr std::array<LengthUnit, 10> units{{
      {1.0, {"m", "metre", "meter", "metres", "meters"}},
      {1e-3, {"mm", "millimetre", "millimeter", "millimetres", "millimeters"}},
      {1e-2, {"cm", "centimetre", "centimeter", "centimetres", "centimeters"}},
      {1e-6, {"um", "micrometre", "micrometer", "micron", "microns"}},
      {1e3, {"km", "kilometre", "kilometer", "kilometres", "kilometers"}},
      {0.0254, {"in", "inch", "inches", "\"", "inch_unit"}},
      {0.3048, {"ft", "foot", "feet", "'", "foot_unit"}},
      {1609.344, {"mi", "mile", "miles", "mile_unit", "statute_mile"}},
      {2.54e-5, {"mil", "mils", "thou", "milinch", "mil_unit"}},
      {2.54e-8, {"uin", "microinch", "microinches", "uinch", "microinch_unit"}},
  }};
  const std::string wanted = lower(name);
  for (const LengthUnit& unit : units) {
    if (std::ranges::any_of(unit.names, [&](const char* known) { return wanted == known; })) return &unit;
  }
  return nullptr;
}

Index count_faces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  if (!shape.IsNull()) TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent();
}

/// Solids, shells outside of solids, faces outside of shells, each once.
std::vector<TopoDS_Shape> bodies_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape bodies;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) bodies.Add(it.Current());
  for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) bodies.Add(it.Current());
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) bodies.Add(it.Current());
  return listed(bodies);
}

/// Numbers and labels the faces. Every instance of a part but the first gets geometry of its own, so that
/// what happens to a face (split, sewn, renamed) happens to that one alone.
void number_faces(RawContent& raw, FaceLabels& labels) {
  TopoDS_Compound whole;
  BRep_Builder builder;
  builder.MakeCompound(whole);
  std::unordered_set<const TopoDS_TShape*> seen;
  for (const TopoDS_Shape& body : bodies_of(raw.content.shape)) {
    const std::vector<TopoDS_Shape> faces = faces_of(body);
    const bool shares = std::ranges::any_of(
        faces, [&](const TopoDS_Shape& face) { return seen.contains(face.TShape().get()); });
    const TopoDS_Shape own = shares ? BRepBuilderAPI_Copy(body).Shape() : body;
    const std::vector<TopoDS_Shape> own_faces = faces_of(own);
    for (std::size_t f = 0; f < own_faces.size(); ++f) {
      seen.insert(own_faces[f].TShape().get());
      CadFace label = f < faces.size() ? raw.labels[faces[f]] : CadFace();
      label.file = std::filesystem::path(raw.content.file).stem().string();
      labels.number(own_faces[f], std::move(label));
    }
    builder.Add(whole, own);
  }
  raw.content.shape = whole;
}

}  // namespace

std::string unit_name(const std::string& name) {
  const LengthUnit* known = known_unit(name);
  return known == nullptr ? lower(name) : std::string(known->names[0]);
}

std::string first_failure(const KernelScope& scope) {
  for (const KernelMessage& message : scope.messages()) {
    if (message.gravity < Message_Alarm) continue;
    std::string text = message.text;
    std::ranges::replace_if(
        text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    while (!text.empty() && (text.front() == '*' || text.front() == ' ')) text.erase(0, 1);
    if (!text.empty()) return ": " + text.substr(0, 200);
  }
  return "";
}

void warn_of_lost_faces(const std::vector<std::string>& lost, FileContent& content) {
  constexpr std::size_t listed = 20;  // one line each, then only their number
  for (std::size_t i = 0; i < std::min(lost.size(), listed); ++i) {
    content.warnings.push_back("face " + lost[i] + " could not be converted and is left out");
  }
  if (lost.size() > listed) {
    content.warnings.push_back(std::to_string(lost.size() - listed) +
                               " more faces could not be converted and are left out");
  }
}

RawContent read_brep(const std::string& file, const std::string& cad_unit, Progress& progress) {
  const KernelScope scope;
  RawContent raw{.content = {.file = file, .format = "BREP", .shape_unit = 1.0}};
  FileContent& content = raw.content;
  BRep_Builder builder;
  bool done = false;
  const Handle(KernelProgress) bridge = new KernelProgress(progress, "read " + file);
  const std::string failure =
      failure_of([&] { done = BRepTools::Read(content.shape, file.c_str(), builder, bridge->Start()); });
  progress.step("read " + file, 1.0);
  if (!done || content.shape.IsNull()) {
    throw input_error(file, 0, "the BREP data cannot be parsed" + (failure.empty() ? "" : ": " + failure),
                      "export the file again from the CAD system");
  }
  if (cad_unit.empty()) {
    content.warnings.emplace_back(
        "the file states no unit: its numbers are taken as metres (--cad-unit overrules that)");
  }
  return raw;
}

double metres_per_unit(const std::string& unit) {
  const LengthUnit* known = known_unit(unit);
  return known == nullptr ? 0 : known->metres;
}

FileContent read_cad_file(const std::string& file, const std::string& cad_unit, FaceLabels& labels,
                          Progress& progress) {
  progress.step("read " + file, 0.0);
  if (!cad_unit.empty() && metres_per_unit(cad_unit) <= 0) {
    throw Error(ErrorKind::usage, "unknown CAD unit '" + cad_unit + "'", "use m, mm, cm, in or ft");
  }
  const Sniff sniff = sniff_cad_file(file);
  RawContent raw;
  switch (sniff.format) {
    case CadFormat::step:
      raw = read_step(file, progress);
      break;
    case CadFormat::iges:
      raw = read_iges(file, progress);
      break;
    case CadFormat::brep:
      raw = read_brep(file, cad_unit, progress);
      break;
    case CadFormat::unknown:
      throw input_error(file, 0, sniff.problem, formats_hint);
  }
  FileContent& content = raw.content;
  if (content.format == "STEP") content.unit_in_metres = metres_per_unit(content.unit);
  if (!(content.unit_in_metres > 0)) {
    // The kernel converts with the file's own factor; only overruling it needs to know that factor.
    if (!cad_unit.empty()) {
      throw input_error(file, 0,
                        "its length unit '" + content.unit + "' is unknown, so it cannot be overruled",
                        "leave out --cad-unit, or export the file in metres or millimetres");
    }
    content.warnings.push_back("unknown length unit '" + content.unit +
                               "': converted as the file defines it");
    content.unit_in_metres = 0;
  } else if (!cad_unit.empty()) {
    const double asked = metres_per_unit(cad_unit);
    content.shape_unit *= asked / content.unit_in_metres;
    content.unit_in_metres = asked;
  }
  if (count_faces(content.shape) == 0) {
    throw input_error(file, 0,
                      content.shape.IsNull() ? "no surface in it (nothing could be converted to a shape)"
                                             : "no surface in it (only curves or points)",
                      "export solids or surfaces, not a wire frame");
  }
  number_faces(raw, labels);
  return std::move(raw.content);
}

FileContent content_of(const TopoDS_Shape& shape, FaceLabels& labels) {
  RawContent raw;
  raw.content.file = std::string("(built in code)");
  raw.content.format = std::string("BREP");
  raw.content.unit = std::string("m");
  raw.content.shape_unit = 1;
  raw.content.shape = shape;
  number_faces(raw, labels);
  return std::move(raw.content);
}

}  // namespace flowcage::occ
