#pragma once
#include <TDocStd_Document.hxx>
#include <string>
#include <unordered_map>

#include "occ_bridge/internal/file_readers.hpp"

namespace flowcage::occ {

/// Names that a file gives to single faces, shells and solids, by their geometry's handle.
using EntityNames = std::unordered_map<const TopoDS_TShape*, std::string>;

/// Labels every face of `shape` with its own name and its solid's (else its shell's).
void label_entities(const TopoDS_Shape& shape, const EntityNames& names, PlacedLabels& labels);

/// Walks the product structure of an XCAF document and labels the faces of every instance: product, path of
/// instance names, colour and layer. The nearest one counts: a face's own colour before its solid's, before
/// its instance's, before its part's, before those of the assemblies around it; layers alike. A colour given
/// to one occurrence deep in an assembly from far above (SHUO) is not seen.
void label_instances(const Handle(TDocStd_Document) & document, const EntityNames& names,
                     PlacedLabels& labels);

}  // namespace flowcage::occ
