#include <BRepBuilderAPI_Transform.hxx>
#include <BRepTools.hxx>
#include <IGESControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <algorithm>
#include <filesystem>

#include "core/base/error.hpp"
#include "occ_bridge/internal/kernel_units.hpp"
#include "occ_bridge/internal/occ_globals.hpp"
#include "occ_bridge/internal/shape_rep.hpp"

namespace flowcage {
namespace {

void write_step(const TopoDS_Shape& shape, const std::string& file, const std::string& unit) {
  const InterfaceSettings settings({{"xstep.cascade.unit", "M"}, {"write.step.unit", unit}});
  STEPControl_Writer writer;
  if (writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone ||
      writer.Write(file.c_str()) != IFSelect_RetDone) {
    throw Error(ErrorKind::output, file + ": cannot write STEP",
                "check the folder, its permissions and free space");
  }
}

void write_iges(const TopoDS_Shape& shape, const std::string& file, const std::string& unit) {
  // Unlike the STEP writer this one takes the shape for millimetres whatever xstep.cascade.unit says.
  const InterfaceSettings settings({{"xstep.cascade.unit", "MM"}, {"write.iges.unit", unit}});
  gp_Trsf to_millimetres;
  to_millimetres.SetScale(gp_Pnt(0, 0, 0), 1000);
  IGESControl_Writer writer(unit.c_str(), 0);
  if (!writer.AddShape(BRepBuilderAPI_Transform(shape, to_millimetres, true).Shape()) ||
      !writer.Write(file.c_str())) {
    throw Error(ErrorKind::output, file + ": cannot write IGES",
                "check the folder, its permissions and free space");
  }
}

}  // namespace

void write_cad(const Shape& shape, const std::string& file, const std::string& unit) {
  const std::string known = kernel_unit(unit);
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::lock_guard lock(occ_globals_mutex());
  silence_occ();
  if (extension == ".step" || extension == ".stp") {
    write_step(shape.rep().shape, file, known);
  } else if (extension == ".iges" || extension == ".igs") {
    write_iges(shape.rep().shape, file, known);
  } else if (extension == ".brep") {
    if (!BRepTools::Write(shape.rep().shape, file.c_str())) {
      throw Error(ErrorKind::output, file + ": cannot write BREP",
                  "check the folder, its permissions and free space");
    }
  } else {
    throw Error(ErrorKind::usage, file + ": unknown CAD format", "use .step, .stp, .iges, .igs or .brep");
  }
}

}  // namespace flowcage
