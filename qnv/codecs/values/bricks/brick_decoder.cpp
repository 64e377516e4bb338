#include "qnv/codecs/values/bricks/brick_decoder.h"

#include "qnv/codecs/values/bricks/brick_merge.h"
#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace gs::qnv {
namespace {

constexpr std::size_t kScanPiece = std::size_t{1} << 20;

values::ClusterChunks chunks_for(const std::shared_ptr<const ChunkSource>& source, const BrickLimits& limits) {
  if (source) return values::ClusterChunks(source);
  return values::ClusterChunks(limits.arrived_bytes);
}

std::vector<VolumeLayout> layouts_of(const StreamHeader& header, int base) {
  std::vector<VolumeLayout> levels;
  for (int level = 0; level <= base; ++level)
    levels.push_back(values::level_layout(header.grid, header.description, level));
  return levels;
}

/// Returns a finer part of the values.
ValueBrick value_brick(const values::Brick& brick, const values::BrickLayout& layout, const VolumeLayout& level,
                       bool gaps) {
  ValueBrick part;
  part.level = brick.name.level;
  part.first = brick.samples->box.first;
  part.size = brick.samples->box.size;
  const values::SampleBox core = layout.core(brick.name);
  part.core_first = core.first;
  part.core_size = core.size;
  for (std::size_t a = 0; a < 3; ++a) {
    int steps = 0;  // an axis of one voxel stays as it is
    for (int l = brick.name.level; l < layout.base(); ++l) steps += layout.extent(l)[a] > 1 ? 1 : 0;
    part.steps[a] = std::ldexp(1.0, -steps);
  }
  part.slope = level.slope;
  part.intercept = level.intercept;
  if (gaps && part.level == 0) part.missing = values::kMissingInBrick;
  part.samples = {brick.samples, &brick.samples->samples};
  return part;
}

}  // namespace

int BrickDecoder::base_level(const ValueGrid& grid, std::size_t most_vectors) {
  return std::min(values::level_for(grid.dimensions, most_vectors), values::level_count(grid.dimensions));
}

BrickDecoder::BrickDecoder(const StreamHeader& header, const BrickLimits& limits,
                           std::shared_ptr<const ChunkSource> source)
    : header_(header),
      limits_(limits),
      source_(std::move(source)),
      layout_(header.grid.dimensions, base_level(header.grid, limits.base_vectors)),
      levels_(layouts_of(header, layout_.base())),
      chunks_(chunks_for(source_, limits)),
      gaps_(header.grid.dimensions),
      cache_(layout_, levels_),
      decoder_(make_values_decoder(header, limits.base_vectors)) {
  GeometryBase base{header.description, header.color};
  base_volume_ = shown_ = std::make_shared<const Volume>(std::move(base));
  base_.limits = values::sample_limits(header.description.value_range, header.grid.unit, header.grid.zero);
}

// Blocks of a level give the samples of the next finer one. The coarsest blocks also have the low band.
bool BrickDecoder::is_base(std::uint64_t block) const {
  return block < layout_.blocks().first_of(layout_.base()) || block == 0;
}
bool BrickDecoder::is_fine(std::uint64_t block) const {
  return layout_.base() > 0 && block >= layout_.blocks().first_of(layout_.base()) && block < layout_.blocks().count();
}

void BrickDecoder::take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
  if (type == ChunkType::gaps && header_.grid.gaps) {
    if (!base_taken_.insert(offset).second) return;
    if (auto run = values::parse_run(payload)) (void)gaps_.add(std::move(*run));
  }
  if (type != ChunkType::values) return;
  const auto cluster = values::parse_cluster(payload);
  if (!cluster) return;
  if (is_base(cluster->block) && base_taken_.insert(offset).second) {
    decoder_->add(type, payload, {});
    ++base_chunks_;
  }
  if (!is_fine(cluster->block)) return;
  const auto bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size());
  const bool known = chunks_.note(cluster->block, {offset, bytes, cluster->index});
  if (known && !source_) chunks_.keep(cluster->block, offset, payload);
}

void BrickDecoder::take_place(const values::ChunkPlace& place) {
  if (place.type == ChunkType::gaps || (place.type == ChunkType::values && is_base(place.first)))
    base_places_.push_back({place.offset, place.bytes});
  if (place.type == ChunkType::values && is_fine(place.first))
    (void)chunks_.note(place.first, {place.offset, place.bytes, place.count});
}

bool BrickDecoder::set_directory(std::span<const std::byte> chunks) {
  const auto places = values::places_of(chunks, header_);
  if (!places) return false;
  for (const values::ChunkPlace& place : *places) take_place(place);
  return true;
}

bool BrickDecoder::push(std::span<const std::byte> bytes) {
  return reader_.push(bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    take(type, payload, offset);
  });
}

void BrickDecoder::finish() {
  reader_.finish([this](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    take(type, payload, offset);
  });
}

bool BrickDecoder::add(std::uint64_t offset, std::span<const std::byte> chunk) {
  const auto parsed = sound_chunk(chunk);
  const auto* const sound = std::get_if<SoundChunk>(&parsed);
  if (sound) take(sound->type, sound->payload, offset);
  return sound != nullptr;
}

