#include "tools/commands/appliance/site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "firmware_host/control/usb.h"
#include "tools/interrupt.h"
#include "tools/output_file.h"
#include "tracker/segmentation/segmenter.h"
#include "tracker/segmentation/stored_background.h"
#include "tracker/synth/open_source.h"

namespace armature::tools {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostKept = 90;  // frames for the background
constexpr auto kPatience = 500ms;
constexpr int kMostSilences = 20;  // before the first frame: 10 s
constexpr float kUnevenDegrees = 5;
constexpr float kDegrees = 180 / std::numbers::pi_v<float>;

void store_background(const std::string& file, std::span<const DepthFrame> frames, Findings& findings) {
  const StoredBackground background = median_of(frames);
  if (const auto written = write_file(file, print_background(background)); !written)
    return findings.bad("background", written.error().message, "a folder that this user may write to");
  const auto known = std::ranges::count_if(background.depth_mm, [](auto depth) { return depth != 0; });
  findings.good("background",
                fmt::format("{:.0f} % of the image are known; in the configuration: [segmentation] background = \"{}\"",
                            100 * static_cast<double>(known) / static_cast<double>(background.depth_mm.size()),
                            std::filesystem::absolute(file).string()));
}

/// Which way is up for the Kinect that `source` names, as its accelerometer feels it: unit, camera frame.
std::optional<Eigen::Vector3f> up_by_gravity(std::string_view source) {
  constexpr std::string_view kKinect = "freenect:";
  if (!source.starts_with(kKinect)) return std::nullopt;
  source.remove_prefix(kKinect.size());
  const auto motor = KinectMotor::open(source);
  if (!motor) return std::nullopt;
  const auto posture = (*motor)->posture();
  if (!posture) return std::nullopt;
  return Eigen::Map<const Eigen::Vector3d>(posture->up_m_s2.data()).cast<float>().normalized();
}

/// How far a sensor that feels or sees `up` so looks down, degrees.
float tilt_deg(const Eigen::Vector3f& up) {
  return std::asin(std::clamp(-up.z(), -1.0F, 1.0F)) * kDegrees;
}

std::string looks(float degrees) {
  return fmt::format("looks {} by {:.0f} degrees", degrees < 0 ? "up" : "down", std::abs(degrees));
}

}  // namespace

float degrees_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees;
}

