#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <armature/navproto/control.h>
#include <armature/navproto/endpoints.h>
#include <armature/navproto/feed.h>
#include <armature/navproto/subscriber.h>

#include "tools/commands/commands.h"
#include "tools/commands/listen_json.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/output_file.h"
#include "tools/terminal/live_model.h"
#include "tools/terminal/live_view.h"
#include "tools/terminal/terminal.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;
using navproto::StopReason;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kRedraw = 40ms;
constexpr milliseconds kLogLine = 500ms;

struct ListenOptions {
  std::string endpoint{navproto::kDefaultEndpoint};
  std::string keys, server_key;  ///< of a publisher over tcp that asks for them
  std::optional<navproto::CurveClient> curve;
  bool json = false;
  bool plain = false;
  long frames = 0;       ///< 0 = no limit
  long until_frame = 0;  ///< 0 = no limit
  double seconds = 0;    ///< 0 = no limit
  double timeout = 0;    ///< seconds without any message that count as failure; 0 = wait for ever
  std::string svg;
  int columns = 110;
  int rows = 34;
};

/// Asks the daemon for its dead zones now and then, on a thread of its own because an answer may take its time.
class SettingsWatch {
 public:
  explicit SettingsWatch(const std::string& endpoint)
      : thread_([this, endpoint](const std::stop_token& stop) { run(endpoint, stop); }) {}

  [[nodiscard]] std::optional<navproto::ControlSettings> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(settings_, std::nullopt);
  }

 private:
  void run(const std::string& endpoint, const std::stop_token& stop) {
    auto client = navproto::ControlClient::connect(endpoint);
    if (!client) return;
    while (!stop.stop_requested()) {
      if (auto reply = client->request({.id = 0, .kind = navproto::RequestKind::Status, .settings = {}}, 200ms)) {
        const std::scoped_lock lock(mutex_);
        settings_ = std::move(reply->settings);
      }
      for (int i = 0; i < 10 && !stop.stop_requested(); ++i) std::this_thread::sleep_for(50ms);
    }
  }

  std::mutex mutex_;
  std::optional<navproto::ControlSettings> settings_;
  std::jthread thread_;
};

navproto::SubscriberOptions subscriber_options(const ListenOptions& options) {
  navproto::SubscriberOptions subscriber;
  subscriber.curve = options.curve;
  return subscriber;
}

/// Whether the publisher has said that nothing more will come.
bool is_over(const navproto::NavigationMessage& navigation) {
  return navigation.stop_reason == StopReason::EndOfStream || navigation.stop_reason == StopReason::Exit;
}

/// One run of the command: receives, shows, stops.
class Listener {
 public:
  explicit Listener(const ListenOptions& options)
      : options_(options),
        nav_(options.endpoint, subscriber_options(options)),
        model_(options.endpoint, navproto::monotonic_now()),
        start_(navproto::monotonic_now()),
        shows_picture_(!options.json && !options.plain && Terminal::there()) {}

  Expected<void> run() {
    if (const auto allowed = navproto::may_connect(options_.endpoint); !allowed) return fail(allowed.error().message);
    // Who only listens wants every value; who looks wants the body and the dead zones, too.
    std::optional<SettingsWatch> settings;
    if (shows_picture_ || !options_.svg.empty()) {
      if (auto feed = navproto::FeedSubscriber::connect(options_.endpoint, options_.curve))
        feed_.emplace(std::move(*feed));
      settings.emplace(options_.endpoint);
    }
    if (shows_picture_) terminal_.emplace();
    auto result = follow(settings);
    terminal_.reset();
    if (!result) return result;
    if (!options_.svg.empty()) {
      Screen screen(options_.columns, options_.rows);
      draw_live_view(model_.state(), screen);
      result = write_file(options_.svg, svg(screen, "armature listen: a person steers a camera"));
    }
    if (result && !options_.json) std::printf("%s\n", live_line(model_.state()).c_str());
    return result;
  }

 private:
  Expected<void> follow(std::optional<SettingsWatch>& settings) {
    while (!interrupt_.requested()) {
      const auto arrivals = nav_.wait(kRedraw);
      const auto now = navproto::monotonic_now();
      if (arrivals) heard_ = now;
      if (auto result = take(arrivals, now); !result) return result;
      if (settings) {
        if (const auto news = settings->take()) model_.take(*news);
      }
      model_.advance(nav_.velocity(), now);
      if (auto result = show(now); !result) return result;
      if (over_ || (options_.frames > 0 && frames_ >= options_.frames)) return {};
      if (options_.seconds > 0 && now - start_ >= std::chrono::duration<double>(options_.seconds)) return {};
      if (options_.timeout > 0 && now - std::max(heard_, start_) >= std::chrono::duration<double>(options_.timeout)) {
        std::array<char, 32> seconds{};
        std::snprintf(seconds.data(), seconds.size(), "%g", options_.timeout);
        return fail(options_.endpoint + ": nothing came within " + seconds.data() +
                    " s; is armatured running with this endpoint?");
      }
    }
    return {};
  }

