#include "tracker/config.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "tracker/config_fields.h"
#include "tracker/segmentation/stored_background.h"

namespace armature {
namespace {

constexpr float kDegrees = 180 / std::numbers::pi_v<float>;

template <std::size_t N>
std::string listed(const std::array<std::string_view, N>& names) {
  std::string out;
  for (const auto name : names) out += (out.empty() ? "" : ", ") + std::string(name);
  return out;
}

std::string shown(const toml::node& node) {
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

/// Takes each known key out of the parsed table and keeps the complaint nearest to the top of the file.
class Reader {
 public:
  Reader(const toml::table& root, std::string_view name) : root_(root), name_(name) {}

  void section(const std::string& name, std::string_view) {
    section_ = name;
    known_.insert(name);
    for (auto dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
      known_.insert(name.substr(0, dot));
    }
  }
  void text(std::string_view key, std::string& value, std::string_view) {
    take<std::string>(key, "a text in quotes", [&](const std::string& v) {
      value = v;
      return true;
    });
  }
  void flag(std::string_view key, bool& value, std::string_view) {
    take<bool>(key, "true or false", [&](bool v) {
      value = v;
      return true;
    });
  }
  void whole(std::string_view key, int& value, int low, int high, std::string_view) {
    take<std::int64_t>(key, fmt::format("a whole number from {} to {}", low, high), [&](std::int64_t v) {
      if (v < low || v > high) return false;
      value = static_cast<int>(v);
      return true;
    });
  }
  void number(std::string_view key, float& value, float low, float high, std::string_view) {
    scaled(key, low, high, [&](double v) { value = static_cast<float>(v); });
  }
  void angle(std::string_view key, float& value, float low, float high, std::string_view) {
    scaled(key, low, high, [&](double v) { value = static_cast<float>(v) / kDegrees; });
  }
  void seconds(std::string_view key, std::chrono::milliseconds& value, float low, float high, std::string_view) {
    scaled(key, low, high, [&](double v) { value = std::chrono::milliseconds(std::lround(v * 1000)); });
  }
  template <class Enum, std::size_t N>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, N>& names, std::string_view) {
    take<std::string>(key, "one of " + listed(names), [&](const std::string& v) {
      const auto found = std::find(names.begin(), names.end(), v);
      if (found == names.end()) return false;
      value = static_cast<Enum>(found - names.begin());
      return true;
    });
  }

  /// Complains about whatever was not asked for.
  void refuse_unknown() { refuse_unknown(root_, ""); }

  void complain(const toml::source_region& where, const std::string& what) {
    if (first_line_ != 0 && where.begin.line >= first_line_) return;
    first_line_ = std::max<toml::source_index>(where.begin.line, 1);
    complaint_ = fmt::format("{}:{}: {}", name_, where.begin.line, what);
  }
  [[nodiscard]] const std::string& complaint() const { return complaint_; }
  /// The place of each key that was there.
  [[nodiscard]] auto take_places() { return std::move(places_); }
  [[nodiscard]] bool has(std::string_view path) const { return bool(root_.at_path(path)); }
  [[nodiscard]] toml::source_region place(std::string_view path) const {
    const auto node = root_.at_path(path);
    return node ? node.node()->source() : root_.source();
  }

 private:
  template <class T, class Accept>
  void take(std::string_view key, const std::string& expected, Accept accept) {
    const std::string path = section_ + "." + std::string(key);
    const toml::node* node = find(path);
    if (node == nullptr) return;
    const auto value = node->template value_exact<T>();
    if (!value || !accept(*value)) refuse(path, *node, expected);
  }
  template <class Accept>
  void scaled(std::string_view key, float low, float high, Accept accept) {
    const std::string path = section_ + "." + std::string(key);
    const toml::node* node = find(path);
    if (node == nullptr) return;
    const auto value = node->is_number() ? node->template value<double>() : std::nullopt;
    if (value && *value >= static_cast<double>(low) && *value <= static_cast<double>(high)) return accept(*value);
    refuse(path, *node, fmt::format("a number from {} to {}", low, high));
  }
  /// What a known key is set to; null where it is not there.
  const toml::node* find(const std::string& path) {
    known_.insert(path);
    const toml::node* node = root_.at_path(path).node();
    if (node != nullptr) places_[path] = fmt::format("{}:{}", name_, node->source().begin.line);
    return node;
  }
  void refuse(const std::string& path, const toml::node& node, const std::string& expected) {
    complain(node.source(), fmt::format("{} = {}: expected {}", path, shown(node), expected));
  }
  void refuse_unknown(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string path = prefix + std::string(key.str());
      if (!known_.contains(path)) {
        complain(key.source(), fmt::format("{}: unknown key; `armatured --print-config` lists them all", path));
      } else if (const auto* inner = node.as_table()) {
        refuse_unknown(*inner, path + ".");
      } else if (is_section(path)) {
        complain(key.source(), fmt::format("{} = {}: expected a table [{}]", path, shown(node), path));
      }
    }
  }
  [[nodiscard]] bool is_section(const std::string& path) const {
    const auto next = known_.upper_bound(path + ".");
    return next != known_.end() && next->starts_with(path + ".");
  }

