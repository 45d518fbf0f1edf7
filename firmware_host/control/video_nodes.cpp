#include "firmware_host/control/video_nodes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace armature {
namespace {

namespace fs = std::filesystem;

std::string text_of(const __u8* text) {
  return reinterpret_cast<const char*>(text);
}

/// Whether the node at `descriptor` offers depth; fills in what it says of itself.
bool sends_depth(int descriptor, VideoNode& node) {
  v4l2_capability capability{};
  if (::ioctl(descriptor, VIDIOC_QUERYCAP, &capability) != 0) return false;
  node.name = text_of(capability.card);
  node.bus = text_of(capability.bus_info);
  v4l2_fmtdesc offered{};
  offered.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; ::ioctl(descriptor, VIDIOC_ENUM_FMT, &offered) == 0; ++offered.index) {
    if (offered.pixelformat == V4L2_PIX_FMT_Z16) node.format = "Z16";
    if (offered.pixelformat == V4L2_PIX_FMT_Y10BPACK) node.format = "Y10B";
  }
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (node.format.empty() && ::ioctl(descriptor, VIDIOC_G_FMT, &format) == 0) {
    if (format.fmt.pix.pixelformat == V4L2_PIX_FMT_Z16) node.format = "Z16";
    if (format.fmt.pix.pixelformat == V4L2_PIX_FMT_Y10BPACK) node.format = "Y10B";
  }
  return !node.format.empty();
}

}  // namespace

std::vector<VideoNode> list_depth_nodes() {
  std::vector<VideoNode> nodes;
  std::error_code error;
  std::vector<int> numbers;
  constexpr std::string_view kPrefix = "video";
  for (const auto& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kPrefix) && name.size() > kPrefix.size() && name.size() < 10 &&
        std::all_of(name.begin() + kPrefix.size(), name.end(), [](char c) { return c >= '0' && c <= '9'; })) {
      numbers.push_back(std::stoi(name.substr(kPrefix.size())));
    }
  }
  std::sort(numbers.begin(), numbers.end());
  for (const int number : numbers) {
    VideoNode node{.path = "/dev/video" + std::to_string(number), .name = {}, .bus = {}, .format = {}, .problem = {}};
    const int descriptor = ::open(node.path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) {
      node.problem = std::strerror(errno);
      nodes.push_back(node);
      continue;
    }
    if (sends_depth(descriptor, node)) nodes.push_back(node);
    ::close(descriptor);
  }
  return nodes;
}

std::string usb_port_of_video(const std::string& path) {
  std::error_code error;
  const fs::path node = fs::canonical(path, error).filename();
  if (error || node.empty()) return {};
  for (fs::path at = fs::canonical("/sys/class/video4linux" / node, error); !error && at.has_relative_path();
       at = at.parent_path())
    if (fs::exists(at / "busnum", error)) return at.filename();
  return {};
}

std::vector<std::string> who_has_open(const std::string& path) {
  std::vector<std::string> programs;
  std::error_code error;
  for (const auto& process : fs::directory_iterator("/proc", error)) {
    const std::string pid = process.path().filename().string();
    if (pid.find_first_not_of("0123456789") != std::string::npos || pid == std::to_string(::getpid())) continue;
    for (const auto& open : fs::directory_iterator(process.path() / "fd", error)) {
      if (fs::read_symlink(open.path(), error) != path) continue;
      std::string name;
      std::getline(std::ifstream(process.path() / "comm") >> std::ws, name);
      programs.push_back(name.append(" (").append(pid).append(")"));
      break;
    }
  }
  return programs;
}

}  // namespace armature
