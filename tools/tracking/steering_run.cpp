#include "tools/tracking/steering_run.h"

#include <algorithm>
#include <cmath>

#include "tracker/synth/synth_source.h"

namespace armature::tools {
namespace {

constexpr int kMaxDelay = 6;

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto rank = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The share of a motion that the joints show where the person makes about `around_rad` of it.
double shown_share(const std::vector<std::vector<SteeringFrame>>& runs, std::size_t motion, int delay,
                   const ResponseCurve& in_force, double around_rad) {
  constexpr double kAbout = 0.17;  // the scripts hold half of the range, and 1.15 of it
  double made = 0, shown = 0;
  for (const auto& run : runs) {
    for (std::size_t i = static_cast<std::size_t>(delay); i < run.size(); ++i) {
      const auto angle = static_cast<double>(run[i - static_cast<std::size_t>(delay)].true_angle_rad[motion]);
      if (!run[i].engaged || !run[i].present || std::abs(std::abs(angle) - around_rad) > kAbout * around_rad) continue;
      made += std::abs(angle);
      shown += std::copysign(1.0, angle) *
               static_cast<double>(in_force.shown_angle(run[i].tracked.motions[motion].angle_rad));
    }
  }
  return made > 0 ? shown / made : 1;
}

/// Least squares through zero of what `other` is read too large, on what `motion` is read.
double read_too_large(const std::vector<std::vector<SteeringFrame>>& runs, std::size_t motion, std::size_t other,
                      int delay) {
  double xx = 0, xy = 0;
  for (const auto& run : runs) {
    for (std::size_t i = static_cast<std::size_t>(delay); i < run.size(); ++i) {
      if (!run[i].engaged || !run[i].present) continue;
      const auto& read = run[i].tracked.motions;
      const auto x = static_cast<double>(read[motion].angle_rad);
      xx += x * x;
      xy += x *
            static_cast<double>(read[other].angle_rad - run[i - static_cast<std::size_t>(delay)].true_angle_rad[other]);
    }
  }
  return xx > 0 ? xy / xx : 0;
}

}  // namespace

Expected<std::vector<SteeringFrame>> run_steering(const std::string& uri, std::shared_ptr<const Forest> forest,
                                                  TrackerOptions options) {
  using namespace std::chrono_literals;
  constexpr std::string_view kScheme = "synth:";
  auto source = SynthSource::open(uri.starts_with(kScheme) ? uri.substr(kScheme.size()) : uri);
  if (!source) return tl::unexpected(source.error());
  options.rest.mode = RestMode::Auto;
  NavigationOptions exact = options.navigation;
  exact.motions = of_true_joints(exact.motions);
  Navigator truth(exact, {.mode = RestMode::Fixed, .fixed = (*source)->rest()});
  Pipeline pipeline(std::move(forest), options);

  std::vector<SteeringFrame> frames;
  DepthFrame frame;
  std::chrono::nanoseconds last{0};
  while (true) {
    const auto status = (*source)->read(frame, 1s);
    if (!status) return tl::unexpected(status.error());
    if (*status != ReadStatus::Frame) return frames;
    const TrackerOutput& output = pipeline.process(frame.view());
    const FrameTruth& known = (*source)->truth();
    frames.push_back({.present = known.present,
                      .engaged = output.state == EngagementState::Engaged,
                      .true_angle_rad = known.motions.angle_rad,
                      .true_normalized = known.normalized,
                      .truth = known.present
                                   ? truth.process(known.skeleton, (*source)->rest().frame.up, frame.sensor.time)
                                   : truth.stop(),
                      .tracked = output.navigation,
                      .dt = frame.sensor.time - last});
    last = frame.sensor.time;
  }
}

MotionAccuracy motion_accuracy(const std::vector<std::vector<SteeringFrame>>& runs, MotionId motion,
                               const MotionOptions& in_force) {
  const std::size_t m = index(motion);
  MotionAccuracy out;
  std::vector<double> errors;
  for (const auto& run : runs) {
    for (const SteeringFrame& frame : run) {
      if (!frame.engaged || !frame.present) continue;
      errors.push_back(std::abs(static_cast<double>(frame.tracked.motions[m].normalized) -
                                static_cast<double>(frame.true_normalized[m])));
    }
  }
  out.frames = errors.size();
  out.median = quantile(errors, 0.50);
  out.p95 = quantile(errors, 0.95);

  double least = -1;
  for (int delay = 0; delay <= kMaxDelay; ++delay) {
    double xx = 0, xy = 0, yy = 0;
    for (const auto& run : runs) {
      for (std::size_t i = static_cast<std::size_t>(delay); i < run.size(); ++i) {
        if (!run[i].engaged || !run[i].present) continue;
        const double x = static_cast<double>(run[i - static_cast<std::size_t>(delay)].true_angle_rad[m]);
        const double y = static_cast<double>(run[i].tracked.motions[m].angle_rad);
        xx += x * x, xy += x * y, yy += y * y;
      }
    }
    const double residual = xx > 0 ? yy - xy * xy / xx : yy;
    if (least >= 0 && residual >= least) continue;
    least = residual;
    out.slope = xx > 0 ? xy / xx : 0;
    out.delay_frames = delay;
  }
  for (std::size_t other = 0; other < kMotionCount; ++other)
    if (other != m) out.crosstalk[other] = read_too_large(runs, m, other, out.delay_frames);
  if (motion != MotionId::RotateHips)
    out.crosstalk[index(MotionId::RotateHips)] += static_cast<double>(in_force.read_as_hips[m]);
  const ResponseCurve curve = in_force.curve(m);
  const double near = static_cast<double>(curve.knee_rad), full = 2 * near;
  const double shown_near = near * shown_share(runs, m, out.delay_frames, curve, near);
  const double shown_full = full * shown_share(runs, m, out.delay_frames, curve, full);
  out.gain = near / shown_near;
  out.far_gain = (full - near) / (shown_full - shown_near);
  return out;
}

}  // namespace armature::tools
