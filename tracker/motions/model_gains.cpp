#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.04F, 1.49F, 1.27F, 1.34F, 0.97F, 1.04F, 1.26F, 1.01F};
constinit const PerMotion<float> kModelFarGain = {0.97F, 1.66F, 1.32F, 0.90F, 0.97F, 1.19F, 0.95F, 1.15F};
constinit const PerMotion<float> kModelReadAsHips = {0.31F, 0, 0, 0.24F, 0, 0, 0, 0};

}  // namespace armature
