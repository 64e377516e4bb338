#pragma once

#include "base/budget.h"
#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// Gaussian splats of other programs as surfaces of QNV. All importers: bytes in, a cloud or a message out
/// (what is wrong, what was expected); any thread; safe for untrusted input, with memory bounded by a multiple
/// of the file (packed formats: by what really unpacks), and drawn from the budget that is given.
namespace gs::app {

/// Standard deviation of a splat's Gaussian, in radii of its disc: sigma = k * sqrt(A / pi). With k^2 = 1/2 the
/// Gaussian's integral 2 pi sigma^2 is the disc's area A, so that opacity 1 conserves area (the paper, section 4).
inline constexpr float kSigmaOfRadius = 0.70710678f;
/// The real spherical harmonic of degree 0: colour = 0.5 + kSphericalHarmonic0 * dc.
inline constexpr float kSphericalHarmonic0 = 0.28209479f;
/// Splats from this opacity on count as opaque, among them those of our exports: 0.99, in 8 bits 252 / 255.
inline constexpr float kOpaque = 0.988f;
/// Key of the metadata that say how splats are drawn, and which properties of the file are discarded.
inline constexpr char kSplatsDrawnAs[] = "splats drawn as";
/// Splats fainter than this show nowhere on an 8-bit display; they are left out.
inline constexpr float kMinOpacity = 1.0f / 255;
/// A splat is a disc while its smallest standard deviation is no larger than this part of the middle one.
inline constexpr float kMaxDiscThickness = 0.3f;
/// Memory that a splat takes on its way into a cloud.
inline constexpr std::size_t kSplatMemory = 146;

/// Factors for x, y, z that lead from a file's axes to those of VRML97 (x right, y up, z back).
inline constexpr glm::vec3 kFromRightDownForward{1, -1, -1};
inline constexpr glm::vec3 kFromRightUpBack{1, 1, 1};

/// Splats as every reader leaves them, in the file's own axes and units: one entry a splat in each array, `normals`
/// possibly empty. Values may still be broken (NaN, infinite, negative).
struct SplatModel {
  std::string format;  // as in the metadata
  glm::vec3 axes = kFromRightDownForward;
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> scales;     // standard deviations along the splat's own axes, linear
  std::vector<glm::vec4> rotations;  // quaternions x, y, z, w of any length
  std::vector<float> opacities;      // 0..1
  std::vector<glm::vec3> dc;         // colour coefficients of degree 0
  std::vector<glm::vec3> normals;    // which side is outside; zero: not known
  std::size_t announced = 0;         // splats that the file says it has
  int harmonics = 0;                 // highest degree of the file's spherical harmonics; above 0, they are discarded
  Share share;

  /// Draws memory for `count` more splats, before they are made; why there is not so much.
  [[nodiscard]] std::optional<std::string> draw(const WorldBudget& budget, std::uint64_t count);
  void resize(std::size_t count);
  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// The cloud of a model: kind surface, two-sided, with origin, box and total. Each splat becomes the disc across its
/// smallest axis, with area pi * s1 * s2 / kSigmaOfRadius^2 of the two larger standard deviations s1, s2. Left out:
/// splats fainter than kMinOpacity, and broken ones. The normal's sign: that of `normals`; else, where every
/// splat is flat across its own z axis, that axis (our exports; 2DGS); else away from the middle of the box.
/// Metadata: "source", and as counts where not 0: "splats not discs" (kept, yet thicker than kMaxDiscThickness),
/// "splats too faint", "splats broken", "splats missing" (announced, not in the file). If a splat is translucent, or
/// the file has spherical harmonics, kSplatsDrawnAs says that they are discarded.
[[nodiscard]] qnv::Splats cloud_of_splats(const SplatModel& model);

using ImportedCloud = std::variant<qnv::Splats, std::string>;

/// `cloud_of_splats`, or a message where no splat is left.
[[nodiscard]] ImportedCloud import_result(const SplatModel& model);

/// Inria's 3D Gaussian splatting PLY and 2DGS PLY (no scale_2); ascii or binary. Axes: right, down, forward.
/// A file that ends early gives the splats that are there.
[[nodiscard]] ImportedCloud import_splats_ply(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());
/// Reports whether the header of a PLY file names the properties of 3DGS or 2DGS.
[[nodiscard]] bool is_splats_ply(std::span<const std::byte> bytes);

/// antimatter15's .splat: 32 bytes a splat, no header, any prefix is a scene. Axes: right, down, forward.
[[nodiscard]] ImportedCloud import_splats_antimatter(std::span<const std::byte> bytes,
                                                     const WorldBudget& budget = own_budget());

/// PlayCanvas compressed PLY (SuperSplat): chunks of 256 splats, 16 bytes a splat. Axes: right, down, forward.
/// A file that ends early gives the splats that are there.
[[nodiscard]] ImportedCloud import_splats_compressed_ply(std::span<const std::byte> bytes,
                                                         const WorldBudget& budget = own_budget());
/// True for a PLY file with the elements and properties of the compressed form.
[[nodiscard]] bool is_splats_compressed_ply(std::span<const std::byte> bytes);

/// mkkellogg's .ksplat version 0.1, compression modes 0, 1 and 2. Axes: right, down, forward.
[[nodiscard]] ImportedCloud import_splats_ksplat(std::span<const std::byte> bytes,
                                                 const WorldBudget& budget = own_budget());

/// Niantic's SPZ versions 1 to 3 (one gzip stream) and 4 (zstd streams). Axes: right, up, back, or as the
/// coordinate system extension says.
[[nodiscard]] ImportedCloud import_splats_spz(std::span<const std::byte> bytes,
                                              const WorldBudget& budget = own_budget());
/// True for "NGSP" at the start; gzip data has to be unpacked to tell.
[[nodiscard]] bool is_splats_spz(std::span<const std::byte> bytes);

}  // namespace gs::app
