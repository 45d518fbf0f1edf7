#include "tracker/body/body_surface.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <Eigen/Geometry>

namespace armature {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using sdk::SphereEdge;

constexpr std::uint8_t label(PartLabel part) {
  return static_cast<std::uint8_t>(part);
}

/// A slice through the torso: a capsule from left to right. `height` as a share of the way from hip to shoulder line;
/// half length, radius and how far its centre lies before the spine in metres at a stature of 1.75 m.
struct TorsoSlice {
  double height;
  double half_length;
  double radius;
  double forward;
};
constexpr std::array<TorsoSlice, 6> kTorso = {{
    {-0.10, 0.080, 0.090, 0.000},
    {0.06, 0.080, 0.110, -0.005},
    {0.35, 0.065, 0.105, 0.005},
    {0.68, 0.072, 0.110, 0.005},
    {0.90, 0.105, 0.076, -0.005},
    {1.00, 0.098, 0.062, -0.010},
}};
constexpr double kSliceDistance = 0.028;
/// Below the first share a slice is hip, below the second waist, above clavicle.
constexpr double kHipUntil = 0.14;
constexpr double kWaistUntil = 0.60;

class SurfaceBuilder {
 public:
  SurfaceBuilder(const BodyShape& shape, const PosedBody& body, const Outfit& outfit, std::vector<SurfaceEdge>& out)
      : shape_(shape), body_(body), outfit_(outfit), out_(out) {}

  void build() {
    torso();
    head();
    for (const Side side : {Side::Left, Side::Right}) {
      arm(side);
      leg(side);
    }
    if (outfit_.skirt > 0) skirt();
    if (outfit_.bag != Outfit::Bag::None) bag();
  }

 private:
  [[nodiscard]] double thick(double radius) const { return radius * shape_.bulk + outfit_.cloth; }

  void add(const Vector3d& a, double ra, const Vector3d& b, double rb, const PartCut& cut,
           Material material = Material::Body) {
    out_.push_back({SphereEdge{{a, ra}, {b, rb}}, cut, material});
  }

  /// All of one part; `right` where left and right of the midline differ.
  static PartCut whole(PartLabel part) {
    PartCut cut;
    cut.bands[0] = {1e9, label(part), label(part)};
    return cut;
  }
  static PartCut halves(PartLabel left, const Vector3d& origin, const Vector3d& to_left) {
    PartCut cut;
    cut.origin = origin;
    cut.left = to_left;
    cut.bands[0] = {1e9, label(left), label(mirrored(left))};
    return cut;
  }
  static PartCut nothing() { return {}; }

  struct Span {
    double until;
    PartLabel part;
  };
  static PartCut bands(const Vector3d& from, const Vector3d& to, std::initializer_list<Span> spans) {
    PartCut cut;
    cut.origin = from;
    cut.along = (to - from).normalized();
    cut.band_count = 0;
    for (const Span& span : spans) {
      cut.bands[static_cast<std::size_t>(cut.band_count++)] = {span.until, label(span.part), label(span.part)};
    }
    return cut;
  }

  /// A point of the spine and its axes at a share of the way from hip to shoulder line.
  void spine_at(double height, Vector3d& point, Matrix3d& axes) const {
    const Vector3d hips = body_.pelvis_centre;
    const Vector3d &waist = body_[JointId::Waist], &mid = body_[JointId::Torso], &neck = body_[JointId::Neck];
    constexpr double kLumbar = 0.20, kThoracic = 0.55;
    // A quadratic B-spline over the four points rounds the bends; outside it the end parts go on straight.
    if (height <= 0.1) {
      point = hips + height * shape_.torso * body_.pelvis.col(1);
      axes = body_.pelvis;
      return;
    }
    const Vector3d p0 = 0.5 * (hips + waist), p1 = waist, p2 = 0.5 * (waist + mid), p3 = mid;
    const Vector3d p4 = mid + 0.4 * (neck - mid);
    constexpr double h0 = 0.5 * kLumbar, h2 = 0.5 * (kLumbar + kThoracic), h4 = kThoracic + 0.4 * (1 - kThoracic);
    const auto bezier = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, double t) -> Vector3d {
      return (1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c;
    };
    const auto blended = [](const Matrix3d& a, const Matrix3d& b, double t) -> Matrix3d {
      Matrix3d m = (1 - t) * a + t * b;
      m.col(0).normalize();
      m.col(1) = (m.col(1) - m.col(1).dot(m.col(0)) * m.col(0)).normalized();
      m.col(2) = m.col(0).cross(m.col(1));
      return m;
    };
    if (height < h2) {
      const double t = (height - h0) / (h2 - h0);
      point = bezier(p0, p1, p2, t);
      axes = blended(body_.pelvis, body_.belly, t);
    } else if (height < h4) {
      const double t = (height - h2) / (h4 - h2);
      point = bezier(p2, p3, p4, t);
      axes = blended(body_.belly, body_.chest, t);
    } else {
      point = neck + (height - 1) * shape_.torso * body_.chest.col(1);
      axes = body_.chest;
    }
  }

