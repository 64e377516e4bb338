#include "app/formats/qnv/held_streams.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace gs::app {
namespace {

// Bytes per vector in cuts and caches of a packed stream.
constexpr std::uint64_t kLevelBytes = 96;

}  // namespace

std::shared_ptr<qnv::LodStream> hold_levels(std::unique_ptr<qnv::LodStream> stream, const WorldBudget& budget,
                                            bool grows) {
  struct Held {
    std::unique_ptr<qnv::LodStream> stream;
    Share share, arrived;
  };
  // A small stream gets the amount that its header requires. Any other stream gets half of the remaining budget.
  constexpr std::uint64_t kAtLeast = std::uint64_t{1} << 20, kMaxCounted = std::uint64_t{1} << 40;
  const std::uint64_t wanted = kAtLeast + kLevelBytes * std::min(stream->header().vectors, kMaxCounted);
  const std::uint64_t bytes = std::min(wanted, budget->left(Resource::vectors) / 2);
  auto held = std::make_shared<Held>(Held{std::move(stream), Share(budget, Resource::vectors), {}});
  (void)held->share.grow(bytes);
  qnv::LodLimits limits;
  limits.cache_bytes = std::min<std::size_t>(limits.cache_bytes, held->share.amount() / 2);
  limits.discs = held->share.amount() / kLevelBytes;
  if (grows) {
    // The directory follows all chunks, so its offset is their total size.
    const std::uint64_t directory = held->stream->header().directory, left = budget->left(Resource::files) / 2;
    held->arrived = Share(budget, Resource::files);
    (void)held->arrived.grow(directory > 0 ? std::min(left, directory) : left / 2);
    limits.arrived_bytes = kAtLeast + held->arrived.amount();
  }
  held->stream->set_limits(limits);
  return {held, held->stream.get()};
}

qnv::SplatLimits cut_limits(std::uint64_t share, std::optional<std::uint64_t> arrived) {
  qnv::SplatLimits limits;
  limits.cache_bytes = std::min<std::size_t>(limits.cache_bytes, share / 2);
  limits.cut_bytes = std::min<std::size_t>(limits.cut_bytes, share / 2);
  if (!arrived) return limits;
  limits.arrived_bytes = (std::size_t{1} << 20) + *arrived;
  // Views of a large stream keep many received chunks. The cache leaves them up to a quarter of its memory.
  limits.cache_bytes -= std::min<std::size_t>(limits.cache_bytes / 4, *arrived);
  return limits;
}

std::shared_ptr<qnv::SplatStream> hold_cuts(std::unique_ptr<qnv::SplatStream> stream, const WorldBudget& budget,
                                            bool grows) {
  struct Held {
    std::unique_ptr<qnv::SplatStream> stream;
    Share share, arrived;
  };
  // A small stream gets memory for all of its Gaussians, in a cut and in the cache. Any other stream gets at most half
  // of the remaining budget.
  constexpr std::uint64_t kAtLeast = std::uint64_t{16} << 20, kMaxCounted = std::uint64_t{1} << 40, kParts = 3;
  const std::uint64_t each = qnv::bytes_of_splat(stream->header().gaussians.degree);
  constexpr qnv::SplatLimits limits;
  const std::uint64_t wanted =
      std::min<std::uint64_t>(kAtLeast + kParts * each * std::min(stream->header().vectors, kMaxCounted),
                              limits.cache_bytes + limits.cut_bytes);
  auto held = std::make_shared<Held>(Held{std::move(stream), Share(budget, Resource::vectors), {}});
  (void)held->share.grow(std::min(wanted, budget->left(Resource::vectors) / 2));
  if (grows) {
    // The directory follows all chunks, so its offset is their total size.
    const std::uint64_t directory = held->stream->header().directory, left = budget->left(Resource::files) / 2;
    held->arrived = Share(budget, Resource::files);
    (void)held->arrived.grow(directory > 0 ? std::min(left, directory) : left / 2);
  }
  held->stream->set_limits(
      cut_limits(held->share.amount(), grows ? std::optional(held->arrived.amount()) : std::nullopt));
  return {held, held->stream.get()};
}

qnv::Gaussians gaussians_of(std::shared_ptr<qnv::SplatStream> stream) {
  qnv::Gaussians gaussians{qnv::GeometryBase{stream->header().description, stream->header().color, stream}};
  gaussians.antialiased = stream->header().gaussians.antialiased;
  gaussians.stream = std::move(stream);
  return gaussians;
}

}  // namespace gs::app
