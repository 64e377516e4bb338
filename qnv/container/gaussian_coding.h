#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Properties of a stream of Gaussians. FORMAT.md, "Gaussians payload".
struct GaussianCoding {
  /// Importance of the Gaussians with the finest steps, and scale below which details count as points, at most
  /// kMostScale. Both are logarithms to the base 2, in eighths.
  int important = 0, finest = 0;
  int steps = 0;             // log2 of a factor of all steps, in eighths; at most kMostSteps in magnitude
  int degree = 0;            // of the spherical harmonics, 0 to 3
  bool antialiased = false;  // as Gaussians::antialiased

  /// Version of the coding. Encoders write the last one.
  enum class Version : std::uint8_t {
    plain,
    trained,  // models start with a table
    tuned,    // as trained; each property of a leaf has its own steps, which depend more on the importance
  };
  Version version = Version::plain;

  // Bits that refine the scales and opacities of leaves; at most kMostFine, and 0 unless `version` is `trained`.
  std::uint8_t fine = 0;

  static constexpr int kMostSteps = 32, kMostScale = 639, kMostFine = 4;
  friend bool operator==(const GaussianCoding&, const GaussianCoding&) = default;
};

/// Encodes the header section.
[[nodiscard]] std::vector<std::byte> encode_gaussian_coding(const GaussianCoding& coding);
/// Decodes the header section. Returns nullopt if it is truncated or contains invalid numbers. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<GaussianCoding> decode_gaussian_coding(std::span<const std::byte> section);

}  // namespace gs::qnv
