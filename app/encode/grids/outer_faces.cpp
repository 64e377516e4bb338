#include "app/encode/grids/outer_faces.h"

#include "app/formats/vtk/cell_shapes.h"
#include "app/formats/vtk/grid_cells.h"
#include "qnv/base/key_table.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <tuple>
#include <unordered_set>
#include <utility>

namespace gs::app {
namespace {

using qnv::EncodeError;

/// Face of a cell with its key: the space of the points, and the sorted corners.
struct StoredFace {
  std::array<std::int32_t, 4> corners{};  // sorted; for a triangle, the first one is kFaceEnd
  std::uint32_t space = 0;
  OuterFace face;

  [[nodiscard]] auto key() const { return std::tie(space, corners); }
};

/// Consecutive faces in the store, all of one bucket.
struct FaceBlock {
  std::uint64_t offset = 0;
  std::uint32_t bucket = 0, faces = 0;
};

// Maximum number of faces of a cell.
constexpr std::uint64_t kMostFaces = 6;
// Divisors of the memory limit: for the bucket that is compared, for faces that wait for storage, for outer faces.
constexpr std::uint64_t kBucketShare = 16, kWaitingShare = 16, kOuterShare = 8;
constexpr std::uint64_t kLeastMemory = std::uint64_t{1} << 20;
// Maximum size of a bucket, as a multiple of its share.
constexpr std::uint64_t kUneven = 4;
// Minimum number of buckets. It gives up to 16 ranks equal buckets, so that --resume may change the number of ranks.
constexpr std::uint64_t kLeastBuckets = 64;
// Minimum mean number of waiting faces per used bucket for a record. Fewer faces would make small blocks.
constexpr std::size_t kWorthRecording = 64;

/// Returns the records after the first `head` bytes of a result. Returns an empty list if the size does not fit.
template <class Record>
std::vector<Record> records_in(std::span<const std::byte> result, std::size_t head) {
  if (result.size() < head || (result.size() - head) % sizeof(Record) != 0) return {};
  std::vector<Record> records((result.size() - head) / sizeof(Record));
  if (!records.empty())
    std::memcpy(static_cast<void*>(records.data()), result.data() + head, records.size() * sizeof(Record));
  return records;
}

/// Search for the outer faces of one grid.
class FaceSearch {
 public:
  FaceSearch(const LargeGrid& grid, qnv::EncodeRanks& shared, std::uint64_t memory, Progress* progress)
      : grid_(grid),
        shared_(shared),
        memory_(std::max(memory, kLeastMemory)),
        progress_(progress),
        own_(qnv::share_of(shared.ranks(), grid.runs.size())) {
    std::uint64_t cells = 0;
    for (const LargeGrid::Run& run : grid.runs) cells += run.cells;
    const std::uint64_t least = std::max(kLeastBuckets, std::uint64_t{4} * shared.count()),
                        most = std::max<std::uint64_t>(least, 1 << 16);
    buckets_ = static_cast<std::size_t>(
        std::clamp<std::uint64_t>(cells * kMostFaces * sizeof(StoredFace) / (memory_ / kBucketShare) + 1, least, most));
    own_buckets_ = qnv::share_of(shared.ranks(), buckets_);
    waiting_.resize(buckets_);
    most_waiting_ = static_cast<std::size_t>(
        std::clamp<std::uint64_t>(memory_ / kWaitingShare / buckets_ / sizeof(StoredFace), 16, 2048));
  }

  std::variant<std::vector<OuterFace>, EncodeError> run() {
    restore_buckets();
    const std::byte own{compared_.size() == own_buckets_.size() ? std::uint8_t{0} : std::uint8_t{1}};
    const std::vector<std::byte> missing = shared_.ranks().gather(std::span(&own, 1));
    if (std::ranges::count(missing, std::byte{1}) > 0) {
      if (auto failed = shared_.agree(store_faces())) return std::move(*failed);
      std::vector<FaceBlock> blocks = qnv::gather_records<FaceBlock>(shared_.ranks(), blocks_);
      blocks_ = {};
      std::ranges::sort(blocks, {}, &FaceBlock::bucket);
      if (auto failed = shared_.agree(compare(blocks))) return std::move(*failed);
    }
    return deliver();
  }

