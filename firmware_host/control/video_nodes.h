#pragma once

#include <string>
#include <vector>

namespace armature {

/// A V4L2 node that sends depth.
struct VideoNode {
  std::string path;     ///< "/dev/video0"
  std::string name;     ///< the driver's word for the camera
  std::string bus;      ///< where it is plugged in
  std::string format;   ///< "Z16" or "Y10B"; empty where it may not be asked
  std::string problem;  ///< empty, or why it cannot be opened by this user
};

/// The depth cameras among /dev/video*, in the order of their numbers.
[[nodiscard]] std::vector<VideoNode> list_depth_nodes();

/// The USB port that a node's camera is plugged in at, "1-2.3", as the kernel names it; empty where it is on no USB.
[[nodiscard]] std::string usb_port_of_video(const std::string& path);

/// The programs that hold a file open, as "NAME (PID)". Of other users' programs only root sees.
[[nodiscard]] std::vector<std::string> who_has_open(const std::string& path);

}  // namespace armature
