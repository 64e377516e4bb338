#include "qnv/codecs/values/labels/encode/label_pyramid.h"

#include "base/nth_type.h"
#include "base/parallel.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/stored_code.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace gs::qnv::values {

namespace {

constexpr char kNoLabels[] = "numbers that are not labels; expected whole numbers from -2^31 to 2^32 - 1";

template <class Use>
void with_voxels(VoxelType type, Use&& use) {
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(type), use);
}

/// Reader of stored voxels as codes. Numbers of float64 become those of 32-bit integers.
class CodeReader {
 public:
  explicit CodeReader(const VolumeLayout& layout) : layout_(layout) {}

  /// Converts voxels. Returns false if one is not a whole number of at most 32 bits.
  bool read(std::span<const std::byte> stored, std::span<std::uint32_t> codes) {
    const bool swap = layout_.big_endian != (std::endian::native == std::endian::big);
    with_voxels(layout_.type, [&]<class T>(T) {
      for (std::size_t i = 0; i < codes.size(); ++i) {
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), stored.data() + i * sizeof(T), sizeof(T));
        if (swap) std::reverse(raw.begin(), raw.end());
        codes[i] = code_of_number(std::bit_cast<T>(raw));
      }
    });
    return good();
  }
  [[nodiscard]] bool good() const { return whole_ && (least_ >= 0 || most_ < 2147483648.0); }
  /// Replaces the range of the numbers by that of all ranks. Collective.
  void join(Ranks& ranks) {
    const std::array<double, 2> own{least_, most_};
    const auto all = gather_records(ranks, std::span<const double>(own));
    for (std::size_t i = 0; i + 1 < all.size(); i += 2) {
      least_ = std::min(least_, all[i]);
      most_ = std::max(most_, all[i + 1]);
    }
  }
  /// Returns the type of the numbers that the codes stand for.
  [[nodiscard]] VoxelType type() const {
    return layout_.type != VoxelType::f64 ? layout_.type : least_ < 0 ? VoxelType::i32 : VoxelType::u32;
  }

 private:
  template <class T>
  std::uint32_t code_of_number(T number) {
    if constexpr (!std::is_floating_point_v<T>) {
      return static_cast<std::uint32_t>(number);
    } else {
      const auto wide = static_cast<double>(number);
      if (!(wide >= -2147483648.0 && wide < 4294967296.0) || wide != std::floor(wide)) {
        whole_ = false;
        return 0;
      }
      if constexpr (std::is_same_v<T, float>) return code_of(number);
      least_ = std::min(least_, wide);
      most_ = std::max(most_, wide);
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(wide));
    }
  }

  const VolumeLayout& layout_;
  bool whole_ = true;
  double least_ = 0, most_ = 0;  // of float64
};

/// Codes that occur, in ascending order.
class CodeSet {
 public:
  explicit CodeSet(VoxelType type) : few_(size_of(type) <= 2 ? std::size_t{1} << 16 : 0) {}

  void add(std::span<const std::uint32_t> codes) {
    if (!few_.empty()) {
      for (const std::uint32_t code : codes) few_[code & 0xffff] = true;  // a negative number has the upper bits, too
      return;
    }
    std::vector<std::uint32_t> fresh;
    for (std::size_t i = 0; i < codes.size(); ++i)
      if (i == 0 || codes[i] != codes[i - 1]) fresh.push_back(codes[i]);
    std::ranges::sort(fresh);
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    std::vector<std::uint32_t> joined;
    std::ranges::set_union(all_, fresh, std::back_inserter(joined));
    all_ = std::move(joined);
  }
  [[nodiscard]] std::vector<std::uint32_t> take(VoxelType type) {
    const bool is_signed = type == VoxelType::i8 || type == VoxelType::i16;
    for (std::size_t i = 0; i < few_.size(); ++i)
      if (few_[i]) {
        const auto code = static_cast<std::uint32_t>(i);
        all_.push_back(is_signed && i >= 32768 ? code | 0xffff0000u : code);
      }
    return std::move(all_);
  }

 private:
  std::vector<bool> few_;
  std::vector<std::uint32_t> all_;
};