 private:
  [[nodiscard]] std::string name_of(const char* work, std::uint64_t number) const {
    return std::string(work) + " " + std::to_string(buckets_) + " " + std::to_string(number);
  }

  /// Restores the outer faces of this rank's buckets that --resume has.
  void restore_buckets() {
    for (std::uint64_t bucket = own_buckets_.first; bucket < own_buckets_.end; ++bucket) {
      const auto result = shared_.store().finished(name_of("bucket", bucket));
      if (!result) continue;
      const auto faces = records_in<OuterFace>(*result, 0);
      const bool exist = std::ranges::all_of(faces, [&](const OuterFace& f) { return f.run < grid_.runs.size(); });
      if (!exist || faces.size() * sizeof(OuterFace) != result->size()) continue;
      outer_.insert(outer_.end(), faces.begin(), faces.end());
      compared_.insert(static_cast<std::uint32_t>(bucket));
    }
  }

  /// Restores the blocks of faces that --resume has for the runs from `first` on. Returns the end of these runs, or
  /// `first` if there are none.
  std::uint64_t restore_faces(std::uint64_t first) {
    const auto result = shared_.store().finished(name_of("faces", first));
    std::uint64_t end = 0;
    if (!result || result->size() < sizeof end) return first;
    std::memcpy(&end, result->data(), sizeof end);
    const auto blocks = records_in<FaceBlock>(*result, sizeof end);
    const bool exist = std::ranges::all_of(blocks, [&](const FaceBlock& b) { return b.bucket < buckets_; });
    if (!exist || end <= first || end > own_.end) return first;
    if (auto problem = record_faces(first)) return first;
    blocks_.insert(blocks_.end(), blocks.begin(), blocks.end());
    begin_record(end);
    return end;
  }

  void begin_record(std::uint64_t run) {
    record_run_ = run;
    record_offset_ = shared_.store().size();
    record_blocks_ = blocks_.size();
  }
  /// Stores the waiting faces. Records the runs since the last record, up to `end`, for --resume.
  std::optional<EncodeError> record_faces(std::uint64_t end) {
    for (std::size_t bucket = 0; bucket < buckets_; ++bucket)
      if (!flush(bucket)) return EncodeError{shared_.store().problem()};
    if (end == record_run_) return std::nullopt;
    const auto head = std::as_bytes(std::span(&end, 1)),
               blocks = std::as_bytes(std::span(blocks_).subspan(record_blocks_));
    std::vector<std::byte> result(head.begin(), head.end());
    result.insert(result.end(), blocks.begin(), blocks.end());
    if (!shared_.store().finish(name_of("faces", record_run_), record_offset_, result))
      return EncodeError{shared_.store().problem()};
    begin_record(end);
    return std::nullopt;
  }
  [[nodiscard]] bool worth_recording() const {
    std::size_t faces = 0, used = 0;
    for (const std::vector<StoredFace>& one : waiting_) {
      faces += one.size();
      used += one.empty() ? 0 : 1;
    }
    return faces >= kWorthRecording * used;
  }

  /// Stores the faces of this rank's cells by buckets.
  std::optional<EncodeError> store_faces() {
    LargeGridReader reader(grid_);
    begin_record(own_.first);
    for (std::uint64_t number = own_.first; number < own_.end; ++number) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      for (std::uint64_t first = own_.end; first != number && number < own_.end;)
        number = restore_faces(first = number);
      if (number == own_.end) break;
      const LargeGrid::Run& run = grid_.runs[static_cast<std::size_t>(number)];
      const auto part = reader.part(run.part);
      if (const auto* const problem = std::get_if<std::string>(&part)) return EncodeError{*problem};
      auto read = std::get<GridPartReader*>(part)->cells(run, most_run_corners(memory_));
      if (auto* const problem = std::get_if<std::string>(&read)) return EncodeError{std::move(*problem)};
      if (auto problem =
              store_run(static_cast<std::uint32_t>(number), grid_.parts[run.part].space, std::get<GridRun>(read)))
        return problem;
      if (worth_recording())
        if (auto problem = record_faces(number + 1)) return problem;
      if (progress_) progress_->done += run.cells;
    }
    if (auto problem = record_faces(own_.end)) return problem;
    waiting_ = {};
    return shared_.store().publish() ? std::nullopt : std::optional(EncodeError{shared_.store().problem()});
  }