  void torso() {
    const int count = std::max(8, static_cast<int>(std::lround((kTorso.back().height - kTorso.front().height) *
                                                               shape_.torso / (kSliceDistance * shape_.bulk))));
    const double widen = shape_.shoulder_half_width / (0.17 * shape_.bulk);  // slim shoulders on a large girth
    for (int i = 0; i <= count; ++i) {
      const double height = kTorso.front().height + i * (kTorso.back().height - kTorso.front().height) / count;
      std::size_t k = 0;
      while (k + 2 < kTorso.size() && kTorso[k + 1].height < height) ++k;
      const TorsoSlice &low = kTorso[k], &high = kTorso[k + 1];
      double t = (height - low.height) / (high.height - low.height);
      t = t * t * (3 - 2 * t);
      const auto mix = [&](double a, double b) { return (a + t * (b - a)) * shape_.bulk; };
      Vector3d centre;
      Matrix3d axes;
      spine_at(height, centre, axes);
      centre += mix(low.forward, high.forward) * axes.col(2);
      const double narrow = height > 0.8 ? std::clamp(widen, 0.75, 1.1) : 1.0;
      const Vector3d half = narrow * mix(low.half_length, high.half_length) * axes.col(0);
      const double radius = mix(low.radius, high.radius) + outfit_.cloth;
      const PartLabel part = height < kHipUntil     ? PartLabel::LeftHip
                             : height < kWaistUntil ? PartLabel::LeftWaist
                                                    : PartLabel::LeftClavicle;
      add(centre + half, radius, centre - half, radius, halves(part, centre, axes.col(0)));
    }
  }

  void head() {
    const double k = shape_.head_scale;
    const Vector3d& neck = body_[JointId::Neck];
    const Vector3d& centre = body_[JointId::Head];
    const Vector3d left = body_.head.col(0), up = body_.head.col(1), forward = body_.head.col(2);
    const Vector3d throat = neck + 0.02 * k * body_.chest.col(1) - 0.005 * k * body_.chest.col(2);
    const Vector3d chin = centre - 0.075 * k * up + 0.030 * k * forward;
    const Vector3d jaw = centre - 0.035 * k * up + 0.015 * k * forward;

    PartCut cut;
    cut.origin = centre;
    cut.along = up;
    cut.left = left;
    cut.band_count = 2;
    cut.bands[0] = {0.005 * k, label(PartLabel::HeadLeft), label(PartLabel::HeadRight)};
    cut.bands[1] = {1e9, label(PartLabel::HeadTopLeft), label(PartLabel::HeadTopRight)};
    add(centre + 0.012 * k * forward, 0.078 * k, centre - 0.020 * k * forward + 0.004 * k * up, 0.079 * k, cut);
    add(jaw, 0.074 * k, chin, 0.050 * k, cut);
    add(centre - 0.025 * k * up + 0.070 * k * forward, 0.022 * k, centre - 0.04 * k * up + 0.075 * k * forward,
        0.018 * k, cut);  // nose
    const double bulk = 0.5 * (shape_.bulk + k);
    add(throat, 0.076 * bulk + 0.5 * outfit_.cloth, centre - 0.06 * k * up - 0.010 * k * forward, 0.068 * bulk,
        whole(PartLabel::Neck));
    for (const Side side : {Side::Left, Side::Right}) {  // the slope from neck to shoulder
      const Vector3d shoulder = body_[on_side(JointId::LeftShoulder, side)];
      add(throat + 0.02 * k * up, 0.048 * bulk + outfit_.cloth, 0.2 * throat + 0.8 * shoulder, thick(0.058),
          whole(on_side(PartLabel::LeftClavicle, side)));
    }
    if (outfit_.hair > 0) {
      const Vector3d back = centre - 0.022 * k * forward + 0.008 * k * up;
      add(back, 0.080 * k + outfit_.hair, centre + 0.025 * k * up, 0.075 * k + outfit_.hair, cut, Material::Hair);
      if (outfit_.hair_length > 0) {
        const double radius = 0.055 * k + outfit_.hair;
        const Vector3d fall = -outfit_.hair_length * (0.6 * up + 0.4 * body_.chest.col(1));
        for (const double sideways : {-0.035, 0.035}) {
          const Vector3d top = back + sideways * k * left;
          add(top, radius, top + fall - 0.02 * k * forward, 0.8 * radius, cut, Material::Hair);
        }
      }
    }
  }

