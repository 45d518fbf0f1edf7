#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "firmware_host/recording/recorder.h"
#include "tools/commands/commands.h"
#include "tools/commands/recording_result.h"
#include "tools/json_lines.h"
#include "tools/output_file.h"
#include "tools/picture.h"
#include "tracker/synth/script.h"
#include "tracker/synth/synth_source.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string name;
  std::string out;
  std::string truth;
  std::string pictures;
  int picture_every = 15;
  std::vector<std::string> options;  // key=value of the source's URI
  bool list = false;
  bool json = false;
};

Json xyz(const Eigen::Vector3f& p) {
  return Json::array(
      {number(static_cast<double>(p.x())), number(static_cast<double>(p.y())), number(static_cast<double>(p.z()))});
}

Json truth_line(long frame, const DepthFrame& depth, const SynthSource& source) {
  const FrameTruth& truth = source.truth();
  Json line;
  line["frame"] = frame;
  line["time_s"] = number(std::chrono::duration<double>(depth.sensor.time).count());
  line["present"] = truth.present;
  line["user_position"] = xyz(truth.skeleton.user_position);
  constexpr std::array<const char*, 3> kStates = {"lost", "inferred", "observed"};
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const Joint& joint = truth.skeleton.joints[j];
    line["joints"][std::string(kJointNames[j])] = {{"xyz", xyz(joint.position)},
                                                   {"state", kStates[static_cast<std::size_t>(joint.state)]}};
  }
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    line["motions"][std::string(kMotionNames[m])] = {
        {"angle_rad", number(static_cast<double>(truth.motions.angle_rad[m]))},
        {"normalized", number(static_cast<double>(truth.normalized[m]))}};
  }
  std::array<int, kPartCount> pixels{};
  for (const std::uint8_t part : truth.part) {
    if (part != kNoPart) ++pixels[part];
  }
  line["part_pixels"] = pixels;
  return line;
}

/// The frame's depth on the left, the parts of the user with the joints on the right.
Picture picture_of(const DepthFrame& frame, const FrameTruth& truth) {
  const Intrinsics& k = frame.intrinsics;
  Picture picture(2 * k.width, k.height);
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
      picture.set(u, v, depth_colour(frame.depth_mm[pixel]));
      if (truth.owner[pixel] != 0) picture.set(k.width + u, v, part_colour(truth.part[pixel]));
    }
  }
  for (const Joint& joint : truth.skeleton.joints) {
    if (joint.state == JointState::Lost || joint.position.z() <= 0) continue;
    const Colour colour = joint.state == JointState::Observed ? Colour{255, 255, 255} : Colour{255, 90, 90};
    const auto u = static_cast<int>(
        std::lround(k.centre_x_px + k.focal_x_px * static_cast<double>(joint.position.x() / joint.position.z())));
    const auto v = static_cast<int>(
        std::lround(k.centre_y_px + k.focal_y_px * static_cast<double>(joint.position.y() / joint.position.z())));
    if (u < 0 || u >= k.width) continue;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) picture.set(k.width + u + i, v + j, colour);
    }
  }
  return picture;
}

/// Hands on a synthetic source's frames and keeps what is true in them.
class Witness final : public DepthSource {
 public:
  Witness(std::unique_ptr<SynthSource> source, const Arguments& arguments)
      : source_(std::move(source)), arguments_(arguments) {}

  [[nodiscard]] const SourceInfo& info() const noexcept override { return source_->info(); }

  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    auto status = source_->read(frame, timeout);
    if (!status || *status != ReadStatus::Frame) return status;
    if (!arguments_.truth.empty()) truth_ += truth_line(frames_, frame, *source_).dump() + '\n';
    if (!arguments_.pictures.empty() && frames_ % arguments_.picture_every == 0) {
      std::string number = std::to_string(frames_);
      number.insert(0, 5 - std::min<std::size_t>(5, number.size()), '0');
      const auto path = std::filesystem::path(arguments_.pictures) / (number + ".png");
      if (auto written = picture_of(frame, source_->truth()).write_png(path); !written) {
        return tl::unexpected(written.error());
      }
    }
    ++frames_;
    return status;
  }

  [[nodiscard]] long frames() const noexcept { return frames_; }
  [[nodiscard]] const std::string& truth() const noexcept { return truth_; }

 private:
  std::unique_ptr<SynthSource> source_;
  const Arguments& arguments_;
  std::string truth_;
  long frames_ = 0;
};

