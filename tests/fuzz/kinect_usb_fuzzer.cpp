#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "firmware_host/backends/freenect_device.h"
#include "firmware_host/backends/v4l2.h"
#include "firmware_host/control/usb.h"

// What comes over USB and is read by ourselves: the motor's answer, the camera's counter, packed disparities.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace armature;
  const std::span all(bytes, size);
  std::array<std::uint8_t, 10> answer{};
  std::copy_n(bytes, std::min(size, answer.size()), answer.begin());
  for (const double axis : parse_kinect_posture(answer).up_m_s2) {
    if (!std::isfinite(axis)) std::abort();
  }
  UnwrappedTicks clock(60e6);
  std::chrono::nanoseconds last{-1};
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    const auto ticks = static_cast<std::uint32_t>(bytes[i] | bytes[i + 1] << 8 | bytes[i + 2] << 16) |
                       static_cast<std::uint32_t>(bytes[i + 3]) << 24U;
    const auto time = clock(ticks);
    if (time < last) std::abort();
    last = time;
  }
  std::vector<std::uint16_t> disparity(size * 8 / 10);
  unpack_y10b(all, disparity);
  for (const std::uint16_t value : disparity) {
    if (value > 1023) std::abort();
  }
  return 0;
}
