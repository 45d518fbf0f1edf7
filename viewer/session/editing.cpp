#include "viewer/session/editing.h"

#include <algorithm>

#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/editing/region_edits.h>
#include <armature/sdk/expansion/patch_map.h>

#include "viewer/session/model.h"

namespace armature::viewer {
namespace {

constexpr sdk::Colour kPaint = {24, 84, 214};
/// Over what is sharpened, of the bounding box's diagonal.
constexpr double kSharpenedLength = 0.01;

using Described = sdk::Expected<std::shared_ptr<const sdk::Descriptor>>;

Described shared(sdk::Expected<std::unique_ptr<sdk::Descriptor>> made) {
  if (!made) return tl::unexpected(made.error());
  return std::shared_ptr<const sdk::Descriptor>(std::move(*made));
}

template <auto signature>
Described spectral(const sdk::Surface& surface, const sdk::Task& task) {
  const sdk::Laplacian laplacian = sdk::laplacian(surface.mesh, surface.adjacency);
  const auto spectrum = sdk::spectrum(surface.mesh, laplacian, {}, task);
  if (!spectrum) return tl::unexpected(spectrum.error());
  if (spectrum->converged < static_cast<std::size_t>(spectrum->values.size()))
    return sdk::fail("the Laplacian's eigenfunctions did not converge; compare by gls");
  return shared(signature(*spectrum, laplacian));
}

sdk::Expected<sdk::Mesh> by_vertices(const sdk::Surface& surface, const Edit& edit, const EditPlaces& places,
                                     const sdk::Task& task) {
  if (places.similarity.empty()) return sdk::fail("click a spot first: what is like it is edited");
  std::vector<double> weights = sdk::edit_weights(places.similarity, places.transfer);
  const double length = edit.amount * surface.diagonal;
  switch (edit.op) {
    case EditOp::Displace: return sdk::displaced(surface.mesh, weights, length);
    case EditOp::Smooth:
      return sdk::smoothed(surface.mesh, sdk::laplacian(surface.mesh, surface.adjacency), weights, length, task);
    case EditOp::Sharpen:
      return sdk::sharpened(surface.mesh, sdk::laplacian(surface.mesh, surface.adjacency), weights,
                            kSharpenedLength * surface.diagonal, edit.amount, task);
    case EditOp::Paint:
      for (double& weight : weights) weight *= std::clamp(edit.amount, 0.0, 1.0);
      return sdk::painted(surface.mesh, weights, kPaint);
    case EditOp::Pull:
    case EditOp::Copy:
    case EditOp::Alike: break;
  }
  return sdk::fail("this is done to regions: select one, find what is like it, and edit these");
}

sdk::Expected<sdk::Mesh> by_regions(const sdk::Surface& surface, const Edit& edit, const EditPlaces& places,
                                    const sdk::Task& task) {
  if (places.reference.empty()) return sdk::fail("select a region first: by click, cut, brush or lasso");
  const bool alone = places.matches.empty();
  const double length = edit.amount * surface.diagonal;
  const auto everywhere = [&](const sdk::RegionEdit& done) {
    return sdk::transported(surface, places.reference, places.matches, done, {}, task);
  };
  switch (edit.op) {
    case EditOp::Displace: return everywhere(sdk::DisplaceEdit{length});
    case EditOp::Smooth: return everywhere(sdk::SmoothEdit{length});
    case EditOp::Paint: return everywhere(sdk::PaintEdit{kPaint, std::clamp(edit.amount, 0.0, 1.0)});
    case EditOp::Pull: {
      const auto ball = sdk::patch_ball(surface, places.reference);
      if (!ball) return tl::unexpected(ball.error());
      const Eigen::Vector3d& normal = surface.vertex_normals[ball->centre.index()];
      return everywhere(sdk::HandleEdit{surface.mesh.position(ball->centre), length * normal});
    }
    case EditOp::Copy:
      if (alone) return sdk::fail("find regions like the selected one first; they take its shape");
      return everywhere(sdk::CopyEdit{});
    case EditOp::Alike:
      if (alone) return sdk::fail("find regions like the selected one first; they become more alike");
      return sdk::made_alike(surface, places.reference, places.matches, edit.amount, {}, task);
    case EditOp::Sharpen: break;
  }
  return sdk::fail("this is done to vertices by their similarity: click a spot, then edit what is like it");
}

}  // namespace

Described describe(const MeshShape& shape, Likeness by, double radius, const sdk::Task& task) {
  const sdk::Surface& surface = shape.surface;
  switch (by) {
    case Likeness::Hks: return spectral<sdk::heat_kernel_signature>(surface, task);
    case Likeness::Wks: return spectral<sdk::wave_kernel_signature>(surface, task);
    case Likeness::Psc: {
      const auto contexts = sdk::PatchContexts::build(surface, radius, task);
      if (!contexts) return tl::unexpected(contexts.error());
      return shared(sdk::patch_shape_context(surface, *contexts, task));
    }
    case Likeness::Gls: break;
  }
  const auto fits = sdk::GrowingLeastSquares::build(sdk::point_set_of(shape.mesh), {}, task);
  if (!fits) return tl::unexpected(fits.error());
  return shared(sdk::gls_descriptor(*fits, sdk::GlsAggregation::Mean, task));
}

sdk::Expected<std::vector<float>> similarity_to(const sdk::Descriptor& descriptor,
                                                std::span<const sdk::VertexId> vertices, const sdk::Task& task) {
  const auto unlike = sdk::dissimilarities(descriptor, vertices, task);
  if (!unlike) return tl::unexpected(unlike.error());
  return sdk::similarity_map(*unlike);
}

std::vector<sdk::VertexId> vertices_of(const sdk::Mesh& mesh, std::span<const sdk::FaceId> faces) {
  std::vector<sdk::VertexId> vertices;
  for (const sdk::FaceId face : faces)
    for (const sdk::VertexId vertex : mesh.triangle(face)) vertices.push_back(vertex);
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

sdk::Expected<sdk::Mesh> edited(const MeshShape& shape, const Edit& edit, const EditPlaces& places,
                                const sdk::Task& task) {
  return edit.regions ? by_regions(shape.surface, edit, places, task) : by_vertices(shape.surface, edit, places, task);
}

}  // namespace armature::viewer
