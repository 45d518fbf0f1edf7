// How far a match reaches: by a support vector machine, as in section 5.4.3 of the thesis, beside our nearest point.
//
// usage: libsvm_extent [SEEDS]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <vector>

#include <Eigen/Dense>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/mesh/measures.h>
#include <libsvm/svm.h>

#include "tools/elapsed.h"
#include "tools/evaluation/planted.h"

namespace sdk = armature::sdk;
namespace tools = armature::tools;
using Eigen::Vector3d;

namespace {

constexpr std::size_t kMostSamples = 2000;
constexpr double kWidth = 10;  // of the kernel, in medians of the distance to the nearest sample

/// A place in the reference's frame: distance and direction around the mean normal, and height.
struct Features {
  sdk::PatchBall ball;
  Vector3d centre;
  Eigen::Matrix3d frame;

  [[nodiscard]] Vector3d of(const Vector3d& point) const {
    const Vector3d x = frame.transpose() * (point - centre) / ball.radius;
    const double aside = x.head<2>().norm();
    const double stretch = aside > 0 ? x.norm() / aside : 0;
    return {x.x() * stretch, x.y() * stretch, x.z()};
  }
};

/// A machine that says whether a place belongs to the patch.
class Machine {
 public:
  Machine(std::vector<Vector3d> places, const std::vector<bool>& inside) : places_(std::move(places)) {
    std::vector<double> nearest;
    for (std::size_t i = 0; i < places_.size(); i += 1 + places_.size() / 200) {
      double least = 1e300;
      for (std::size_t j = 0; j < places_.size(); ++j)
        if (j != i) least = std::min(least, (places_[i] - places_[j]).norm());
      nearest.push_back(least);
    }
    std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2), nearest.end());
    const double sigma = kWidth * nearest[nearest.size() / 2];
    for (std::size_t i = 0; i < places_.size(); ++i) {
      nodes_.push_back(node(places_[i]));
      labels_.push_back(inside[i] ? 1 : -1);
    }
    for (auto& one : nodes_) rows_.push_back(one.data());
    problem_ = {static_cast<int>(rows_.size()), labels_.data(), rows_.data()};
    svm_parameter parameter{};
    parameter.svm_type = C_SVC;
    parameter.kernel_type = RBF;
    parameter.gamma = 1 / (2 * sigma * sigma);
    parameter.C = 10;
    parameter.eps = 1e-3;
    parameter.cache_size = 100;
    parameter.shrinking = 1;
    svm_set_print_string_function([](const char*) {});
    model_ = svm_train(&problem_, &parameter);
  }
  ~Machine() { svm_free_and_destroy_model(&model_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  [[nodiscard]] bool holds(const Vector3d& place) const { return svm_predict(model_, node(place).data()) > 0; }

 private:
  static std::vector<svm_node> node(const Vector3d& place) {
    return {{1, place.x()}, {2, place.y()}, {3, place.z()}, {-1, 0}};
  }
  std::vector<Vector3d> places_;
  std::vector<std::vector<svm_node>> nodes_;
  std::vector<svm_node*> rows_;
  std::vector<double> labels_;
  svm_problem problem_{};
  svm_model* model_ = nullptr;
};

double overlap(const std::vector<double>& areas, const std::vector<sdk::FaceId>& a, const std::vector<sdk::FaceId>& b) {
  const auto area = [&](const std::vector<sdk::FaceId>& faces) {
    double sum = 0;
    for (const sdk::FaceId face : faces) sum += areas[face.index()];
    return sum;
  };
  std::vector<sdk::FaceId> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return area(both) / (area(a) + area(b) - area(both));
}

Vector3d middle(const sdk::Mesh& mesh, sdk::FaceId face) {
  return (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
}

Vector3d apply(const Eigen::Matrix4d& T, const Vector3d& point) {
  return (T * point.homogeneous()).head<3>();
}

struct Sums {
  double overlap = 0, learn_ms = 0, match_ms = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  for (const double noise : {0.0, 0.2}) {
    Sums ours, svm;
    int matches = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto scene = tools::planted_reliefs({.noise_percent = noise, .seed = static_cast<std::uint32_t>(seed)}, 6);
      const sdk::Surface surface(scene.mesh);
      const sdk::Mesh& mesh = scene.mesh;
      const std::vector<double> areas = sdk::face_areas(mesh);
      sdk::PatchExpansionTimes times;
      const auto expansion = sdk::expand_patch(surface, scene.reference, {}, {}, &times);
      const auto ball = sdk::patch_ball(surface, scene.reference);
      if (!expansion || !ball) return 1;
      ours.learn_ms += times.learn_ms / seeds;
      const double registered_ms = times.matches_ms / static_cast<double>(times.candidates);

      auto start = std::chrono::steady_clock::now();
      Vector3d normal = Vector3d::Zero();
      for (const sdk::FaceId face : scene.reference) normal += sdk::area_vector(mesh, face);
      const Vector3d n = normal.normalized();
      const Vector3d u = n.unitOrthogonal();
      Features features{*ball, mesh.position(ball->centre), {}};
      features.frame << u, n.cross(u), n;
      const double reach = 1.2 * ball->radius;
      const auto about = [&](const Eigen::Matrix4d& T) {
        std::vector<sdk::FaceId> faces;
        for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
          if ((apply(T, middle(mesh, sdk::FaceId(f))) - features.centre).norm() < reach) faces.emplace_back(f);
        return faces;
      };
      const auto around = about(Eigen::Matrix4d::Identity());
      std::vector<Vector3d> places;
      std::vector<bool> inside;
      for (std::size_t i = 0; i < around.size(); i += 1 + around.size() / kMostSamples) {
        places.push_back(features.of(middle(mesh, around[i])));
        inside.push_back(std::ranges::binary_search(scene.reference, around[i]));
      }
      const Machine machine(std::move(places), inside);
      svm.learn_ms += tools::milliseconds_since(start) / seeds;

      for (const sdk::Match& match : expansion->first(scene.copies.size()))
        for (const tools::PlantedCopy& copy : scene.copies) {
          if (overlap(areas, match.faces, copy.faces) < 0.5) continue;
          ++matches;
          ours.match_ms += registered_ms;
          ours.overlap += overlap(areas, match.faces, copy.faces);
          const auto near = about(match.reference_from_match);
          start = std::chrono::steady_clock::now();
          std::vector<sdk::FaceId> learned;
          for (const sdk::FaceId face : near)
            if (machine.holds(features.of(apply(match.reference_from_match, middle(mesh, face)))))
              learned.push_back(face);
          svm.match_ms += tools::milliseconds_since(start);
          svm.overlap += overlap(areas, learned, copy.faces);
        }
    }
    const auto say = [&](const char* name, const Sums& sums, const char* note) {
      std::printf("noise %.1f %%  %-14s overlap %.4f  learn %.2f ms  a match %.3f ms%s (%d matches)\n", noise, name,
                  sums.overlap / matches, sums.learn_ms, sums.match_ms / matches, note, matches);
    };
    say("nearest point", ours, ", registered, too");
    say("libsvm", svm, "");
  }
  return 0;
}
