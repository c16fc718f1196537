#pragma once
#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <vector>

#include "core/limit/spectral_powers.hpp"

namespace flowcage {

/// The limit surface over one quad of a level whose parent has only quads, as combinations of the control
/// points round it: no mesh, no points (Stam, "Exact Evaluation of Catmull-Clark Subdivision Surfaces at
/// Arbitrary Parameter Values", SIGGRAPH 1998, extended to creases, corners, darts and boundaries).
///
/// Such a quad has corner 0 at any vertex P, corners 1 and 3 at points of edges of P, corner 2 at a face
/// point, so all that is irregular sits at P. Parameters (s,t) are (0,0) at P, (1,0) at corner 1, (0,1) at
/// corner 3.
///
/// Control points, in order: P; E[0..], the other ends of P's edges; F[0..], the opposite corners of P's
/// faces, F[i] between E[i] and E[i + 1]; and the seven outer points. With k the quad's place in the ring and
/// (x,y) steps from P along edges k and k + 1 they are
///
///      c1   a1 -- b1 -- d  2      E[k] = (1,0), F[k] = (1,1), E[k+1] = (0,1)
///     F[k+1] E[k+1] F[k] b0 1
///     E[k+2]  P -- E[k] a0  0     outer: c0 (2,-1), a0 (2,0), b0 (2,1), d (2,2), b1 (1,2), a1 (0,2), c1
///     (-1,2)
///       .   E[k-1] F[k-1] c0 -1
///
/// Beyond a boundary c0 or c1 does not exist; its weight is 0.
struct PatchShape {
  int edge_count = 4, face_count = 4;  ///< of P's ring; face_count == edge_count - 1 on a boundary
  int face = 0;                        ///< k
  double vertex_sharpness = 0;
  std::vector<double> edge_sharpness;  ///< of P's edges

  bool operator<(const PatchShape& other) const;
  int point_count() const { return 1 + edge_count + face_count + 7; }
};

/// Rows over a shape's control points: position, derivative by s, derivative by t.
using PatchRows = Eigen::MatrixXd;  // 3 x point_count

/// Everything about shapes that does not depend on (s,t), computed once for each.
class PatchShapes {
 public:
  PatchShapes();
  ~PatchShapes();
  PatchShapes(PatchShapes&&) noexcept;
  PatchShapes& operator=(PatchShapes&&) noexcept;

  /// The number of a shape, for `evaluate`; prepared on first use, with all shapes it refines to. Not
  /// thread-safe.
  int prepare(const PatchShape& shape);

  /// Exact up to rounding anywhere on the quad. At P itself, unless the quad is a plain bicubic, ds and dt
  /// are limit tangents instead of derivatives, which vanish or have no bound there. Any thread.
  PatchRows evaluate(int shape, double s, double t) const;

 private:
  struct Prepared;
  std::vector<std::unique_ptr<const Prepared>> prepared_;
  std::map<PatchShape, int> numbers_;
};

}  // namespace flowcage
