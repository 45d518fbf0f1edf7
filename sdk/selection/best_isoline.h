#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// Where a field on a surface is looked for a cut.
struct CutSearch {
  std::span<const FaceId> faces = {};  ///< that are looked at
  double lower = 0;                    ///< isovalues lie above this
  double upper = 1;                    ///< and below this
  double scale = 0;                    ///< how wide a valley is, in length units
  int isovalues = 50;                  ///< how many are tried
};

/// The isovalue of a field by VertexId whose isolines make the best cut: short ones (the mean gradient along them is
/// high, since all isolines of a harmonic field pass the same flux), in valleys that run along them, and a little
/// rather in the middle. Score: length-weighted mean of |grad| times (1 + beta concavity), by a prior. (A choice: Zheng
/// and Tai 2010 have a score of their own.)
[[nodiscard]] double best_isovalue(const Surface& surface, std::span<const double> field, const CutSearch& search);

/// The faces whose mean value is above the isovalue and that hang together with most of `seeds`, ascending; by common
/// edges.
[[nodiscard]] std::vector<FaceId> region_above(const Surface& surface, std::span<const double> field, double isovalue,
                                               std::span<const VertexId> seeds);
/// The same of the faces that are said to be in it.
[[nodiscard]] std::vector<FaceId> region_about(const Surface& surface, std::span<const VertexId> seeds,
                                               const std::function<bool(FaceId)>& is_in);

}  // namespace armature::sdk
