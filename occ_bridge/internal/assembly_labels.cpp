#include "occ_bridge/internal/assembly_labels.hpp"

#include <Quantity_Color.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cctype>

#include "occ_bridge/internal/face_labels.hpp"

namespace flowcage::occ {

namespace {

/// What is handed down from the outside to the inside of an assembly.
struct Style {
  std::string color{}, layer{};
  Style over(const Style& outer) const {
    return {color.empty() ? outer.color : color, layer.empty() ? outer.layer : layer};
  }
};
using SubShapeStyles = std::unordered_map<const TopoDS_TShape*, Style>;

void name_down(const TopoDS_Shape& shape, const EntityNames& names, CadFace label,
               const SubShapeStyles& styles, Style style, PlacedLabels& labels) {
  if (shape.IsNull()) return;
  const auto styled = styles.find(shape.TShape().get());
  if (styled != styles.end()) style = styled->second.over(style);
  const auto named = names.find(shape.TShape().get());
  const TopAbs_ShapeEnum kind = shape.ShapeType();
  if (kind == TopAbs_FACE) {
    if (named != names.end()) label.name = named->second;
    label.color = style.color;
    label.layer = style.layer;
    labels[shape] = std::move(label);
    return;
  }
  if (kind > TopAbs_FACE) return;
  const bool names_body = kind == TopAbs_SOLID || (kind == TopAbs_SHELL && label.solid.empty());
  if (names_body && named != names.end()) label.solid = named->second;
  for (TopoDS_Iterator it(shape); it.More(); it.Next()) {
    name_down(it.Value(), names, label, styles, style, labels);
  }
}

class Walk {
 public:
  Walk(const TDF_Label& main, const EntityNames& names, PlacedLabels& labels)
      : colors_(XCAFDoc_DocumentTool::ColorTool(main)),
        layers_(XCAFDoc_DocumentTool::LayerTool(main)),
        names_(names),
        labels_(labels) {}

  /// `around`: part and instance path so far.
  void visit(const TDF_Label& label, const TopLoc_Location& location, CadFace around, const Style& outer) {
    Style style = style_of(label).over(outer);
    TDF_Label shape_label = label;
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      if (!XCAFDoc_ShapeTool::GetReferredShape(label, shape_label)) return;
      const std::string instance = name_of(label);
      if (!instance.empty()) around.instance += (around.instance.empty() ? "" : "/") + instance;
      style = style_of(label).over(style_of(shape_label)).over(outer);
    }
    const TopLoc_Location here =
        XCAFDoc_ShapeTool::IsReference(label) ? location * XCAFDoc_ShapeTool::GetLocation(label) : location;
    if (XCAFDoc_ShapeTool::IsAssembly(shape_label)) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(shape_label, components);
      for (const TDF_Label& component : components) visit(component, here, around, style);
      return;
    }
    around.part = name_of(shape_label);
    SubShapeStyles styles;
    TDF_LabelSequence inside;
    XCAFDoc_ShapeTool::GetSubShapes(shape_label, inside);
    for (const TDF_Label& sub : inside) {
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(sub);
      if (!shape.IsNull()) styles[shape.TShape().get()] = style_of(sub);
    }
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(shape_label);
    if (!shape.IsNull()) name_down(shape.Moved(here), names_, around, styles, style, labels_);
  }

 private:
  static std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    return clean_name(TCollection_AsciiString(name->Get()).ToCString());
  }

  Style style_of(const TDF_Label& label) const {
    Style style;
    Quantity_Color color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
      if (!style.color.empty() || !colors_->GetColor(label, type, color)) continue;
      style.color = Quantity_Color::ColorToHex(color).ToCString();
      std::ranges::transform(style.color, style.color.begin(),
                             [](unsigned char c) { return std::tolower(c); });
    }
    Handle(TColStd_HSequenceOfExtendedString) names;
    if (layers_->GetLayers(label, names) && !names.IsNull() && !names->IsEmpty()) {
      style.layer = clean_name(TCollection_AsciiString(names->First()).ToCString());
    }
    return style;
  }

  Handle(XCAFDoc_ColorTool) colors_;
  Handle(XCAFDoc_LayerTool) layers_;
  const EntityNames& names_;
  PlacedLabels& labels_;
};

}  // namespace

void label_entities(const TopoDS_Shape& shape, const EntityNames& names, PlacedLabels& labels) {
  name_down(shape, names, {}, {}, {}, labels);
}

void label_instances(const Handle(TDocStd_Document) & document, const EntityNames& names,
                     PlacedLabels& labels) {
  Walk walk(document->Main(), names, labels);
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
  for (const TDF_Label& root : roots) walk.visit(root, {}, {}, {});
}

}  // namespace flowcage::occ
