#include <IFSelect_ReturnStatus.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include "occ_bridge/internal/assembly_labels.hpp"
#include "occ_bridge/internal/face_labels.hpp"
#include "occ_bridge/internal/file_readers.hpp"

namespace flowcage::occ {

namespace {

/// The document tools invent names ("SOLID", "COMPOUND") where the file has none, unless told not to.
class WithoutInventedNames {
 public:
  WithoutInventedNames() : before_(XCAFDoc_ShapeTool::AutoNaming()) {
    XCAFDoc_ShapeTool::SetAutoNaming(false);
  }
  ~WithoutInventedNames() { XCAFDoc_ShapeTool::SetAutoNaming(before_); }
  WithoutInventedNames(const WithoutInventedNames&) = delete;
  WithoutInventedNames& operator=(const WithoutInventedNames&) = delete;

 private:
  Standard_Boolean before_;
};

void read_units(STEPControl_Reader& reader, FileContent& content) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  failure_of([&] { reader.FileUnits(lengths, angles, solid_angles); });
  content.unit = lengths.IsEmpty() ? "" : unit_name(lengths.First().ToCString());
  for (int i = 2; i <= lengths.Length(); ++i) {
    const std::string other = unit_name(lengths(i).ToCString());
    if (other == content.unit) continue;
    content.warnings.push_back("parts are in different units (" + content.unit + ", " + other +
                               "); each is read in its own");
    break;
  }
}

/// Names of faces, shells and solids, and the faces that the kernel could not convert.
EntityNames read_entities(const STEPControl_Reader& reader, FileContent& content) {
  EntityNames names;
  std::vector<std::string> lost;
  const auto model = reader.Model();
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = model->Value(i);
    const bool is_face = entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
    const bool is_solid = entity->IsKind(STANDARD_TYPE(StepShape_SolidModel));
    const bool is_shell = entity->IsKind(STANDARD_TYPE(StepShape_ConnectedFaceSet)) ||
                          entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel));
    if (!is_face && !is_solid && !is_shell) continue;
    const Handle(Transfer_Binder) binder = process->Find(entity);
    const TopoDS_Shape shape = binder.IsNull() ? TopoDS_Shape() : TransferBRep::ShapeResult(binder);
    if (shape.IsNull()) {
      if (is_face) lost.push_back('#' + std::to_string(model->Number(entity)));
      continue;
    }
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    if (item.IsNull() || item->Name().IsNull()) continue;
    const std::string name = clean_name(item->Name()->ToCString());
    if (name.empty()) continue;
    names.emplace(shape.TShape().get(), name);
    if (is_solid) content.solid_names.push_back(name);
  }
  warn_of_lost_faces(lost, content);
  return names;
}

}  // namespace

RawContent read_step(const std::string& file, Progress& progress) {
  const KernelScope scope(KernelScope::Parameters{{"xstep.cascade.unit", "MM"}});
  const WithoutInventedNames scope_of_names;
  RawContent raw{.content = {.file = file, .format = "STEP"}};
  FileContent& content = raw.content;
  STEPCAFControl_Reader reader;
  reader.SetPropsMode(Standard_False);
  reader.SetGDTMode(Standard_False);
  reader.SetMatMode(Standard_False);
  reader.SetViewMode(Standard_False);
  IFSelect_ReturnStatus status = IFSelect_RetFail;
  const std::string failure = failure_of([&] { status = reader.ReadFile(file.c_str()); });
  if (!failure.empty() || status != IFSelect_RetDone || reader.Reader().Model().IsNull()) {
    throw input_error(
        file, 0, "the STEP data cannot be parsed" + (failure.empty() ? first_failure(scope) : ": " + failure),
        "export the file again from the CAD system");
  }
  read_units(reader.ChangeReader(), content);

  const std::string stage = "read " + file;
  const Handle(KernelProgress) bridge = new KernelProgress(progress, stage);
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  const std::string stopped = failure_of([&] { reader.Transfer(document, bridge->Start()); });
  progress.step(stage, 1.0);
  if (!stopped.empty()) {
    content.warnings.push_back("conversion stopped early (" + stopped + "): part of the model is missing");
  }
  content.shape = reader.Reader().OneShape();
  const EntityNames names = read_entities(reader.Reader(), content);
  label_entities(content.shape, names, raw.labels);
  const std::string unlabelled = failure_of([&] { label_instances(document, names, raw.labels); });
  if (!unlabelled.empty()) {
    content.warnings.push_back("its product structure cannot be read (" + unlabelled +
                               "): no names of parts, colours and layers");
  }
  return raw;
}

}  // namespace flowcage::occ