// Returns the label of a coarser voxel from the labels of at most eight voxels.
std::uint32_t frequent(std::span<const std::uint32_t> labels, std::span<const std::uint64_t> counts) {
  std::uint32_t best = labels[0];
  std::ptrdiff_t votes = 0;
  for (const std::uint32_t label : labels) {
    const std::ptrdiff_t now = std::ranges::count(labels, label);
    if (now > votes || (now == votes && counts[label] < counts[best])) {
      votes = now;
      best = label;
    }
  }
  return best;
}

/// Makes a level from the next finer one, piece by piece.
class LevelHalving {
 public:
  LevelHalving(const StoredLabels& fine, std::span<const std::uint64_t> counts) : fine_(fine), counts_(counts) {}

  /// Returns a piece of the coarser level. Any thread.
  [[nodiscard]] StoredLabels::Packed piece(const Extent& at) const {
    Extent first{}, last{};  // pieces of the finer level
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = 2 * at[a];
      last[a] = std::min(first[a] + 2, fine_.pieces()[a]);
    }
    if (const auto label = common(first, last)) return {{}, *label};
    thread_local std::vector<std::uint32_t> box, part;
    constexpr Extent kPiece{kTileEdge, kTileEdge, StoredLabels::kDepth};
    Extent size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = std::min(2 * kPiece[a], fine_.extent()[a] - first[a] * kPiece[a]);
    box.resize(sample_count(size));
    each(first, last, [&](const Extent& one) {
      const Extent its = fine_.size_of(one);
      part.resize(sample_count(its));
      (void)fine_.read(one, part);
      for (std::uint32_t z = 0; z < its[2]; ++z)
        for (std::uint32_t y = 0; y < its[1]; ++y)
          std::copy_n(&part[(std::size_t{z} * its[1] + y) * its[0]], its[0],
                      &box[((std::size_t{(one[2] - first[2]) * kPiece[2]} + z) * size[1] +
                            (one[1] - first[1]) * kPiece[1] + y) *
                               size[0] +
                           (one[0] - first[0]) * kPiece[0]]);
      return true;
    });
    return StoredLabels::pack(halve(box, size));
  }

 private:
  template <class Visit>
  static bool each(const Extent& first, const Extent& last, Visit&& visit) {
    for (std::uint32_t z = first[2]; z < last[2]; ++z)
      for (std::uint32_t y = first[1]; y < last[1]; ++y)
        for (std::uint32_t x = first[0]; x < last[0]; ++x)
          if (!visit(Extent{x, y, z})) return false;
    return true;
  }
  // Returns the label that all voxels of some pieces have.
  [[nodiscard]] std::optional<std::uint32_t> common(const Extent& first, const Extent& last) const {
    const auto label = fine_.uniform(first);
    const bool equal = label && each(first, last, [&](const Extent& one) { return fine_.uniform(one) == label; });
    return equal ? label : std::nullopt;
  }
  [[nodiscard]] std::vector<std::uint32_t> halve(std::span<const std::uint32_t> fine, const Extent& size) const {
    const Extent to = low_extent(size, 1);
    std::vector<std::uint32_t> made;
    made.reserve(sample_count(to));
    std::array<std::uint32_t, 8> labels;
    for (std::uint32_t z = 0; z < to[2]; ++z)
      for (std::uint32_t y = 0; y < to[1]; ++y)
        for (std::uint32_t x = 0; x < to[0]; ++x) {
          std::size_t count = 0;
          bool equal = true;
          for (std::uint32_t k = 2 * z; k < std::min(2 * z + 2, size[2]); ++k)
            for (std::uint32_t j = 2 * y; j < std::min(2 * y + 2, size[1]); ++j)
              for (std::uint32_t i = 2 * x; i < std::min(2 * x + 2, size[0]); ++i) {
                labels[count] = fine[(std::size_t{k} * size[1] + j) * size[0] + i];
                equal = equal && labels[count++] == labels[0];
              }
          made.push_back(equal ? labels[0] : frequent(std::span(labels).first(count), counts_));
        }
    return made;
  }

  const StoredLabels& fine_;
  std::span<const std::uint64_t> counts_;
};

/// Reader of all steps into a store.
class PyramidReader {
 public:
  PyramidReader(std::span<const VolumeSource> steps, SharedStore& store, Ranks& ranks, unsigned threads,
                Progress* progress)
      : sources_(steps),
        store_(store),
        ranks_(ranks),
        threads_(threads),
        progress_(progress),
        set_(steps.front().layout.type) {}

