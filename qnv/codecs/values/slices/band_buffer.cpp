#include "qnv/codecs/values/slices/band_buffer.h"

#include <algorithm>
#include <cstddef>

namespace gs::qnv::values {

namespace {

// Calls visit(band, z, y) for each row of a block.
template <class Visit>
void each_row(const BlockPlace& place, const Visit& visit) {
  for (std::uint32_t b = 0; b < place.band_count; ++b)
    for (std::uint32_t z = 0; z < place.bands[b].size[2]; ++z)
      for (std::uint32_t y = 0; y < place.bands[b].size[1]; ++y) visit(b, z, y);
}

std::int32_t wrapped_sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}
std::int32_t wrapped_difference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

}  // namespace

void BandBuffer::prepare() {
  constexpr std::size_t kSlice = std::size_t{kBlockEdge} * kBlockEdge;
  if (!values_.empty()) return;
  values_.resize(bands_.parts.size() * kBlockEdge * kSlice);
  std::int32_t* next = values_.data();
  for (auto& part : bands_.parts)
    for (std::int32_t*& slice : part) {
      slice = next;
      next += kSlice;
    }
  bands_.row = kBlockEdge;
}

void BandBuffer::clear(const BlockPlace& place) {
  prepare();
  each_row(place, [&](std::uint32_t b, std::uint32_t z, std::uint32_t y) {
    std::fill_n(bands_.parts[b][z] + y * kBlockEdge, kBlockEdge, 0);
  });
}

void BandBuffer::subtract(const BlockPlace& place, const BlockBands& a, const BlockBands& b) {
  prepare();
  each_row(place, [&](std::uint32_t band, std::uint32_t z, std::uint32_t y) {
    const std::int32_t* const from = a.parts[band][z] + y * a.row;
    std::transform(from, from + place.bands[band].size[0], b.parts[band][z] + y * b.row,
                   bands_.parts[band][z] + y * kBlockEdge, wrapped_difference);
  });
}

void BandBuffer::add_to(const BlockPlace& place, const BlockBands& to) const {
  each_row(place, [&](std::uint32_t band, std::uint32_t z, std::uint32_t y) {
    std::int32_t* const sum = to.parts[band][z] + y * to.row;
    std::transform(sum, sum + place.bands[band].size[0], bands_.parts[band][z] + y * kBlockEdge, sum, wrapped_sum);
  });
}

void BandBuffer::copy_to(const BlockPlace& place, const BlockBands& to) const { copy_bands(place, bands_, to); }

void copy_bands(const BlockPlace& place, const BlockBands& from, const BlockBands& to) {
  each_row(place, [&](std::uint32_t band, std::uint32_t z, std::uint32_t y) {
    std::copy_n(from.parts[band][z] + y * from.row, place.bands[band].size[0], to.parts[band][z] + y * to.row);
  });
}

}  // namespace gs::qnv::values
