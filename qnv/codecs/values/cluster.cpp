#include "qnv/codecs/values/cluster.h"

#include "qnv/base/short_number.h"

#include <algorithm>

namespace gs::qnv::values {

namespace {

// Bit beside the plane of a block.
constexpr std::uint8_t kDiffers = 128;

}  // namespace

std::vector<std::byte> pack(const Cluster& cluster) {
  std::vector<std::byte> out;
  put_number(out, cluster.block);
  put_number(out, cluster.index);
  put_number(out, cluster.steps);
  if (cluster.index == 0) out.push_back(static_cast<std::byte>(cluster.plane | (cluster.differs ? kDiffers : 0)));
  out.insert(out.end(), cluster.bytes.begin(), cluster.bytes.end());
  return out;
}

std::optional<Cluster> parse_cluster(std::span<const std::byte> payload, bool may_differ) {
  if (payload.size() > kMaxComponentBytes) return std::nullopt;
  const auto block = take_wide_number(payload);
  const auto index = take_wide_number(payload);
  const auto steps = take_wide_number(payload);
  constexpr std::uint64_t kMost = 0xffffffff;
  if (!block || !index || !steps || *steps == 0 || std::max({*block, *index, *steps}) > kMost) return std::nullopt;
  Cluster cluster{static_cast<std::uint32_t>(*block),
                  static_cast<std::uint32_t>(*index),
                  static_cast<std::uint32_t>(*steps),
                  0,
                  {}};
  if (*index == 0) {
    if (payload.empty()) return std::nullopt;
    cluster.plane = std::to_integer<std::uint8_t>(payload.front());
    cluster.differs = may_differ && (cluster.plane & kDiffers) != 0;
    if (cluster.differs) cluster.plane &= static_cast<std::uint8_t>(~kDiffers);
    payload = payload.subspan(1);
  }
  if (cluster.plane > kHighestPlane) return std::nullopt;
  cluster.bytes.assign(payload.begin(), payload.end());
  return cluster;
}

std::size_t decode(std::span<const Cluster> clusters, Block& block, BlockScratch& scratch) {
  std::vector<CodedSteps> coded;
  coded.reserve(clusters.size());
  for (const Cluster& cluster : clusters) {
    if (cluster.index == 0) block.start(cluster.plane);
    coded.push_back({cluster.bytes, cluster.steps});
  }
  return block.decode(coded, scratch);
}

}  // namespace gs::qnv::values