  std::variant<LabelPyramid, EncodeError> read() {
    const VolumeLayout& layout = sources_.front().layout;
    start("reading", std::uint64_t{layout.dimensions[2]} * sources_.size() / ranks_.count());
    CodeReader reader(layout);
    for (const VolumeSource& source : sources_) {
      if (source.layout.dimensions != layout.dimensions || source.layout.type != layout.type)
        return EncodeError{"the steps of a series of labels have different sizes or types; expected equal ones"};
      if (auto problem = join_level(made_.steps.emplace_back().emplace_back(layout.dimensions, store_),
                                    [&](StoredLabels& level) { return store_codes(source, reader, level); }))
        return std::move(*problem);
    }
    reader.join(ranks_);
    if (!reader.good()) return EncodeError{"the label volume has " + std::string(kNoLabels)};
    made_.stored = reader.type();
    std::vector<std::uint32_t> codes = set_.take(layout.type);
    codes = gather_records(ranks_, std::span<const std::uint32_t>(codes));
    std::ranges::sort(codes);
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
    made_.palette = std::make_shared<const LabelPalette>(std::move(codes));
    if (made_.palette->groups() > LabelPalette::kMostGroups ||
        encode_label_palette(*made_.palette).size() > LabelPalette::kMostBytes)
      return EncodeError{"the volume has " + std::to_string(made_.palette->size()) +
                         " different labels far apart; expected at most 100,000 of them"};
    if (auto problem = agree(ranks_, count())) return std::move(*problem);
    start("reducing", static_cast<std::uint64_t>(level_count(layout.dimensions)) * sources_.size());
    for (LabelPyramid::Levels& levels : made_.steps)
      for (int level = level_count(layout.dimensions); level > 0; --level) {
        if (auto problem = reduce(levels)) return std::move(*problem);
        if (progress_) ++progress_->done;
      }
    return std::move(made_);
  }

 private:
  void start(const char* stage, std::uint64_t total) const {
    if (!progress_) return;
    progress_->stage = stage;
    progress_->done = 0;
    progress_->total = total;
  }

  // Packs the pieces of a layer in several threads, then stores them in order.
  template <class Pack>
  void store_layer(StoredLabels& level, const Pack& pack) {
    const std::size_t nx = level.pieces()[0], count = nx * level.pieces()[1];
    std::vector<StoredLabels::Packed> packed(count);
    parallel_for(
        count,
        [&](std::size_t i) {
          packed[i] = pack(static_cast<std::uint32_t>(i % nx), static_cast<std::uint32_t>(i / nx));
        },
        count < 16 ? 1 : threads_);
    for (const StoredLabels::Packed& piece : packed) (void)level.append(piece);
  }

  // Fills a level with `fill`, which adds the layers of this rank and may return an error. Then joins those of all
  // ranks.
  template <class Fill>
  std::optional<EncodeError> join_level(StoredLabels& level, const Fill& fill) {
    std::optional<EncodeError> problem = fill(level);
    store_.publish();
    if (!problem && store_.failed()) problem = cannot_keep();
    if ((problem = agree(ranks_, problem))) return problem;
    level.join(ranks_);
    return std::nullopt;
  }
  [[nodiscard]] EncodeError cannot_keep() const { return {"cannot keep the labels: " + store_.problem()}; }

