#include "firmware_host/recording/recorder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include <OpenNI.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "firmware_host/backends/openni2_runtime.h"
#include "firmware_host/recording/driver/push_device.h"
#include "firmware_host/recording/file_reader.h"
#include "firmware_host/recording/oni_layout.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kMaxFrames = 287'000;         // a longer seek table is more than the player can read
constexpr std::uint64_t kMaxQueuedFrames = 8;         // in memory, between us and OpenNI2's thread
constexpr std::size_t kMaxDifferentDepths = 1 << 15;  // the codec's indices have 15 bits
constexpr std::uint16_t kUnstorableDepth = 65535;
constexpr auto kDiskPatience = 20s;
constexpr auto kDiskHesitation = 300ms;  // after which it is asked whether it is full
constexpr off_t kRoomForFrames = 1 << 20;

std::filesystem::path temporary_path(const std::filesystem::path& path) {
  static std::atomic<unsigned> serial{0};
  auto name = std::string(".").append(path.filename().string()).append(".");
  name += std::to_string(::getpid()) + "-" + std::to_string(++serial) + ".tmp.oni";
  return path.parent_path() / name;
}

/// Follows the file that OpenNI2's thread writes, one write a record: the only sign of how far it has come.
class RecordFollower {
 public:
  explicit RecordFollower(FileReader file) : file_(std::move(file)) {}

  void look() {
    const std::uint64_t size = file_.current_size();
    std::array<std::byte, kOniRecordHeaderBytes> bytes{};
    OniRecordHeader header;
    while (offset_ + bytes.size() <= size && file_.read_at(offset_, bytes) && parse_record_header(bytes, header) &&
           offset_ + header.total_bytes() <= size && header.total_bytes() >= kOniRecordHeaderBytes) {
      offset_ += header.total_bytes();
      if (header.type == OniRecordType::DataBegin) begun_ = true;
      if (header.type == OniRecordType::NewData) ++frames_;
    }
  }
  [[nodiscard]] bool begun() const noexcept { return begun_; }
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

 private:
  FileReader file_;
  std::uint64_t offset_ = kOniFileHeaderBytes;
  std::uint64_t frames_ = 0;
  bool begun_ = false;
};

/// Whether the disk, or the limit of this process, refuses to hold more of the file. Nothing is written to find out.
bool full(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const off_t end = ::lseek(descriptor, 0, SEEK_END);
  rlimit limit{};
  const bool limited = ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && static_cast<rlim_t>(end) >= limit.rlim_cur;
  const bool refused = end >= 0 && ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, end, kRoomForFrames) != 0 &&
                       (errno == ENOSPC || errno == EDQUOT || errno == EFBIG);
  ::close(descriptor);
  return limited || refused;
}

/// Waits for OpenNI2's thread to write what it was given: until `condition` holds; false where the disk is full, or
/// slower than anybody waits.
template <class Condition>
bool wait_for(const std::filesystem::path& file, Condition condition) {
  const auto began = std::chrono::steady_clock::now();
  auto look_at_disk = began + kDiskHesitation;
  while (!condition()) {
    const auto now = std::chrono::steady_clock::now();
    if (now - began > kDiskPatience || (now > look_at_disk && full(file))) return false;
    if (now > look_at_disk) look_at_disk = now + kDiskHesitation;
    std::this_thread::sleep_for(200us);
  }
  return true;
}

bool more_than_codec_holds(std::span<const std::uint16_t> depth_mm) {
  if (depth_mm.size() <= kMaxDifferentDepths) return false;
  std::bitset<65536> seen;
  for (const std::uint16_t depth : depth_mm) seen.set(depth);
  return seen.count() > kMaxDifferentDepths;
}

double field_of_view_rad(int pixels, double focal_px) {
  return 2 * std::atan(pixels / (2 * focal_px));
}

Expected<void> check_facts(const std::string& name, const RecordingFacts& facts) {
  const Intrinsics& k = facts.intrinsics;
  if (k.width < 1 || k.height < 1 || k.width > kMaxImageSide || k.height > kMaxImageSide ||
      std::size_t{2} * static_cast<unsigned>(k.width) * static_cast<unsigned>(k.height) > kMaxOniPayloadBytes)
    return fail(name + ": resolution " + std::to_string(k.width) + " x " + std::to_string(k.height) +
                ": expected sides of 1 to 4096 and at most 2880000 pixels");
  // One rule for what a side-car may say: what its reader accepts.
  if (auto checked = parse_sidecar(format_sidecar(facts), name + ".toml"); !checked)
    return tl::unexpected(checked.error());
  return {};
}

Expected<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return fail(path.string() + ": cannot be written: " + std::strerror(errno));
  return {};
}

}  // namespace

