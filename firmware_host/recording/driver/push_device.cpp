// An OpenNI2 driver whose device has no sensor: whoever opens it pushes the depth images through it. OpenNI2's own
// recorder, attached to its stream, then writes a recording that every OpenNI2 program reads.
#include "firmware_host/recording/driver/push_device.h"

#include <cstdio>
#include <cstring>
#include <string>

// ONI_EXPORT_DRIVER needs these two and no header of the installed OpenNI2 defines them.
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

namespace armature {
namespace {

constexpr int kMaxDepth = 65535;  // the codec spoils depths at or above the stated maximum

struct PushMode {
  OniVideoMode video{};
  float horizontal_fov_rad = 0;
  float vertical_fov_rad = 0;
};

bool parse_push_uri(const char* uri, PushMode& mode) {
  unsigned serial = 0;
  double horizontal = 0;
  double vertical = 0;
  if (std::sscanf(uri, kPushUriFormat, &serial, &mode.video.resolutionX, &mode.video.resolutionY, &mode.video.fps,
                  &horizontal, &vertical) != 6)
    return false;
  mode.video.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM;
  mode.horizontal_fov_rad = static_cast<float>(horizontal);
  mode.vertical_fov_rad = static_cast<float>(vertical);
  return true;
}

template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

class PushStream final : public oni::driver::StreamBase {
 public:
  explicit PushStream(const PushMode& mode) : mode_(mode) {}

  OniStatus start() override { return ONI_STATUS_OK; }
  void stop() override {}

  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_CROPPING ||
           id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV || id == ONI_STREAM_PROPERTY_VERTICAL_FOV ||
           id == ONI_STREAM_PROPERTY_MAX_VALUE;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE: return give(mode_.video, data, size);
      case ONI_STREAM_PROPERTY_CROPPING:  // without it the player drops every image of the recording
        return give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV: return give(mode_.horizontal_fov_rad, data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV: return give(mode_.vertical_fov_rad, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE: return give(kMaxDepth, data, size);
      default: return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  OniBool isCommandSupported(int id) override { return id == kPushFrameCommand || id == kSynchronizeCommand; }
  OniStatus invoke(int id, void* data, int size) override {
    if (id == kSynchronizeCommand) {
      const int nothing = 0;
      raisePropertyChanged(kSynchronizeProperty, &nothing, sizeof nothing);
      return ONI_STATUS_OK;
    }
    if (id != kPushFrameCommand || size != static_cast<int>(sizeof(PushedFrame))) return ONI_STATUS_BAD_PARAMETER;
    return push(*static_cast<const PushedFrame*>(data));
  }

 private:
  OniStatus push(const PushedFrame& pushed) {
    const int row_bytes = mode_.video.resolutionX * static_cast<int>(sizeof(std::uint16_t));
    if (pushed.bytes != row_bytes * mode_.video.resolutionY) return ONI_STATUS_BAD_PARAMETER;
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return ONI_STATUS_ERROR;
    frame->frameIndex = pushed.index;
    frame->timestamp = pushed.timestamp_us;
    frame->sensorType = ONI_SENSOR_DEPTH;
    frame->videoMode = mode_.video;
    frame->width = mode_.video.resolutionX;
    frame->height = mode_.video.resolutionY;
    frame->stride = row_bytes;
    frame->croppingEnabled = 0;
    frame->cropOriginX = 0;
    frame->cropOriginY = 0;
    frame->dataSize = pushed.bytes;
    std::memcpy(frame->data, pushed.depth_mm, static_cast<std::size_t>(pushed.bytes));
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
    return ONI_STATUS_OK;
  }

  PushMode mode_;
};

class PushDevice final : public oni::driver::DeviceBase {
 public:
  explicit PushDevice(const PushMode& mode) : mode_(mode), sensor_{ONI_SENSOR_DEPTH, 1, &mode_.video} {}

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = &sensor_;
    *count = 1;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return type == ONI_SENSOR_DEPTH ? new PushStream(mode_) : nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

 private:
  PushMode mode_;
  OniSensorInfo sensor_;
};

class PushDriver final : public oni::driver::DriverBase {
 public:
  explicit PushDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus tryDevice(const char* uri) override {
    PushMode mode;
    if (!parse_push_uri(uri, mode)) return ONI_STATUS_ERROR;
    OniDeviceInfo info{};
    std::snprintf(info.uri, sizeof info.uri, "%s", uri);
    std::snprintf(info.vendor, sizeof info.vendor, "Armature");
    std::snprintf(info.name, sizeof info.name, "Armature recording");
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    PushMode mode;
    return parse_push_uri(uri, mode) ? new PushDevice(mode) : nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}
};

}  // namespace
}  // namespace armature

ONI_EXPORT_DRIVER(armature::PushDriver)