bool BrickDecoder::scan_source(const std::function<bool()>& stop) {
  std::vector<std::byte> piece(kScanPiece);
  for (std::uint64_t at = 0; at < source_->size();) {
    const std::size_t size = source_->read(at, piece);
    if (size == 0 || (stop && stop())) return false;
    if (!push(std::span(piece).first(size))) return false;
    at += size;
  }
  finish();
  return true;
}

bool BrickDecoder::read_source(const std::function<bool()>& stop) {
  constexpr std::uint64_t kMostDirectory = std::uint64_t{64} << 20;
  const std::uint64_t from = header_.directory, size = source_->size();
  std::vector<std::byte> bytes(from > 0 && from < size && size - from <= kMostDirectory
                                   ? static_cast<std::size_t>(size - from)
                                   : std::size_t{0});
  if (bytes.empty() || source_->read(from, bytes) != bytes.size() || !set_directory(bytes)) return scan_source(stop);
  bytes = {};
  std::vector<std::byte> buffer;
  for (const ChunkRange& place : base_places_) {
    if (stop && stop()) return false;
    const auto chunk = read_chunk(*source_, place.offset, static_cast<std::size_t>(place.bytes), buffer);
    if (const auto* const sound = std::get_if<SoundChunk>(&chunk)) take(sound->type, sound->payload, place.offset);
  }
  return true;
}

// Decodes the coarse level again if chunks of it arrived. Returns true if it changed.
bool BrickDecoder::decode_base() {
  if (base_chunks_ == shown_chunks_) return false;
  shown_chunks_ = base_chunks_;
  Geometry geometry = decoder_->geometry(GeometryBase{header_.description, header_.color});
  auto* const volume = geometry.as<Volume>();
  if (!volume || !volume->values) return false;
  base_volume_ = std::make_shared<const Volume>(std::move(*volume));
  whole_base_ = base_volume_->values->level == layout_.base() && layout_.base() > 0;
  if (!whole_base_) return true;
  const VolumeSource& source = base_volume_->values->source;
  const values::Extent extent = layout_.extent(layout_.base());
  const std::size_t slice = std::size_t{extent[0]} * extent[1];
  std::vector<std::int32_t> samples(slice * extent[2]);
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    if (!source.read(z, std::as_writable_bytes(std::span(samples).subspan(z * slice, slice)))) whole_base_ = false;
  base_.samples = {layout_.base(), {{}, extent}, std::move(samples)};
  base_.shares = values::VectorShares(*base_volume_, levels_.back(), layout_.base());
  ++base_.version;
  return true;
}

std::shared_ptr<const Volume> BrickDecoder::decode(std::span<const LodView> views, const std::atomic<bool>& stop) {
  const bool changed = decode_base();
  chosen_.clear();
  if (whole_base_) chosen_ = values::choose_bricks({layout_, levels_, base_.shares, views, limits_.brick_bytes});
  if (!cache_.update(chosen_, base_, chunks_, gaps_, limits_.brick_bytes, stop)) return shown_;
  if (!source_) chunks_.trim([this](std::uint64_t block) { return cache_.uses(block); });
  if (changed || cache_.computed() > 0 || chosen_ != merged_) merge();
  return shown_;
}

void BrickDecoder::merge() {
  merged_ = chosen_;
  if (chosen_.empty()) {
    shown_ = base_volume_;
    return;
  }
  auto merged = std::make_shared<Volume>(values::merge_bricks(*base_volume_, layout_, levels_, chosen_, cache_));
  auto values = std::make_shared<VolumeValues>(*base_volume_->values);
  for (const values::BrickName& name : chosen_)
    if (const values::Brick* const brick = cache_.find(name); brick && brick->samples)
      values->bricks.push_back(
          value_brick(*brick, layout_, levels_[static_cast<std::size_t>(name.level)], gaps_.count() > 0));
  std::ranges::stable_sort(values->bricks, {}, &ValueBrick::level);
  values->bytes += cache_.bytes();
  merged->values = std::move(values);
  shown_ = std::move(merged);
}

std::vector<ChunkRange> BrickDecoder::wanted() const {
  std::vector<ChunkRange> ranges;
  if (source_) return ranges;
  for (const ChunkRange& place : base_places_)
    if (!base_taken_.contains(place.offset)) ranges.push_back(place);
  std::unordered_set<std::uint64_t> blocks;
  for (const values::BrickName& name : chosen_)
    layout_.visit_blocks(name, false, [&](std::uint64_t block) {
      if (!blocks.insert(block).second) return;
      for (const values::ClusterPlace& place : chunks_.of(block))
        if (!chunks_.has(place)) ranges.push_back({place.offset, place.bytes, chunks_.was_dropped(place)});
    });
  std::ranges::sort(ranges, {}, &ChunkRange::offset);
  return ranges;
}

BrickStatistics BrickDecoder::statistics() const {
  BrickStatistics counts;
  counts.bricks = cache_.count();
  counts.shown = merged_.size();
  counts.computed = cache_.computed();
  counts.bytes = cache_.bytes();
  counts.arrived = chunks_.bytes();
  counts.clusters = chunks_.count();
  counts.base = counts.finest = layout_.base();
  for (const values::BrickName& name : merged_) counts.finest = std::min(counts.finest, name.level);
  return counts;
}

}  // namespace gs::qnv
