#pragma once

// Included before everything that is built for aarch64, so that Eigen sums in the order in which it does on x86-64: there
// it has no packets of two floats, so three floats are summed one by one. (With -U__ARM_FEATURE_FMA: what is fused
// rounds otherwise.) Held by tests/tracker/same_bytes.cpp.
#ifdef __cplusplus
#include <Eigen/Core>

namespace Eigen::internal {

template <int Size>
struct find_best_packet_helper<Size, Packet4f, false> {
  using type = Packet4f;
};

}  // namespace Eigen::internal
#endif
