// Prints a digest of everything that the tracker says of a synthetic person, a line every 30 frames: what is built for
// another processor must print the same. usage: same_bytes SYNTH...

#include <cstdio>
#include <cstring>

#include "tracker/installation.h"
#include "tracker/pipeline.h"
#include "tracker/synth/synth_source.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// FNV-1a.
class Digest {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) value_ = (value_ ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3U;
  }
  template <class T>
  void add(const T& value) {
    add(std::as_bytes(std::span(&value, 1)));
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

int print_digests(const char* name) {
  auto forest = Forest::load(installed_model());
  auto source = SynthSource::open(name);
  if (!forest || !source) {
    std::fprintf(stderr, "%s\n", (!forest ? forest.error() : source.error()).message.c_str());
    return 1;
  }
  TrackerOptions options;
  options.rest.mode = RestMode::Auto;
  Pipeline pipeline(std::make_shared<const Forest>(std::move(*forest)), options);
  pipeline.reset((*source)->info().intrinsics);
  Digest seen, users, joints, steering;
  DepthFrame frame;
  for (int n = 1; (*source)->read(frame, 1s).value_or(ReadStatus::EndOfStream) == ReadStatus::Frame; ++n) {
    const TrackerOutput& output = pipeline.process(frame.view());
    seen.add(std::as_bytes(std::span(frame.depth_mm)));
    users.add(std::as_bytes(output.user_of_pixel));
    for (const Joint& joint : output.skeleton.joints) {
      for (const float coordinate : {joint.position.x(), joint.position.y(), joint.position.z(), joint.confidence})
        joints.add(coordinate);
    }
    for (const MotionOutput& motion : output.navigation.motions) steering.add(motion.shaped);
    steering.add(output.navigation.velocity.linear_m_s);
    steering.add(output.navigation.velocity.angular_rad_s);
    if (n % 30 == 0) {
      std::printf("%s frame %d: depth %016lx users %016lx joints %016lx steering %016lx\n", name, n, seen.value(),
                  users.value(), joints.value(), steering.value());
    }
  }
  return 0;
}

}  // namespace
}  // namespace armature

int main(int argc, char** argv) {
  int code = argc > 1 ? 0 : 2;
  for (int i = 1; i < argc; ++i) code |= armature::print_digests(argv[i]);
  return code;
}
