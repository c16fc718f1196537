#pragma once
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <string>

namespace flowcage::test_shapes {

/// What the kernel's own reader makes of a STEP, IGES or BREP file: nothing sewn, nothing healed. Null where
/// it transfers nothing.
inline TopoDS_Shape read_shape(const std::string& file) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  TopoDS_Shape shape;
  const auto transfer = [&](XSControl_Reader& reader) {
    if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return;
    reader.TransferRoots();
    shape = reader.OneShape();
  };
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".brep") {
    BRepTools::Read(shape, file.c_str(), BRep_Builder());
  } else if (extension == ".igs" || extension == ".iges") {
    IGESControl_Reader reader;
    transfer(reader);
  } else {
    STEPControl_Reader reader;
    transfer(reader);
  }
  return shape;
}

}  // namespace flowcage::test_shapes
