#include "qnv/codecs/values/block_shape.h"

#include <algorithm>

namespace gs::qnv::values {

BlockShape::BlockShape(const BlockPlace& place) {
  std::uint32_t sizes = 0, flags = 0;
  for (std::uint32_t i = 0; i < place.band_count; ++i) {
    const BandPart& part = parts_[i] = place.bands[i];
    Band band;
    for (std::size_t a = 0; a < 3; ++a)
      band.cubes[a] = static_cast<std::uint8_t>((part.size[a] + kCubeEdge - 1) / kCubeEdge);
    band.highs = static_cast<std::uint8_t>(part.highs);
    band.row = band.cubes[0] * kCubeEdge + 8;
    band.slice = band.row * (band.cubes[1] * kCubeEdge + 2);
    band.flag_row = band.cubes[0] + 2u;
    band.flag_slice = band.flag_row * (band.cubes[1] + 2u);
    band.first_cube = static_cast<std::uint16_t>(cubes_.size());
    const std::uint32_t first = sizes + band.slice + band.row + 4,
                        first_flag = flags + band.flag_slice + band.flag_row + 1;
    const bool same = i > 0 && bands_.back().cubes == band.cubes;
    for (std::uint8_t z = 0; z < band.cubes[2]; ++z)
      for (std::uint8_t y = 0; y < band.cubes[1]; ++y)
        for (std::uint8_t x = 0; x < band.cubes[0]; ++x) {
          Cube cube;
          cube.band = static_cast<std::uint8_t>(i);
          cube.at = {x, y, z};
          for (std::size_t a = 0; a < 3; ++a)
            cube.size[a] = static_cast<std::uint8_t>(std::min(kCubeEdge, part.size[a] - cube.at[a] * kCubeEdge));
          cube.first = first + kCubeEdge * (z * band.slice + y * band.row + x);
          cube.flag = first_flag + z * band.flag_slice + y * band.flag_row + x;
          if (same)
            cube.before =
                static_cast<std::int32_t>(cubes_[bands_.back().first_cube + cubes_.size() - band.first_cube].flag);
          cubes_.push_back(cube);
        }
    sizes += band.slice * (band.cubes[2] * kCubeEdge + 2);
    flags += band.flag_slice * (band.cubes[2] + 2u);
    bands_.push_back(band);
  }
  size_bytes_ = (sizes + 8 + 15) / 16 * 16;
  flag_bytes_ = flags;
}

bool BlockShape::suits(const BlockPlace& place) const {
  if (place.band_count != bands_.size()) return false;
  for (std::uint32_t i = 0; i < place.band_count; ++i)
    if (place.bands[i].size != parts_[i].size || place.bands[i].highs != parts_[i].highs) return false;
  return true;
}

std::shared_ptr<const BlockShape> BlockShape::of(const BlockPlace& place) {
  // Most blocks of a volume have the size of the one before.
  thread_local std::shared_ptr<const BlockShape> last;
  if (!last || !last->suits(place)) last = std::make_shared<const BlockShape>(place);
  return last;
}

}  // namespace gs::qnv::values
