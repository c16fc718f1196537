#include "occ_bridge/internal/read_files.hpp"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_SolidModel.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

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

/// Our short name where we know the unit, else the file's in lower case.
std::string unit_name(const std::string& name) {
  const LengthUnit* known = known_unit(name);
  return known == nullptr ? lower(name) : std::string(known->names[0]);
}

Index count_faces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  if (!shape.IsNull()) TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent();
}

/// The kernel's first complaint, for errors whose cause it knows better than we do.
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

/// A STEP or IGES reader that has loaded its file: everything it can convert, and what it could not.
void transfer_all(XSControl_Reader& reader, FileContent& content, Progress& progress) {
  const std::string stage = "read " + content.file;
  const Handle(KernelProgress) bridge = new KernelProgress(progress, stage);
  const std::string failure = failure_of([&] { reader.TransferRoots(bridge->Start()); });
  progress.step(stage, 1.0);
  if (!failure.empty()) {
    content.warnings.push_back("conversion stopped early (" + failure + "): part of the model is missing");
  }
  content.shape = reader.OneShape();
}

/// Calls `visit(entity, converted shape or null)` for each entity of the model.
template <typename Visit>
void for_each_entity(const XSControl_Reader& reader, const Visit& visit) {
  const auto model = reader.Model();
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = model->Value(i);
    const Handle(Transfer_Binder) binder = process->Find(entity);
    visit(entity, binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder));
  }
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

FileContent read_step(const std::string& file, FaceNames& names, Progress& progress) {
  const KernelScope scope(KernelScope::Parameters{{"xstep.cascade.unit", "MM"}});
  FileContent content{.file = file, .format = "STEP"};
  STEPControl_Reader reader;
  IFSelect_ReturnStatus status = IFSelect_RetFail;
  const std::string failure = failure_of([&] { status = reader.ReadFile(file.c_str()); });
  if (!failure.empty() || status != IFSelect_RetDone || reader.Model().IsNull()) {
    throw input_error(
        file, 0, "the STEP data cannot be parsed" + (failure.empty() ? first_failure(scope) : ": " + failure),
        "export the file again from the CAD system");
  }
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  failure_of([&] { reader.FileUnits(lengths, angles, solid_angles); });
  content.unit = lengths.IsEmpty() ? "" : unit_name(lengths.First().ToCString());
  for (int i = 2; i <= lengths.Length(); ++i) {
    const std::string other = unit_name(lengths(i).ToCString());
    if (other != content.unit) {
      content.warnings.push_back("parts are in different units (" + content.unit + ", " + other +
                                 "); each is read in its own");
      break;
    }
  }
  transfer_all(reader, content, progress);

  std::vector<std::string> lost;
  for_each_entity(reader, [&](const Handle(Standard_Transient) & entity, const TopoDS_Shape& result) {
    const bool is_face = entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
    const bool is_solid = entity->IsKind(STANDARD_TYPE(StepShape_SolidModel));
    if (!is_face && !is_solid) return;
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    const std::string name = item.IsNull() || item->Name().IsNull() ? "" : item->Name()->ToCString();
    if (is_solid && !result.IsNull() && !name.empty()) content.solid_names.push_back(name);
    if (!is_face) return;
    if (result.IsNull()) lost.push_back('#' + std::to_string(reader.Model()->Number(entity)));
    if (!result.IsNull() && !name.empty()) names.set(result, name);
  });
  warn_of_lost_faces(lost, content);
  return content;
}

FileContent read_iges(const std::string& file, FaceNames& names, Progress& progress) {
  const KernelScope scope(KernelScope::Parameters{{"xstep.cascade.unit", "MM"}});
  FileContent content{.file = file, .format = "IGES"};
  IGESControl_Reader reader;
  IFSelect_ReturnStatus status = IFSelect_RetFail;
  const std::string failure = failure_of([&] { status = reader.ReadFile(file.c_str()); });
  const auto model = reader.IGESModel();
  if (!failure.empty() || status != IFSelect_RetDone || model.IsNull()) {
    throw input_error(
        file, 0, "the IGES data cannot be parsed" + (failure.empty() ? first_failure(scope) : ": " + failure),
        "export the file again from the CAD system");
  }
  const Handle(TCollection_HAsciiString) unit = model->GlobalSection().UnitName();
  content.unit = unit.IsNull() ? "" : unit_name(unit->ToCString());
  content.unit_in_metres = 1e-3 * model->GlobalSection().UnitValue();
  transfer_all(reader, content, progress);

  std::vector<std::string> lost;
  for_each_entity(reader, [&](const Handle(Standard_Transient) & item, const TopoDS_Shape& result) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(item);
    if (entity.IsNull()) return;
    const int type = entity->TypeNumber();
    const bool is_face = type == 143 || type == 144 || type == 510;  // bounded, trimmed, B-rep face
    if (is_face && result.IsNull()) {
      lost.push_back("at directory line " + std::to_string(2 * model->Number(entity) - 1));
    }
    if (!result.IsNull() && entity->HasName() && !entity->NameValue().IsNull()) {
      std::string name = entity->NameValue()->ToCString();
      std::erase(name, ' ');
      if (name.empty()) return;
      for (TopExp_Explorer it(result, TopAbs_FACE); it.More(); it.Next()) names.set(it.Current(), name);
    }
  });
  warn_of_lost_faces(lost, content);
  return content;
}

FileContent read_brep(const std::string& file, const std::string& cad_unit, Progress& progress) {
  const KernelScope scope;
  FileContent content{.file = file, .format = "BREP", .shape_unit = 1.0};
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
  return content;
}

}  // namespace

void FaceNames::set(const TopoDS_Shape& face, std::string name) {
  names_[face.TShape().get()] = {face.TShape(), std::move(name)};
}

const std::string& FaceNames::of(const TopoDS_Shape& face) const {
  static const std::string none;
  const auto found = names_.find(face.TShape().get());
  return found == names_.end() ? none : found->second.name;
}

void FaceNames::inherit(const TopoDS_Shape& from, const TopoDS_Shape& to) {
  const std::string name = of(from);
  if (name.empty() || to.IsNull()) return;
  for (TopExp_Explorer it(to, TopAbs_FACE); it.More(); it.Next()) {
    if (of(it.Current()).empty()) set(it.Current(), name);
  }
}

double metres_per_unit(const std::string& unit) {
  const LengthUnit* known = known_unit(unit);
  return known == nullptr ? 0 : known->metres;
}

FileContent read_cad_file(const std::string& file, const std::string& cad_unit, FaceNames& names,
                          Progress& progress) {
  progress.step("read " + file, 0.0);
  if (!cad_unit.empty() && metres_per_unit(cad_unit) <= 0) {
    throw Error(ErrorKind::usage, "unknown CAD unit '" + cad_unit + "'", "use m, mm, cm, in or ft");
  }
  const Sniff sniff = sniff_cad_file(file);
  FileContent content;
  switch (sniff.format) {
    case CadFormat::step:
      content = read_step(file, names, progress);
      break;
    case CadFormat::iges:
      content = read_iges(file, names, progress);
      break;
    case CadFormat::brep:
      content = read_brep(file, cad_unit, progress);
      break;
    case CadFormat::unknown:
      throw input_error(file, 0, sniff.problem, formats_hint);
  }
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
  return content;
}

}  // namespace flowcage::occ
