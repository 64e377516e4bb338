#include "app/formats/common/byte_order.h"
#include "app/formats/ply/ply_table.h"
#include "app/formats/splats/ply_harmonics.h"
#include "app/formats/splats/splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
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

/// Tables of a file. The tables of chunks and harmonics may be too short for all splats.
struct CompressedTables {
  PlyTable chunks, splats;
  std::optional<PlyTable> harmonics;
  std::array<std::size_t, 4> offsets{};  // of the packed numbers in a row of `splats`
  int degree = 0;                        // of the harmonics
};

/// Reads the spherical harmonics of the splats from index `first` on.
void read_coefficients(const PlyTable& table, std::size_t first, SplatModel& model) {
  if (first >= table.rows) return;
  const PlyTable part = part_of(table, first, std::min(model.size(), table.rows - first));
  for_coefficients(model, [&](std::size_t channel, std::size_t number, std::size_t column) {
    const std::vector<float> values = part.column("f_rest_" + std::to_string(column));
    for (std::size_t i = 0; i < values.size(); ++i) {
      // 0 and 255 are -4 and 4; others lie in the middle of their steps.
      const float u = values[i], share = u <= 0 ? 0 : u >= 255 ? 1 : (u + 0.5f) / 256;
      model.coefficient(i, number)[static_cast<int>(channel)] = (share - 0.5f) * 8;
    }
  });
}

std::optional<std::string> read_range(const CompressedTables& tables, std::size_t first, std::size_t count,
                                      const WorldBudget& budget, SplatModel& model) {
  model.set_degree(tables.degree);
  if (auto problem = model.draw(budget, count)) return problem;
  model.format = "PlayCanvas compressed PLY";
  model.announced = count;
  model.resize(count);
  const std::size_t chunk = first / kChunkSplats, end = (first + count + kChunkSplats - 1) / kChunkSplats;
  const std::vector<Chunk> chunks = read_chunks(part_of(tables.chunks, chunk, end - chunk));
  const std::size_t stride = tables.splats.element.least_row_bytes();
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* row = tables.splats.data.data() + (first + i) * stride;
    std::array<std::uint32_t, 4> packed{};
    for (std::size_t k = 0; k < 4; ++k) packed[k] = load_little<std::uint32_t>(row + tables.offsets[k]);
    unpack(chunks[(first + i) / kChunkSplats - chunk], packed, model, i);
  }
  if (tables.harmonics && tables.degree > 0) read_coefficients(*tables.harmonics, first, model);
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

OpenedSplatRows open_compressed_ply_rows(std::span<const std::byte> bytes, const WorldBudget& budget) {
  const auto tables = std::make_shared<CompressedTables>();
  const auto open = [&](const char* element, PlyTable& table) -> std::optional<std::string> {
    auto opened = open_ply_table(bytes, element, budget);
    if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
    table = std::move(std::get<PlyTable>(opened));
    return std::nullopt;
  };
  if (auto problem = open("chunk", tables->chunks)) return std::move(*problem);
  if (auto problem = open("vertex", tables->splats)) return std::move(*problem);
  const PlyTable& splats = tables->splats;
  if (!find_packed(splats.element, tables->offsets))
    return "not compressed splats: expected packed_position, packed_rotation, packed_scale and packed_color as uint";
  if (splats.header.format != PlyFormat::little_endian) return "compressed splats: expected binary_little_endian";
  if (!tables->chunks.has("min_x") || !tables->chunks.has("max_scale_z"))
    return "compressed splats: expected min_x to max_scale_z in element chunk";
  SplatRows rows;
  rows.count = splats.rows / kChunkSplats < tables->chunks.rows ? splats.rows : tables->chunks.rows * kChunkSplats;
  rows.announced = splats.element.count;
  const PlyTable* last = &splats;
  for (const PlyElement& element : splats.header.elements)
    if (element.name == "sh") tables->degree = harmonics_degree(element);
  if (tables->degree > 0) {
    if (auto problem = open("sh", tables->harmonics.emplace())) return std::move(*problem);
    if (tables->harmonics->data.data() > last->data.data()) last = &*tables->harmonics;
  }
  rows.start = last->data.empty() ? 0 : static_cast<std::size_t>(last->data.data() - bytes.data());
  rows.row_bytes = last->element.least_row_bytes();
  rows.read = [tables](std::size_t first, std::size_t count, const WorldBudget& own, SplatModel& model) {
    return read_range(*tables, first, count, own, model);
  };
  return rows;
}

ImportedVectors import_splats_compressed_ply(std::span<const std::byte> bytes, const WorldBudget& budget) {
  return import_rows(open_compressed_ply_rows(bytes, budget), budget);
}

}  // namespace gs::app
