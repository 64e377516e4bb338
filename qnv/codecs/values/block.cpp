#include "qnv/codecs/values/block.h"

#include "qnv/codecs/values/coefficients.h"
#include "qnv/codecs/values/plane_coding.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

namespace gs::qnv::values {

namespace {

// Halves the unit of sizes. The next bit of each coefficient is not known yet.
void halve_unit(std::vector<std::uint8_t>& sizes) {
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  std::uint8_t* const at = sizes.data();
  for (std::size_t i = 0; i + sizeof(Bytes) <= sizes.size(); i += sizeof(Bytes)) {
    Bytes bytes;
    std::memcpy(&bytes, at + i, sizeof bytes);
    bytes += bytes;
    const Bytes large = Bytes(bytes > 4);
    bytes = (large & 4) | (~large & bytes);
    std::memcpy(at + i, &bytes, sizeof bytes);
  }
}

}  // namespace

BlockBands bands_in_volume(const BlockPlace& place, std::span<std::int32_t> volume, Extent extent) {
  BlockBands bands;
  bands.row = extent[0];
  for (std::uint32_t i = 0; i < place.band_count; ++i) {
    const BandPart& part = place.bands[i];
    for (std::uint32_t z = 0; z < part.size[2]; ++z) {
      const std::size_t at = ((std::size_t{part.first[2]} + z) * extent[1] + part.first[1]) * extent[0] + part.first[0];
      if (at < volume.size()) bands.parts[i][z] = volume.data() + at;
    }
  }
  return bands;
}

Block::Block(const BlockPlace& place)
    : place_(place), shape_(BlockShape::of(place)), cubes_(shape_->cubes().size()), active_(shape_->flag_bytes()) {}

int Block::load(const BlockBands& bands) {
  values_.assign(cubes_.size() * kCubeSize, 0);
  errors_.resize(cubes_.size());
  tops_.resize(cubes_.size());
  std::uint32_t bits = 0;
  std::uint32_t* to = values_.data();
  for (std::size_t i = 0; i < cubes_.size(); ++i, to += kCubeSize) {
    const BlockShape::Cube& cube = shape_->cubes()[i];
    for (std::uint32_t z = 0; z < cube.size[2]; ++z) {
      const std::int32_t* from = bands.parts[cube.band][cube.at[2] * kCubeEdge + z] +
                                 cube.at[1] * kCubeEdge * bands.row + cube.at[0] * kCubeEdge;
      for (std::uint32_t y = 0; y < cube.size[1]; ++y, from += bands.row)
        load_line(from, cube.size[0], to + (z * kCubeEdge + y) * kCubeEdge);
    }
    std::uint32_t top = 0;
    for (std::size_t k = 0; k < kCubeSize; ++k) top |= to[k];
    tops_[i] = top & ~kSign;
    bits |= tops_[i];
    errors_[i] = tops_[i] == 0 ? 0 : squared_error(to, std::bit_width(tops_[i]));
    cubes_[i].values = -1;
  }
  return std::bit_width(bits) - 1;
}

double Block::energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < cubes_.size(); ++i)
    energy += errors_[i] * error_weight(place_.level, place_.bands[shape_->cubes()[i].band].highs);
  return energy;
}

void Block::write(std::size_t number, const BlockBands& bands) const {
  const BlockShape::Cube& cube = shape_->cubes()[number];
  const std::uint32_t* from = values_.data() + static_cast<std::size_t>(cubes_[number].values) * kCubeSize;
  const std::uint32_t middle = middle_above(cubes_[number].lowest);
  for (std::uint32_t z = 0; z < cube.size[2]; ++z)
    for (std::uint32_t y = 0; y < cube.size[1]; ++y)
      add_line(from + (z * kCubeEdge + y) * kCubeEdge, cube.size[0], middle,
               bands.parts[cube.band][cube.at[2] * kCubeEdge + z] + (cube.at[1] * kCubeEdge + y) * bands.row +
                   cube.at[0] * kCubeEdge);
}

void Block::write(const BlockBands& bands) const {
  for (std::size_t i = 0; i < cubes_.size(); ++i)
    if (cubes_[i].values >= 0) write(i, bands);
}

