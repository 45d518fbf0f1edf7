#include "sdk/deformation/best_turn.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace armature::sdk {

using Eigen::Matrix3d;

Matrix3d best_turn(Matrix3d S) {
  constexpr double kHold = 1e-12;  // decides where S says nothing
  S += kHold * S.norm() * Matrix3d::Identity();
  const Eigen::JacobiSVD<Matrix3d> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace armature::sdk
