#include "qnv/codecs/octree/lod/lod.h"

#include "qnv/codecs/octree/lod/lod_whole.h"

#include <limits>
#include <utility>

namespace gs::qnv {

OctreeSplats::OctreeSplats(std::shared_ptr<LodStream> of)
    : GeometryBase{of->header().description, of->header().color, of}, stream(std::move(of)) {}

LodStream::Opened LodStream::make(LodChunks::Opened opened, std::size_t cache_bytes) {
  if (auto* problem = std::get_if<StreamProblem>(&opened)) return std::move(*problem);
  return std::unique_ptr<LodStream>(new LodStream(std::move(std::get<LodChunks>(opened)), cache_bytes));
}

LodStream::Opened LodStream::open(std::vector<std::byte> bytes, std::size_t cache_bytes) {
  return make(LodChunks::open(memory_source(std::move(bytes)), false), cache_bytes);
}

LodStream::Opened LodStream::open(std::shared_ptr<const ChunkSource> source, std::size_t cache_bytes) {
  return make(LodChunks::open(std::move(source), true), cache_bytes);
}

LodStream::Opened LodStream::begin(std::span<const std::byte> front, std::size_t cache_bytes) {
  return make(LodChunks::begin(front), cache_bytes);
}

bool LodStream::push(std::span<const std::byte> bytes) {
  return chunks_.push(bytes, [this](std::uint32_t node) { cache_.find_box(node); });
}

void LodStream::finish() {
  chunks_.finish([this](std::uint32_t node) { cache_.find_box(node); });
}

bool LodStream::add(std::uint64_t offset, std::span<const std::byte> chunk) {
  return chunks_.add(offset, chunk, [this](std::uint32_t node) { cache_.find_box(node); });
}

void LodStream::set_limits(const LodLimits& limits) {
  most_discs_ = limits.discs;
  cutter_.set_most_discs(limits.discs);
  cache_.set_most_bytes(limits.cache_bytes);
  chunks_.set_most_bytes(limits.arrived_bytes);
}

Splats LodStream::whole() {
  Splats all({header().description, header().color});
  LodWhole whole(chunks_, most_discs_);
  (void)whole.visit([&](const Cluster& cluster, std::size_t first, std::size_t count) {
    append_discs(cluster, first, count, header().cube, all);
  });
  cut_short_ = whole.cut_short();
  return all;
}

std::size_t LodStream::count() {
  return LodWhole(chunks_, std::numeric_limits<std::size_t>::max()).visit([](const Cluster&, std::size_t, std::size_t) {
  });
}

}  // namespace gs::qnv
