#pragma once

#include <span>

#include <Eigen/Core>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_weights.h>

#include "sdk/deformation/directed_vertex.h"

namespace armature::sdk {

/// skin() by dual quaternions that also says where the turns blended at a vertex disagree: by one less the squared
/// length of what they are blended to, which is zero wherever something turns as a whole. directed[v] becomes where v
/// goes, and its outward direction, turned as v is and times that; the return value is the most of it. Nothing may be
/// stretched. The same bits on any number of cores.
double skin_with_directions(const SkinWeights& weights, std::span<const SphereMotion> motions,
                            std::span<const Eigen::Vector3d> rest, std::span<const FourDirections> outward,
                            std::span<DirectedVertex> directed);

}  // namespace armature::sdk
