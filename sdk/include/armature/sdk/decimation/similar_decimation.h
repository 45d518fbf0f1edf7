#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/error.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/decimate_mesh.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What regions are compared by (thesis, sections 6.3.2 to 6.3.4).
enum class RegionDescriptor : std::uint8_t {
  GlsHistograms,        ///< histograms of GLS: what the thesis's results use
  GlsMean,              ///< averaged GLS
  Quadric,              ///< eigenvalues of the quadrics
  ScaledGlsHistograms,  ///< histograms, small scales counting less in large regions
  MergedGls,            ///< GLS fitted anew to the merged neighbourhoods
};

/// Which collapses are done together.
struct SimilarityOptions {
  RegionDescriptor descriptor = RegionDescriptor::GlsHistograms;  ///< what they are compared by
  /// Collapses less unlike the cheapest than this are done with it, in the descriptor's measure: from 0 to 1 for
  /// histograms. 0 does one at a time: the plain decimation, bit by bit.
  double threshold = 0.6;
  /// The threshold of each step lies instead in the first gap of the ranked dissimilarities (section 6.5): the first
  /// that is four times as wide as they lie apart before it on average, and 0.02 or more; at most 0.4.
  bool adaptive = false;
  /// What costs more than so many times the cheapest is not done with it: 1 or more.
  double cost_ratio = 1.5;
  /// Nor what covers so many times its area, or less than that part of it: 1 or more.
  double area_ratio = 2;
  std::size_t scales = 10;  ///< of GLS
  /// Components that lie on one another once they are moved, turned or mirrored, and those that do so with themselves,
  /// are simplified in step: what corresponds in them is joined together or not at all.
  bool in_step = true;
};

/// The descriptor of a mesh's vertices that `options` name.
[[nodiscard]] Expected<std::unique_ptr<Descriptor>> region_descriptor(const Mesh& mesh,
                                                                      const SimilarityOptions& options,
                                                                      const Task& task = {});

/// The same of points. Those without areas count alike.
[[nodiscard]] Expected<std::unique_ptr<Descriptor>> region_descriptor(const PointSet& points,
                                                                      const SimilarityOptions& options,
                                                                      const Task& task = {});

/// A hierarchy of fewer steps.
struct SimilarBuild {
  HierarchyBuild build;        ///< its hierarchy's steps are those of collapses done together
  double descriptor_ms = 0;    ///< what the descriptors took, which `build.statistics` leaves out
  double counterparts_ms = 0;  ///< what finding counterparts took, which it leaves out as well
};

/// Decimates a mesh as build_hierarchy() does, but like regions together (thesis, algorithm 4): each step collapses the
/// cheapest edge and those whose regions are like its own, as far as they are independent, so that the levels at the
/// ends of steps keep the likenesses of the shape and are fewer. Every level in between is there as well. Takes up to
/// three times as long, descriptors left out. Deterministic. Refused where build_hierarchy() is, and for options out of
/// range.
[[nodiscard]] Expected<SimilarBuild> build_similar_hierarchy(const Mesh& mesh, const HierarchyOptions& options = {},
                                                             const SimilarityOptions& similarity = {},
                                                             const Task& task = {});
/// The same of points with normals, as build_hierarchy() takes them.
[[nodiscard]] Expected<SimilarBuild> build_similar_hierarchy(const PointSet& points,
                                                             const HierarchyOptions& options = {},
                                                             const SimilarityOptions& similarity = {},
                                                             const Task& task = {});
/// The same with a descriptor of the mesh's vertices that is there already.
[[nodiscard]] Expected<SimilarBuild> build_similar_hierarchy(const Mesh& mesh, const Descriptor& descriptor,
                                                             const HierarchyOptions& options,
                                                             const SimilarityOptions& similarity,
                                                             const Task& task = {});

/// A coarser mesh, made in fewer steps.
struct SimilarMesh {
  DecimatedMesh decimated;     ///< as of decimate_mesh()
  std::size_t steps = 0;       ///< of collapses done together
  double descriptor_ms = 0;    ///< what the descriptors took
  double counterparts_ms = 0;  ///< what finding counterparts took
  double decimate_ms = 0;      ///< all else
};

/// The same with decimate_mesh().
[[nodiscard]] Expected<SimilarMesh> decimate_similar_mesh(const Mesh& mesh, const DecimateMeshOptions& options,
                                                          const SimilarityOptions& similarity = {},
                                                          const Task& task = {});

}  // namespace armature::sdk
