#include "qnv/codecs/values/bricks/brick_decoder.h"

#include "qnv/codecs/values/bricks/brick_merge.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/decode/level_layout.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <variant>

namespace gs::qnv {
namespace {

constexpr std::size_t kScanPiece = std::size_t{1} << 20;

std::vector<VolumeLayout> layouts_of(const StreamHeader& header, int base) {
  std::vector<VolumeLayout> levels;
  for (int level = 0; level <= base; ++level)
    levels.push_back(values::level_layout(header.grid, header.description, level));
  return levels;
}

values::StepChain chain_of(const StreamHeader& header, std::uint32_t step) {
  values::StepChain chain;
  const values::ComponentCounts counts = values::component_counts(header.grid);
  chain.blocks = counts.blocks;
  chain.cubes = counts.cubes;
  chain.series = !header.steps.times.empty();
  if (!chain.series) return chain;
  chain.last = std::min(step, static_cast<std::uint32_t>(header.steps.times.size() - 1));
  chain.first = chain.last - chain.last % static_cast<std::uint32_t>(kChainSteps);
  return chain;
}

/// Returns a finer part of the values.
ValueBrick value_brick(const values::Brick& brick, const values::BrickLayout& layout, const VolumeLayout& level,
                       const ValueGrid& grid, bool gaps) {
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
  part.slope = brick.stored ? grid.slope : level.slope;
  part.intercept = brick.stored ? grid.intercept : level.intercept;
  if (brick.stored) part.type = values::stored_type(grid);
  if (gaps && part.level == 0 && part.type != VoxelType::f32) part.missing = values::kMissingInBrick;
  if (part.level == 0 && !brick.final.flags.empty() && !grid.errors.empty()) {
    part.error = grid.errors.back().most;
    part.bounded = std::make_shared<const std::vector<std::uint8_t>>(brick.final.flags);
  }
  part.samples = {brick.samples, &brick.samples->samples};
  return part;
}

}  // namespace

int BrickDecoder::base_level(const ValueGrid& grid, std::size_t most_vectors) {
  return std::min(values::level_for(grid.dimensions, most_vectors), values::level_count(grid.dimensions));
}

BrickDecoder::BrickDecoder(const StreamHeader& header, const BrickLimits& limits,
                           std::shared_ptr<const ChunkSource> source, std::uint32_t step)
    : header_(header),
      limits_(limits),
      source_(std::move(source)),
      layout_(header.grid.dimensions, base_level(header.grid, limits.base_vectors)),
      chain_(chain_of(header, step)),
      levels_(layouts_of(header, layout_.base())),
      kept_(limits.arrived_bytes),
      chunks_(source_, kept_, chain_),
      gaps_(header.grid.dimensions),
      remainders_(header.grid.dimensions, source_, kept_),
      cache_(layout_, levels_, header.grid),
      decoder_(chain_.series ? make_series_decoder(header, limits.base_vectors)
                             : make_values_decoder(header, limits.base_vectors)) {
  decoder_->show({0, false, false, {chain_.last, {}}});
  GeometryBase base{header.description, header.color};
  base_volume_ = shown_ = std::make_shared<const Volume>(std::move(base));
  // The coarse level gets only its own chunks, so the header's errors of prefixes do not hold for it.
  decoder_->leave_order();
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
  if (type == ChunkType::values) take_cluster(payload, offset);
  if ((type == ChunkType::gaps && header_.grid.gaps) || (type == ChunkType::remainders && has_remainders()))
    take_run(type, payload, offset);
}

void BrickDecoder::take_cluster(std::span<const std::byte> payload, std::uint64_t offset) {
  std::uint32_t step = 0;
  const auto cluster = chain_.parse(payload, &step);
  if (!cluster) return;
  if (is_base(cluster->block) && base_taken_.insert(offset).second) {
    base_known_.insert(offset);
    if (decoder_) decoder_->add(ChunkType::values, payload, {});
    ++base_chunks_;
  }
  if (!is_fine(cluster->block)) return;
  const auto bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size());
  const std::uint64_t number = chain_.number(step, cluster->block);
  const bool known = chunks_.note(number, {offset, bytes, cluster->index});
  if (known && !source_) chunks_.keep(number, offset, payload);
}

void BrickDecoder::take_run(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
  auto run = values::parse_run(payload);
  if (!run) return;
  if (chain_.series) {
    if (run->first / chain_.cubes != chain_.last) return;
    run->first %= chain_.cubes;
  }
  if (type == ChunkType::remainders) {
    const auto bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size());
    const bool known = remainders_.note({run->first, offset, bytes, run->count});
    if (known && !source_) kept_.keep(offset, values::RemainderRuns::owner(run->first), payload);
  } else if (!base_taken_.contains(offset) && gaps_.add(std::move(*run))) {
    base_known_.insert(offset);
    base_taken_.insert(offset);
  }
}

