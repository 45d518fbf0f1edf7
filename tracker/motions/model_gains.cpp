#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more, with seeds 101 to 103.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.08F, 1.49F, 1.29F, 1.28F, 0.97F, 1.05F, 1.30F, 0.95F};
constinit const PerMotion<float> kModelFarGain = {0.94F, 1.67F, 1.31F, 0.94F, 0.99F, 1.20F, 0.99F, 1.17F};
constinit const PerMotion<float> kModelReadAsHips = {0.31F, 0, 0, 0.33F, 0, 0, 0, 0};

}  // namespace armature
