#include "qnv/codecs/records/records_payload.h"

#include "base/bytes.h"

#include <algorithm>
#include <cmath>

namespace gs::qnv {
namespace {

constexpr double kCells = 1u << kDeepestRecordsCell;

std::variant<RecordsHeader, RecordsError> decode_records_header(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  RecordsHeader header;
  header.layer = in.integer<std::uint8_t>();
  header.cell.depth = in.integer<std::uint8_t>();
  header.count = in.integer<std::uint16_t>();
  for (std::uint32_t* at : {&header.cell.x, &header.cell.y, &header.cell.z}) *at = in.integer<std::uint32_t>();
  for (int axis = 0; axis < 3; ++axis) header.frame.lower[axis] = in.f32();
  for (int axis = 0; axis < 3; ++axis) header.frame.cell[axis] = in.f32();
  header.frame.weight_step = in.f32();
  header.cell_weight = in.f32();
  if (header.cell.depth > kDeepestRecordsCell)
    return RecordsError{"a records chunk of cell depth " + std::to_string(header.cell.depth) + "; expected 0 to 20"};
  const std::uint32_t cells = 1u << header.cell.depth;
  if (header.cell.x >= cells || header.cell.y >= cells || header.cell.z >= cells)
    return RecordsError{"a records chunk of cell " + std::to_string(header.cell.x) + " " +
                        std::to_string(header.cell.y) + " " + std::to_string(header.cell.z) + "; expected below " +
                        std::to_string(cells)};
  if (!valid(header.frame)) return RecordsError{"a records chunk with an invalid box or weight step"};
  if (!(header.cell_weight >= 0) || !std::isfinite(header.cell_weight))
    return RecordsError{"a records chunk with an invalid cell weight; expected at least 0"};
  return header;
}

// Collects the indices and bytes of the records that are not in the ranges `missing`.
void collect(std::span<const std::byte> records, std::span<const ByteRange> missing, RecordsPatch& patch,
             std::vector<std::byte>& whole) {
  const std::size_t count = records.size() / kRecordBytes;
  std::vector<bool> damaged(count);
  for (const ByteRange& range : missing) {
    if (range.first >= range.last || range.last <= kRecordsHeaderBytes) continue;
    const std::size_t first = std::max(range.first, kRecordsHeaderBytes) - kRecordsHeaderBytes;
    const std::size_t last = std::min((range.last - kRecordsHeaderBytes - 1) / kRecordBytes + 1, count);
    for (std::size_t i = first / kRecordBytes; i < last; ++i) damaged[i] = true;
  }
  whole.reserve(records.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (damaged[i]) continue;
    patch.indices.push_back(static_cast<std::uint16_t>(i));
    const auto record = records.subspan(kRecordBytes * i, kRecordBytes);
    whole.insert(whole.end(), record.begin(), record.end());
  }
}

}  // namespace

RecordsCube::RecordsCube(const Box& box) {
  double side = 0;
  for (int axis = 0; axis < 3; ++axis) {
    lower_[static_cast<std::size_t>(axis)] = box.empty() ? 0 : box.lower[axis];
    if (!box.empty()) side = std::max(side, double{box.upper[axis]} - double{box.lower[axis]});
  }
  cells_per_unit_ = side > 0 ? kCells / side : 0;
}

std::array<std::uint32_t, 3> RecordsCube::cell_of(const glm::vec3& position) const { return cell_of(position, {}); }

std::array<std::uint32_t, 3> RecordsCube::cell_of(const glm::vec3& position, const RecordsCell& within) const {
  const unsigned shift = kDeepestRecordsCell - within.depth;
  const std::array<std::uint32_t, 3> first{within.x << shift, within.y << shift, within.z << shift};
  std::array<std::uint32_t, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = (position[static_cast<int>(axis)] - lower_[axis]) * cells_per_unit_;
    const std::uint32_t whole = at > 0 ? static_cast<std::uint32_t>(std::min(at, kCells - 1)) : 0;
    cell[axis] = std::clamp(whole, first[axis], first[axis] + (1u << shift) - 1);
  }
  return cell;
}

std::variant<RecordsPatch, RecordsError> decode_records(std::span<const std::byte> payload,
                                                        std::span<const ByteRange> missing) {
  const bool header_missing = std::any_of(missing.begin(), missing.end(), [](const ByteRange& range) {
    return range.first < std::min(range.last, kRecordsHeaderBytes);
  });
  if (payload.size() < kRecordsHeaderBytes || header_missing)
    return RecordsError{"a records chunk with a truncated header; expected 48 bytes"};
  auto header = decode_records_header(payload.first(kRecordsHeaderBytes));
  if (auto* error = std::get_if<RecordsError>(&header)) return std::move(*error);
  RecordsPatch patch;
  patch.header = std::get<RecordsHeader>(header);
  std::span<const std::byte> records = payload.subspan(kRecordsHeaderBytes);
  if (records.size() > patch.header.count * kRecordBytes)
    return RecordsError{"a records chunk of " + std::to_string(payload.size()) + " bytes; its " +
                        std::to_string(patch.header.count) + " records need " +
                        std::to_string(kRecordsHeaderBytes + patch.header.count * kRecordBytes)};
  std::vector<std::byte> whole;
  collect(records, missing, patch, whole);
  const std::size_t count = patch.indices.size();
  patch.positions.resize(count);
  patch.normals.resize(count);
  patch.weights.resize(count);
  patch.colors.resize(count);
  unpack_records(whole, patch.header.frame, patch.positions.data(), patch.normals.data(), patch.weights.data(),
                 patch.colors.data());
  return patch;
}

}  // namespace gs::qnv
