#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

struct GlsSums;

/// The algebraic sphere that fits the points around one place best, by what it is geometrically (Mellado, Guennebaud,
/// Barla, Reuter, Schlick 2012; thesis, section 6.2).
struct Gls {
  double tau = 0;    ///< signed distance of the place to the sphere, positive outside
  double kappa = 0;  ///< curvature, positive where normals diverge: 1/r of a ball
  double phi = 0;    ///< fitness: 1 where all normals fit, less where they scatter; 0: no fit
  Eigen::Vector3d eta = Eigen::Vector3d::Zero();  ///< the sphere's normal there, of unit length; zero where phi is 0
};

/// How these change with the place (x, y, z) and with the scale, in this order.
struct GlsDerivatives {
  Eigen::RowVector4d tau = Eigen::RowVector4d::Zero();                    ///< of `Gls::tau`
  Eigen::RowVector4d kappa = Eigen::RowVector4d::Zero();                  ///< of `Gls::kappa`
  Eigen::RowVector4d phi = Eigen::RowVector4d::Zero();                    ///< of `Gls::phi`
  Eigen::Matrix<double, 3, 4> eta = Eigen::Matrix<double, 3, 4>::Zero();  ///< of `Gls::eta`
};

/// At which scales points are looked at, and how closely.
struct GlsOptions {
  std::vector<double> scales = {};  ///< radii of neighbourhoods, positive, in the points' unit; empty: `gls_scales()`
  /// Points nearer to one another than so much of the scale are summed up as one, of which only the weight is
  /// approximate: what lies on one sphere or plane still gives exactly that. 0 looks at every point.
  double merged = 1.0 / 6;
};

/// `count` scales, evenly spread by their logarithm from twice the spacing of the points to a quarter of the diagonal
/// of their bounding box (thesis, section 6.4), and none below what `build` takes. Fewer for points at one place: none.
[[nodiscard]] std::vector<double> gls_scales(const PointSet& points, std::size_t count = 10);

/// Growing least squares: spheres fitted to the neighbourhoods of points at several scales, each point weighted by its
/// area times (d^2/t^2 - 1)^2 within distance t. The same after moves and turns, and bit by bit on every run and any
/// number of threads. Thread-safe to read.
class GrowingLeastSquares {
 public:
  /// Time n log n for each scale. Refused where `validate()` refuses, without points, and for scales that are not
  /// positive or below a millionth of the bounding box. Points without a normal or area weigh nothing.
  [[nodiscard]] static Expected<GrowingLeastSquares> build(PointSet points, GlsOptions options = {},
                                                           const Task& task = {});
  ~GrowingLeastSquares();
  GrowingLeastSquares(GrowingLeastSquares&&) noexcept;
  GrowingLeastSquares& operator=(GrowingLeastSquares&&) noexcept;

  [[nodiscard]] const PointSet& points() const noexcept;          ///< as they came
  [[nodiscard]] std::span<const double> scales() const noexcept;  ///< ascending or as given

  /// At any place, at the scale of that number.
  [[nodiscard]] Gls at(const Eigen::Vector3d& place, std::size_t scale) const;
  /// The derivatives there, analytic; zeros where phi is 0.
  [[nodiscard]] GlsDerivatives derivatives_at(const Eigen::Vector3d& place, std::size_t scale) const;
  /// At all points of the set, at the scale of that number: [V]. Uses all cores.
  [[nodiscard]] Expected<std::vector<Gls>> at_points(std::size_t scale, const Task& task = {}) const;

 private:
  friend GlsSums neighbourhood_sums(const GrowingLeastSquares& gls, const Eigen::Vector3d& place, std::size_t scale);
  struct State;
  explicit GrowingLeastSquares(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

/// How unlike two places are at a scale t, without unit: (d tau / t)^2 + (t d kappa)^2 + (d phi)^2 (equation 6.1, whose
/// print has the wrong powers of t).
[[nodiscard]] double gls_dissimilarity(const Gls& a, const Gls& b, double scale) noexcept;

}  // namespace armature::sdk
