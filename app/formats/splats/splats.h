#pragma once

#include "base/budget.h"
#include "qnv/base/geometry.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// Import of Gaussian splats of other programs as QNV surfaces. Each importer takes the bytes of a file and returns
/// vectors or a message. Any thread. Safe for untrusted input. Memory is charged to `budget` and bounded by a multiple
/// of the file size; for compressed formats, by the real decompressed size.
namespace gs::app {

/// Standard deviation of a splat's Gaussian, relative to the radius of its disc: sigma = k * sqrt(A / pi). With k^2 =
/// 1/2, the integral of the Gaussian, 2 pi sigma^2, is the area A of the disc. Thus opacity 1 conserves area (section 4
/// of the paper).
inline constexpr float kSigmaOfRadius = 0.70710678f;
/// Value of the real spherical harmonic of degree 0. The colour is 0.5 + kSphericalHarmonic0 * dc.
inline constexpr float kSphericalHarmonic0 = 0.28209479f;
/// Minimum opacity that counts as opaque. Includes our exports, which have 0.99, or 252 / 255 in 8 bits.
inline constexpr float kOpaque = 0.988f;
/// Metadata key for the properties that splats lose when they become discs. Only discs can be encoded.
inline constexpr char kSplatsAsDiscs[] = "splats as discs";
/// Metadata key for the number of splats that are no discs.
inline constexpr char kThickSplats[] = "splats not discs";
/// Minimum opacity. Fainter splats are invisible on an 8-bit display and omitted.
inline constexpr float kMinOpacity = 1.0f / 255;
/// Maximum ratio of the smallest to the middle standard deviation of a splat that counts as a disc.
inline constexpr float kMaxDiscThickness = 0.3f;
/// Number of splats in a run. Importers sum areas by run, too, so that reading in ranges gives equal sums.
inline constexpr std::size_t kSplatRun = std::size_t{1} << 15;
/// Memory in bytes to convert one splat: as read, and as converted.
inline constexpr std::size_t kSplatMemory = 190;

/// Factors for x, y, z from a file with the axes right, down, forward to VRML97 (right, up, back).
inline constexpr glm::vec3 kFromRightDownForward{1, -1, -1};
inline constexpr glm::vec3 kFromRightUpBack{1, 1, 1};

/// Splats as read from a file, in its axes and units. Each array has one entry per splat; `normals` may be empty
/// instead. Values may be invalid (NaN, infinite, negative).
struct SplatModel {
  std::string format;  // name of the format, for the metadata
  glm::vec3 axes = kFromRightDownForward;
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> scales;        // linear standard deviations along the axes of the splat
  std::vector<glm::vec4> rotations;     // quaternions x, y, z, w, not normalised
  std::vector<float> opacities;         // 0 to 1
  std::vector<glm::vec3> dc;            // colour coefficients of spherical harmonics of degree 0
  std::vector<glm::vec3> normals;       // point to the outside; zero means unknown
  std::size_t announced = 0;            // number of splats that the file claims to have
  int harmonics = 0;                    // degree of the file's spherical harmonics
  int degree = 0;                       // degree of `coefficients`, at most qnv::Gaussians::kMaxDegree
  std::vector<glm::vec3> coefficients;  // of degrees 1 to `degree`: qnv::harmonic_count(degree) per splat
  bool antialiased = false;             // as qnv::Gaussians::antialiased
  Share share;