  std::optional<EncodeError> store_codes(const VolumeSource& source, CodeReader& reader, StoredLabels& level) {
    const VolumeLayout& layout = source.layout;
    const std::size_t slice = slice_voxels(layout);
    std::vector<std::byte> stored(slice * size_of(layout.type));
    std::vector<std::uint32_t> codes(slice * StoredLabels::kDepth);
    const RankShare layers = share_of(ranks_, level.pieces()[2]);
    const auto end =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(layers.end * StoredLabels::kDepth, layout.dimensions[2]));
    for (auto z = static_cast<std::uint32_t>(layers.first * StoredLabels::kDepth); z < end; ++z) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      if (!source.read(z, stored)) return EncodeError{"slice " + std::to_string(z) + " of the volume cannot be read"};
      const std::uint32_t in_layer = z % StoredLabels::kDepth;
      const auto here = std::span(codes).subspan(in_layer * slice, slice);
      if (!reader.read(stored, here))
        return EncodeError{"slice " + std::to_string(z) + " of the label volume has " + kNoLabels};
      set_.add(here);
      if (progress_) ++progress_->done;
      if (in_layer + 1 < StoredLabels::kDepth && z + 1 < end) continue;
      store_layer(level, [&](std::uint32_t x, std::uint32_t y) {
        thread_local std::vector<std::uint32_t> part;
        part.clear();
        const Extent size = level.size_of({x, y, z / StoredLabels::kDepth});
        for (std::uint32_t k = 0; k < size[2]; ++k)
          for (std::uint32_t j = 0; j < size[1]; ++j) {
            const auto row = codes.begin() + static_cast<std::ptrdiff_t>(
                                                 k * slice + (std::size_t{y} * kTileEdge + j) * layout.dimensions[0] +
                                                 std::size_t{x} * kTileEdge);
            part.insert(part.end(), row, row + size[0]);
          }
        return StoredLabels::pack(part);
      });
      if (store_.failed()) return cannot_keep();
    }
    return std::nullopt;
  }

  // Counts the voxels of each label. Each rank counts its layers.
  std::optional<EncodeError> count() {
    made_.counts.assign(made_.palette->size(), 0);
    for (LabelPyramid::Levels& levels : made_.steps) {
      StoredLabels& level = levels.front();
      level.set_palette(made_.palette);
      const Extent pieces = level.pieces();
      const RankShare layers = share_of(ranks_, pieces[2]);
      for (auto z = static_cast<std::uint32_t>(layers.first); z < layers.end; ++z)
        for (std::uint32_t y = 0; y < pieces[1]; ++y)
          for (std::uint32_t x = 0; x < pieces[0]; ++x)
            level.each_run({x, y, z}, [&](std::uint32_t label, std::size_t voxels) { made_.counts[label] += voxels; });
    }
    const auto all = gather_records(ranks_, std::span<const std::uint64_t>(made_.counts));
    std::ranges::fill(made_.counts, std::uint64_t{0});
    for (std::size_t i = 0; i < all.size(); ++i) made_.counts[i % made_.counts.size()] += all[i];
    return store_.failed() ? std::optional(cannot_keep()) : std::nullopt;
  }

  // Adds the next coarser level. Each rank makes some of its layers.
  std::optional<EncodeError> reduce(LabelPyramid::Levels& levels) {
    const LevelHalving halving(levels.back(), made_.counts);
    StoredLabels coarse(low_extent(levels.back().extent(), 1), store_);
    auto problem = join_level(coarse, [&](StoredLabels& level) -> std::optional<EncodeError> {
      const RankShare layers = share_of(ranks_, level.pieces()[2]);
      for (auto z = static_cast<std::uint32_t>(layers.first); z < layers.end; ++z) {
        if (is_cancelled(progress_)) return EncodeError{"cancelled"};
        store_layer(level, [&](std::uint32_t x, std::uint32_t y) { return halving.piece({x, y, z}); });
      }
      return std::nullopt;
    });
    if (!problem) levels.push_back(std::move(coarse));
    return problem;
  }

  std::span<const VolumeSource> sources_;
  SharedStore& store_;
  Ranks& ranks_;
  unsigned threads_;
  Progress* progress_;
  CodeSet set_;
  LabelPyramid made_;
};

}  // namespace

std::variant<LabelPyramid, EncodeError> read_labels(std::span<const VolumeSource> steps, SharedStore& store,
                                                    Ranks& ranks, unsigned threads, Progress* progress) {
  const VolumeLayout& layout = steps.front().layout;
  if (const auto problem = check(layout)) return EncodeError{problem->message};
  const std::uint64_t voxels = voxel_count(layout);
  const std::uint32_t longest = *std::ranges::max_element(layout.dimensions);
  if (voxels > kMostSamples || longest > kMaxLabelEdge)
    return EncodeError{"the label volume has " + std::to_string(voxels) + " voxels, " + std::to_string(longest) +
                       " along an axis; expected at most " + std::to_string(kMostSamples) + " and " +
                       std::to_string(kMaxLabelEdge)};
  return PyramidReader(steps, store, ranks, threads, progress).read();
}

}  // namespace gs::qnv::values