  std::optional<EncodeError> store_run(std::uint32_t number, std::uint32_t space, const GridRun& cells) {
    for (std::size_t i = 0; i < cells.types.size(); ++i) {
      const GridShape shape = grid_shape(cells.types[i]);
      if (shape.as == GridShape::As::polyhedron)
        return EncodeError{"grids with polyhedra cannot be read in parts; raise --memory"};
      const auto cell = cells.cell(i);
      if (shape.as != GridShape::As::solid || cell.size() < shape.corners) continue;
      for (std::size_t face = 0; face < shape.faces.size(); ++face) {
        const FaceCorners found = face_of(cell, cells.types[i], face);
        if (found.count < 3) continue;
        StoredFace stored;
        stored.corners.fill(kFaceEnd);
        std::ranges::copy(found.list(), stored.corners.begin());
        std::ranges::sort(stored.corners);
        stored.space = space;
        stored.face = {number, static_cast<std::uint32_t>(i << OuterFace::kFaceBits | face)};
        if (!wait(stored)) return EncodeError{shared_.store().problem()};
      }
    }
    return std::nullopt;
  }

  bool wait(const StoredFace& face) {
    // Neighbouring faces often have similar numbers of corners, and then share a bucket. So a run uses few buckets.
    constexpr int kNear = 8;
    const auto least = static_cast<std::uint32_t>(face.corners[face.corners[0] == kFaceEnd ? 1 : 0]);
    const std::uint64_t place = std::uint64_t{face.space} << 32 | least;
    const auto bucket = static_cast<std::size_t>((qnv::mixed_key(place >> kNear) >> 16) % buckets_);
    waiting_[bucket].push_back(face);
    return waiting_[bucket].size() < most_waiting_ || flush(bucket);
  }

  bool flush(std::size_t bucket) {
    std::vector<StoredFace>& faces = waiting_[bucket];
    if (faces.empty()) return true;
    blocks_.push_back(
        {shared_.store().size(), static_cast<std::uint32_t>(bucket), static_cast<std::uint32_t>(faces.size())});
    const bool stored = shared_.store().append(std::as_bytes(std::span(faces)));
    faces.clear();
    return stored;
  }