void BrickDecoder::take_place(values::ChunkPlace place) {
  const std::uint64_t number = place.first;
  if (chain_.series) {
    const std::uint64_t count = place.type == ChunkType::values ? chain_.blocks : chain_.cubes,
                        step = place.first / count;
    // Only clusters of earlier steps matter.
    if (place.type == ChunkType::values ? !chain_.has(step) : step != chain_.last) return;
    place.first %= count;
  }
  if (place.type == ChunkType::gaps || (place.type == ChunkType::values && is_base(place.first))) {
    base_places_.push_back({place.offset, place.bytes});
    base_known_.insert(place.offset);
  }
  if (place.type == ChunkType::values && is_fine(place.first))
    (void)chunks_.note(number, {place.offset, place.bytes, place.count});
  if (place.type == ChunkType::remainders && has_remainders())
    (void)remainders_.note({place.first, place.offset, place.bytes, place.count});
}

// Reports whether all chunks of the stream are known, and those of the coarse level and all gaps are received.
bool BrickDecoder::has_final_base() const {
  if (chain_.series) return false;
  if (!decoder_) return base_.final;
  const std::vector<ValueError>& errors = header_.grid.errors;
  const DecodeCount count = decoder_->count();
  // If the coarse level is the coarsest one, its only block also belongs to a brick. Count it once.
  const std::size_t twice = is_fine(0) ? chunks_.known(0) : 0;
  return !errors.empty() &&
         base_known_.size() + chunks_.count() - twice + remainders_.count() >= errors.back().chunks &&
         base_taken_.size() == base_known_.size() && count.refused == 0 && !count.full;
}

bool BrickDecoder::set_directory(std::span<const std::byte> chunks) {
  const auto places = values::places_of(chunks, header_);
  if (!places) return false;
  for (const values::ChunkPlace& place : *places) take_place(place);
  has_places_ = true;
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
  has_places_ = true;
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
  if (!decoder_ || base_chunks_ == shown_chunks_) return false;
  shown_chunks_ = base_chunks_;
  Geometry geometry = decoder_->geometry(GeometryBase{header_.description, header_.color});
  auto* const volume = geometry.as<Volume>();
  if (!volume || !volume->values) return false;
  volume->series.reset();
  whole_base_ = volume->values->level == layout_.base() && layout_.base() > 0;
  if (!whole_base_) {
    base_volume_ = std::make_shared<const Volume>(std::move(*volume));
    return true;
  }
  const values::Extent extent = layout_.extent(layout_.base());
  const std::size_t slice = std::size_t{extent[0]} * extent[1];
  auto samples = std::make_shared<values::BrickSamples>();
  samples->level = layout_.base();
  samples->box = {{}, extent};
  samples->samples.resize(slice * extent[2]);
  auto values = std::make_shared<VolumeValues>(*volume->values);
  for (std::uint32_t z = 0; z < extent[2]; ++z)
    if (!values->source.read(z, std::as_writable_bytes(std::span(samples->samples).subspan(z * slice, slice))))
      whole_base_ = false;
  // The values and the bricks share the samples, so that the decoder can end.
  values->source.read = [samples, slice](std::uint32_t z, std::span<std::byte> to) {
    if (z >= samples->box.size[2] || to.size() != slice * sizeof(std::int32_t)) return false;
    std::memcpy(to.data(), samples->samples.data() + z * slice, to.size());
    return true;
  };
  volume->values = std::move(values);
  base_volume_ = std::make_shared<const Volume>(std::move(*volume));
  base_.samples = std::move(samples);
  base_.shares = values::VectorShares(*base_volume_, levels_.back(), layout_.base());
  ++base_.version;
  return true;
}

// Chooses the bricks that views need, and the blocks and runs that these need.
void BrickDecoder::choose(std::span<const LodView> views) {
  needs_ = {};
  runs_.clear();
  if (!whole_base_) return;
  // Wait for most of the coarse level: each part of it would change all bricks, and its decoder still uses memory.
  constexpr std::size_t kParts = 20;
  if (!source_ && has_places_ && kParts * base_taken_.size() < (kParts - 1) * base_known_.size()) return;
  needs_.chosen = values::choose_bricks({layout_, levels_, base_.shares, views, limits_.brick_bytes});
  const auto need = [this](std::uint64_t block) { needs_.blocks.insert(block); };
  for (const values::BrickName& name : needs_.chosen) {
    layout_.visit_blocks(name, false, need);
    if (name.level > 0) continue;
    const Box box = values::brick_box(layout_, name, levels_.front());
    const float voxel = values::largest_step(levels_.front());
    bool all = false, slice = false;
    for (const LodView& view : views) {
      const VolumeNeeds& needs = view.volume;
      if (outside(box, view)) continue;
      all = all || (needs.exact && !needs.only_slices);
      slice = slice || values::touches_slice(box, voxel, needs);
    }
    if (!all && !slice) continue;
    needs_.exact.insert(name);
    layout_.visit_sources(name, need);
    need_runs(layout_.extended(name), views, all);
  }
}

