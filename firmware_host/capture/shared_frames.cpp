#include "firmware_host/capture/shared_frames.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace armature {
namespace {

constexpr std::uint32_t kMagic = 0x414D4632;  // changes with the layout
constexpr std::size_t kSlots = 3;
constexpr std::size_t kTroubleBytes = 256;

struct Slot {
  std::atomic<std::uint64_t> version{0};
  std::uint64_t sequence = 0;
  std::int64_t sensor_ns = 0;
  std::int64_t host_ns = 0;
  std::uint32_t sensor_clock = 0;
  Intrinsics intrinsics;
  std::array<std::uint16_t, SharedFrames::kMaxPixels> depth_mm;  // pages that are never written are never there
};

bool plausible(const Intrinsics& k) noexcept {
  const auto pixels = std::int64_t{k.width} * k.height;
  return k.width > 0 && k.height > 0 && k.width <= kMaxImageSide && k.height <= kMaxImageSide &&
         pixels <= SharedFrames::kMaxPixels && std::isfinite(k.focal_x_px) && k.focal_x_px > 0 &&
         std::isfinite(k.focal_y_px) && k.focal_y_px > 0 && std::isfinite(k.centre_x_px) &&
         std::isfinite(k.centre_y_px);
}

}  // namespace

struct SharedFrames::Layout {
  std::uint32_t magic = kMagic;
  std::atomic<CaptureState> state{CaptureState::Opening};
  std::atomic<CaptureCommand> command{CaptureCommand::None};
  std::atomic<std::int64_t> alive_ns{0};
  std::atomic<std::uint32_t> light{0};
  std::atomic<std::uint64_t> written{0};  // frames ever; frame n is in slot n % kSlots
  std::atomic<double> frames_per_second{30};
  std::atomic<std::uint32_t> trouble_version{0};
  std::array<char, kTroubleBytes> trouble{};
  std::array<Slot, kSlots> slots;
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

Expected<SharedFrames> SharedFrames::create() {
  const int descriptor = ::memfd_create("armature-frames", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  SharedFrames frames(descriptor, nullptr);  // closes it where anything fails
  const auto complain = [] { return fail(std::string("shared memory for frames: ") + std::strerror(errno)); };
  if (descriptor < 0 || ::ftruncate(descriptor, sizeof(Layout)) != 0) return complain();
  // Neither side can make it smaller under the other's feet.
  ::fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
  void* memory = ::mmap(nullptr, sizeof(Layout), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) return complain();
  frames.layout_ = new (memory) Layout;
  return frames;
}

Expected<SharedFrames> SharedFrames::attach(int descriptor) {
  SharedFrames frames(descriptor, nullptr);  // closes it where anything fails
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || status.st_size != static_cast<off_t>(sizeof(Layout))) {
    return fail("shared memory for frames: descriptor " + std::to_string(descriptor) + " holds something else");
  }
  void* memory = ::mmap(nullptr, sizeof(Layout), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) return fail(std::string("shared memory for frames: ") + std::strerror(errno));
  frames.layout_ = static_cast<Layout*>(memory);
  if (frames.layout_->magic != kMagic) return fail("shared memory for frames: of another version");
  return frames;
}

SharedFrames::~SharedFrames() {
  if (layout_ != nullptr) ::munmap(layout_, sizeof(Layout));
  if (descriptor_ >= 0) ::close(descriptor_);
}
SharedFrames::SharedFrames(SharedFrames&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      layout_(std::exchange(other.layout_, nullptr)),
      last_read_(other.last_read_) {}
SharedFrames& SharedFrames::operator=(SharedFrames&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(layout_, other.layout_);
  std::swap(last_read_, other.last_read_);
  return *this;
}

bool SharedFrames::write(const DepthFrame& frame, double frames_per_second) noexcept {
  const Intrinsics& k = frame.intrinsics;
  if (!plausible(k) ||
      frame.depth_mm.size() != static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height)) {
    return false;
  }
  const std::uint64_t number = layout_->written.load(std::memory_order_relaxed) + 1;
  Slot& slot = layout_->slots[number % kSlots];
  const std::uint64_t version = slot.version.load(std::memory_order_relaxed);
  slot.version.store(version | 1U, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  slot.sequence = frame.sequence;
  slot.sensor_ns = frame.sensor.time.count();
  slot.host_ns = frame.host.time.count();
  slot.sensor_clock = static_cast<std::uint32_t>(frame.sensor.clock);
  slot.intrinsics = k;
  std::memcpy(slot.depth_mm.data(), frame.depth_mm.data(), frame.depth_mm.size() * sizeof(std::uint16_t));
  slot.version.store((version | 1U) + 1, std::memory_order_release);
  layout_->frames_per_second.store(frames_per_second, std::memory_order_relaxed);
  layout_->written.store(number, std::memory_order_release);
  return true;
}

void SharedFrames::set_state(CaptureState state, const std::string& trouble) noexcept {
  layout_->trouble_version.fetch_add(1, std::memory_order_acq_rel);
  layout_->trouble.fill('\0');
  std::memcpy(layout_->trouble.data(), trouble.data(), std::min(trouble.size(), kTroubleBytes - 1));
  layout_->trouble_version.fetch_add(1, std::memory_order_acq_rel);
  layout_->state.store(state, std::memory_order_release);
}

void SharedFrames::alive(std::chrono::nanoseconds now) noexcept {
  layout_->alive_ns.store(now.count(), std::memory_order_relaxed);
}

CaptureCommand SharedFrames::take_command() noexcept {
  return layout_->command.exchange(CaptureCommand::None, std::memory_order_acq_rel);
}

SharedFrames::Read SharedFrames::read(DepthFrame& frame) {
  const std::uint64_t number = layout_->written.load(std::memory_order_acquire);
  if (number == last_read_ || number == 0) return Read::Nothing;
  const Slot& slot = layout_->slots[number % kSlots];
  const std::uint64_t version = slot.version.load(std::memory_order_acquire);
  const Intrinsics k = slot.intrinsics;
  last_read_ = number;
  if ((version & 1U) != 0 || !plausible(k)) return Read::Torn;
  frame.intrinsics = k;
  frame.sequence = slot.sequence;
  frame.sensor = {std::chrono::nanoseconds(slot.sensor_ns),
                  static_cast<ClockId>(std::min(slot.sensor_clock, std::uint32_t{3}))};
  frame.host = {std::chrono::nanoseconds(slot.host_ns), ClockId::HostMonotonic};
  frame.depth_mm.resize(static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height));
  std::memcpy(frame.depth_mm.data(), slot.depth_mm.data(), frame.depth_mm.size() * sizeof(std::uint16_t));
  std::atomic_thread_fence(std::memory_order_acquire);
  return slot.version.load(std::memory_order_relaxed) == version ? Read::Frame : Read::Torn;
}

CaptureState SharedFrames::state() const noexcept {
  return layout_->state.load(std::memory_order_acquire);
}

std::string SharedFrames::trouble() const {
  std::array<char, kTroubleBytes> copy{};
  const std::uint32_t version = layout_->trouble_version.load(std::memory_order_acquire);
  std::memcpy(copy.data(), layout_->trouble.data(), copy.size() - 1);
  std::atomic_thread_fence(std::memory_order_acquire);
  if ((version & 1U) != 0 || layout_->trouble_version.load(std::memory_order_relaxed) != version) return "";
  std::string text(copy.data());
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

double SharedFrames::frames_per_second() const noexcept {
  const double fps = layout_->frames_per_second.load(std::memory_order_relaxed);
  return fps > 0.1 && fps < 1000 ? fps : 30;
}

std::chrono::nanoseconds SharedFrames::last_alive() const noexcept {
  return std::chrono::nanoseconds(layout_->alive_ns.load(std::memory_order_relaxed));
}

void SharedFrames::command(CaptureCommand command) noexcept {
  layout_->command.store(command, std::memory_order_release);
}

void SharedFrames::show(std::uint32_t light) noexcept {
  layout_->light.store(light, std::memory_order_relaxed);
}

std::uint32_t SharedFrames::shown() const noexcept {
  return layout_->light.load(std::memory_order_relaxed);
}

void SharedFrames::clear() noexcept {
  // The last writer may have died between two bytes: its odd versions become even, its frames are not handed out.
  for (Slot& slot : layout_->slots) slot.version.store((slot.version.load() + 1) & ~std::uint64_t{1});
  layout_->trouble_version.store((layout_->trouble_version.load() + 1) & ~std::uint32_t{1});
  layout_->trouble.fill('\0');
  layout_->magic = kMagic;
  layout_->command.store(CaptureCommand::None);
  layout_->state.store(CaptureState::Opening);
  last_read_ = layout_->written.load();
}

}  // namespace armature