  void arm(Side side) {
    const auto at = [&](JointId left) -> const Vector3d& { return body_[on_side(left, side)]; };
    const auto part = [&](PartLabel left) { return on_side(left, side); };
    const Vector3d &shoulder = at(JointId::LeftShoulder), &elbow = at(JointId::LeftElbow);
    const Vector3d& wrist = at(JointId::LeftWrist);
    const double b = shape_.bulk;
    add(shoulder, thick(0.056), shoulder + 0.25 * (elbow - shoulder), thick(0.053),
        whole(part(PartLabel::LeftShoulder)));
    add(shoulder, thick(0.052), elbow, thick(0.043),
        bands(shoulder, elbow,
              {{0.22 * shape_.upper_arm, part(PartLabel::LeftShoulder)},
               {shape_.upper_arm - 0.055 * b, part(PartLabel::LeftUpperArm)},
               {1e9, part(PartLabel::LeftElbow)}}));
    const double sleeve = outfit_.sleeves;
    const Vector3d belly_of_forearm = elbow + 0.25 * (wrist - elbow);
    const PartCut cut = bands(elbow, wrist,
                              {{0.055 * b, part(PartLabel::LeftElbow)},
                               {shape_.forearm - 0.045 * b, part(PartLabel::LeftForearm)},
                               {1e9, part(PartLabel::LeftWrist)}});
    add(elbow, 0.042 * b + sleeve, belly_of_forearm, 0.043 * b + sleeve, cut);
    add(belly_of_forearm, 0.043 * b + sleeve, wrist, 0.029 * b + sleeve, cut);

    const double h = shape_.hand / 0.0875;  // of an adult's hand
    const Vector3d direction = body_.hand_directions[static_cast<std::size_t>(side)];
    const Vector3d knuckles = wrist + shape_.hand * direction;
    const PartCut hand =
        bands(wrist, knuckles, {{0.02 * h, part(PartLabel::LeftWrist)}, {1e9, part(PartLabel::LeftHand)}});
    Vector3d broad = direction.cross(at(JointId::LeftElbow) - shoulder);
    broad = broad.squaredNorm() > 1e-6 ? Vector3d(broad.normalized()) : Vector3d(direction.unitOrthogonal());
    const Vector3d across = 0.018 * h * broad.cross(direction);
    add(wrist + 0.5 * across, 0.024 * h, knuckles + across, 0.024 * h, hand);
    add(wrist - 0.5 * across, 0.024 * h, knuckles - across, 0.024 * h, hand);
    add(knuckles, 0.026 * h, knuckles + 0.045 * h * direction, 0.014 * h, hand);
  }

