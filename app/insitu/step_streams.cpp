#include "app/insitu/step_streams.h"

#include "app/insitu/arrays/value_colors.h"
#include "qnv/codecs/encode.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gs::app::insitu {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

Pairs step_metadata(const StepData& data, const StreamLimits& limits, const std::string& field,
                    const std::string& unit) {
  Pairs pairs{{"title", limits.title + (field.empty() ? "" : ": " + field)},
              {"source", "GhostSpace in situ"},
              {"step", std::to_string(data.step)},
              {"time", number_text(data.time)}};
  if (!unit.empty()) pairs.emplace_back("sample units", unit);
  return pairs;
}

qnv::EncodeOptions options_of(const StreamLimits& limits) {
  qnv::EncodeOptions options;
  options.threads = std::max(limits.threads, 1U);
  return options;
}

// Returns one component of a grid as a volume.
qnv::VolumeSource volume_of(const GridValues& grid, std::uint32_t component) {
  qnv::VolumeSource source;
  qnv::VolumeLayout& layout = source.layout;
  layout.dimensions = grid.size;
  layout.type = grid.type;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    const double spacing = grid.grid.spacing[a];
    layout.axes[a] = glm::vec3(0);
    layout.axes[a][axis] = static_cast<float>(spacing * grid.thinning);
    // The origin belongs to index 0, but the first point of the grid may have another index.
    layout.origin[axis] = grid.grid.origin[a] + spacing * static_cast<double>(grid.grid.whole[2 * a]);
    const bool flat = grid.grid.whole[2 * a + 1] == grid.grid.whole[2 * a];
    if (grid.field.of_cells != 0 && !flat) layout.origin[axis] += spacing / 2;
  }
  source.read = [&grid, component](std::uint32_t z, std::span<std::byte> slice) {
    grid.read(component, z, slice);
    return true;
  };
  return source;
}

std::variant<StepStream, std::string> encode_grid(const StepData& data, const GridValues& grid,
                                                  const StreamLimits& limits) {
  qnv::VolumeSource source = volume_of(grid, 0);
  if (grid.field.components > 1)
    for (std::uint32_t c = 0; c < grid.field.components; ++c) source.components.push_back(volume_of(grid, c));
  StepStream stream;
  stream.field = grid.field.name.data();
  stream.unit = grid.field.unit.data();
  stream.thinning = grid.thinning;
  qnv::EncodeRequest request{qnv::Payload::values, options_of(limits)};
  request.options.metadata = step_metadata(data, limits, stream.field, stream.unit);
  request.options.tolerance.error = limits.error > 0 ? limits.error : limits.relative_error;
  request.options.tolerance.of_range = limits.error <= 0;
  auto encoded = qnv::encode(std::cref(source), std::move(request));
  if (auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return std::move(problem->message);
  qnv::EncodedStream& made = std::get<qnv::Encoding>(encoded).stream;
  const auto [low, high] = made.header.description.value_range;
  stream.max_error = limits.error > 0 ? limits.error : limits.relative_error * (static_cast<double>(high) - low);
  stream.bytes = std::move(made.bytes);
  return stream;
}

// Appends the stream on success, else a problem with the name of the field.
void take(std::variant<StepStream, std::string> made, const std::string& field, std::vector<StepStream>& streams,
          std::vector<std::string>& problems) {
  if (auto* stream = std::get_if<StepStream>(&made))
    streams.push_back(std::move(*stream));
  else
    problems.push_back("field '" + field + "' cannot be encoded: " + std::get<std::string>(made));
}

}  // namespace

std::uint64_t StepData::bytes() const {
  std::uint64_t all = 0;
  for (const GridValues& grid : grids) all += grid.bytes.size();
  for (const SurfaceValues& surface : surfaces) all += surface.triangles.size() * sizeof(SurfaceTriangle);
  for (const ParticleValues& some : particles) all += some.points.size() * sizeof(ParticlePoint);
  return all;
}

std::uint64_t StepData::grid_bytes() const {
  std::uint64_t all = 0;
  for (const GridValues& grid : grids)
    all += std::uint64_t{grid.size[0]} * grid.size[1] * grid.size[2] * grid.field.components * qnv::size_of(grid.type);
  return all;
}

const char* name_of(StreamKind kind) {
  switch (kind) {
    case StreamKind::volume:
      return "volume";
    case StreamKind::surface:
      return "surface";
    case StreamKind::particles:
      return "particles";
  }
  return "";
}

std::vector<StepStream> encode_step(const StepData& data, const StreamLimits& limits,
                                    std::vector<std::string>& problems) {
  std::vector<StepStream> streams;
  if (data.served)
    streams.push_back({StreamKind::volume,
                       data.served->grid.field,
                       data.served->grid.unit,
                       {},
                       data.served->max_error,
                       data.served->thinning,
                       data.served});
  for (const GridValues& grid : data.grids)
    take(encode_grid(data, grid, limits), grid.field.name.data(), streams, problems);
  for (const SurfaceValues& surface : data.surfaces) {
    StepStream stream{StreamKind::surface, surface.field.name.data(), surface.field.unit.data(), {}, 0, 1};
    qnv::EncodeOptions options = options_of(limits);
    options.metadata = step_metadata(data, limits, stream.field, stream.unit);
    const auto problem = encode_surface(surface, limits.relative_error, std::move(options), stream.bytes);
    take(problem ? std::variant<StepStream, std::string>(*problem) : std::move(stream), "surface", streams, problems);
  }
  for (const ParticleValues& some : data.particles) {
    StepStream stream{StreamKind::particles, some.field.name.data(), some.field.unit.data(), {}, 0, some.stride};
    qnv::EncodeOptions options = options_of(limits);
    options.metadata = step_metadata(data, limits, stream.field, stream.unit);
    const auto problem = encode_particles(some, std::move(options), stream.bytes);
    take(problem ? std::variant<StepStream, std::string>(*problem) : std::move(stream), "particles", streams, problems);
  }
  return streams;
}

}  // namespace gs::app::insitu
