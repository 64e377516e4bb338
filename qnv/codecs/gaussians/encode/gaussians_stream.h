#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/gaussian_source.h"

#include <cstddef>
#include <variant>

namespace gs::qnv {

/// Maximum number of Gaussians in one tree, unless EncodeOptions::part_splats is set.
inline constexpr std::size_t kMostWholeGaussians = 500'000;

/// Encodes Gaussian splats as a stream: FORMAT.md, "Gaussians payload". Uses these options: vectors, max_bytes,
/// metadata, parity, splat_steps, part_splats, memory, spill, sink, ranks, threads. All numbers must be finite, except
/// for coefficients of harmonics, where other numbers become 0. Runs on any thread; blocks.
std::variant<EncodedStream, EncodeError> encode_gaussians(const Gaussians& source, const EncodeOptions& options,
                                                          Progress* progress = nullptr);
/// Encodes Gaussians that may exceed memory. If there are more than EncodeOptions::part_splats, divides them into parts
/// of space. Each part gets an own tree. One more tree joins the merged Gaussians at the tops of these trees. Ranks
/// share the parts; they need a sink.
std::variant<EncodedStream, EncodeError> encode_gaussians(const GaussianSource& source, const EncodeOptions& options,
                                                          Progress* progress = nullptr);

}  // namespace gs::qnv
