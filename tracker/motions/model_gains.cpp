#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.05F, 1.52F, 1.29F, 1.26F, 0.96F, 1.12F, 1.29F, 0.92F};
constinit const PerMotion<float> kModelFarGain = {1.00F, 1.73F, 1.37F, 0.90F, 0.98F, 1.30F, 1.01F, 1.31F};
constinit const PerMotion<float> kModelReadAsHips = {0.33F, 0, 0, 0.26F, 0, 0, 0, 0};

}  // namespace armature
