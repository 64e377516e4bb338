#include "app/insitu/arrays/grid_parts.h"

#include "qnv/sampling/volume/volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace gs::app::insitu {
namespace {

// Approximate size of a message, small to bound the buffers.
constexpr std::size_t kMessageBytes = std::size_t{1} << 20;

void fill_missing(qnv::VoxelType type, std::span<std::byte> values) {
  if (type != qnv::VoxelType::f32) {
    std::ranges::fill(values, std::byte{0});
    return;
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i + sizeof nan <= values.size(); i += sizeof nan) std::memcpy(&values[i], &nan, sizeof nan);
}

// Returns the number of slices of a part that fit into one message, at least 1.
std::uint32_t slices_of_message(const GridBox& box, std::size_t value_bytes) {
  const std::size_t slice = std::max<std::size_t>(std::size_t{box.size[0]} * box.size[1] * value_bytes, 1);
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(kMessageBytes / slice, 1, box.size[2]));
}

// Sends the parts. `message` has the capacity of a message.
bool send_parts(Ranks& ranks, const std::vector<GridPart>& parts, std::uint32_t components, std::size_t value_bytes,
                std::vector<std::byte>& message) {
  const std::uint64_t count = parts.size();
  if (!ranks.send(&count, sizeof count)) return false;
  for (const GridPart& part : parts) {
    if (!ranks.send(&part.box, sizeof part.box)) return false;
    const GridBox& box = part.box;
    const std::size_t pitch = box.size[0] * value_bytes, slice = pitch * box.size[1];
    const std::uint32_t step = slices_of_message(box, value_bytes);
    for (std::uint32_t c = 0; c < components; ++c)
      for (std::uint32_t z = 0; z < box.size[2]; z += step) {
        const std::uint32_t end = std::min(z + step, box.size[2]);
        message.resize(slice * (end - z));
        for (std::uint32_t at = z; at < end; ++at) part.copy_slice(c, at, message.data() + slice * (at - z), pitch);
        if (!ranks.send(message.data(), message.size())) return false;
      }
  }
  return true;
}

// Copies rows of a slab of a box to their places in a grid.
void place_slab(const GridBox& box, std::uint32_t z, std::uint32_t slices, const std::byte* from, std::uint32_t c,
                std::size_t value_bytes, GridValues& values) {
  const auto& size = values.size;
  const std::size_t row = box.size[0] * value_bytes;
  for (std::uint32_t k = 0; k < slices; ++k)
    for (std::uint32_t y = 0; y < box.size[1]; ++y, from += row) {
      const std::size_t at =
          ((std::size_t{c} * size[2] + box.first[2] + z + k) * size[1] + box.first[1] + y) * size[0] + box.first[0];
      std::memcpy(values.bytes.data() + at * value_bytes, from, row);
    }
}

// Receives the parts of a rank. `message` has the capacity of a message.
bool receive_parts(Ranks& ranks, int from, std::size_t value_bytes, GridValues& values,
                   std::vector<std::byte>& message) {
  std::uint64_t count = 0;
  if (!ranks.receive(&count, sizeof count, from)) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    GridBox box;
    if (!ranks.receive(&box, sizeof box, from)) return false;
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a)
      inside = inside && box.size[a] > 0 && std::uint64_t{box.first[a]} + box.size[a] <= values.size[a];
    if (!inside) return false;
    const std::size_t slice = std::size_t{box.size[0]} * box.size[1] * value_bytes;
    const std::uint32_t step = slices_of_message(box, value_bytes);
    for (std::uint32_t c = 0; c < values.field.components; ++c)
      for (std::uint32_t z = 0; z < box.size[2]; z += step) {
        const std::uint32_t slices = std::min(step, box.size[2] - z);
        message.resize(slice * slices);
        if (!ranks.receive(message.data(), message.size(), from)) return false;
        place_slab(box, z, slices, message.data(), c, value_bytes, values);
      }
  }
  return true;
}

std::int64_t ceil_divided(std::int64_t a, std::int64_t b) { return a >= 0 ? (a + b - 1) / b : -((-a) / b); }

}  // namespace

std::variant<BlockView, std::string> block_view(const gs_insitu_block& block) {
  BlockView view;
  std::array<std::int64_t, 3> points{};
  constexpr std::int64_t kMaxPoints = std::int64_t{1} << 31;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t first = block.whole_extent[2 * a], last = block.whole_extent[2 * a + 1];
    const std::int64_t low = block.extent[2 * a], high = block.extent[2 * a + 1];
    if (last < first || first < -kMaxPoints || last > kMaxPoints)
      return "whole_extent is empty or too large; expected first <= last along each axis";
    if (high < low || low < -kMaxPoints || high > kMaxPoints)
      return "the extent of a block is empty or too large; expected first <= last along each axis";
    points[a] = high - low + 1;
    view.grid.origin[a] = block.origin[a];
    view.grid.spacing[a] = block.spacing[a] == 0 ? 1 : block.spacing[a];
    if (!std::isfinite(block.origin[a]) || !std::isfinite(block.spacing[a]) || block.spacing[a] < 0)
      return "origin or spacing of a block is not finite; expected numbers, with a spacing above 0";
    for (const std::size_t side : {2 * a, 2 * a + 1}) {
      view.grid.whole[side] = block.whole_extent[side];
      view.extent[side] = block.extent[side];
      view.ghost[side] = block.ghost[side];
      if (block.ghost[side] < 0) return "a block has a negative number of ghost layers; expected 0 or more";
    }
  }
  if (block.field_count > kMaxFields) return "a block has more than 16 fields; expected at most 16";
  if (block.field_count > 0 && !block.fields) return "the fields of a block are missing; expected their address";
  for (std::size_t i = 0; i < block.field_count; ++i) {
    std::array<std::int64_t, 3> sizes = points;
    if (block.fields[i].association == GS_INSITU_CELLS)
      for (std::int64_t& size : sizes) size = std::max<std::int64_t>(size - 1, 1);
    auto field = field_view(block.fields[i], sizes);
    if (auto* problem = std::get_if<std::string>(&field)) return std::move(*problem);
    view.fields.push_back(std::move(std::get<FieldView>(field)));
  }
  return view;
}