  /// Compares the faces of this rank's buckets. Keeps those that occur once.
  std::optional<EncodeError> compare(std::span<const FaceBlock> blocks) {
    std::vector<StoredFace> faces;
    auto next =
        std::ranges::lower_bound(blocks, static_cast<std::uint32_t>(own_buckets_.first), {}, &FaceBlock::bucket);
    for (std::uint64_t number = own_buckets_.first; number < own_buckets_.end; ++number) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      const auto bucket = static_cast<std::uint32_t>(number);
      if (compared_.contains(bucket)) {
        while (next != blocks.end() && next->bucket == bucket) ++next;
        continue;
      }
      faces.clear();
      for (; next != blocks.end() && next->bucket == bucket; ++next) {
        const std::size_t before = faces.size();
        if ((before + next->faces) * sizeof(StoredFace) > memory_ / kBucketShare * kUneven)
          return EncodeError{"too many cells share their points; expected a regular grid, or a larger --memory"};
        faces.resize(before + next->faces);
        if (!shared_.store().read(next->offset, std::as_writable_bytes(std::span(faces).subspan(before))))
          return EncodeError{shared_.store().problem()};
      }
      std::ranges::sort(faces, [](const StoredFace& a, const StoredFace& b) { return a.key() < b.key(); });
      const std::size_t found = outer_.size();
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const bool twin = (i > 0 && faces[i - 1].key() == faces[i].key()) ||
                          (i + 1 < faces.size() && faces[i + 1].key() == faces[i].key());
        if (!twin) outer_.push_back(faces[i].face);
      }
      if (outer_.size() * sizeof(OuterFace) > memory_ / kOuterShare)
        return EncodeError{"the grid has too many outer faces; expected fewer, or a larger --memory"};
      if (!shared_.store().finish(name_of("bucket", number), shared_.store().size(),
                                  std::as_bytes(std::span(outer_).subspan(found))))
        return EncodeError{shared_.store().problem()};
    }
    return std::nullopt;
  }

  /// Sends each outer face to the rank that reads its run.
  std::variant<std::vector<OuterFace>, EncodeError> deliver() {
    const auto before = [](const OuterFace& a, const OuterFace& b) {
      return std::tie(a.run, a.place) < std::tie(b.run, b.place);
    };
    std::ranges::sort(outer_, before);
    if (shared_.count() == 1) return std::move(outer_);
    std::vector<std::uint64_t> ends;
    for (std::uint64_t rank = 1; rank <= shared_.count(); ++rank) {
      const auto end = static_cast<std::uint32_t>(grid_.runs.size() * rank / shared_.count());  // like share_of()
      const auto at = std::ranges::lower_bound(outer_, end, {}, &OuterFace::run);
      ends.push_back(static_cast<std::uint64_t>(at - outer_.begin()) * sizeof(OuterFace));
    }
    std::vector<OuterFace> own;
    auto failed = qnv::pass_parts(shared_, std::as_bytes(std::span(outer_)), ends, [&](std::uint64_t bytes) {
      own.resize(static_cast<std::size_t>(bytes / sizeof(OuterFace)));
      return std::as_writable_bytes(std::span(own));
    });
    if (failed) return std::move(*failed);
    outer_ = {};
    std::ranges::sort(own, before);
    return own;
  }

  const LargeGrid& grid_;
  qnv::EncodeRanks& shared_;
  std::uint64_t memory_;
  Progress* progress_;
  qnv::RankShare own_;  // runs that this rank reads
  std::size_t buckets_ = 1, most_waiting_ = 1;
  qnv::RankShare own_buckets_;                        // buckets that this rank compares
  std::unordered_set<std::uint32_t> compared_;        // buckets that --resume restored
  std::uint64_t record_run_ = 0, record_offset_ = 0;  // first run and first byte of the next record
  std::size_t record_blocks_ = 0;                     // first block of the next record
  std::vector<std::vector<StoredFace>> waiting_;      // by bucket
  std::vector<FaceBlock> blocks_;
  std::vector<OuterFace> outer_;
};

}  // namespace

std::size_t most_run_corners(std::uint64_t memory) {
  constexpr std::uint64_t kLeast = 27 * LargeGrid::kRunCells;  // hexahedra of VTK have up to 27 corners
  return static_cast<std::size_t>(std::max(kLeast, memory / 64 / sizeof(double)));
}

FaceCorners face_of(std::span<const std::int32_t> cell, std::size_t type, std::size_t face) {
  FaceCorners made;
  const GridFaceCorners& local = grid_shape(static_cast<std::uint8_t>(type)).faces[face];
  for (const std::int8_t corner : local) {
    if (corner == kNoGridCorner) continue;
    const std::int32_t point = cell[static_cast<std::size_t>(corner)];
    if (made.count == 0 || made.corners[made.count - 1] != point) made.corners[made.count++] = point;
  }
  while (made.count > 1 && made.corners[made.count - 1] == made.corners[0]) --made.count;
  return made;
}

std::variant<std::vector<OuterFace>, EncodeError> outer_faces(const LargeGrid& grid, qnv::EncodeRanks& shared,
                                                              std::uint64_t memory, Progress* progress) {
  return FaceSearch(grid, shared, memory, progress).run();
}

}  // namespace gs::app
