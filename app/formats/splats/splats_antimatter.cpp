#include "app/formats/common/byte_order.h"
#include "app/formats/splats/splats.h"

namespace gs::app {
namespace {

constexpr std::size_t kRecordBytes = 32;

float color_coefficient(std::byte color) {
  return (static_cast<float>(std::to_integer<int>(color)) / 255 - 0.5f) / kSphericalHarmonic0;
}

}  // namespace

OpenedSplatRows open_antimatter_rows(std::span<const std::byte> bytes, const WorldBudget&) {
  SplatRows rows;
  rows.count = bytes.size() / kRecordBytes;
  if (rows.count == 0) return "the file is too short: expected records of " + std::to_string(kRecordBytes) + " bytes";
  rows.announced = (bytes.size() + kRecordBytes - 1) / kRecordBytes;
  rows.row_bytes = kRecordBytes;
  rows.read = [bytes](std::size_t first, std::size_t count, const WorldBudget& budget, SplatModel& model) {
    auto problem = model.draw(budget, count);
    if (problem) return problem;
    model.format = "antimatter .splat";
    model.announced = count;
    model.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* from = bytes.data() + (first + i) * kRecordBytes;
      for (int k = 0; k < 3; ++k) {
        model.positions[i][k] = static_cast<double>(load_little<float>(from + 4 * k));
        model.scales[i][k] = load_little<float>(from + 12 + 4 * k);
        model.dc[i][k] = color_coefficient(from[24 + k]);
      }
      model.opacities[i] = static_cast<float>(std::to_integer<int>(from[27])) / 255;
      const auto part = [&](int k) { return (static_cast<float>(std::to_integer<int>(from[28 + k])) - 128) / 128; };
      model.rotations[i] = {part(1), part(2), part(3), part(0)};
    }
    return problem;
  };
  return rows;
}

ImportedVectors import_splats_antimatter(std::span<const std::byte> bytes, const WorldBudget& budget) {
  return import_rows(open_antimatter_rows(bytes, budget), budget);
}

}  // namespace gs::app