void GridPart::copy_slice(std::uint32_t c, std::uint32_t z, std::byte* to, std::size_t pitch) const {
  for (std::uint32_t y = 0; y < box.size[1]; ++y, to += pitch)
    copy_values(field.type,
                field.at(start[0], start[1] + std::int64_t{y} * thinning, start[2] + std::int64_t{z} * thinning, c),
                field.strides[0] * thinning, box.size[0], to);
}

void GridPart::copy_floats(std::uint32_t z, float* to) const {
  for (std::uint32_t y = 0; y < box.size[1]; ++y, to += box.size[0])
    insitu::copy_floats(
        field.type, field.at(start[0], start[1] + std::int64_t{y} * thinning, start[2] + std::int64_t{z} * thinning, 0),
        field.strides[0] * thinning, box.size[0], to);
}

std::vector<GridPart> grid_parts(std::span<const BlockView> blocks, const FieldFacts& field, std::uint32_t thinning) {
  std::vector<GridPart> parts;
  for (const BlockView& block : blocks) {
    const FieldView* const found = find_field(block.fields, field);
    if (!found) continue;
    GridPart part;
    part.field = *found;
    part.thinning = thinning;
    bool any = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t whole = block.grid.whole[2 * a], low = block.extent[2 * a];
      const bool flat = block.grid.whole[2 * a + 1] == whole;
      const std::int64_t less = found->of_cells && !flat ? 1 : 0;
      const std::int64_t first = std::max(low + block.ghost[2 * a], whole);
      const std::int64_t last =
          std::min(block.extent[2 * a + 1] - block.ghost[2 * a + 1], block.grid.whole[2 * a + 1]) - less;
      const std::int64_t begin = ceil_divided(first - whole, thinning);
      const std::int64_t end = last < whole ? -1 : (last - whole) / thinning;
      any = any && begin <= end;
      if (!any) break;
      part.box.first[a] = static_cast<std::uint32_t>(begin);
      part.box.size[a] = static_cast<std::uint32_t>(end - begin + 1);
      part.start[a] = whole + begin * thinning - low;
    }
    if (any) parts.push_back(std::move(part));
  }
  return parts;
}

void GridValues::read(std::uint32_t c, std::uint32_t z, std::span<std::byte> slice) const {
  const std::size_t value_bytes = qnv::size_of(type), whole = std::size_t{size[0]} * size[1] * value_bytes;
  if (slice.size() < whole) return;
  if (!bytes.empty()) {
    std::memcpy(slice.data(), bytes.data() + (std::size_t{c} * size[2] + z) * whole, whole);
    return;
  }
  fill_missing(type, slice.first(whole));
  for (const GridPart& part : parts) {
    if (z < part.box.first[2] || z - part.box.first[2] >= part.box.size[2]) continue;
    part.copy_slice(c, z - part.box.first[2],
                    slice.data() + (std::size_t{part.box.first[1]} * size[0] + part.box.first[0]) * value_bytes,
                    size[0] * value_bytes);
  }
}

bool gather_grid(Ranks& ranks, std::span<const BlockView> blocks, const StepPlan& plan, const FieldFacts& field,
                 bool copy, GridValues& values, bool& complete) {
  const std::size_t value_bytes = qnv::size_of(stored_type(field.type));
  std::vector<GridPart> parts;
  std::vector<std::byte> message;
  // All memory is allocated before the first message.
  const bool ready = ranks.attempt("grid", [&] {
    parts = grid_parts(blocks, field, plan.thinning);
    values.size = grid_size(plan.grid, field.of_cells != 0, plan.thinning);
    const std::size_t slice = std::size_t{values.size[0]} * values.size[1] * value_bytes;
    if (ranks.count() > 1) message.reserve(std::max(kMessageBytes, slice));
    if (!ranks.is_first()) return;
    values.field = field;
    values.grid = plan.grid;
    values.thinning = plan.thinning;
    values.type = stored_type(field.type);
    values.parts = parts;
    if (ranks.count() == 1 && !copy) return;
    std::vector<std::byte> bytes(slice * values.size[2] * field.components);
    for (std::uint32_t c = 0; c < field.components; ++c)
      for (std::uint32_t z = 0; z < values.size[2]; ++z)
        values.read(c, z, std::span(bytes).subspan((std::size_t{c} * values.size[2] + z) * slice, slice));
    values.bytes = std::move(bytes);
    values.parts.clear();
  });
  if (!ranks.agree(ready, complete)) return false;
  if (!complete) return true;
  if (!ranks.is_first()) return send_parts(ranks, parts, field.components, value_bytes, message);
  for (int from = 1; from < ranks.count(); ++from)
    if (!receive_parts(ranks, from, value_bytes, values, message)) return false;
  return true;
}

}  // namespace gs::app::insitu
