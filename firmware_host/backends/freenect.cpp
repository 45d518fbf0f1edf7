#include "firmware_host/backends/freenect.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "firmware_host/backends/pacer.h"
#include "firmware_host/recording/file_reader.h"

namespace armature {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
constexpr std::uint64_t kMaxIndexBytes = 64 << 20;
constexpr std::size_t kMaxHeaderBytes = 64;
constexpr std::uint16_t kNoDepthRaw = 2047;
constexpr double kMaxDepth_mm = 10000;

// A Kinect's calibration as libfreenect assumes it: distances in centimetres, the size of a pixel in millimetres.
constexpr double kReferenceDistance = 120;
constexpr double kReferencePixelSize = 0.1042F;
constexpr double kEmitterDistance = 7.5;
constexpr double kConstantShift = 200;
constexpr double kFocal_px = kReferenceDistance / (2 * kReferencePixelSize);

std::string quoted(std::string_view text) {
  std::string line;
  for (const char c : text.substr(0, 80)) line += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return "'" + line + "'";
}

/// The pixels behind the header line of a depth image.
Expected<void> read_depth_image(const std::filesystem::path& path, std::vector<std::uint16_t>& depth) {
  const auto bytes = read_file(path, kMaxHeaderBytes + 2 * kPixels);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const auto line_end = text.substr(0, kMaxHeaderBytes).find('\n');
  const auto header = text.substr(0, line_end);
  if (line_end == std::string_view::npos || header != "P5 640 480 65535")
    return fail(path.string() + ": expected the line 'P5 640 480 65535' at byte 0, found " + quoted(header));
  const auto pixels = text.substr(line_end + 1);
  if (pixels.size() != 2 * kPixels)
    return fail(path.string() + ": " + std::to_string(pixels.size()) + " bytes of pixels: expected " +
                std::to_string(2 * kPixels));
  depth.resize(kPixels);
  std::memcpy(depth.data(), pixels.data(), pixels.size());
  return {};
}

class FakenectSource final : public DepthSource {
 public:
  FakenectSource(const std::filesystem::path& directory, std::vector<FakenectEntry> entries, const OpenOptions& options)
      : directory_(directory), entries_(std::move(entries)), pacer_(options), clock_(options.clock) {
    info_.uri = "fakenect:" + directory.string();
    info_.intrinsics = {kWidth, kHeight, kFocal_px, kFocal_px, kWidth / 2.0, kHeight / 2.0};
    info_.frame_count = static_cast<long>(entries_.size());
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<void> start() {
    std::vector<std::uint16_t> first;
    if (auto read = read_depth_image(directory_ / entries_.front().file, first); !read) return read;
    raw_ = *std::max_element(first.begin(), first.end()) <= kNoDepthRaw;
    return {};
  }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    if (next_ == entries_.size()) return ReadStatus::EndOfStream;
    const FakenectEntry& entry = entries_[next_];
    if (!pacer_.wait_until_due(entry.time, timeout)) return ReadStatus::Timeout;
    const auto path = directory_ / entry.file;
    if (auto read = read_depth_image(path, frame.depth_mm); !read) return tl::unexpected(read.error());
    if (raw_) {
      for (std::uint16_t& value : frame.depth_mm) {
        if (value > kNoDepthRaw)
          return fail(path.string() + ": holds the value " + std::to_string(value) +
                      ": expected raw 11-bit values as in the first image");
        value = to_mm_[value];
      }
    }
    frame.intrinsics = info_.intrinsics;
    frame.sequence = next_++;
    frame.sensor = {entry.time, ClockId::Recording};
    frame.host = {clock_->now(), ClockId::HostMonotonic};
    return ReadStatus::Frame;
  }

 private:
  std::filesystem::path directory_;
  std::vector<FakenectEntry> entries_;
  SourceInfo info_;
  Pacer pacer_;
  std::shared_ptr<Clock> clock_;
  std::array<std::uint16_t, 2048> to_mm_ = kinect_raw_to_mm();
  std::size_t next_ = 0;
  bool raw_ = true;  // 11-bit values rather than millimetres
};

}  // namespace

std::array<std::uint16_t, 2048> kinect_raw_to_mm() {
  std::array<std::uint16_t, 2048> to_mm{};
  for (std::size_t raw = 0; raw < kNoDepthRaw; ++raw) {
    const double shift_px = (static_cast<double>(raw) - 4 * kConstantShift) / 4 - 0.375;
    const double metric = shift_px * kReferencePixelSize;
    if (metric >= kEmitterDistance) break;  // behind the camera from here on
    const double mm = 10 * (metric * kReferenceDistance / (kEmitterDistance - metric) + kReferenceDistance);
    to_mm[raw] = mm > 0 && mm <= kMaxDepth_mm ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};
  }
  return to_mm;
}

Expected<std::vector<FakenectEntry>> parse_fakenect_index(std::string_view text, std::string_view name) {
  std::vector<FakenectEntry> entries;
  double first_s = 0;
  for (int line_number = 1; !text.empty(); ++line_number) {
    const auto end = std::min(text.find('\n'), text.size());
    auto line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.starts_with("d-")) continue;
    const auto wrong = [&](const char* expected) {
      return fail(std::string(name) + ":" + std::to_string(line_number) + ": " + expected + ", found " + quoted(line));
    };
    if (line.find_first_of(std::string_view("/\\\0", 3)) != std::string_view::npos || line.size() > 255)
      return wrong("expected a file's name without its folder");
    double seconds = 0;
    const auto parsed = std::from_chars(line.data() + 2, line.data() + line.size(), seconds);
    if (parsed.ec != std::errc{} || !std::isfinite(seconds) || std::abs(seconds) > 1e12 ||
        parsed.ptr == line.data() + line.size() || *parsed.ptr != '-')
      return wrong("expected 'd-SECONDS-TICKS.pgm'");
    if (entries.empty()) first_s = seconds;
    auto time = std::chrono::round<std::chrono::microseconds>(std::chrono::duration<double>(seconds - first_s));
    if (!entries.empty()) time = std::max(time, entries.back().time);
    entries.push_back({std::string(line), time});
  }
  if (entries.empty()) return fail(std::string(name) + ": names no depth images: expected lines 'd-SECONDS-TICKS.pgm'");
  return entries;
}

Expected<std::unique_ptr<DepthSource>> open_fakenect(const std::filesystem::path& directory,
                                                     const OpenOptions& options) {
  const auto index = directory / "INDEX.txt";
  const auto bytes = read_file(index, kMaxIndexBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  auto entries = parse_fakenect_index({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, index.string());
  if (!entries) return tl::unexpected(entries.error());
  auto source = std::make_unique<FakenectSource>(directory, std::move(*entries), options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return source;
}

}  // namespace armature
