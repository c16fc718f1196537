#pragma once
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

/// A model after everything in which the kernel may fail badly: read, sewn, split, oriented, triangulated.
struct PreparedModel {
  TopoDS_Shape shape{};         ///< with triangulations
  double metres = 1;            ///< per length unit of `shape`
  double deflection = 0;        ///< of the triangulation, in the shape's length unit
  std::vector<CadFace> labels;  ///< of the faces, in the order of exploration
  std::vector<Index> bodies;    ///< which body each face comes from; empty where none was united
  CadSummary summary;           ///< files, unit, selection, sewing, names of solids and warnings so far
};

/// From the files' shapes: the chosen faces, one unit, without slivers, sewn, split at kinks, oriented,
/// triangulated. Precondition: each content has at least one face.
PreparedModel prepare_model(std::vector<FileContent> contents, FaceLabels& labels,
                            const CadReadSettings& settings, Progress& progress);

/// To bytes and back without loss, for the way between two processes.
std::string bytes_of(const PreparedModel& model);
PreparedModel prepared_from(const std::string& bytes);

}  // namespace flowcage::occ
