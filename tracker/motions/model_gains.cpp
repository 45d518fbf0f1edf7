#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more, with seeds 101 to 103.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.09F, 1.53F, 1.31F, 1.36F, 0.98F, 1.06F, 1.30F, 0.92F};
constinit const PerMotion<float> kModelFarGain = {0.95F, 1.68F, 1.31F, 0.89F, 0.99F, 1.22F, 1.00F, 1.31F};
constinit const PerMotion<float> kModelReadAsHips = {0.32F, 0, 0, 0.30F, 0, 0, 0, 0};

}  // namespace armature
