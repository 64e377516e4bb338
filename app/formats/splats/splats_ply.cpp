#include "app/formats/ply/ply_table.h"
#include "app/formats/splats/ply_harmonics.h"
#include "app/formats/splats/splats.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace gs::app {
namespace {

constexpr const char* kNeeded[] = {"x", "y", "z", "opacity", "scale_0", "scale_1", "rot_0", "rot_1", "rot_2", "rot_3"};

bool has(const PlyElement& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& p) { return !p.is_list && p.name == name; });
}

float sigmoid(float x) { return 1 / (1 + std::exp(-x)); }

/// Calls store(i, value) for all rows of a column. Returns false and calls nothing if there is no such column.
template <class Store>
bool for_column(const PlyTable& table, std::string_view name, Store&& store) {
  const std::vector<float> values = table.column(name);
  for (std::size_t i = 0; i < values.size(); ++i) store(i, values[i]);
  return !values.empty();
}

}  // namespace

bool is_splats_ply(std::span<const std::byte> bytes) {
  const auto header = ply_header_of(bytes);
  if (!header) return false;
  for (const PlyElement& element : header->elements)
    if (element.name == "vertex")
      return std::all_of(std::begin(kNeeded), std::end(kNeeded), [&](const char* name) { return has(element, name); });
  return false;
}

std::optional<std::string> read_splats(const PlyTable& table, SplatModel& model, const WorldBudget& budget) {
  for (const char* name : kNeeded)
    if (!table.has(name)) return "not Gaussian splats: expected the property '" + std::string(name) + "'";
  model.set_degree(harmonics_degree(table.element));
  if (auto problem = model.draw(budget, table.rows)) return problem;
  const bool flat = !table.has("scale_2");
  model.format = flat ? "2DGS PLY" : "3DGS PLY";
  model.announced = static_cast<std::size_t>(std::min<std::uint64_t>(table.element.count, SIZE_MAX));
  model.resize(table.rows);
  constexpr const char* kPositions[] = {"x", "y", "z"};
  constexpr const char* kScales[] = {"scale_0", "scale_1", "scale_2"};
  constexpr const char* kColors[] = {"f_dc_0", "f_dc_1", "f_dc_2"};
  constexpr const char* kNormals[] = {"nx", "ny", "nz"};
  constexpr const char* kRotations[] = {"rot_1", "rot_2", "rot_3", "rot_0"};  // x, y, z, w; the file has w first
  if (table.has("nx") && table.has("ny") && table.has("nz")) model.normals.resize(table.rows);
  for (int k = 0; k < 3; ++k) {
    const std::vector<double> places = table.wide_column(kPositions[k]);
    for (std::size_t i = 0; i < places.size(); ++i) model.positions[i][k] = places[i];
    for_column(table, kScales[k], [&](std::size_t i, float v) { model.scales[i][k] = std::exp(v); });
    for_column(table, kColors[k], [&](std::size_t i, float v) { model.dc[i][k] = v; });
    if (!model.normals.empty())
      for_column(table, kNormals[k], [&](std::size_t i, float v) { model.normals[i][k] = v; });
  }
  for (int k = 0; k < 4; ++k)
    for_column(table, kRotations[k], [&](std::size_t i, float v) { model.rotations[i][k] = v; });
  for_coefficients(model, [&](std::size_t channel, std::size_t number, std::size_t column) {
    for_column(table, "f_rest_" + std::to_string(column),
               [&](std::size_t i, float v) { model.coefficient(i, number)[static_cast<int>(channel)] = v; });
  });
  model.antialiased = table.header.antialiased;
  for_column(table, "opacity", [&](std::size_t i, float v) { model.opacities[i] = sigmoid(v); });
  return std::nullopt;
}

OpenedSplatRows open_splats_ply_rows(std::span<const std::byte> bytes, const WorldBudget& budget) {
  const auto header = ply_header_of(bytes);
  if (header && header->format == PlyFormat::ascii) return "splats PLY: expected a binary format";
  auto opened = open_ply_table(bytes, "vertex", budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const auto table = std::make_shared<const PlyTable>(std::move(std::get<PlyTable>(opened)));
  SplatRows rows;
  rows.count = table->rows;
  rows.announced = table->element.count;
  rows.start = static_cast<std::size_t>(table->data.data() - bytes.data());
  rows.row_bytes = table->element.least_row_bytes();
  rows.read = [table](std::size_t first, std::size_t count, const WorldBudget& own, SplatModel& model) {
    return read_splats(part_of(*table, first, count), model, own);
  };
  return rows;
}

ImportedVectors import_splats_ply(std::span<const std::byte> bytes, const WorldBudget& budget) {
  auto opened = open_ply_table(bytes, "vertex", budget);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  SplatModel model;
  if (auto problem = read_splats(std::get<PlyTable>(opened), model, budget)) return std::move(*problem);
  return import_result(model);
}

}  // namespace gs::app
