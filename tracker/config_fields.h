#pragma once

#include "tracker/config.h"

namespace armature {

/// The one list of what can be set: name, place in Config, bounds and meaning. Reading, checking and printing all walk
/// it. A visitor has:
///   section(name, doc)                     the table that the following keys stand in
///   text(key, std::string&, doc)
///   flag(key, bool&, doc)
///   whole(key, int&, low, high, doc)
///   number(key, float&, low, high, doc)
///   angle(key_deg, float& radians, low_deg, high_deg, doc)
///   seconds(key_s, std::chrono::milliseconds&, low_s, high_s, doc)
///   choice(key, Enum&, names, doc)
template <class Visitor>
void visit_config(Config& c, Visitor& v) {
  v.section("source", "Where depth comes from.");
  v.text("uri", c.source,
         "openni2:, freenect:N, v4l2:/dev/videoN, oni:FILE, fakenect:DIR or synth:NAME; empty: named by --source");
  v.flag("lossless", c.lossless, "read a recording frame by frame and drop none, instead of at its own pace");

  v.section("publish", "Where velocities go.");
  v.text("endpoint", c.endpoint, "a ZeroMQ endpoint; ipc:///PATH (mode 0660) or tcp://ADDRESS:PORT");
  v.text("keys", c.keys, "tcp: our own CURVE keys, made by `armature keys new FILE`");
  v.text("allow", c.allow, "tcp: whose keys may connect, made by `armature keys allow FILE KEY NAME`");
  v.flag("insecure", c.insecure, "tcp without keys: everybody on the network may listen; logged at every start");

  v.section("control", "Who may change settings: programs of this machine.");
  v.text("endpoint", c.control,
         "ipc:///PATH, whose socket is PATH.control; empty: beside publish.endpoint, or the default");
  v.text("uids", c.control_uids, "numbers of users who may, besides root and our own: \"1000, 1001\"");

  v.section("health", "For whoever watches over many of these.");
  v.whole("metrics_port", c.metrics_port, 0, 65535, "Prometheus metrics on http://127.0.0.1:PORT/metrics; 0: none");

  v.section("segmentation", "What is looked at: who is outside is not seen.");
  SegmentationOptions& zone = c.tracker.segmentation;
  v.number("near_m", zone.near_m, 0.3F, 8.0F, "nearest distance along the optical axis");
  v.number("far_m", zone.far_m, 0.5F, 10.0F, "farthest");
  v.number("half_width_m", zone.half_width_m, 0.2F, 10.0F, "to either side of the optical axis");
  v.text("background", c.background,
         "the empty site, made by `armature doctor --site URI --background FILE`; empty: learned from what is seen");

  v.section("skeleton", "From depth to joints.");
  v.text("model", c.model, "a forest made by `armature forest train`; empty: the installed one");
  v.whole("stride", c.tracker.forest.stride, 0, 16, "pixels between samples; 0: a 160th of the image's width");
  v.number("bandwidth_m", c.tracker.joints.bandwidth_m, 0.02F, 0.3F, "kernel radius of the mean shift");
  v.number("observed_confidence", c.tracker.joints.observed_confidence, 0.0F, 1.0F, "below it a joint is inferred");
  v.whole("hold_frames", c.tracker.joints.hold_frames, 0, 300, "how long an unseen joint is inferred from the past");

  v.section("rest", "The pose against which motions are measured.");
  RestOptions& rest = c.tracker.rest;
  v.choice("mode", rest.mode, kRestModeNames,
           "stillness (live), auto (from the first frames, then improved) or first (the first frames)");
  v.whole("first_frames", rest.first_frames, 1, 128, "auto and first: frames of the rest pose");
  v.seconds("stillness_s", rest.stillness, 0.2F, 10.0F, "how long a user stands still for her rest pose");
  v.number("still_spread_m", rest.still_spread_m, 0.001F, 0.5F, "standard deviation of a joint at 2 m that is still");
  v.number("still_drift_m", rest.still_drift_m, 0.001F, 0.5F, "drift of a joint at 2 m that is still");

  v.section("engagement", "Who steers: the active zone on the floor before the sensor, and how long a turn lasts.");
  EngagementOptions& engagement = c.tracker.engagement;
  v.number("near_m", engagement.near_m, 0.3F, 8.0F, "the zone begins so far before the sensor, along the floor");
  v.number("far_m", engagement.far_m, 0.5F, 10.0F, "and ends so far");
  v.number("half_width_m", engagement.half_width_m, 0.2F, 10.0F, "to either side");
  v.number("place_radius_m", engagement.place_radius_m, 0.3F, 10.0F,
           "whoever steers and moves farther from where she stood still has left");
  v.angle("facing_deg", engagement.facing_rad, 40.0F, 90.0F,
          "whose shoulders look as narrow as if turned farther cannot take over");
  v.seconds("lost_timeout_s", engagement.lost_timeout, 0.0F, 60.0F,
            "a user who has left or is out of sight for longer has to stand still again");

  NavigationOptions& navigation = c.tracker.navigation;
  v.section("navigation", "What the two motions do. Forward and to the left are positive.");
  v.choice("profile", c.profile, kProfileNames,
           "the default pair: standing (lean_bust, bend_knees) or "
           "seated (rotate_shoulders, bend_bust)");
  v.choice("turn", navigation.pair.turn, kMotionNames, "the motion that turns the view");
  v.choice("walk", navigation.pair.walk, kMotionNames, "the motion that walks");
  v.flag("allow_correlated", navigation.allow_correlated, "allow pairs that move together on most bodies");
  v.number("max_walk_m_s", navigation.actuator.max_walk_m_s, 0.0F, 100.0F, "speed at full motion");
  v.angle("max_turn_deg_s", navigation.actuator.max_turn_rad_s, 0.0F, 720.0F, "turn rate at full motion");
  v.number("walk_acceleration_m_s2", navigation.actuator.walk_acceleration_m_s2, 0.01F, 1000.0F,
           "how fast walking speeds up; stopping is not limited");
  v.angle("turn_acceleration_deg_s2", navigation.actuator.turn_acceleration_rad_s2, 1.0F, 7200.0F,
          "how fast turning speeds up; stopping is not limited");

  v.section("adaptation", "Motion ranges that follow the person who steers; they are reset with her.");
  AdaptationOptions& adaptation = navigation.adaptation;
  v.flag("enabled", adaptation.enabled, "whether they do");
  v.number("least", adaptation.least, 0.3F, 1.0F, "of the configured range, at least");
  v.number("most", adaptation.most, 1.0F, 3.0F, "of the configured range, at most");
  v.number("carrying", adaptation.carrying, 0.3F, 1.0F, "and of that while something is carried before the body");

  v.section("filter", "One-Euro filter on the angles: calm at rest, quick in motion.");
  OneEuroOptions& filter = navigation.motions.filter;
  v.number("min_cutoff_hz", filter.min_cutoff_hz, 0.05F, 30.0F, "lower is calmer and later");
  v.number("speed_coefficient", filter.speed_coefficient, 0.0F, 100.0F, "higher follows fast motion more closely");
  v.number("derivative_cutoff_hz", filter.derivative_cutoff_hz, 0.05F, 30.0F, "smooths the speed itself");
  v.number("min_confidence", navigation.motions.min_confidence, 0.0F, 1.0F, "below it a motion is held");
  v.seconds("hold_time_s", navigation.motions.hold_time, 0.0F, 5.0F, "for so long; then it counts as zero");

  for (std::size_t m = 0; m < kMotionCount; ++m) {
    v.section("motions." + std::string(kMotionNames[m]), "");
    v.angle("range_deg", navigation.motions.range_rad[m], 1.0F, 120.0F, "the angle that counts as 1");
    v.number("gain", navigation.motions.gain[m], 0.1F, 10.0F,
             "shown angles times this, up to half of the default range; depends on the model");
    v.number("far_gain", navigation.motions.far_gain[m], 0.1F, 10.0F, "and times this beyond");
    v.number("read_as_hips", navigation.motions.read_as_hips[m], -1.0F, 1.0F,
             "so much of it rotate_hips is read too large by; depends on the model");
    v.number("alpha", navigation.transfer[m].alpha, 0.0F, 0.9F, "dead zone, share of the range; noise may widen it");
    v.number("beta", navigation.transfer[m].beta, 0.2F, 5.0F, "slope; above 1 the motion starts gently");
  }
}

}  // namespace armature
