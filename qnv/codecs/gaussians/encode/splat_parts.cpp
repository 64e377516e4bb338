#include "qnv/codecs/gaussians/encode/splat_parts.h"

#include "base/box.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Floats of a splat without harmonics: position, scales, rotation, opacity, colour.
constexpr std::size_t kSplatFloats = 14;
// Size of a block of a part.
constexpr std::size_t kBlockFloats = std::size_t{1} << 14;

std::size_t floats_of(std::size_t per) { return kSplatFloats + 3 * per; }

}  // namespace

SpaceCells::SpaceCells(std::vector<glm::vec3> positions, std::size_t most) {
  (void)divide(positions, std::max<std::size_t>(most, 1));
}

std::uint32_t SpaceCells::divide(std::span<glm::vec3> positions, std::size_t most) {
  const auto own = static_cast<std::uint32_t>(planes_.size());
  planes_.emplace_back();
  const auto end_as_cell = [&] {
    planes_[own].below = static_cast<std::uint32_t>(cells_++);
    return own;
  };
  if (positions.size() <= most) return end_as_cell();
  Box box;
  for (const glm::vec3& p : positions) box.add(p);
  const glm::vec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = positions.begin() + static_cast<std::ptrdiff_t>(positions.size() / 2);
  std::ranges::nth_element(positions, middle, {}, [axis](const glm::vec3& p) { return p[axis]; });
  const float at = (*middle)[axis];
  const auto above =
      std::partition(positions.begin(), positions.end(), [&](const glm::vec3& p) { return p[axis] < at; });
  const auto below = static_cast<std::size_t>(above - positions.begin());
  if (below == 0) return end_as_cell();  // half of the positions or more are equal along the longest axis
  const std::uint32_t first = divide(positions.first(below), most), second = divide(positions.subspan(below), most);
  planes_[own] = {axis, at, first, second};
  return own;
}

std::size_t SpaceCells::cell_of(const glm::vec3& position) const {
  std::uint32_t at = 0;
  while (planes_[at].axis >= 0)
    at = position[planes_[at].axis] < planes_[at].at ? planes_[at].below : planes_[at].above;
  return planes_[at].below;
}

PartWriter::PartWriter(const SpaceCells& cells, int degree, SharedStore& store)
    : cells_(cells), per_(harmonic_count(degree)), store_(store), open_(cells.size()) {}

bool PartWriter::flush(std::size_t cell) {
  std::vector<float>& floats = open_[cell];
  const std::size_t splats = floats.size() / floats_of(per_);
  if (splats == 0) return true;
  const auto offset = store_.add(std::as_bytes(std::span(floats)));
  if (!offset) return false;
  done_.push_back({*offset, static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(splats)});
  floats.clear();
  return true;
}

bool PartWriter::add(const Gaussians& splats) {
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const std::size_t cell = cells_.cell_of(splats.positions[i]);
    std::vector<float>& floats = open_[cell];
    const auto put = [&floats](const auto& v, int count) {
      for (int k = 0; k < count; ++k) floats.push_back(v[k]);
    };
    put(splats.positions[i], 3);
    put(splats.scales[i], 3);
    put(splats.rotations[i], 4);
    floats.push_back(splats.opacities[i]);
    put(splats.bases[i], 3);
    for (std::size_t k = 0; k < per_; ++k) put(splats.harmonics[i * per_ + k], 3);
    if (floats.size() >= kBlockFloats && !flush(cell)) return false;
  }
  return true;
}

std::optional<std::vector<CellBlock>> PartWriter::finish() {
  for (std::size_t cell = 0; cell < open_.size(); ++cell) {
    if (!flush(cell)) return std::nullopt;
    open_[cell] = {};
  }
  return std::move(done_);
}

std::vector<StoredPart> parts_of(std::vector<CellBlock> blocks, int degree, std::size_t most) {
  std::ranges::stable_sort(blocks, {}, &CellBlock::cell);
  const std::size_t bytes = floats_of(harmonic_count(degree)) * sizeof(float);
  std::vector<StoredPart> parts;
  std::uint32_t cell = 0;
  for (CellBlock block : blocks)
    while (block.splats > 0) {
      if (parts.empty() || block.cell != cell || parts.back().splats == most) parts.emplace_back();
      cell = block.cell;
      StoredPart& part = parts.back();
      const auto some = static_cast<std::uint32_t>(std::min<std::size_t>(block.splats, most - part.splats));
      part.blocks.push_back({block.offset, some});
      part.splats += some;
      block.offset += some * bytes;
      block.splats -= some;
    }
  return parts;
}

std::optional<Gaussians> read_part(const StoredPart& part, int degree, const SharedStore& store) {
  Gaussians splats;
  splats.degree = degree;
  const std::size_t per = harmonic_count(degree), floats = floats_of(per);
  splats.positions.reserve(part.splats);
  splats.scales.reserve(part.splats);
  splats.rotations.reserve(part.splats);
  splats.opacities.reserve(part.splats);
  splats.bases.reserve(part.splats);
  splats.harmonics.reserve(per * part.splats);
  std::vector<float> block;
  for (const StoredPart::Block& at : part.blocks) {
    block.resize(at.splats * floats);
    if (!store.read(at.offset, std::as_writable_bytes(std::span(block)))) return std::nullopt;
    for (std::size_t i = 0; i < at.splats; ++i) {
      const float* const v = block.data() + i * floats;
      splats.positions.emplace_back(v[0], v[1], v[2]);
      splats.scales.emplace_back(v[3], v[4], v[5]);
      splats.rotations.emplace_back(v[6], v[7], v[8], v[9]);
      splats.opacities.push_back(v[10]);
      splats.bases.emplace_back(v[11], v[12], v[13]);
      for (std::size_t k = 0; k < per; ++k) {
        const float* const c = v + kSplatFloats + 3 * k;
        splats.harmonics.emplace_back(c[0], c[1], c[2]);
      }
      splats.description.box.add(splats.positions.back());
    }
  }
  return splats;
}

}  // namespace gs::qnv::gaussians