  /// Sets the degree of the file's harmonics, and of the coefficients. Call it before draw().
  void set_degree(int in_file) {
    harmonics = in_file;
    degree = in_file < qnv::Gaussians::kMaxDegree ? in_file : qnv::Gaussians::kMaxDegree;
  }
  /// Charges memory for `count` more splats. Must be called before they are stored. Returns a message if the budget is
  /// exceeded.
  [[nodiscard]] std::optional<std::string> draw(const WorldBudget& budget, std::uint64_t count);
  void resize(std::size_t count);
  /// Appends `count` splats of `part` from index `first` on, with the larger degree of both. Charges memory for them.
  /// Returns a message if the budget is exceeded.
  [[nodiscard]] std::optional<std::string> append(const SplatModel& part, std::size_t first, std::size_t count,
                                                  const WorldBudget& budget);
  /// Returns a coefficient. `number` counts from 0 (degree 1, m = -1).
  [[nodiscard]] glm::vec3& coefficient(std::size_t splat, std::size_t number) {
    return coefficients[splat * qnv::harmonic_count(degree) + number];
  }
  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// File of Gaussian splats that is read in ranges, so that it may exceed memory. The bytes of the file must outlive it.
struct SplatRows {
  std::size_t count = 0;        // number of complete splats in the file
  std::uint64_t announced = 0;  // number of splats that the file claims to have
  std::size_t start = 0;        // offset of the last table of rows in the file
  std::size_t row_bytes = 0;    // size of a row of this table
  /// Reads `count` splats from index `first` on into an empty model. Returns a message if the budget is exceeded. The
  /// range must be in the file. Any thread.
  std::function<std::optional<std::string>(std::size_t first, std::size_t count, const WorldBudget& budget,
                                           SplatModel& model)>
      read;
};
/// Opened file, or an error message.
using OpenedSplatRows = std::variant<SplatRows, std::string>;

/// Imported splats, as discs or as Gaussians, or an error message.
using ImportedVectors = std::variant<qnv::Splats, qnv::Gaussians, std::string>;

/// Converts splats to a two-sided surface with origin, box and total. Each splat becomes a disc perpendicular to its
/// smallest axis. The area of the disc is pi * s1 * s2 / kSigmaOfRadius^2. s1 and s2 are the larger standard
/// deviations. The Gaussians also keep their shapes, opacities and colours. Omits invalid splats, and splats below
/// kMinOpacity.
///
/// `normals` gives the direction of a disc's normal, if known. Otherwise, if all splats are flat across their z axis
/// (our exports, 2DGS), the normal is that axis. Otherwise it points away from the centre of the box.
///
/// Metadata has "source" and these counts unless they are 0: "splats not discs" (included, but thicker than
/// kMaxDiscThickness), "splats too faint", "splats broken", and "splats missing" (announced, but not in the file).
/// kSplatsAsDiscs names opacity and spherical harmonics, if the splats have these.
[[nodiscard]] qnv::Gaussians vectors_of_splats(const SplatModel& model);

/// Returns a surface of discs if all splats are flat and opaque and have one colour, as in our exports. Otherwise
/// returns Gaussians. Returns a message if no splat remains.
[[nodiscard]] ImportedVectors import_result(const SplatModel& model);

/// Reads all splats of an opened file, and returns their import_result().
[[nodiscard]] ImportedVectors import_rows(const OpenedSplatRows& opened, const WorldBudget& budget);

struct PlyTable;

/// Reads the rows of a 3DGS or 2DGS PLY file into an empty model. Returns a message if it has other properties, or if
/// the budget is exceeded.
[[nodiscard]] std::optional<std::string> read_splats(const PlyTable& table, SplatModel& model,
                                                     const WorldBudget& budget);

/// Imports Inria's 3D Gaussian splatting PLY, or 2DGS PLY (without scale_2), ascii or binary. The axes are right, down,
/// forward. A truncated file gives its complete splats.
[[nodiscard]] ImportedVectors import_splats_ply(std::span<const std::byte> bytes,
                                                const WorldBudget& budget = own_budget());
/// Opens a binary file for import_splats_ply() in ranges. Returns a message for ASCII.
[[nodiscard]] OpenedSplatRows open_splats_ply_rows(std::span<const std::byte> bytes, const WorldBudget& budget);
/// Returns true if the header of a PLY file has the properties of 3DGS or 2DGS.
[[nodiscard]] bool is_splats_ply(std::span<const std::byte> bytes);

/// Imports antimatter15's .splat format: 32 bytes per splat, no header. Each prefix of a file is valid. The axes are
/// right, down, forward.
[[nodiscard]] ImportedVectors import_splats_antimatter(std::span<const std::byte> bytes,
                                                       const WorldBudget& budget = own_budget());
/// Opens a file for import_splats_antimatter() in ranges.
[[nodiscard]] OpenedSplatRows open_antimatter_rows(std::span<const std::byte> bytes, const WorldBudget& budget);

/// Imports PlayCanvas compressed PLY (SuperSplat): chunks of 256 splats, 16 bytes per splat. The axes are right, down,
/// forward. A truncated file gives its complete splats.
[[nodiscard]] ImportedVectors import_splats_compressed_ply(std::span<const std::byte> bytes,
                                                           const WorldBudget& budget = own_budget());
/// Opens a file for import_splats_compressed_ply() in ranges. Charges an ASCII file to `budget` before refusing it.
[[nodiscard]] OpenedSplatRows open_compressed_ply_rows(std::span<const std::byte> bytes, const WorldBudget& budget);
/// Returns true if a PLY file has the elements and properties of PlayCanvas compressed PLY.
[[nodiscard]] bool is_splats_compressed_ply(std::span<const std::byte> bytes);

/// Imports mkkellogg's .ksplat format, version 0.1, with compression modes 0, 1 and 2. The axes are right, down,
/// forward.
[[nodiscard]] ImportedVectors import_splats_ksplat(std::span<const std::byte> bytes,
                                                   const WorldBudget& budget = own_budget());

/// Imports Niantic's SPZ: versions 1 to 3 (one gzip stream) and version 4 (zstd streams). The axes are right, up, back,
/// or those of the coordinate system extension.
[[nodiscard]] ImportedVectors import_splats_spz(std::span<const std::byte> bytes,
                                                const WorldBudget& budget = own_budget());
/// Reads SPZ into `model`. Returns a message on failure. Safe for untrusted input; memory is charged to the budget.
[[nodiscard]] std::optional<std::string> read_spz_model(std::span<const std::byte> bytes, const WorldBudget& budget,
                                                        SplatModel& model);
/// Returns true if the data begin with "NGSP". Decompresses the start of gzip data to check that.
[[nodiscard]] bool is_splats_spz(std::span<const std::byte> bytes);

}  // namespace gs::app