struct Recorder::State {
  std::filesystem::path path;
  std::filesystem::path temporary;
  RecordingFacts facts;
  openni::Device device;
  openni::VideoStream stream;
  openni::Recorder recorder;
  std::optional<RecordFollower> follower;
  std::uint64_t frames = 0;
  std::chrono::nanoseconds first_time{0};
  std::chrono::nanoseconds last_time{0};
  bool made = false;  // the file is ours

  ~State() {
    close();
    if (made && !temporary.empty() && (temporary != path || frames == 0)) {
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      std::filesystem::remove(sidecar_path(temporary), ignored);
    }
  }

  // In this order: the recorder's thread reads from the stream until it has ended.
  void close() {
    recorder.destroy();
    stream.stop();
    stream.destroy();
    device.close();
  }

  Expected<void> open() {
    const std::string name = path.string();
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) return fail(name + ": cannot be written: " + std::strerror(errno));
    ::close(descriptor);
    made = true;

    static std::atomic<unsigned> serial{0};
    const Intrinsics& k = facts.intrinsics;
    const int fps = std::max(1, static_cast<int>(std::lround(facts.frames_per_second)));
    std::array<char, 256> uri{};
    std::snprintf(uri.data(), uri.size(), kPushUriFormat, ++serial, k.width, k.height, fps,
                  field_of_view_rad(k.width, k.focal_x_px), field_of_view_rad(k.height, k.focal_y_px));
    const auto complain = [&](const char* step) {
      return fail(name + ": cannot be recorded: " + openni2_complaint(step));
    };
    if (device.open(uri.data()) != openni::STATUS_OK) return complain("no recording driver beside libOpenNI2.so.0");
    if (stream.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) return complain("no depth stream");
    if (stream.start() != openni::STATUS_OK) return complain("the stream does not start");
    if (recorder.create(temporary.c_str()) != openni::STATUS_OK) return complain("no recorder");
    if (recorder.attach(stream) != openni::STATUS_OK) return complain("the recorder refuses the stream");
    if (recorder.start() != openni::STATUS_OK) return complain("the recorder does not start");

    auto file = FileReader::open(temporary);
    if (!file) return tl::unexpected(file.error());
    follower.emplace(std::move(*file));
    if (!wait_for(temporary, [&] {
          follower->look();
          return follower->begun();
        }))
      return fail(name + ": cannot be written: OpenNI2's recorder does not start");
    // The recorder drops frames until it has left the step in which it wrote what we just saw.
    int nothing = 0;
    if (stream.invoke(kSynchronizeCommand, &nothing, sizeof nothing) != openni::STATUS_OK)
      return complain("the recording driver is of another version");
    return {};
  }

  // Waits until at most `queued` frames have not reached the file.
  bool catch_up(std::uint64_t queued) {
    return wait_for(temporary, [&] {
      follower->look();
      return follower->frames() + queued >= frames;
    });
  }
};

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;
Recorder::~Recorder() = default;

Expected<Recorder> Recorder::create(std::filesystem::path path, const RecordingFacts& facts, bool in_place) {
  if (auto checked = check_facts(path.string(), facts); !checked) return tl::unexpected(checked.error());
  if (auto loaded = load_openni2(); !loaded) return tl::unexpected(loaded.error());
  auto state = std::make_unique<State>();
  state->temporary = in_place ? path : temporary_path(path);
  if (in_place) {
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(path, ignored)))
      return fail(path.string() + ": is there already, and a live source is recorded in place: name another file");
    if (auto written = write_text(sidecar_path(path), format_sidecar(facts)); !written)
      return tl::unexpected(written.error());
  }
  state->path = std::move(path);
  state->facts = facts;
  if (auto opened = state->open(); !opened) return tl::unexpected(opened.error());
  return Recorder(std::move(state));
}

Expected<void> Recorder::append(const DepthView& frame) {
  State& s = *state_;
  const std::string place = s.path.string() + ": frame " + std::to_string(s.frames);
  const Intrinsics& k = s.facts.intrinsics;
  const auto pixels = static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height);
  if (frame.width() != k.width || frame.height() != k.height || frame.depth_mm.size() != pixels)
    return fail(place + ": " + std::to_string(frame.width()) + " x " + std::to_string(frame.height()) + ": expected " +
                std::to_string(k.width) + " x " + std::to_string(k.height) + " as before");
  if (s.frames == kMaxFrames)
    return fail(place + ": expected at most " + std::to_string(kMaxFrames) + " frames in one recording");
  if (s.frames == 0) s.first_time = frame.sensor.time;
  if (s.frames > 0 && frame.sensor.time < s.last_time) return fail(place + ": its time runs backwards");
  if (std::find(frame.depth_mm.begin(), frame.depth_mm.end(), kUnstorableDepth) != frame.depth_mm.end())
    return fail(place + ": holds a depth of 65535 mm: expected at most 65534");
  if (more_than_codec_holds(frame.depth_mm))
    return fail(place + ": holds more than 32768 different depths, which the format cannot store");

  s.last_time = frame.sensor.time;
  const auto since_first = std::chrono::round<std::chrono::microseconds>(frame.sensor.time - s.first_time);
  PushedFrame pushed{frame.depth_mm.data(), static_cast<int>(frame.depth_mm.size_bytes()),
                     static_cast<int>(s.frames + 1), static_cast<std::uint64_t>(since_first.count())};
  if (s.stream.invoke(kPushFrameCommand, &pushed, sizeof pushed) != openni::STATUS_OK)
    return fail(place + ": OpenNI2 refuses it: " + openni2_complaint("no reason given"));
  ++s.frames;
  if (!s.catch_up(kMaxQueuedFrames)) return fail(place + ": cannot be written: is the disk full?");
  return {};
}