Expected<void> list_scripts(bool json) {
  for (const Script& script : scripts()) {
    if (!json) continue;
    if (auto written = write_json_line(
            stdout, {{"name", script.name}, {"duration_s", script.duration_s}, {"description", script.description}});
        !written) {
      return written;
    }
  }
  if (!json) std::fputs(describe_scripts().c_str(), stdout);
  return {};
}

Expected<void> synth(const Arguments& arguments) {
  if (arguments.list) return list_scripts(arguments.json);
  std::string name = arguments.name;
  for (const std::string& option : arguments.options) {
    name += (name.find('?') == std::string::npos ? '?' : '&') + option;
  }
  auto source = SynthSource::open(name);
  if (!source) return tl::unexpected(source.error());
  if (!arguments.pictures.empty()) {
    std::error_code error;
    std::filesystem::create_directories(arguments.pictures, error);
    if (error) return fail(arguments.pictures + ": cannot be made: " + error.message());
  }
  Witness witness(std::move(*source), arguments);
  if (!arguments.out.empty()) {
    auto recorded =
        record_with_progress(witness, arguments.out, {.keep_when_stopped = false}, {"synthesising", arguments.json});
    if (!recorded) return recorded;
  } else {
    DepthFrame frame;
    for (;;) {
      auto status = witness.read(frame, std::chrono::milliseconds(0));
      if (!status) return tl::unexpected(status.error());
      if (*status != ReadStatus::Frame) break;
    }
    if (arguments.json) {
      if (auto written = write_json_line(stdout, {{"frames", witness.frames()}}); !written) return written;
    }
  }
  if (!arguments.truth.empty()) return write_file(arguments.truth, witness.truth());
  return {};
}

}  // namespace

void add_synth(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "synth",
      "Record a synthetic person who plays a script in front of a Kinect v1, with the truth about every frame");
  command->add_option("NAME", arguments->name, "A script; --list names them");
  command->add_option("OUT", arguments->out, "The recording, OUT.oni; without it only what is asked for below is made")
      ->check(check_recording_name);
  command->add_option("--truth", arguments->truth,
                      "Write a JSON line a frame: joints, motions, the pixels of each body part");
  command->add_option("--png", arguments->pictures, "Write pictures of depth and body parts into this folder");
  command->add_option("--png-every", arguments->picture_every, "A picture every so many frames")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_flag("--list", arguments->list, "Name the scripts and what happens in them");
  command->add_flag("--json", arguments->json, "Print results as lines of JSON");
  const auto pass_on = [&](const char* flag, std::string key, const char* what) {
    command->add_option_function<std::string>(
        flag, [arguments, key](const std::string& value) { arguments->options.push_back(key + "=" + value); }, what);
  };
  pass_on("--seed", "seed", "Person, clothes, room, camera and noise [1]");
  pass_on("--size", "size", "WIDTHxHEIGHT [640x480]");
  pass_on("--fps", "fps", "Frames a second [30]");
  pass_on("--distance", "distance", "Of the person from the camera, metres [wholly in view]");
  pass_on("--turned", "turned_deg", "The person faces so many degrees to her left of the camera [0]");
  pass_on("--noise", "noise", "Strength of the sensor's noise; 0 = an ideal camera [1]");
  pass_on("--carry", "carry", "nothing, bag, shoulder_bag, backpack, mug or phone [nothing]");
  command->footer("Scripts:\n" + describe_scripts() +
                  "\nEverywhere else a script is a source: synth:NAME?seed=7&size=320x240&carry=mug\n\n"
                  "Examples:\n"
                  "  armature synth lean_bust lean.oni --truth lean.jsonl --seed 7\n"
                  "  armature synth demo --png pictures/ --size 320x240");
  command->callback([arguments, &run] {
    const bool something = !arguments->out.empty() || !arguments->truth.empty() || !arguments->pictures.empty();
    if (!arguments->list && arguments->name.empty()) throw CLI::RequiredError("NAME (--list names the scripts)");
    if (!arguments->list && !something) throw CLI::RequiredError("OUT.oni, --truth or --png");
    run = [arguments] { return synth(*arguments); };
  });
}

}  // namespace armature::tools
