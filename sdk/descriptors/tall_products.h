#pragma once

#include <Eigen/Core>

namespace armature::sdk {

// Products of matrices that have far more rows than columns, which Eigen's own are slow at: they copy the tall one into
// another order first. On all cores; the same bits on any number of them.

/// a' b.
[[nodiscard]] Eigen::MatrixXd dot(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                  const Eigen::Ref<const Eigen::MatrixXd>& b);
/// w -= q c.
void subtract(Eigen::Ref<Eigen::MatrixXd> w, const Eigen::Ref<const Eigen::MatrixXd>& q, const Eigen::MatrixXd& c);
/// q c.
[[nodiscard]] Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& q, const Eigen::MatrixXd& c);

}  // namespace armature::sdk
