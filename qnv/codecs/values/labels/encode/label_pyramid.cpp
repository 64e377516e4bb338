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
#include <string>
#include <type_traits>
#include <utility>

namespace gs::qnv::values {

namespace {

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
    return whole_ && (least_ >= 0 || most_ < 2147483648.0);
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

LabelGrid coarser(const LabelGrid& fine, std::span<const std::uint64_t> counts, unsigned threads) {
  LabelGrid grid;
  grid.extent = low_extent(fine.extent, 1);
  grid.labels.resize(sample_count(grid.extent));
  const auto [nx, ny, nz] = fine.extent;
  const auto halve_slice = [&, nx = nx, ny = ny, nz = nz](std::size_t z) {
    std::uint32_t* to = &grid.labels[z * grid.extent[0] * grid.extent[1]];
    std::array<std::uint32_t, 8> labels;
    for (std::uint32_t y = 0; y < grid.extent[1]; ++y)
      for (std::uint32_t x = 0; x < grid.extent[0]; ++x) {
        std::size_t count = 0;
        bool equal = true;
        for (std::size_t k = 2 * z; k < std::min<std::size_t>(2 * z + 2, nz); ++k)
          for (std::size_t j = 2 * y; j < std::min(2 * y + 2, ny); ++j)
            for (std::size_t i = 2 * x; i < std::min(2 * x + 2, nx); ++i) {
              labels[count] = fine.labels[(k * ny + j) * nx + i];
              equal = equal && labels[count++] == labels[0];
            }
        *to++ = equal ? labels[0] : frequent(std::span(labels).first(count), counts);
      }
  };
  parallel_for(grid.extent[2], halve_slice, threads);
  return grid;
}

}  // namespace

std::variant<LabelPyramid, EncodeError> read_labels(const VolumeSource& source, unsigned threads, Progress* progress) {
  const VolumeLayout& layout = source.layout;
  if (const auto problem = check(layout)) return EncodeError{problem->message};
  const std::uint64_t voxels = voxel_count(layout);
  const std::uint32_t longest = *std::ranges::max_element(layout.dimensions);
  if (voxels > kMostSamples || longest > kMaxLabelEdge)
    return EncodeError{"the label volume has " + std::to_string(voxels) + " voxels, " + std::to_string(longest) +
                       " along an axis; expected at most " + std::to_string(kMostSamples) + " and " +
                       std::to_string(kMaxLabelEdge)};
  LabelPyramid made;
  made.levels.push_back({layout.dimensions, {}});
  std::vector<std::uint32_t>& all = made.levels.front().labels;
  all.resize(voxels);
  const std::size_t slice = slice_voxels(layout);
  std::vector<std::byte> stored(slice * size_of(layout.type));
  CodeReader reader(layout);
  CodeSet set(layout.type);
  if (progress) {
    progress->stage = "reading";
    progress->done = 0;
    progress->total = layout.dimensions[2];
  }
  for (std::uint32_t z = 0; z < layout.dimensions[2]; ++z) {
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (!source.read(z, stored)) return EncodeError{"slice " + std::to_string(z) + " of the volume cannot be read"};
    const auto codes = std::span(all).subspan(z * slice, slice);
    if (!reader.read(stored, codes))
      return EncodeError{
          "slice " + std::to_string(z) +
          " of the label volume has numbers that are no labels; expected whole numbers from -2^31 to 2^32 - 1"};
    set.add(codes);
    if (progress) progress->done = z + 1;
  }
  made.stored = reader.type();
  made.palette = LabelPalette(set.take(layout.type));
  if (made.palette.groups() > LabelPalette::kMostGroups ||
      encode_label_palette(made.palette).size() > LabelPalette::kMostBytes)
    return EncodeError{"the volume has " + std::to_string(made.palette.size()) +
                       " different labels far apart; expected at most 100,000 of them"};
  made.counts.assign(made.palette.size(), 0);
  std::uint32_t code = made.palette.code(0), index = 0;
  for (std::uint32_t& label : all) {
    if (label != code) {
      code = label;
      index = made.palette.index(code).value_or(0);
    }
    label = index;
    ++made.counts[index];
  }
  for (int level = level_count(layout.dimensions); level > 0; --level)
    made.levels.push_back(coarser(made.levels.back(), made.counts, threads));
  return made;
}

}  // namespace gs::qnv::values