  void leg(Side side) {
    const auto at = [&](JointId left) -> const Vector3d& { return body_[on_side(left, side)]; };
    const auto part = [&](PartLabel left) { return on_side(left, side); };
    const Vector3d &hip = at(JointId::LeftHip), &knee = at(JointId::LeftKnee), &ankle = at(JointId::LeftAnkle);
    const double b = shape_.bulk;
    const Vector3d down = (knee - hip) / shape_.thigh;
    // Seen from outside the thigh begins beside the joint.
    const Vector3d seat = hip + 0.01 * b * outward(side) * body_.pelvis.col(0);
    const PartCut thigh = bands(hip, knee,
                                {{0.20 * shape_.thigh, part(PartLabel::LeftHip)},
                                 {shape_.thigh - 0.075 * b, part(PartLabel::LeftThigh)},
                                 {1e9, part(PartLabel::LeftKnee)}});
    const double slack = 0.5 * outfit_.trousers;
    add(seat, thick(0.095), hip + 0.35 * shape_.thigh * down, thick(0.084), thigh);
    add(hip + 0.35 * shape_.thigh * down, thick(0.084), knee, thick(0.060) + slack, thigh);

    const PartCut shin = bands(knee, ankle,
                               {{0.075 * b, part(PartLabel::LeftKnee)},
                                {shape_.shin - 0.03 * b, part(PartLabel::LeftShin)},
                                {1e9, part(PartLabel::LeftFoot)}});
    const double cloth = outfit_.trousers;
    const Vector3d back = body_.knee_directions[static_cast<std::size_t>(side)];
    const Vector3d calf = knee + 0.33 * (ankle - knee) - 0.012 * b * back;
    add(knee, 0.057 * b + cloth, calf, 0.059 * b + cloth, shin);
    add(calf, 0.059 * b + cloth, ankle, 0.041 * b + cloth, shin);

    const Matrix3d& axes = body_.feet[static_cast<std::size_t>(side)];
    const double f = shape_.foot / 0.149;
    const double radius = 0.034 * f + outfit_.shoe;
    const PartCut foot = whole(part(PartLabel::LeftFoot));
    const Vector3d sole = at(JointId::LeftFoot) - 0.4 * shape_.ankle_height * axes.col(1);
    const Vector3d ball = sole + radius * axes.col(1);
    const Vector3d heel = ball - 1.28 * shape_.foot * axes.col(2);
    const Vector3d toes = ball + 0.062 * f * axes.col(2);
    add(ankle, 0.041 * b + 0.5 * cloth, ball + 0.3 * (ankle - ball), radius, foot);
    add(heel, radius, ball, radius, foot);
    const Vector3d wide = 0.012 * f * axes.col(0);
    add(ball + wide, radius, toes + wide, 0.8 * radius, foot);
    add(ball - wide, radius, toes - wide, 0.75 * radius, foot);
  }

  void skirt() {
    const Vector3d left = body_.pelvis.col(0);
    const Vector3d hips = body_.pelvis_centre;
    const auto &lh = body_[JointId::LeftHip], &rh = body_[JointId::RightHip];
    const auto &lk = body_[JointId::LeftKnee], &rk = body_[JointId::RightKnee];
    const auto &la = body_[JointId::LeftAnkle], &ra = body_[JointId::RightAnkle];
    const int count = std::max(3, static_cast<int>(std::lround(outfit_.skirt * shape_.thigh / 0.04)));
    for (int i = 0; i <= count; ++i) {
      const double share = outfit_.skirt * i / count;  // over the thigh's length; beyond 1 along the shins
      const auto leg_at = [&](const Vector3d& h, const Vector3d& k, const Vector3d& a) -> Vector3d {
        return share <= 1 ? Vector3d(h + share * (k - h)) : Vector3d(k + (share - 1) * (a - k));
      };
      const Vector3d l = leg_at(lh, lk, la), r = leg_at(rh, rk, ra);
      const double flare = outfit_.skirt_flare * i / count;
      const double radius = thick(0.098 - 0.020 * std::min(1.0, share)) + 0.5 * flare;
      const Vector3d middle = 0.5 * (l + r);
      const Vector3d half = 0.5 * (l - r) + 0.5 * flare * left;
      const PartLabel part = share < 0.20   ? PartLabel::LeftHip
                             : share < 0.84 ? PartLabel::LeftThigh
                             : share < 1.16 ? PartLabel::LeftKnee
                                            : PartLabel::LeftShin;
      add(middle + half, radius, middle - half, radius, halves(part, middle, (lh - rh).normalized()));
    }
    (void)hips;
  }

