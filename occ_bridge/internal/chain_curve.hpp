#pragma once
#include <Geom_Curve.hxx>
#include <vector>

#include "core/target/target_surface.hpp"
#include "occ_bridge/internal/arc_length.hpp"

namespace flowcage::occ {

/// One exact curve of a chain: [t0, t1] of `curve` (in metres), run through against its parameter where
/// `reversed`.
struct ChainPiece {
  Handle(Geom_Curve) curve;
  double t0 = 0, t1 = 0;
  bool reversed = false;
  double usual_speed = 0;  ///< largest |dc/dt| of a few points: what a vanishing derivative is measured by
};
ChainPiece make_piece(const Handle(Geom_Curve) & curve, double t0, double t1);

/// Exact curves joined end to end, by arc length. Thread-safe: Geom_Curve evaluates without a cache, unlike
/// the kernel's adaptors.
class ChainCurve {
 public:
  /// `deviation`: of the polyline from the exact curves, in metres. Precondition: at least one piece.
  ChainCurve(const std::vector<ChainPiece>& pieces, double deviation);

  double length() const { return length_; }
  /// At arc length s, clamped to [0, length].
  CurvePoint point(double s) const;
  /// The nearest point: of all exact pieces, not of the polyline.
  CurvePoint closest(const Vec3& query) const;

  std::vector<Vec3> polyline() const;
  std::vector<double> polyline_s() const;

 private:
  struct Piece {
    ChainPiece exact;
    ArcLengthTable table;
    double s = 0;  ///< of its start in the chain
  };
  struct Knot {
    Vec3 position;
    double t = 0;
    Index piece = 0;
  };
  double s_at(const Piece& piece, double t) const;
  CurvePoint at(const Piece& piece, double t) const;
  double newton(const Piece& piece, const Vec3& query, double t, double low, double high) const;

  std::vector<Piece> pieces_;
  std::vector<Knot> knots_;    ///< of the polyline, in chain order; a piece's last = the next one's first
  std::vector<double> bulge_;  ///< knots_.size() - 1: how far the curve leaves each segment
  double length_ = 0;
};

/// Parameters of [t0, t1] between which the curve has derivatives of every order.
std::vector<double> smooth_breaks(const Handle(Geom_Curve) & curve, double t0, double t1);

/// Unit tangent toward growing t; where the derivative vanishes, the direction to a point nearby inside of
/// the piece.
Vec3 unit_tangent(const ChainPiece& piece, double t);

}  // namespace flowcage::occ