void Block::write_low(std::span<std::int32_t> bands, Extent extent) const {
  const BlockBands in_volume = bands_in_volume(place_, bands, extent);
  for (std::size_t i = 0; i < cubes_.size(); ++i)
    if (cubes_[i].values >= 0 && place_.bands[shape_->cubes()[i].band].highs == 0) write(i, in_volume);
}

Extent Block::band_place(const BlockShape::Cube& cube) const {
  Extent at{};
  for (std::size_t a = 0; a < 3; ++a) at[a] = (place_.first[a] >> place_.level) + cube.at[a] * kCubeEdge;
  return at;
}

void Block::write_split(const SplitWindow& window) const {
  const std::size_t row = window.row, slice = row * window.size[1];
  for (std::size_t b = 0; b < shape_->bands().size(); ++b) {
    const BandPart& part = place_.bands[b];
    const BlockShape::Band& band = shape_->bands()[b];
    if (part.highs == 0) continue;
    Extent base{}, high{}, low_end{}, first{}, last{};  // places in the band, and cubes in the window
    for (std::size_t a = 0; a < 3; ++a) {
      base[a] = place_.first[a] >> place_.level;
      high[a] = part.first[a] != base[a] ? 1 : 0;
      low_end[a] = std::min(base[a] + part.size[a], (window.first[a] + window.size[a] - high[a] + 1) / 2);
      first[a] = (std::max(base[a], window.first[a] / 2) - base[a]) / kCubeEdge;
      last[a] = low_end[a] > base[a] ? (low_end[a] - base[a] + kCubeEdge - 1) / kCubeEdge : 0;
    }
    for (std::uint32_t k = first[2]; k < last[2]; ++k)
      for (std::uint32_t j = first[1]; j < last[1]; ++j)
        for (std::uint32_t i = first[0]; i < last[0]; ++i) {
          const std::size_t number = band.first_cube + (k * band.cubes[1] + j) * band.cubes[0] + i;
          if (cubes_[number].values < 0) continue;
          const BlockShape::Cube& cube = shape_->cubes()[number];
          const Extent at = band_place(cube);
          const std::uint32_t* from = values_.data() + static_cast<std::size_t>(cubes_[number].values) * kCubeSize;
          const std::uint32_t middle = middle_above(cubes_[number].lowest);
          Extent begin{}, end{};
          for (std::size_t a = 0; a < 3; ++a) {
            begin[a] = std::max(at[a], window.first[a] / 2);
            end[a] = std::min(at[a] + cube.size[a], low_end[a]);
          }
          if (begin[0] >= end[0] || begin[1] >= end[1]) continue;
          from += ((begin[2] - at[2]) * kCubeEdge + (begin[1] - at[1])) * kCubeEdge + (begin[0] - at[0]);
          std::int32_t* to = window.samples + (2 * begin[2] + high[2] - window.first[2]) * slice +
                             (2 * begin[1] + high[1] - window.first[1]) * row + (high[0] != 0 ? window.odd : 0) +
                             (begin[0] - window.first[0] / 2);
          for (std::uint32_t z = begin[2]; z < end[2]; ++z, from += kCubeEdge * kCubeEdge, to += 2 * slice)
            for (std::uint32_t y = 0; y < end[1] - begin[1]; ++y)
              add_line(from + y * kCubeEdge, end[0] - begin[0], middle, to + 2 * y * row);
        }
  }
}

void Block::fill_sizes(std::vector<std::uint8_t>& sizes) const {
  sizes.assign(shape_->size_bytes(), 0);
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    if (cubes_[i].values < 0) continue;
    const BlockShape::Cube& cube = shape_->cubes()[i];
    const BlockShape::Band& band = shape_->bands()[cube.band];
    const std::uint32_t* const values = values_.data() + static_cast<std::size_t>(cubes_[i].values) * kCubeSize;
    std::array<std::uint8_t, kCubeSize> all;
    for (std::uint32_t k = 0; k < kCubeSize; ++k)
      all[k] = static_cast<std::uint8_t>(std::min((values[k] & ~kSign) >> plane_, kMaxSize));
    const std::uint8_t* from = all.data();
    for (std::uint32_t z = 0; z < kCubeEdge; ++z)
      for (std::uint32_t y = 0; y < kCubeEdge; ++y, from += kCubeEdge)
        std::memcpy(sizes.data() + cube.first + z * band.slice + y * band.row, from, kCubeEdge);
  }
}

