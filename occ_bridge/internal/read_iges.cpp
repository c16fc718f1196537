#include <IFSelect_ReturnStatus.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESCAFControl.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_LevelListEntity.hxx>
#include <IGESGraph_Color.hxx>
#include <Quantity_Color.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "occ_bridge/internal/face_labels.hpp"
#include "occ_bridge/internal/file_readers.hpp"

namespace flowcage::occ {

namespace {

/// What a directory entry says, and the faces that its entity became.
struct Statement {
  CadFace label{};
  TopoDS_Shape shape{};
  int faces = 0;
};

std::string color_of(const IGESData_IGESEntity& entity) {
  if (entity.DefColor() == IGESData_DefReference) {
    const auto definition = Handle(IGESGraph_Color)::DownCast(entity.Color());
    if (definition.IsNull()) return {};
    double red = 0, green = 0, blue = 0;  // in percent
    definition->RGBIntensity(red, green, blue);
    const auto byte = [](double percent) {
      return static_cast<int>(std::lround(255 * std::clamp(percent / 100, 0.0, 1.0)));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(red), byte(green), byte(blue));
  }
  if (entity.DefColor() != IGESData_DefValue) return {};
  std::string hex = Quantity_Color::ColorToHex(IGESCAFControl::DecodeColor(entity.RankColor())).ToCString();
  std::ranges::transform(hex, hex.begin(), [](unsigned char c) { return std::tolower(c); });
  return hex;
}

std::string layer_of(const IGESData_IGESEntity& entity) {
  if (entity.DefLevel() == IGESData_DefSeveral && !entity.LevelList().IsNull() &&
      entity.LevelList()->NbLevelNumbers() > 0) {
    return std::to_string(entity.LevelList()->LevelNumber(1));
  }
  return entity.DefLevel() == IGESData_DefOne ? std::to_string(entity.Level()) : std::string();
}

/// Type numbers of the IGES specification.
bool is_face(int type) {
  return type == 143 || type == 144 || type == 510;  // bounded, trimmed, B-rep face
}
bool is_body(int type) {
  return type == 186 || type == 514;  // solid, shell
}
bool is_group(int type) {
  return type == 308 || type == 408 || type == 402;  // subfigure, its instance, associativity
}

Statement statement_of(const IGESData_IGESEntity& entity, const TopoDS_Shape& shape) {
  Statement statement{.shape = shape};
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  statement.faces = faces.Extent();
  statement.label.color = color_of(entity);
  statement.label.layer = layer_of(entity);
  const int type = entity.TypeNumber();
  std::string name;
  if (entity.HasName() && !entity.NameValue().IsNull()) name = clean_name(entity.NameValue()->ToCString());
  if (type == 308) {
    const auto* figure = dynamic_cast<const IGESBasic_SubfigureDef*>(&entity);
    if (figure != nullptr && !figure->Name().IsNull()) name = clean_name(figure->Name()->ToCString());
  }
  (is_group(type)  ? statement.label.part
   : is_body(type) ? statement.label.solid
                   : statement.label.name) = name;
  return statement;
}

/// The nearest statement counts: entities of few faces first, and what is said is not said again.
void label_faces(std::vector<Statement> statements, const TopoDS_Shape& whole, PlacedLabels& labels) {
  const auto fill = [](CadFace& label, const CadFace& from) {
    for (const auto field :
         {&CadFace::name, &CadFace::solid, &CadFace::part, &CadFace::layer, &CadFace::color}) {
      if ((label.*field).empty()) label.*field = from.*field;
    }
  };
  std::ranges::stable_sort(statements, {}, &Statement::faces);
  for (const Statement& statement : statements) {
    for (TopExp_Explorer it(statement.shape, TopAbs_FACE); it.More(); it.Next()) {
      fill(labels[it.Current()], statement.label);
    }
  }
  // Faces of a subfigure's instances: their own entities know them at the definition's place.
  for (TopExp_Explorer it(whole, TopAbs_FACE); it.More(); it.Next()) {
    const auto defined = labels.find(it.Current().Located(TopLoc_Location()));
    if (defined == labels.end()) continue;
    const CadFace label = defined->second;
    fill(labels[it.Current()], label);
  }
}

}  // namespace

RawContent read_iges(const std::string& file, Progress& progress) {
  const KernelScope scope(KernelScope::Parameters{{"xstep.cascade.unit", "MM"}});
  RawContent raw{.content = {.file = file, .format = "IGES"}};
  FileContent& content = raw.content;
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
  const double named = metres_per_unit(content.unit);
  if (named > 0 && std::abs(named - content.unit_in_metres) > 1e-6 * named) {
    content.warnings.push_back(fmt::format(
        "its unit flag says {:g} m, its unit's name '{}'; the flag is taken (--cad-unit overrules it)",
        content.unit_in_metres, content.unit));
  }

  const std::string stage = "read " + file;
  const Handle(KernelProgress) bridge = new KernelProgress(progress, stage);
  const std::string stopped = failure_of([&] { reader.TransferRoots(bridge->Start()); });
  progress.step(stage, 1.0);
  if (!stopped.empty()) {
    content.warnings.push_back("conversion stopped early (" + stopped + "): part of the model is missing");
  }
  content.shape = reader.OneShape();

  std::vector<std::string> lost;
  std::vector<Statement> statements;
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(model->Value(i));
    if (entity.IsNull()) continue;
    const Handle(Transfer_Binder) binder = process->Find(entity);
    const TopoDS_Shape shape = binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder);
    if (shape.IsNull()) {
      if (is_face(entity->TypeNumber())) {
        lost.push_back("at directory line " + std::to_string(2 * model->Number(entity) - 1));
      }
      continue;
    }
    const std::string failed = failure_of([&] { statements.push_back(statement_of(*entity, shape)); });
    if (!failed.empty()) {
      content.warnings.push_back(
          fmt::format("name, colour and layer at directory line {} cannot be read ({})", 2 * i - 1, failed));
    }
  }
  warn_of_lost_faces(lost, content);
  label_faces(std::move(statements), content.shape, raw.labels);
  return raw;
}

}  // namespace flowcage::occ
