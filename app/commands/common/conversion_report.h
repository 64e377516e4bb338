#pragma once

#include "app/commands/common/vectors_of.h"
#include "qnv/codecs/shared/encode_options.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Reports of `encode` and `export` in the words of users.
namespace gs::app {

/// Returns a number with its noun: "1 triangle", "4,212 triangles".
[[nodiscard]] std::string counted(std::uint64_t number, std::string_view one, std::string_view many);

/// Content of a stream: how its geometry is encoded, and what else it has.
struct StreamContents {
  std::string geometry;  // "displaced mesh", "octree of 3,000 splats"
  bool texture = false;
  bool mesh_at_end = false;  // ends with the original mesh
  bool gaussians = false;    // keeps opacities and shapes of splats

  /// Returns the description: "displaced mesh, texture, original mesh at the end".
  [[nodiscard]] std::string text() const;
};
[[nodiscard]] StreamContents contents_of(const qnv::EncodedStream& stream, const OpenedInput& input);

/// Returns the properties of an input that no stream and no mesh keeps, as messages for the user.
[[nodiscard]] std::vector<std::string> lost_properties(const OpenedInput& input);
/// Returns the properties that a stream with these contents has lost in addition.
[[nodiscard]] std::vector<std::string> lost_in_stream(const OpenedInput& input, const StreamContents& contents);
/// Prints one note per loss on standard error.
void print_losses(const std::string& in, const std::vector<std::string>& losses);

/// Result of a conversion.
struct Conversion {
  const std::string& in;
  std::uint64_t in_bytes = 0;
  const std::string& out;
  std::uint64_t out_bytes = 0;
  std::string contents;
};
/// Prints the summary: "duck.glb 120 kB -> duck.qnv 78 kB (displaced mesh, texture), 16 s".
void print_conversion(const Conversion& conversion, std::chrono::steady_clock::time_point start);

}  // namespace gs::app
