#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <armature/sdk/descriptors/descriptor.h>
#include <armature/sdk/descriptors/gls.h>
#include <armature/sdk/descriptors/spectrum.h>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// The heat kernel signature at 16 times evenly spread by their logarithm between 4 ln 10 / lambda_max and 4 ln 10 /
/// lambda_1 (Sun, Ovsjanikov, Guibas 2009), each over the heat trace. Unlike by the mean of |a - b| / (a + b).
/// Aggregates by mean over area, as all of spectra do. A spectrum begins with a constant for each component: where it
/// holds nothing else, all of these tell no more than how large components are.
[[nodiscard]] std::unique_ptr<Descriptor> heat_kernel_signature(const Spectrum& spectrum, const Laplacian& laplacian);
/// The same for shapes of any size: the lowest frequencies of how the logarithm of the heat kernel changes with that of
/// time (Bronstein and Kokkinos 2010). Unlike by the distance over the sum of lengths.
[[nodiscard]] std::unique_ptr<Descriptor> scale_invariant_heat_kernel_signature(const Spectrum& spectrum,
                                                                                const Laplacian& laplacian);
/// The wave kernel signature at 32 energies, with a variance of 7 steps (Aubry, Schlickewei, Cremers 2011). Unlike by
/// the mean of |a - b| / (a + b).
[[nodiscard]] std::unique_ptr<Descriptor> wave_kernel_signature(const Spectrum& spectrum, const Laplacian& laplacian);

/// How GLS of regions are aggregated and compared.
enum class GlsAggregation : std::uint8_t {
  Mean,              ///< mean over area at each scale (section 6.3.3); unlike by equation 6.2
  Histograms,        ///< how area spreads over bins at each scale (section 6.3.4); unlike by the mean chi-square
  ScaledHistograms,  ///< the same, a scale counting less the smaller it is than the region (section 6.3.3, proposal)
  Merged,            ///< a fit to the union of all neighbourhoods (section 6.3.3, proposal); unlike by equation 6.2
};

/// Histograms have so many bins for each of three parameters at each scale (section 6.4).
inline constexpr std::size_t kGlsBins = 10;

/// GLS at the scales of the fit, of points or vertices. `gls` may go afterwards.
[[nodiscard]] Expected<std::unique_ptr<Descriptor>> gls_descriptor(const GrowingLeastSquares& gls,
                                                                   GlsAggregation aggregation, const Task& task = {});
/// The two smallest eigenvalues of the quadric of a region over their sum (section 6.3.2); unlike by twice their
/// distance.
[[nodiscard]] std::unique_ptr<Descriptor> quadric_descriptor(const Mesh& mesh);
/// The same of points, each with one plane; without areas they count alike.
[[nodiscard]] std::unique_ptr<Descriptor> quadric_descriptor(const PointSet& points);
/// Patch shape contexts (section 5.4.3); unlike by chi-square. `contexts` may go.
[[nodiscard]] Expected<std::unique_ptr<Descriptor>> patch_shape_context(const Surface& surface,
                                                                        const PatchContexts& contexts,
                                                                        const Task& task = {});
/// Every vertex's component's approximate shape context (section 5.4.1); unlike by chi-square. `index` may go.
[[nodiscard]] std::unique_ptr<Descriptor> approximate_shape_context(const Mesh& mesh, const ComponentIndex& index);

}  // namespace armature::sdk
