#include "tests/occ_bridge/labelled_cad.hpp"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TDF_Label.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <filesystem>
#include <gp_Pln.hxx>
#include <mutex>
#include <stdexcept>

#include "occ_bridge/internal/occ_globals.hpp"
#include "occ_bridge/internal/shape_rep.hpp"

namespace flowcage {
namespace {

TopoDS_Shape in_millimetres(const Shape& shape) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), 1000);
  return BRepBuilderAPI_Transform(shape.rep().shape, scale, true).Shape();
}

class Document {
 public:
  Document() : document_(new TDocStd_Document("BinXCAF")) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    layers_ = XCAFDoc_DocumentTool::LayerTool(document_->Main());
  }

  void tag(const TDF_Label& label, const Tag& tag) const {
    if (!tag.name.empty()) TDataStd_Name::Set(label, TCollection_ExtendedString(tag.name.c_str()));
    Quantity_Color color;
    if (!tag.color.empty() && Quantity_Color::ColorFromHex(tag.color.c_str(), color)) {
      colors_->SetColor(label, color, XCAFDoc_ColorSurf);
    }
    if (!tag.layer.empty()) layers_->SetLayer(label, TCollection_ExtendedString(tag.layer.c_str()));
  }

  void add(const std::vector<TaggedPart>& parts) const {
    const bool alone = parts.size() == 1 && parts[0].places.size() == 1;
    TopoDS_Compound nothing;
    BRep_Builder().MakeCompound(nothing);
    const TDF_Label root = alone ? TDF_Label() : shapes_->AddShape(nothing, true);
    if (!alone) TDataStd_Name::Set(root, "assembly");
    for (const TaggedPart& part : parts) {
      const TopoDS_Shape shape = in_millimetres(part.shape);
      const TDF_Label label = shapes_->AddShape(shape, false);
      tag(label, part.tag);
      TopTools_IndexedMapOfShape faces;
      TopExp::MapShapes(shape, TopAbs_FACE, faces);
      for (std::size_t f = 0; f < part.faces.size(); ++f) {
        tag(shapes_->AddSubShape(label, faces(static_cast<int>(f) + 1)), part.faces[f]);
      }
      for (std::size_t i = 0; !alone && i < part.places.size(); ++i) {
        gp_Trsf move;
        const Vec3 by = 1000 * part.places[i];
        move.SetTranslation(gp_Vec(by.x(), by.y(), by.z()));
        const TDF_Label instance = shapes_->AddComponent(root, label, TopLoc_Location(move));
        if (i < part.instances.size()) tag(instance, part.instances[i]);
      }
    }
    shapes_->UpdateAssemblies();
  }

  const Handle(TDocStd_Document) & get() const { return document_; }

 private:
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  Handle(XCAFDoc_LayerTool) layers_;
};

}  // namespace

void write_tagged(const std::vector<TaggedPart>& parts, const std::string& file, const std::string& unit) {
  const std::lock_guard lock(occ_globals_mutex());
  silence_occ();
  const InterfaceSettings settings(
      {{"xstep.cascade.unit", "MM"}, {"write.step.unit", unit}, {"write.iges.unit", unit}});
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  Document document;
  document.add(parts);
  bool done = false;
  if (std::filesystem::path(file).extension() == ".step") {
    STEPCAFControl_Writer writer;
    done = writer.Transfer(document.get()) && writer.Write(file.c_str()) == IFSelect_RetDone;
  } else {
    IGESCAFControl_Writer writer;
    done = writer.Transfer(document.get()) && writer.Write(file.c_str());
  }
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 0);
  if (!done) throw std::runtime_error("cannot write " + file);
}

Shape make_faces(const std::vector<std::vector<Vec3>>& polygons, bool sewn) {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  BRepBuilderAPI_Sewing sewing(1e-9);
  for (const std::vector<Vec3>& polygon : polygons) {
    BRepBuilderAPI_MakePolygon wire;
    for (const Vec3& p : polygon) wire.Add(gp_Pnt(p.x(), p.y(), p.z()));
    wire.Close();
    const TopoDS_Shape face = BRepBuilderAPI_MakeFace(wire.Wire(), true).Shape();
    builder.Add(all, face);
    sewing.Add(face);
  }
  if (!sewn) return wrap(all);
  sewing.Perform();
  return wrap(sewing.SewedShape());
}

Shape make_folded_roof() {
  // Degree 1 in both directions: poles at both eaves and the ridge.
  TColgp_Array2OfPnt poles(1, 3, 1, 2);
  const double x[] = {0, 1, 2}, y[] = {0, 1, 0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) poles.SetValue(i + 1, j + 1, gp_Pnt(x[i], y[i], j));
  }
  TColStd_Array1OfReal u_knots(1, 3), v_knots(1, 2);
  TColStd_Array1OfInteger u_count(1, 3), v_count(1, 2);
  for (int i = 0; i < 3; ++i) {
    u_knots.SetValue(i + 1, i);
    u_count.SetValue(i + 1, i == 1 ? 1 : 2);
  }
  for (int j = 0; j < 2; ++j) {
    v_knots.SetValue(j + 1, j);
    v_count.SetValue(j + 1, 2);
  }
  const Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(poles, u_knots, v_knots, u_count, v_count, 1, 1);
  BRepBuilderAPI_Sewing sewing(1e-6);
  const TopoDS_Shape roof = BRepBuilderAPI_MakeFace(surface, 1e-7).Shape();
  sewing.Add(roof);
  for (int j = 0; j < 2; ++j) {  // gables: the roof's own edge, and the floor's
    const Handle(Geom_Curve) fold = surface->VIso(j);
    const TopoDS_Edge over = BRepBuilderAPI_MakeEdge(fold).Edge();
    const TopoDS_Edge under = BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, j), gp_Pnt(2, 0, j)).Edge();
    const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(over, under).Wire();
    sewing.Add(BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, j), gp_Dir(0, 0, 1)), wire).Shape());
  }
  BRepBuilderAPI_MakePolygon floor(gp_Pnt(0, 0, 0), gp_Pnt(2, 0, 0), gp_Pnt(2, 0, 1), gp_Pnt(0, 0, 1), true);
  sewing.Add(BRepBuilderAPI_MakeFace(floor.Wire(), true).Shape());
  sewing.Perform();
  return wrap(sewing.SewedShape());
}

}  // namespace flowcage
