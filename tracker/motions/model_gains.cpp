#include "tracker/motions/motion_options.h"

namespace armature {

// Of tracker/forest/models/person.forest, by `armature bench steering --seeds 101,102,103,104,105,106`; rotate_bust has
// the means of the two rotations that it merges. What is read as hips is from column "read with it" where it is 0.2 or
// more, with seeds 101 to 103.
//                                                shoulders hips   bust   lean   bend  transl. knees  step
constinit const PerMotion<float> kModelGain = {1.06F, 1.51F, 1.28F, 1.29F, 0.99F, 1.08F, 1.23F, 0.96F};
constinit const PerMotion<float> kModelFarGain = {1.09F, 1.59F, 1.34F, 0.95F, 0.98F, 1.13F, 1.02F, 1.16F};
constinit const PerMotion<float> kModelReadAsHips = {0.27F, 0, 0, 0.27F, 0, 0, 0, 0};

}  // namespace armature
