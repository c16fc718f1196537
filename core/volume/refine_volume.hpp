#pragma once
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// One step of 3-D Catmull-Clark subdivision of a block mesh: divisions double, cells grow eightfold, the
/// complex stays (a copy with decayed sharpness where it has semi-sharp edges).
///
/// Inside: cell, face, edge and vertex points as volume/volume_masks says (Joy & MacCracken 1996; Bajaj,
/// Schaefer, Warren & Xu 2002). The boundary is a 2-D Catmull-Clark surface with creases at the complex's
/// sharp edges and corners, independent of the inside (Rom & Brakhage 2011 leave it open; docs/theory.md): it
/// agrees with core/subdivide to rounding. A boundary in a plane of constant x, y or z stays in it to the
/// last bit. Parallel; the same bits on any number of threads. Memory: both point sets, and a few planes of a
/// block a thread. Throws Error(input) when Index cannot number the points.
BlockMesh refine_volume(const BlockMesh& parent);

}  // namespace flowcage
