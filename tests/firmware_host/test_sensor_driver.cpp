// An OpenNI2 driver with one depth sensor, `test:sensor`: 64 x 48 at 60 Hz in tenths of a millimetre, frame n of
// 10000 + 10 n of them.

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

namespace {

constexpr const char* kUri = "test:sensor";
OniVideoMode mode{ONI_PIXEL_FORMAT_DEPTH_100_UM, 64, 48, 60};

template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

class Stream final : public oni::driver::StreamBase {
 public:
  ~Stream() override { stop(); }
  OniStatus start() override {
    stopping_ = false;
    thread_ = std::thread([this] {
      for (int n = 1; !stopping_; ++n) {
        std::this_thread::sleep_for(std::chrono::milliseconds(16));
        send(n);
      }
    });
    return ONI_STATUS_OK;
  }
  void stop() override {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
           id == ONI_STREAM_PROPERTY_VERTICAL_FOV;
  }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(mode, data, size);
    if (id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV) return give(1.0F, data, size);
    if (id == ONI_STREAM_PROPERTY_VERTICAL_FOV) return give(0.8F, data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }

 private:
  void send(int n) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    frame->frameIndex = n;
    frame->timestamp = static_cast<std::uint64_t>(n) * 16'667;
    frame->sensorType = ONI_SENSOR_DEPTH;
    frame->videoMode = mode;
    frame->width = mode.resolutionX;
    frame->height = mode.resolutionY;
    frame->stride = mode.resolutionX * 2;
    frame->croppingEnabled = 0;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->dataSize = frame->stride * frame->height;
    auto* pixels = static_cast<std::uint16_t*>(frame->data);
    for (int i = 0; i < frame->width * frame->height; ++i) pixels[i] = static_cast<std::uint16_t>(10000 + 10 * n);
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

class Device final : public oni::driver::DeviceBase {
 public:
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = &sensor_;
    *count = 1;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return type == ONI_SENSOR_DEPTH ? new Stream : nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

 private:
  OniSensorInfo sensor_{ONI_SENSOR_DEPTH, 1, &mode};
};

class Driver final : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}
  OniStatus initialize(oni::driver::DeviceConnectedCallback connected, oni::driver::DeviceDisconnectedCallback gone,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, gone, changed, cookie);
    announce();
    return status;
  }
  OniStatus tryDevice(const char* uri) override {
    if (std::strcmp(uri, kUri) != 0) return ONI_STATUS_ERROR;
    announce();
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    return std::strcmp(uri, kUri) == 0 ? new Device : nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}

 private:
  void announce() {
    OniDeviceInfo info{};
    std::snprintf(info.uri, sizeof info.uri, "%s", kUri);
    std::snprintf(info.vendor, sizeof info.vendor, "Armature");
    std::snprintf(info.name, sizeof info.name, "Test sensor");
    deviceConnected(&info);
  }
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)