std::size_t Block::cube_context(const BlockShape::Cube& cube) const {
  const BlockShape::Band& band = shape_->bands()[cube.band];
  const std::uint8_t* const flag = active_.data() + cube.flag;
  const std::size_t row = band.flag_row, slice = band.flag_slice;
  const std::uint32_t active =
      std::uint32_t{flag[-1]} + flag[1] + *(flag - row) + flag[row] + *(flag - slice) + flag[slice];
  const std::uint32_t other = cube.before < 0 ? 0 : 1u + active_.data()[cube.before];
  return std::min<std::uint32_t>(active, 4) * 3 + other;
}

void Block::activate(std::size_t number) {
  active_[shape_->cubes()[number].flag] = 1;
  if (!errors_.empty()) {
    cubes_[number].values = static_cast<std::int16_t>(number);
    return;
  }
  cubes_[number].values = static_cast<std::int16_t>(values_.size() / kCubeSize);
  values_.resize(values_.size() + kCubeSize, 0);
}

template <class Side>
void Block::step(Side& side, std::uint8_t* sizes) {
  constexpr bool kEncodes = std::is_same_v<Side, EncodingSide>;
  const BlockShape::Cube& shape = shape_->cubes().data()[cube_];
  Cube& cube = cubes_.data()[cube_];
  if (cube.values < 0) {
    bool any = false;
    if constexpr (kEncodes) any = tops_[cube_] >> plane_ != 0;
    if (side.code(models_.cubes.data()[cube_context(shape)], any)) activate(cube_);
  }
  if (cube.values >= 0) {
    side.values = values_.data() + static_cast<std::size_t>(cube.values) * kCubeSize;
    const BlockShape::Band& band = shape_->bands().data()[shape.band];
    code_cube(side, models_, band.highs, {sizes + shape.first, band.row, band.slice, shape.size});
    cube.lowest = static_cast<std::uint8_t>(plane_);
  }
  if (++cube_ == cubes_.size()) {
    cube_ = 0;
    --plane_;
  }
}

Block::Encoded Block::encode(std::size_t plane_bytes, std::size_t most_bytes, int last_plane, BlockScratch& scratch) {
  EncodingSide side{RangeWriter(scratch.bytes.data()), nullptr, plane_};
  // The last byte may change.
  const auto size = [&] { return std::max<std::size_t>(side.coder.size(scratch.bytes.data()), 1) - 1; };
  Encoded encoded;
  if (fresh_) scratch.sizes.assign(shape_->size_bytes(), 0);
  fresh_ = false;
  do {
    const std::size_t number = cube_;
    step(side, scratch.sizes.data());
    ++encoded.steps;
    if (cubes_[number].values >= 0) {
      const double after = squared_error(values_.data() + number * kCubeSize, side.plane);
      encoded.gain +=
          (errors_[number] - after) * error_weight(place_.level, place_.bands[shape_->cubes()[number].band].highs);
      errors_[number] = after;
    }
    if (at_plane_start()) {
      halve_unit(scratch.sizes);
      side.plane = plane_;
      if (plane_ < last_plane || size() >= plane_bytes) break;
    }
  } while (size() < most_bytes);
  encoded.bytes = std::span(scratch.bytes).first(side.coder.finish(scratch.bytes.data()));
  return encoded;
}

std::size_t Block::decode(std::span<const CodedSteps> clusters, BlockScratch& scratch) {
  if (plane_ < 0 || cubes_.empty() || clusters.empty()) return 0;
  fill_sizes(scratch.sizes);
  std::size_t all = 0;
  for (const CodedSteps& cluster : clusters) {
    scratch.padded.assign(cluster.bytes.begin(), cluster.bytes.end());
    scratch.padded.resize(cluster.bytes.size() + kMostCubeBytes);
    const std::byte* const end = scratch.padded.data() + cluster.bytes.size();
    DecodingSide side{RangeReader(scratch.padded.data()), nullptr, plane_};
    std::size_t done = 0;
    while (done < cluster.steps && !side.coder.exhausted(end)) {
      step(side, scratch.sizes.data());
      ++done;
      if (!at_plane_start()) continue;
      if (plane_ < 0) return all + done;
      halve_unit(scratch.sizes);
      side.plane = plane_;
    }
    all += done;
  }
  return all;
}

}  // namespace gs::qnv::values