  Expected<void> take(const navproto::Arrivals& arrivals, nanoseconds now) {
    if (const auto error = arrivals.error ? nav_.error() : std::nullopt) {
      // Where nothing could be read yet it is most likely a publisher of another version. Later the next may be fine.
      if (frames_ == 0) return fail(error->message);
      model_.take(*error);
      if (!terminal_) std::fprintf(stderr, "armature: %s\n", error->message.c_str());
    }
    Expected<void> written;
    if (arrivals.navigation) {
      const auto navigation = nav_.navigation();
      model_.take(*navigation, now);
      ++frames_;
      const bool reached =
          options_.until_frame > 0 && navigation->times.frame >= static_cast<std::uint64_t>(options_.until_frame);
      over_ = over_ || reached || is_over(*navigation);
      if (options_.json) written = write_json_line(stdout, to_json(*navigation));
    }
    if (written && arrivals.skeleton) {
      const auto skeleton = nav_.skeleton();
      model_.take(*skeleton);
      if (options_.json) written = write_json_line(stdout, to_json(*skeleton));
    }
    if (written && arrivals.health) {
      const auto health = nav_.health();
      model_.take(*health);
      if (options_.json) written = write_json_line(stdout, to_json(*health));
    }
    if (arrivals.events) {
      for (const auto& event : nav_.take_events()) {
        model_.take(event);
        over_ = over_ || event.kind == navproto::EventKind::Stopping;
        if (written && options_.json) written = write_json_line(stdout, to_json(event));
      }
    }
    if (feed_) {
      if (auto frame = feed_->receive(0ms); frame && *frame) model_.take(std::move(**frame));
    }
    return written;
  }

  Expected<void> show(nanoseconds now) {
    if (options_.json || now - shown_ < (terminal_ ? kRedraw : kLogLine)) return {};
    shown_ = now;
    if (terminal_) {
      Screen screen = Terminal::blank();
      draw_live_view(model_.state(), screen);
      terminal_->show(screen);
      const char key = terminal_->key();
      if (key == 'q' || key == 'Q') over_ = true;
      return {};
    }
    if (std::printf("%s\n", live_line(model_.state()).c_str()) < 0 || std::fflush(stdout) != 0) {
      return fail("standard output: cannot be written (disk full or reader gone)");
    }
    return {};
  }

  ListenOptions options_;
  Interrupt interrupt_;
  navproto::NavSubscriber nav_;
  std::optional<navproto::FeedSubscriber> feed_;
  LiveModel model_;
  nanoseconds start_;
  nanoseconds heard_{0};
  nanoseconds shown_{0};
  long frames_ = 0;
  bool over_ = false;
  bool shows_picture_;
  std::optional<Terminal> terminal_;
};

}  // namespace

void add_listen(CLI::App& app, Run& run) {
  auto options = std::make_shared<ListenOptions>();
  auto* command = app.add_subcommand("listen", "Show what a daemon publishes: body, motions, velocities, path");
  command->add_option("endpoint", options->endpoint, "Where armatured publishes: ipc://PATH or tcp://HOST:PORT")
      ->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object a message, a line each (\"type\" says which)");
  command->add_flag("--plain", options->plain, "Lines instead of the picture, in a terminal, too");
  command->add_option("--frames", options->frames, "Stop after this many navigation messages")
      ->check(CLI::PositiveNumber);
  command->add_option("--until-frame", options->until_frame, "Stop when the sensor's frame of this number has come")
      ->check(CLI::PositiveNumber);
  command->add_option("--seconds", options->seconds, "Stop after this time")->check(CLI::PositiveNumber);
  command->add_option("--timeout", options->timeout, "Fail when nothing comes for this many seconds")
      ->check(CLI::PositiveNumber);
  command->add_option("--svg", options->svg, "Write the picture as it is at the end to this file");
  command->add_option("--columns", options->columns, "Width of the --svg picture in characters")
      ->check(CLI::Range(40, 400))
      ->capture_default_str();
  command->add_option("--rows", options->rows, "Height of the --svg picture in characters")
      ->check(CLI::Range(12, 200))
      ->capture_default_str();
  command->add_option("--keys", options->keys, "tcp with keys: our own pair, made by `armature keys new`")
      ->type_name("FILE");
  command->add_option("--server", options->server_key, "tcp with keys: the publisher's public key")->type_name("KEY");
  command->footer(
      "In a terminal: a picture that redraws in place (q quits); elsewhere two lines a second. Ends by itself when "
      "the\n"
      "publisher says that its stream is over. The path is that of a camera which follows the velocities.\n\n"
      "Example: armature listen ipc:///run/armature/nav --json | jq .linear_m_s");
  command->callback([options, &run] {
    run = [options]() -> Expected<void> {
      if (const auto endpoints = navproto::endpoints_of(options->endpoint); !endpoints) {
        return fail(endpoints.error().message);
      }
      if (options->keys.empty() != options->server_key.empty())
        return fail("--keys and --server: expected both or neither");
      if (!options->keys.empty()) {
        auto keys = navproto::read_key_pair(options->keys);
        if (!keys) return fail(keys.error().message);
        if (!navproto::is_key(options->server_key)) return fail("--server: expected a public key of 40 characters");
        options->curve = navproto::CurveClient{options->server_key, std::move(*keys)};
      }
      return Listener(*options).run();
    };
  });
}

}  // namespace armature::tools
