#include "app/formats/common/byte_order.h"
#include "app/formats/ply/ply_table.h"
#include "app/formats/splats/ply_harmonics.h"
#include "app/formats/splats/splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

namespace gs::app {
namespace {

constexpr std::size_t kChunkSplats = 256;
constexpr std::array<const char*, 4> kPacked = {"packed_position", "packed_rotation", "packed_scale", "packed_color"};
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr const char* kColors[] = {"r", "g", "b"};
constexpr float kMaxLogScale = 20;  // limit of the reference writer

/// Ranges of the packed numbers in a chunk.
struct Chunk {
  glm::dvec3 least_position{0}, most_position{0};
  glm::vec3 least_scale{0}, most_scale{0}, least_color{0}, most_color{1};
};

float unit(std::uint32_t packed, int shift, int bits) {
  const std::uint32_t mask = (1u << bits) - 1;
  return static_cast<float>(packed >> shift & mask) / static_cast<float>(mask);
}
/// Unpacks x, y and z to 0..1. They have 11, 10 and 11 bits.
glm::vec3 unit_vector(std::uint32_t packed) {
  return {unit(packed, 21, 11), unit(packed, 11, 10), unit(packed, 0, 11)};
}
template <class Vector>
Vector between(const Vector& least, const Vector& most, const Vector& t) {
  return {least.x + (most.x - least.x) * t.x, least.y + (most.y - least.y) * t.y, least.z + (most.z - least.z) * t.z};
}

/// Unpacks a rotation. The two highest bits are the index of the largest component of w, x, y, z. The other components
/// have ten bits each.
glm::vec4 rotation_of(std::uint32_t packed) {
  std::array<float, 4> wxyz{};
  const std::uint32_t largest = packed >> 30;
  float rest = 1;
  int shift = 20;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    wxyz[i] = (unit(packed, shift, 10) - 0.5f) * std::numbers::sqrt2_v<float>;
    rest -= wxyz[i] * wxyz[i];
    shift -= 10;
  }
  wxyz[largest] = std::sqrt(std::max(rest, 0.0f));
  return {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
}

std::vector<Chunk> read_chunks(const PlyTable& table) {
  std::vector<Chunk> chunks(table.rows);
  const auto fill = [&](const std::string& name, glm::vec3 Chunk::*member, int k) {
    const std::vector<float> values = table.column(name);
    for (std::size_t i = 0; i < values.size(); ++i) (chunks[i].*member)[k] = values[i];
  };
  const auto fill_places = [&](const std::string& name, glm::dvec3 Chunk::*member, int k) {
    const std::vector<double> values = table.wide_column(name);
    for (std::size_t i = 0; i < values.size(); ++i) (chunks[i].*member)[k] = values[i];
  };
  for (int k = 0; k < 3; ++k) {
    const std::string axis = kAxes[k], color = kColors[k];
    fill_places("min_" + axis, &Chunk::least_position, k);
    fill_places("max_" + axis, &Chunk::most_position, k);
    fill("min_scale_" + axis, &Chunk::least_scale, k);
    fill("max_scale_" + axis, &Chunk::most_scale, k);
    // Older files have no colour range; it stays 0 to 1.
    fill("min_" + color, &Chunk::least_color, k);
    fill("max_" + color, &Chunk::most_color, k);
  }
  return chunks;
}

/// Finds the offsets of the four packed numbers in a row. Returns false if one is missing.
bool find_packed(const PlyElement& element, std::array<std::size_t, 4>& offsets) {
  for (std::size_t k = 0; k < kPacked.size(); ++k) {
    std::size_t offset = 0;
    bool found = false;
    for (const PlyProperty& p : element.properties) {
      found = !p.is_list && p.name == kPacked[k] && p.type == PlyType::uint32;
      if (found) break;
      offset += size_of(p.type);
    }
    if (!found) return false;
    offsets[k] = offset;
  }
  return true;
}

void unpack(const Chunk& chunk, const std::array<std::uint32_t, 4>& packed, SplatModel& model, std::size_t i) {
  const auto [position, rotation, scale, color] = packed;
  model.positions[i] = between(chunk.least_position, chunk.most_position, glm::dvec3(unit_vector(position)));
  model.rotations[i] = rotation_of(rotation);
  const glm::vec3 log_scale = between(chunk.least_scale, chunk.most_scale, unit_vector(scale));
  const glm::vec3 rgb =
      between(chunk.least_color, chunk.most_color, {unit(color, 24, 8), unit(color, 16, 8), unit(color, 8, 8)});
  for (int k = 0; k < 3; ++k) {
    model.scales[i][k] = std::exp(std::clamp(log_scale[k], -kMaxLogScale, kMaxLogScale));
    model.dc[i][k] = (rgb[k] - 0.5f) / kSphericalHarmonic0;
  }
  model.opacities[i] = unit(color, 0, 8);
}

/// Reads the spherical harmonics of a model. Returns a message if memory is exhausted.
std::optional<std::string> read_coefficients(std::span<const std::byte> bytes, const WorldBudget& budget,
                                             SplatModel& model) {
  if (model.degree == 0) return std::nullopt;
  auto opened = open_ply_table(bytes, "sh", budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const PlyTable& table = std::get<PlyTable>(opened);
  for_coefficients(model, [&](std::size_t channel, std::size_t number, std::size_t column) {
    const std::vector<float> values = table.column("f_rest_" + std::to_string(column));
    for (std::size_t i = 0; i < std::min(values.size(), model.size()); ++i) {
      // 0 and 255 are -4 and 4; others lie in the middle of their steps.
      const float u = values[i], share = u <= 0 ? 0 : u >= 255 ? 1 : (u + 0.5f) / 256;
      model.coefficient(i, number)[static_cast<int>(channel)] = (share - 0.5f) * 8;
    }
  });
  return std::nullopt;
}

}  // namespace

bool is_splats_compressed_ply(std::span<const std::byte> bytes) {
  const auto header = ply_header_of(bytes);
  if (!header) return false;
  bool chunk = false, vertex = false;
  std::array<std::size_t, 4> offsets{};
  for (const PlyElement& element : header->elements) {
    chunk = chunk || element.name == "chunk";
    vertex = vertex || (element.name == "vertex" && find_packed(element, offsets));
  }
  return chunk && vertex;
}

ImportedVectors import_splats_compressed_ply(std::span<const std::byte> bytes, const WorldBudget& budget) {
  auto opened_chunks = open_ply_table(bytes, "chunk", budget);
  if (auto* problem = std::get_if<std::string>(&opened_chunks)) return std::move(*problem);
  auto opened = open_ply_table(bytes, "vertex", budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const PlyTable& table = std::get<PlyTable>(opened);
  std::array<std::size_t, 4> offsets{};
  if (!find_packed(table.element, offsets))
    return "not compressed splats: expected packed_position, packed_rotation, packed_scale and packed_color as uint";
  if (table.header.format != PlyFormat::little_endian) return "compressed splats: expected binary_little_endian";
  const PlyTable& chunk_table = std::get<PlyTable>(opened_chunks);
  if (!chunk_table.has("min_x") || !chunk_table.has("max_scale_z"))
    return "compressed splats: expected min_x to max_scale_z in element chunk";

  const std::vector<Chunk> chunks = read_chunks(chunk_table);
  const std::size_t count = std::min(table.rows, chunks.size() * kChunkSplats);
  SplatModel model;
  for (const PlyElement& element : table.header.elements)
    if (element.name == "sh") model.set_degree(harmonics_degree(element));
  if (auto problem = model.draw(budget, count)) return std::move(*problem);
  model.format = "PlayCanvas compressed PLY";
  model.announced = static_cast<std::size_t>(std::min<std::uint64_t>(table.element.count, SIZE_MAX));
  model.resize(count);
  const std::size_t stride = table.element.least_row_bytes();
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* row = table.data.data() + i * stride;
    std::array<std::uint32_t, 4> packed{};
    for (std::size_t k = 0; k < 4; ++k) packed[k] = load_little<std::uint32_t>(row + offsets[k]);
    unpack(chunks[i / kChunkSplats], packed, model, i);
  }
  if (auto problem = read_coefficients(bytes, budget, model)) return std::move(*problem);
  return import_result(model);
}

}  // namespace gs::app
