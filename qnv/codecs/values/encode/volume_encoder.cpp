#include "qnv/codecs/values/encode/volume_encoder.h"

#include "qnv/codecs/values/chunk_places.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <utility>

namespace gs::qnv::values {

namespace {

// Number of blocks to encode before LeastRank is updated.
constexpr std::uint32_t kBlocksBetween = 16;
// Maximum number of blocks with clusters in memory.
constexpr std::uint32_t kBlocksAtOnce = 256;

// Returns the record at the beginning of some bytes.
template <class Record>
Record record_at(std::span<const std::byte> bytes) {
  Record record;
  std::memcpy(static_cast<void*>(&record), bytes.data(), sizeof record);
  return record;
}

}  // namespace

void LeastRank::add(std::span<const StoredCluster> clusters) {
  for (const StoredCluster& one : clusters)
    if (one.rank >= rank_) kept_.push_back({one.rank, one.bytes + kClusterChunkCost});
}

void LeastRank::update() {
  std::ranges::sort(kept_, std::greater<>());
  std::size_t bytes = 0, count = 0;
  while (count < kept_.size() && bytes <= max_bytes_) bytes += kept_[count++].second;
  if (bytes <= max_bytes_) return;
  rank_ = kept_[count - 1].first;
  kept_.resize(count);
}

VolumeEncoder::VolumeEncoder(Extent extent, const ValuesLimit& limit, SpillStore& store, unsigned threads,
                             Progress* progress, const EncodedStep* step, const SharedWork& work)
    : extent_(extent),
      layout_(extent, level_count(extent)),
      store_(store),
      threads_(threads),
      progress_(progress),
      before_(step && !step->first ? &step->decoded : nullptr),
      work_(work),
      ranks_(work.ranks ? *work.ranks : alone_) {
  if (limit.max_bytes != 0) least_.emplace(limit.max_bytes);
}

std::optional<EncodeError> VolumeEncoder::encode(const ReadSamples& read, int last_plane) {
  clusters_.clear();
  pieces_.clear();
  lows_.clear();
  problem_.reset();
  if (progress_) {
    progress_->stage = "encoding";
    progress_->done = 0;
    progress_->total = blocks() / ranks_.count();
  }
  std::optional<EncodeError> problem;
  if (!work_.ranks) {
    problem = encode_alone(read, last_plane);
  } else if (least_) {
    if (ranks_.rank() == 0) problem = encode_alone(read, last_plane);
    if (!problem && !store_.publish()) cannot_store();
    problem = agree(ranks_, problem ? problem : problem_);
  } else {
    for (int level = 1; level <= std::max(1, level_count(extent_)) && !problem; ++level)
      problem = encode_level(level, read, last_plane);
  }
  if (!problem) collect();
  return problem;
}

std::optional<EncodeError> VolumeEncoder::encode_alone(const ReadSamples& read, int last_plane) {
  SliceTransform transform(extent_, threads_, [&](std::uint64_t first, std::uint32_t count, LevelSlices& slices) {
    return take(first, count, slices, last_plane);
  });
  SampleBatch batch;
  const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
  for (std::uint32_t z = 0; z < extent_[2]; z += kBatchSlices) {
    if (is_cancelled(progress_)) return EncodeError{"cancelled"};
    if (auto problem = read(z, std::min(kBatchSlices, extent_[2] - z), batch)) return problem;
    std::vector<SliceRows> slices;
    for (std::uint32_t i = 0; i < batch.count; ++i) slices.push_back({batch.samples.data() + i * slice, extent_[0]});
    if (!transform.add(slices)) return problem_ ? std::move(problem_) : EncodeError{"cancelled"};
  }
  return std::nullopt;
}

std::uint64_t VolumeEncoder::LevelPieces::per_row() const { return (in_row + kBlocksAtOnce - 1) / kBlocksAtOnce; }

std::uint64_t VolumeEncoder::LevelPieces::first_of(std::uint64_t piece) const {
  return first_block + piece / per_row() * in_row + piece % per_row() * kBlocksAtOnce;
}

std::uint32_t VolumeEncoder::LevelPieces::count_of(std::uint64_t piece) const {
  const auto before = static_cast<std::uint32_t>(piece % per_row()) * kBlocksAtOnce;
  return std::min(kBlocksAtOnce, in_row - before);
}

VolumeEncoder::LevelPieces VolumeEncoder::pieces_of(int level) const {
  const Extent blocks = layout_.blocks_of(level);
  return {layout_.first_of(level), blocks[2], blocks[0] * blocks[1]};
}

// Returns the pieces of this rank. If there are enough rows, each rank has whole rows, so none is transformed twice.
RankShare VolumeEncoder::share_of_level(const LevelPieces& pieces) const {
  constexpr std::uint64_t kEnough = 4;  // rows per rank
  if (pieces.rows < kEnough * ranks_.count()) return share_of(ranks_, pieces.size());
  const RankShare rows = share_of(ranks_, pieces.rows);
  return {rows.first * pieces.per_row(), rows.end * pieces.per_row()};
}

std::optional<EncodeError> VolumeEncoder::encode_level(int level, const ReadSamples& read, int last_plane) {
  const LevelPieces pieces = pieces_of(level);
  const RankShare share = share_of_level(pieces);
  const std::size_t begin = pieces_.size();
  std::optional<EncodeError> problem;
  for (std::uint64_t piece = share.first; piece < share.end && !problem;) {
    std::uint64_t end = piece;
    while (end < share.end && !restore_piece(name_of(last_plane, level, end), pieces, end)) ++end;
    if (end > piece) problem = encode_pieces(level, {piece, end}, read, last_plane);
    piece = end + 1;
  }
  if (!problem && !store_.publish()) cannot_store();
  if (auto failed = agree(ranks_, problem ? problem : problem_)) return failed;
  lows_ = gather_records(ranks_, std::span<const PieceResult>(pieces_).subspan(begin));
  std::erase_if(lows_,
                [&](const PieceResult& one) { return (one.first_block - pieces.first_block) % pieces.in_row != 0; });
  std::ranges::sort(lows_, {}, &PieceResult::first_block);
  return std::nullopt;
}

std::optional<EncodeError> VolumeEncoder::encode_pieces(int level, RankShare share, const ReadSamples& read,
                                                        int last_plane) {
  const LevelPieces pieces = pieces_of(level);
  const Extent samples = low_extent(extent_, level - 1);
  const RankShare rows{share.first / pieces.per_row(), (share.end + pieces.per_row() - 1) / pieces.per_row()};
  PieceBegin begin{store_.size(), pieces_.size(), clusters_.size()};
  RowTransform transform(extent_, level, rows, threads_, [&](std::uint32_t row, LevelSlices& slices) {
    const std::uint64_t first = row * pieces.per_row();
    for (std::uint64_t piece = std::max(first, share.first); piece < std::min(first + pieces.per_row(), share.end);
         ++piece) {
      const std::optional<std::uint32_t> low_row = piece == first ? std::optional(row) : std::nullopt;
      if (!take(pieces.first_of(piece), pieces.count_of(piece), slices, last_plane) ||
          !finish_piece(name_of(last_plane, level, piece), level, low_row, begin, slices))
        return false;
      begin = {store_.size(), pieces_.size(), clusters_.size()};
    }
    return true;
  });
  const SliceWindow window = RowTransform::window_of(extent_, level, rows);
  const std::size_t slice = std::size_t{samples[0]} * samples[1];
  SampleBatch batch;
  // Batches must begin at multiples of their length, for the filling of missing voxels.
  for (std::uint32_t z = window.first / kBatchSlices * kBatchSlices; z < window.end; z += kBatchSlices) {
    if (is_cancelled(progress_)) return EncodeError{"cancelled"};
    const std::uint32_t count = std::min(kBatchSlices, samples[2] - z);
    if (level == 1) {
      if (auto problem = read(z, count, batch)) return problem;
    } else {
      batch.samples.resize(slice * count);
      for (std::uint32_t i = 0; i < count; ++i)
        if (auto problem = read_low(level, z + i, std::span(batch.samples).subspan(i * slice, slice))) return problem;
    }
    std::vector<SliceRows> slices;
    for (std::uint32_t i = 0; i < count; ++i)
      if (z + i >= window.first && z + i < window.end) slices.push_back({batch.samples.data() + i * slice, samples[0]});
    if (!transform.add(slices)) return problem_ ? problem_ : EncodeError{"cancelled"};
  }
  return std::nullopt;
}

std::string VolumeEncoder::name_of(int last_plane, int level, std::uint64_t piece) const {
  return work_.name + "p" + std::to_string(last_plane) + "l" + std::to_string(level) + "r" + std::to_string(piece);
}

// Reads a slice of the samples that a level transforms. They are the low samples of the previous level.
std::optional<EncodeError> VolumeEncoder::read_low(int level, std::uint32_t slice, std::span<std::int32_t> to) const {
  const std::uint32_t row = slice / kBlockEdge;
  const bool there = row < lows_.size();
  const std::uint64_t offset = there ? lows_[row].low + (slice % kBlockEdge) * to.size_bytes() : 0;
  if (there && store_.read(offset, std::as_writable_bytes(to))) return std::nullopt;
  return EncodeError{"cannot read the samples of level " + std::to_string(level - 1) + " again: " + store_.problem()};
}

// Restores a piece that an earlier run finished. Returns false if there is none, or if it has blocks of another piece.
bool VolumeEncoder::restore_piece(const std::string& work, const LevelPieces& pieces, std::uint64_t piece) {
  const auto result = store_.finished(work);
  if (!result || result->size() < sizeof(PieceResult) ||
      (result->size() - sizeof(PieceResult)) % sizeof(StoredCluster) != 0)
    return false;
  const std::span<const std::byte> bytes(*result);
  const auto kept = record_at<PieceResult>(bytes);
  const std::uint64_t first = pieces.first_of(piece), blocks = pieces.count_of(piece);
  const std::size_t count = (bytes.size() - sizeof(PieceResult)) / sizeof(StoredCluster);
  std::vector<StoredCluster> clusters;
  for (std::size_t i = 0; i < count; ++i) {
    clusters.push_back(record_at<StoredCluster>(bytes.subspan(sizeof(PieceResult) + i * sizeof(StoredCluster))));
    const StoredCluster& one = clusters.back();
    if (one.block < first || one.block - first >= blocks || !std::isfinite(one.rank)) return false;
  }
  if (kept.first_block != first) return false;
  pieces_.push_back(kept);
  clusters_.insert(clusters_.end(), clusters.begin(), clusters.end());
  return true;
}

// Records a piece as finished. If `row` is given, first stores the low samples of this row.
bool VolumeEncoder::finish_piece(const std::string& work, int level, std::optional<std::uint32_t> row,
                                 const PieceBegin& begin, LevelSlices& slices) {
  PieceResult& result = pieces_[begin.pieces];
  const Extent low = slices.low();
  result.low = store_.size();
  if (row && level < level_count(extent_)) {
    std::vector<std::int32_t> samples(std::size_t{low[0]} * low[1]);
    for (std::uint32_t z = *row * kBlockEdge; z < std::min(low[2], (*row + 1) * kBlockEdge); ++z) {
      copy_slice(slices.slice(2 * z), {samples.data(), low[0]}, low);
      if (!store_.append(std::as_bytes(std::span(samples)))) return cannot_store();
    }
  }
  std::vector<std::byte> record;
  const auto add = [&](std::span<const std::byte> bytes) { record.insert(record.end(), bytes.begin(), bytes.end()); };
  add(std::as_bytes(std::span(&result, 1)));
  add(std::as_bytes(std::span(clusters_).subspan(begin.clusters)));
  return store_.finish(work, begin.offset, record) || cannot_store();
}

bool VolumeEncoder::cannot_store() {
  problem_ = EncodeError{"cannot keep the clusters: " + store_.problem()};
  return false;
}

bool VolumeEncoder::take(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane) {
  // With a limited size, earlier blocks determine the clusters that later blocks need. So the size of a part must not
  // depend on the number of threads.
  const std::uint32_t part = least_ ? kBlocksBetween : kBlocksAtOnce;
  for (std::uint32_t i = 0; i < count; i += part) {
    // Each piece has its own sum of errors, so that the total does not depend on the ranks.
    if (i % kBlocksAtOnce == 0) pieces_.push_back({first + i, 0, 0});
    if (!take_part(first + i, std::min(part, count - i), slices, last_plane)) return false;
  }
  return true;
}

bool VolumeEncoder::take_part(std::uint64_t first, std::uint32_t count, LevelSlices& slices, int last_plane) {
  std::vector<BlockEncoder::Result> results(count);
  const float least_rank = least_ ? least_->rank() : 0;
  const bool whole = parallel_for(
      count,
      [&](std::size_t i) {
        thread_local BlockEncoder encoder;
        const BlockPlace place = layout_.place(first + i);
        // Errors of coarse bands spread over many samples, so each level needs two thirds of a plane more.
        const int last = std::max(0, last_plane - 2 * (place.level - 1) / 3);
        const std::optional<BlockBands> before = before_ ? std::optional(before_->bands_of(place)) : std::nullopt;
        encoder.encode(static_cast<std::uint32_t>(first + i), place, slices.bands_of(place),
                       {last, least_rank, !least_}, before ? &*before : nullptr);
        results[i] = encoder.take();
      },
      threads_, progress_);
  if (!whole) return false;
  for (BlockEncoder::Result& result : results) {
    pieces_.back().rest += result.rest;
    if (least_) least_->add(result.clusters);
    for (StoredCluster& cluster : result.clusters) {
      cluster.offset += store_.size();
      clusters_.push_back(cluster);
    }
    if (!store_.append(result.bytes)) return cannot_store();
  }
  if (least_) least_->update();
  return true;
}

// Collects the results of all ranks. Adds the errors in the order of the blocks, so that the sum depends neither on the
// ranks nor on the order of the work.
void VolumeEncoder::collect() {
  clusters_ = gather_records(ranks_, std::span<const StoredCluster>(clusters_));
  pieces_ = gather_records(ranks_, std::span<const PieceResult>(pieces_));
  std::ranges::sort(pieces_, {}, &PieceResult::first_block);
  rest_ = 0;
  for (const PieceResult& piece : pieces_) rest_ += piece.rest;
}

}  // namespace gs::qnv::values