// Notes the runs of a brick: all of them, or those of the rows of cubes that slices touch.
void BrickDecoder::need_runs(const values::SampleBox& brick, std::span<const LodView> views, bool all) {
  if (!has_remainders()) return;
  const auto need = [this](const values::RunPlace& run) { runs_.try_emplace(run.first, run); };
  if (all) return remainders_.visit(brick, need);
  const float voxel = values::largest_step(levels_.front());
  for (std::uint32_t z = 0; z < brick.size[2]; z += values::kCubeEdge)
    for (std::uint32_t y = 0; y < brick.size[1]; y += values::kCubeEdge) {
      values::SampleBox row = brick;
      row.first[1] += y;
      row.first[2] += z;
      row.size[1] = std::min(values::kCubeEdge, brick.size[1] - y);
      row.size[2] = std::min(values::kCubeEdge, brick.size[2] - z);
      const Box box = values::samples_box(row, levels_.front());
      if (std::ranges::any_of(views,
                              [&](const LodView& view) { return values::touches_slice(box, voxel, view.volume); }))
        remainders_.visit(row, need);
    }
}

std::shared_ptr<const Volume> BrickDecoder::decode(std::span<const LodView> views, const std::atomic<bool>& stop) {
  const bool changed = decode_base();
  base_.final = has_final_base();
  // No further chunk changes a complete coarse level, so the memory of its decoder is free.
  if (whole_base_ && has_places_ && base_taken_.size() == base_known_.size()) decoder_.reset();
  choose(views);
  // Former bricks and vectors make room for new ones, unless a renderer still has them.
  const bool finished = cache_.update(needs_, {base_, chunks_, gaps_, remainders_, chain_}, limits_.brick_bytes, stop,
                                      [this] { shown_ = base_volume_; });
  if (!finished) return shown_;
  if (!source_) {
    constexpr std::uint64_t kRun = values::RemainderRuns::owner(0);
    kept_.trim([this](std::uint64_t owner) {
      return (owner & kRun) != 0 ? runs_.contains(owner ^ kRun) : needs_.blocks.contains(owner);
    });
  }
  const bool with_values = std::ranges::any_of(views, [](const LodView& view) { return view.volume.values; });
  if (changed || cache_.computed() > 0 || needs_.chosen != merged_ || with_values != merged_values_) merge(with_values);
  return shown_;
}

// Makes the volume to draw. With `with_values`, it keeps the samples of its bricks in memory while it is drawn.
void BrickDecoder::merge(bool with_values) {
  merged_values_ = with_values;
  merged_ = needs_.chosen;
  if (merged_.empty()) {
    shown_ = base_volume_;
    return;
  }
  auto merged = std::make_shared<Volume>(
      values::merge_bricks(*base_volume_, layout_, levels_, merged_,
                           [this](const values::BrickName& name) { return cache_.find(name); }));
  auto values = std::make_shared<VolumeValues>(*base_volume_->values);
  for (const values::BrickName& name : with_values ? merged_ : std::vector<values::BrickName>())
    if (const values::Brick* const brick = cache_.find(name); brick && brick->samples)
      values->bricks.push_back(
          value_brick(*brick, layout_, levels_[static_cast<std::size_t>(name.level)], header_.grid, gaps_.count() > 0));
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
  for (const std::uint64_t block : needs_.blocks)
    for (const values::ClusterPlace& place : chunks_.of(block))
      if (!chunks_.has(place)) ranges.push_back({place.offset, place.bytes, kept_.was_dropped(place.offset)});
  for (const auto& [first, run] : runs_)
    if (!remainders_.has(run)) ranges.push_back({run.offset, run.bytes, kept_.was_dropped(run.offset)});
  std::ranges::sort(ranges, {}, &ChunkRange::offset);
  return ranges;
}

BrickStatistics BrickDecoder::statistics() const {
  BrickStatistics counts;
  counts.bricks = cache_.count();
  counts.shown = merged_.size();
  counts.computed = cache_.computed();
  counts.bytes = cache_.bytes();
  counts.arrived = kept_.bytes();
  counts.clusters = chunks_.count();
  counts.base = counts.finest = layout_.base();
  for (const values::BrickName& name : merged_) counts.finest = std::min(counts.finest, name.level);
  return counts;
}

}  // namespace gs::qnv