void look_at_site(const SiteOptions& options, Findings& findings) {
  auto source = open_source(options.source);
  if (!source) return findings.bad("site", source.error().message, "`armature devices` lists what is plugged in");
  const Interrupt interrupt;
  Segmenter segmenter(SegmentationOptions{.far_m = 9, .half_width_m = 6});
  DepthFrame frame;
  std::chrono::nanoseconds first{-1};
  FloorPlane floor;
  int frames = 0, silences = 0, with_floor = 0, with_people = 0;
  double seen_share = 0;
  std::vector<DepthFrame> kept;
  while (!interrupt.requested()) {
    const auto status = (*source)->read(frame, kPatience);
    if (!status) return findings.bad("site", status.error().message, "see above");
    if (*status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Timeout) {
      if (frames == 0 && ++silences < kMostSilences) continue;
      break;
    }
    if (first.count() < 0) first = frame.sensor.time;
    if (std::chrono::duration<double>(frame.sensor.time - first).count() > options.seconds) break;
    const Segmentation& seen = segmenter.process(frame.view());
    if (seen.floor) floor = *seen.floor;
    ++frames;
    if (!options.background.empty() && kept.size() < kMostKept &&
        (kept.empty() || kept.front().intrinsics == frame.intrinsics))
      kept.push_back(frame);
    with_floor += seen.floor ? 1 : 0;
    with_people += seen.users.empty() ? 0 : 1;
    const auto known = std::count_if(frame.depth_mm.begin(), frame.depth_mm.end(), [](auto d) { return d != 0; });
    seen_share += static_cast<double>(known) / static_cast<double>(frame.depth_mm.size());
  }
  if (frames == 0) return findings.bad("site", options.source + ": not a single frame", "see the sensor above");
  seen_share /= frames;
  if (seen_share < 0.3)
    findings.bad("light", fmt::format("{:.0f} % of the image has depth", seen_share * 100),
                 "direct sunlight, glass or black surfaces: turn the sensor or shade it");
  else
    findings.good("light", fmt::format("{:.0f} % of the image has depth", seen_share * 100));
  if (with_people > frames / 4)
    findings.note(
        "people",
        "somebody is in view, or a thing like a person: for commissioning nobody should be; what is in view is "
        "background from now on");
  if (!kept.empty()) store_background(options.background, kept, findings);
  const std::optional<Eigen::Vector3f> by_gravity = up_by_gravity(options.source);
  if (by_gravity) findings.note("gravity", "by its accelerometer the sensor " + looks(tilt_deg(*by_gravity)));
  if (with_floor < std::max(1, frames / 2)) {
    return findings.bad("floor", fmt::format("seen in {} of {} frames", with_floor, frames),
                        "tilt the sensor down until the floor two metres before it is in view");
  }
  const Eigen::Vector3f up = floor.normal;
  if (by_gravity && degrees_between(*by_gravity, up) > kUnevenDegrees)
    return findings.bad("gravity",
                        fmt::format("what looks like the floor is not level: it leans by {:.0f} degrees",
                                    degrees_between(*by_gravity, up)),
                        "a ramp or a table is taken for the floor: clear it, or tilt the sensor until the floor is in "
                        "view");
  const float tilt = tilt_deg(up);
  const float roll = std::atan2(up.x(), -up.y()) * kDegrees;
  const std::string stands =
      fmt::format("{:.2f} m above the floor, {}, rolled by {:.0f}", floor.offset, looks(tilt), std::abs(roll));
  if (std::abs(roll) > 5)
    findings.bad("stand", stands, "level it: roll should be within 5 degrees");
  else if (floor.offset < 0.4F || floor.offset > 2.6F || std::abs(tilt) > 40)
    findings.bad("stand", stands, "0.6 to 2.2 m high and tilted by at most 30 degrees see people best");
  else
    findings.good("stand", stands);
  // How far the floor is free: the nearest thing above it within a metre of the middle.
  const Intrinsics& k = frame.intrinsics;
  float free_to = 9;
  const Eigen::Vector3f ahead = (Eigen::Vector3f::UnitZ() - up.z() * up).normalized();
  const Eigen::Vector3f right(ahead.y() * up.z() - ahead.z() * up.y(), ahead.z() * up.x() - ahead.x() * up.z(),
                              ahead.x() * up.y() - ahead.y() * up.x());
  std::array<int, 90> standing{};  // cells of 10 cm
  for (int v = 0; v < k.height; v += 4) {
    for (int u = 0; u < k.width; u += 4) {
      const float z = static_cast<float>(frame.view().at(u, v)) / 1000;
      if (z <= 0) continue;
      const Eigen::Vector3f p(z * static_cast<float>((u - k.centre_x_px) / k.focal_x_px),
                              z * static_cast<float>((v - k.centre_y_px) / k.focal_y_px), z);
      const float above = up.dot(p) + floor.offset, away = ahead.dot(p);
      if (above > 0.25F && above < 2 && std::abs(right.dot(p)) < 0.8F && away > 0 && away < 9)
        ++standing[static_cast<std::size_t>(away * 10)];
    }
  }
  for (std::size_t cell = 0; cell < standing.size(); ++cell) {
    if (standing[cell] > 30) {
      free_to = static_cast<float>(cell) / 10;
      break;
    }
  }
  const float far = std::min(4.0F, free_to - 0.3F);
  if (far < 1.5F) {
    return findings.bad("zone", fmt::format("something stands {:.1f} m before the sensor", free_to),
                        "clear the floor between 1.2 and 3 m before it, or move it");
  }
  findings.good("zone",
                fmt::format("free to {:.1f} m; in the configuration: [engagement] near_m = 1.2, far_m = {:.1f}, "
                            "half_width_m = 0.8",
                            free_to, far));
}

}  // namespace armature::tools
