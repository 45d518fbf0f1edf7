// A program that knows nothing of ours: opens the recording argv[1] with the system's OpenNI2 and writes what it plays
// to argv[2]: a line "WIDTH HEIGHT FPS FRAMES", then for each frame its time stamp (8 bytes) and its pixels.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include <OpenNI.h>

int main(int argc, char** argv) {
  if (argc != 3 || openni::OpenNI::initialize() != openni::STATUS_OK) return 2;
  openni::Device device;
  openni::VideoStream stream;
  if (device.open(argv[1]) != openni::STATUS_OK || !device.isFile()) return 3;
  device.getPlaybackControl()->setSpeed(-1);
  if (stream.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) return 4;
  if (stream.start() != openni::STATUS_OK) return 5;
  const auto mode = stream.getVideoMode();
  const int frames = device.getPlaybackControl()->getNumberOfFrames(stream);
  std::ofstream out(argv[2], std::ios::binary);
  out << mode.getResolutionX() << ' ' << mode.getResolutionY() << ' ' << mode.getFps() << ' ' << frames << '\n';
  for (int i = 0; i < frames; ++i) {
    openni::VideoFrameRef frame;
    if (stream.readFrame(&frame) != openni::STATUS_OK) return 6;
    const std::uint64_t time = frame.getTimestamp();
    out.write(reinterpret_cast<const char*>(&time), sizeof time);
    out.write(static_cast<const char*>(frame.getData()), frame.getDataSize());
  }
  out.flush();

  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find("Armature") != std::string::npos) return 7;
  // No tidying up: how the player's threads end is not what is shown here.
  std::fflush(nullptr);
  std::quick_exit(out ? 0 : 8);
}
