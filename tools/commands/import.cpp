#include "firmware_host/recording/import.h"

#include <algorithm>
#include <memory>

#include "firmware_host/recording/recorder.h"
#include "tools/commands/commands.h"
#include "tools/commands/recording_result.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string raw;  // WIDTHxHEIGHT; empty: PNG images
  double fps = 30;
  double focal_px = 0;
  std::vector<double> centre_px;
  std::vector<std::string> files;
  bool json = false;
};

std::string check_size(const std::string& text) {
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) == 2 && width > 0 && height > 0 &&
      width <= kMaxImageSide && height <= kMaxImageSide)
    return {};
  return "expected WIDTHxHEIGHT, each from 1 to 4096, as in 320x240";
}

Expected<std::unique_ptr<DepthSource>> open_input(const Arguments& arguments) {
  ImportOptions options{.intrinsics = {}, .frames_per_second = arguments.fps};
  Intrinsics& k = options.intrinsics;
  if (!arguments.raw.empty()) {
    std::sscanf(arguments.raw.c_str(), "%dx%d", &k.width, &k.height);
    k = nominal_intrinsics(k.width, k.height);
  }
  if (arguments.focal_px > 0) k.focal_x_px = k.focal_y_px = arguments.focal_px;
  if (!arguments.centre_px.empty()) {
    k.centre_x_px = arguments.centre_px[0];
    k.centre_y_px = arguments.centre_px[1];
  }
  if (!arguments.raw.empty()) return open_raw_depth(arguments.files.front(), options);

  std::vector<std::filesystem::path> images(arguments.files.begin(), arguments.files.end() - 1);
  std::error_code ignored;
  if (images.size() == 1 && std::filesystem::is_directory(images.front(), ignored)) {
    auto listed = list_png_images(images.front());
    if (!listed) return tl::unexpected(listed.error());
    images = std::move(*listed);
  }
  return open_png_depth(std::move(images), options);
}

Expected<void> import(const Arguments& arguments) {
  const std::filesystem::path out = arguments.files.back();
  auto source = open_input(arguments);
  if (!source) return tl::unexpected(source.error());
  return record_with_progress(**source, out, {.keep_when_stopped = false}, {"importing", arguments.json});
}

}  // namespace

void add_import(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "import", "Make an OpenNI2 recording of bare depth frames: a file of raw frames, or 16-bit PNG images");
  command->add_option("--raw", arguments->raw, "The input is raw: frames of WIDTHxHEIGHT uint16 little-endian mm")
      ->check(check_size)
      ->type_name("WxH");
  command->add_option("--fps", arguments->fps, "Frames a second")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  command->add_option("--focal", arguments->focal_px, "Focal length in pixels [a Kinect v1's: 0.8926 x width]")
      ->check(CLI::Range(1.0, 100000.0));
  command->add_option("--centre", arguments->centre_px, "Principal point in pixels [the middle: width/2,height/2]")
      ->delimiter(',')
      ->expected(2)
      ->type_name("X,Y");
  command->add_flag("--json", arguments->json, "Print the result as one line of JSON");
  command
      ->add_option("FILES", arguments->files, "IN.u16, IN.u16.zst, a folder of PNG images or the images; then OUT.oni")
      ->required()
      ->expected(2, 1'000'000);
  command->footer(
      "Depth is in millimetres, 0 where there is none. Replay gives back every pixel unchanged; the intrinsics go "
      "into\n"
      "OUT.oni.toml beside the recording. Any OpenNI2 program can open the result.\n\n"
      "Examples:\n"
      "  armature import --raw 320x240 --focal 285.63 walk.u16.zst walk.oni\n"
      "  armature import --fps 30 --focal 525 --centre 320,240 frames/ turn.oni");
  command->callback([arguments, &run] {
    if (const auto wrong = check_recording_name(arguments->files.back()); !wrong.empty())
      throw CLI::ValidationError("OUT", wrong);
    if (!arguments->raw.empty() && arguments->files.size() != 2)
      throw CLI::ValidationError("FILES", "--raw: expected one input and one output");
    run = [arguments] { return import(*arguments); };
  });
}

}  // namespace armature::tools
