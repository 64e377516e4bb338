#pragma once

#include "base/budget.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace gs::app {

/// Charges `budget` for the cuts, cache and chunks of a packed stream, and limits them to that share. The result owns
/// the stream and its share. `grows` means that the stream keeps received chunks.
[[nodiscard]] std::shared_ptr<qnv::LodStream> hold_levels(std::unique_ptr<qnv::LodStream> stream,
                                                          const WorldBudget& budget, bool grows);

/// Returns the limits of a stream of Gaussians with a share of the memory for vectors, in bytes. `arrived` is the share
/// for received chunks; nullopt means that the stream keeps none.
[[nodiscard]] qnv::SplatLimits cut_limits(std::uint64_t share, std::optional<std::uint64_t> arrived);
/// Charges `budget` for the cuts, cache and chunks of a stream of Gaussians, and limits them to that share. The result
/// owns the stream and its share. `grows` means that the stream keeps received chunks.
[[nodiscard]] std::shared_ptr<qnv::SplatStream> hold_cuts(std::unique_ptr<qnv::SplatStream> stream,
                                                          const WorldBudget& budget, bool grows);
/// Returns Gaussians that refer to `stream`, from which each view takes its own cut.
[[nodiscard]] qnv::Gaussians gaussians_of(std::shared_ptr<qnv::SplatStream> stream);

}  // namespace gs::app
