#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.03F, 1.15F, 1.09F, 1.32F, 0.99F, 1.13F, 1.10F, 1.09F};
constinit const PerMotion<float> kModelFarGain = {0.98F, 1.18F, 1.08F, 0.90F, 0.97F, 1.16F, 1.01F, 1.02F};
constinit const PerMotion<float> kModelReadAsHips = {0, 0, 0, 0.22F, 0, 0, 0, 0};

}  // namespace armature