Expected<void> Recorder::finish() {
  State& s = *state_;
  const std::string name = s.path.string();
  if (s.frames == 0) return fail(name + ": no frames to record");
  if (!s.catch_up(0)) return fail(name + ": cannot be written: is the disk full?");
  s.close();

  const auto file = FileReader::open(s.temporary);
  if (!file) return tl::unexpected(file.error());
  const auto layout = read_oni_layout(*file, name);
  if (!layout) return tl::unexpected(layout.error());
  if (layout->frames.size() != s.frames)
    return fail(name + ": OpenNI2 recorded " + std::to_string(layout->frames.size()) + " of " +
                std::to_string(s.frames) + " frames");
  std::error_code error;
  std::filesystem::resize_file(s.temporary, layout->end_offset, error);
  if (error) return fail(name + ": cannot be written: " + error.message());
  if (auto written = write_text(sidecar_path(s.temporary), format_sidecar(s.facts)); !written) return written;
  // The side-car first: a recording never stands without it.
  std::filesystem::rename(sidecar_path(s.temporary), sidecar_path(s.path), error);
  if (!error) std::filesystem::rename(s.temporary, s.path, error);
  if (error) return fail(name + ": cannot be written: " + error.message());
  s.temporary.clear();
  return {};
}

namespace {

/// The times of a live source as of one clock.
class Timeline {
 public:
  /// Whether the sensor's clock has begun anew, or jumped.
  bool put_on(DepthFrame& frame) {
    const auto by_sensor = frame.sensor.time - sensor_, by_host = frame.host.time - host_;
    const bool anew = started_ && (by_sensor <= 0ns || std::chrono::abs(by_sensor - by_host) > kJump);
    time_ = !started_ ? frame.sensor.time : time_ + (anew ? std::max(by_host, kTick) : by_sensor);
    started_ = true;
    sensor_ = frame.sensor.time;
    host_ = frame.host.time;
    frame.sensor.time = time_;
    return anew;
  }

 private:
  /// The sensor's clock and ours may disagree so far about the time between two frames.
  static constexpr std::chrono::nanoseconds kJump = 300ms;
  static constexpr std::chrono::nanoseconds kTick = 1ms;
  bool started_ = false;
  std::chrono::nanoseconds sensor_{0}, host_{0}, time_{0};
};

}  // namespace

Expected<std::uint64_t> write_recording(const std::filesystem::path& path, DepthSource& source,
                                        const WriteRecordingOptions& options) {
  const SourceInfo& info = source.info();
  auto recorder = Recorder::create(path, {info.intrinsics, info.frames_per_second, info.uri}, options.in_place);
  if (!recorder) return tl::unexpected(recorder.error());
  DepthFrame frame;
  std::uint64_t count = 0;
  std::chrono::nanoseconds first_time{0};
  Timeline timeline;
  bool remarked = false;
  while (!options.max_frames || count < *options.max_frames) {
    if (options.stop.stop_requested()) {
      if (!options.keep_when_stopped) return fail(path.string() + ": interrupted: nothing was written");
      break;
    }
    const auto status = source.read(frame, 100ms);
    if (!status) return tl::unexpected(status.error());
    if (*status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Timeout) continue;
    if (info.live && timeline.put_on(frame) && !std::exchange(remarked, true) && options.remark)
      options.remark("the sensor's clock began anew; times go on by this machine's");
    if (count == 0) first_time = frame.sensor.time;
    if (options.max_duration && frame.sensor.time - first_time >= *options.max_duration) break;
    if (auto appended = recorder->append(frame.view()); !appended) return tl::unexpected(appended.error());
    ++count;
    if (options.progress) options.progress(count);
  }
  if (auto finished = recorder->finish(); !finished) return tl::unexpected(finished.error());
  return count;
}

}  // namespace armature
