// Walks a camera with the body of whoever stands in front of the sensor, and says where it is.
//
// usage: steer [ENDPOINT [FRAMES]]

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <armature/navproto/endpoints.h>
#include <armature/navproto/nav_camera.h>
#include <armature/navproto/subscriber.h>

int main(int argc, char** argv) {
  using namespace armature::navproto;
  constexpr std::chrono::milliseconds kFrameTime{16};

  NavSubscriber nav(argc > 1 ? argv[1] : kDefaultEndpoint);
  NavCamera camera;
  const long frames = argc > 2 ? std::atol(argv[2]) : -1;
  for (long frame = 0; frame != frames; ++frame) {
    if (const auto error = nav.error()) {
      std::fprintf(stderr, "steer: %s\n", error->message.c_str());
      return EXIT_FAILURE;
    }
    camera.advance(nav.velocity(), kFrameTime);
    std::printf("x %.3f m, y %.3f m, heading %.3f rad\n", camera.pose().x_m, camera.pose().y_m,
                camera.pose().heading_rad);
    std::this_thread::sleep_for(kFrameTime);
  }
  return EXIT_SUCCESS;
}