  const toml::table& root_;
  std::string name_;
  std::string section_;
  std::set<std::string> known_;
  decltype(Config::set_at) places_;
  toml::source_index first_line_ = 0;
  std::string complaint_;
};

class Writer {
 public:
  void section(const std::string& name, std::string_view doc) {
    out_ += fmt::format("{}[{}]{}{}\n", out_.empty() ? "" : "\n", name, doc.empty() ? "" : "  # ", doc);
  }
  void text(std::string_view key, const std::string& value, std::string_view doc) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    line(key, quoted.str(), doc);
  }
  void flag(std::string_view key, bool value, std::string_view doc) { line(key, value ? "true" : "false", doc); }
  void whole(std::string_view key, int value, int low, int high, std::string_view doc) {
    line(key, fmt::format("{}", value), fmt::format("{} ({} to {})", doc, low, high));
  }
  void number(std::string_view key, float value, float low, float high, std::string_view doc) {
    line(key, decimal(value), fmt::format("{} ({} to {})", doc, low, high));
  }
  void angle(std::string_view key, float value, float low, float high, std::string_view doc) {
    // Six digits: enough to read the same angle back, few enough to print 35 degrees as 35.
    number(key, std::stof(fmt::format("{:.6g}", value * kDegrees)), low, high, doc);
  }
  void seconds(std::string_view key, std::chrono::milliseconds value, float low, float high, std::string_view doc) {
    number(key, static_cast<float>(value.count()) / 1000, low, high, doc);
  }
  template <class Enum, std::size_t N>
  void choice(std::string_view key, Enum value, const std::array<std::string_view, N>& names, std::string_view doc) {
    line(key, fmt::format("\"{}\"", names[static_cast<std::size_t>(value)]),
         names.size() > 4 ? std::string(doc) : fmt::format("{}", doc));
  }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  static std::string decimal(float value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
  }
  void line(std::string_view key, const std::string& value, std::string_view doc) {
    out_ += fmt::format("{:<34} # {}\n", fmt::format("{} = {}", key, value), doc);
  }
  std::string out_;
};

}  // namespace

tl::unexpected<Error> refuse(const Config& config, std::string_view key, std::string_view value, std::string_view why) {
  for (const auto& known :
       {fmt::format("{}: ", value), fmt::format("endpoint {}: ", value), fmt::format("source '{}': ", value)}) {
    if (!why.starts_with(known)) continue;
    why.remove_prefix(known.size());
    break;
  }
  const auto place = config.set_at.find(key);
  return fail(fmt::format("{}{} = {}: {}", place == config.set_at.end() ? "" : place->second + ": ", key, value, why));
}

Expected<Config> parse_config(std::string_view text, std::string_view name) {
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(fmt::format("{}:{}: not TOML: {}", name, error.source().begin.line, error.description()));
  }
  Config config;
  if (root.at_path("navigation.profile").value_or(std::string_view()) == "seated") {
    config.tracker.navigation.pair = {.turn = MotionId::RotateShoulders, .walk = MotionId::BendBust};
  }
  Reader reader(root, name);
  visit_config(config, reader);
  reader.refuse_unknown();

  const NavigationOptions& navigation = config.tracker.navigation;
  if (const auto why = refused(navigation.pair, navigation.allow_correlated)) {
    reader.complain(reader.place(reader.has("navigation.turn") ? "navigation.turn" : "navigation.walk"), *why);
  }
  const SegmentationOptions& zone = config.tracker.segmentation;
  if (zone.near_m >= zone.far_m) {
    reader.complain(
        reader.place(reader.has("segmentation.near_m") ? "segmentation.near_m" : "segmentation.far_m"),
        fmt::format("segmentation.near_m = {} and far_m = {}: expected near_m < far_m", zone.near_m, zone.far_m));
  }
  const EngagementOptions& active = config.tracker.engagement;
  if (active.near_m >= active.far_m) {
    reader.complain(
        reader.place(reader.has("engagement.near_m") ? "engagement.near_m" : "engagement.far_m"),
        fmt::format("engagement.near_m = {} and far_m = {}: expected near_m < far_m", active.near_m, active.far_m));
  }
  if (!reader.complaint().empty()) return fail(reader.complaint());
  config.set_at = reader.take_places();
  return config;
}

Expected<Config> load_config(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fail(path.string() + ": no such file; `armatured --print-config > FILE` writes one to start from");
  }
  if (std::filesystem::file_size(path, error) > kMaxBytes) {
    return fail(path.string() + ": larger than 1 MiB: not a configuration");
  }
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in && !in.eof()) return fail(path.string() + ": cannot be read");
  auto config = parse_config(text, path.string());
  if (!config || config->background.empty()) return config;
  auto background = read_background(config->background);
  if (!background) {
    const std::string why = background.error().message;
    const bool closed = why.find(std::generic_category().message(EACCES)) != std::string::npos;
    return refuse(*config, "segmentation.background", config->background,
                  why + (closed ? "; let the daemon read it: systemd-tmpfiles --create armature.conf" : ""));
  }
  config->tracker.segmentation.background = std::make_shared<const StoredBackground>(std::move(*background));
  return config;
}

std::string print_config(const Config& config) {
  Config copy = config;
  Writer writer;
  visit_config(copy, writer);
  return writer.take();
}

}  // namespace armature