  void bag() {
    const auto at = [&](JointId left) -> const Vector3d& { return body_[on_side(left, outfit_.bag_side)]; };
    const double s = outfit_.bag_size;
    const Vector3d down = -Vector3d::UnitY();
    const auto carried = [&](const Vector3d& a, double ra, const Vector3d& b, double rb) {
      add(a, ra, b, rb, nothing(), Material::Carried);
    };
    const Vector3d hand = at(JointId::LeftHand);
    const Vector3d out = outward(outfit_.bag_side) * body_.chest.col(0);
    switch (outfit_.bag) {
      case Outfit::Bag::None: break;
      case Outfit::Bag::Hand: {
        const Vector3d fore = 0.10 * s * body_.chest.col(2);
        const Vector3d top = hand + 0.16 * s * down, bottom = hand + 0.34 * s * down;
        carried(hand, 0.012, top, 0.015);
        carried(top + fore, 0.05 * s, bottom + fore, 0.075 * s);
        carried(top - fore, 0.05 * s, bottom - fore, 0.075 * s);
        carried(bottom + fore, 0.075 * s, bottom - fore, 0.075 * s);
        carried(top + fore, 0.05 * s, top - fore, 0.05 * s);
        break;
      }
      case Outfit::Bag::Shoulder: {
        const Vector3d hip = at(JointId::LeftHip) + (0.17 * shape_.bulk + 0.05 * s) * out + 0.06 * Vector3d::UnitY();
        const Vector3d fore = 0.12 * s * body_.chest.col(2);
        carried(hip + fore, 0.055 * s, hip - fore, 0.055 * s);
        carried(hip + fore + 0.16 * s * down, 0.065 * s, hip - fore + 0.16 * s * down, 0.065 * s);
        carried(at(JointId::LeftShoulder) + 0.06 * shape_.bulk * Vector3d::UnitY(), 0.015, hip, 0.02);
        break;
      }
      case Outfit::Bag::Backpack: {
        const Matrix3d& chest = body_.chest;
        const Vector3d back = body_[JointId::Chest] - (0.10 * shape_.bulk + outfit_.cloth + 0.09 * s) * chest.col(2);
        const Vector3d half = 0.10 * s * chest.col(0);
        for (const double up : {0.12, 0.0, -0.13, -0.24}) {
          const Vector3d centre = back + up * s * chest.col(1);
          carried(centre + half, 0.10 * s, centre - half, 0.10 * s);
        }
        break;
      }
      case Outfit::Bag::Mug:
        carried(hand + 0.05 * Vector3d::UnitY() + 0.04 * body_.chest.col(2), 0.04,
                hand - 0.03 * Vector3d::UnitY() + 0.04 * body_.chest.col(2), 0.038);
        break;
      case Outfit::Bag::Phone: {
        const Vector3d direction = body_.hand_directions[static_cast<std::size_t>(outfit_.bag_side)];
        carried(hand - 0.02 * direction, 0.02, hand + 0.10 * direction, 0.02);
        break;
      }
    }
  }

  const BodyShape& shape_;
  const PosedBody& body_;
  const Outfit& outfit_;
  std::vector<SurfaceEdge>& out_;
};

}  // namespace

std::uint8_t part_at(const PartCut& cut, const Vector3d& point) noexcept {
  const Vector3d from = point - cut.origin;
  int band = 0;
  if (cut.band_count > 1) {
    const double along = from.dot(cut.along);
    while (band + 1 < cut.band_count && along > cut.bands[static_cast<std::size_t>(band)].until) ++band;
  }
  const PartCut::Band& found = cut.bands[static_cast<std::size_t>(band)];
  return from.dot(cut.left) >= 0 ? found.left : found.right;
}

void body_surface(const BodyShape& shape, const PosedBody& body, const Outfit& outfit, std::vector<SurfaceEdge>& out) {
  out.clear();
  SurfaceBuilder(shape, body, outfit, out).build();
}

SurfaceEdge moved(const SurfaceEdge& edge, const Matrix3d& rotation, const Vector3d& translation) noexcept {
  SurfaceEdge out = edge;
  for (sdk::Sphere* sphere : {&out.edge.a, &out.edge.b}) sphere->centre = rotation * sphere->centre + translation;
  out.cut.origin = rotation * edge.cut.origin + translation;
  out.cut.along = rotation * edge.cut.along;
  out.cut.left = rotation * edge.cut.left;
  return out;
}

}  // namespace armature
