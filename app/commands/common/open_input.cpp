#include "app/commands/common/open_input.h"

#include "app/base/console.h"
#include "app/base/local_file.h"
#include "app/commands/common/shared.h"
#include "app/encode/surface_triangles.h"
#include "app/formats/confined/confined_import.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/zarr/zarr_place.h"
#include "app/formats/foreign_types.h"
#include "app/formats/gltf/gltf_losses.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/volume/confined/confined_volume.h"
#include "app/loading/updates/limit_report.h"
#include "app/loading/world_loader.h"
#include "base/text.h"
#include "net/base/url.h"
#include "net/files/file.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/reader/decode_stream.h"
#include "qnv/sampling/volume/component_values.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

bool is_raw(const InputOptions& options) { return options.raw.dimensions != decltype(options.raw.dimensions){}; }

Clock::time_point deadline_of(const LoadingOptions& options) {
  const auto time = std::chrono::duration<double>(std::min(options.timeout_seconds, 1e6));
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(time);
}

WorldBudget budget_of(const LoadingOptions& options, const LoadLimit& limit) {
  auto budget = std::make_shared<Budget>(options.limits);
  budget->stop_when([limit] { return limit.over(); });
  return budget;
}

std::optional<Opened> open_volume_input(const InputOptions& options, const std::string& path, OpenedInput& input) {
  const WorldBudget budget = budget_of(options, LoadLimit(deadline_of(options)));
  VolumeOrigin origin{reader_beside(path, load_options(options).allowed), {}, options.component};
  origin.states = std::make_shared<FileStates>();
  input.others.push_back(origin.states);
  auto opened = open_volume_confined(path, options.raw, origin, budget);
  budget->stop_when(nullptr);  // the time limit is for opening; slices are read later
  if (const auto* problem = std::get_if<std::string>(&opened)) {
    (void)fail(*problem);
    return std::nullopt;
  }
  return std::move(std::get<qnv::VolumeSource>(opened));
}

std::optional<Opened> open_geometry_input(const LoadingOptions& options, const ContentType& type,
                                          const GeometryFile& file) {
  Diagnostics diagnostics;
  const LoadLimit limit(deadline_of(options));
  const WorldBudget budget = budget_of(options, limit);
  auto geometry = read_geometry(type, file, diagnostics, limit, budget);
  if (const auto* octree = geometry ? geometry->as<qnv::OctreeSplats>() : nullptr) {
    qnv::LodLimits limits;
    limits.discs = most_decoded_vectors(*budget);
    const auto stream = octree->stream;
    stream->set_limits(limits);
    geometry = stream->whole();
    if (stream->cut_short())
      diagnostics.add(
          {Severity::error, file.path, {}, budget->refusal(Resource::vectors) + "; some parts stay coarse"});
  }
  print_diagnostics(diagnostics);
  if (!geometry) return std::nullopt;
  return std::move(*geometry);
}

std::optional<Opened> open_world_input(const LoadingOptions& options, const std::string& path, std::string& title) {
  auto surface = std::make_unique<OpenedSurface>();
  LoadOptions load = load_options(options);
  load.max_bytes = LoadOptions{}.max_bytes;  // `--max-bytes` limits the output, not the input
  load.whole_surfaces = true;
  surface->world = load_world(path, load);
  print_diagnostics(surface->world.diagnostics);
  if (!surface->world.scene) return std::nullopt;
  title = surface->world.title;
  // Vectors can be viewed from any distance, so tessellate text as finely as for the largest pictures.
  constexpr double kFiner = 22;  // than a usual picture: 20,000 pixels per radian
  render::Sight sight;
  sight.pixels *= kFiner;
  sight.pixels_per_point *= kFiner;
  surface->list = render::collect(*surface->world.scene, surface->world.images, surface->meshes, glm::vec3(0, 0, 10),
                                  surface->world.geometries, nullptr, sight);
  Diagnostics limits;
  report_limits(surface->list, limits);
  print_diagnostics(limits);
  return surface;
}

/// Returns the vectors or the volume of a world that has nothing else, with all of its details; else null.
std::shared_ptr<const qnv::Geometry> only_geometry(const OpenedSurface& surface) {
  const auto& geometries = surface.world.geometries;
  if (surface.world.authored || geometries.size() != 1 || !surface.list.items.empty()) return nullptr;
  return geometries.begin()->second;
}

/// Returns the volume of a file that is no stream, with all numbers of its voxels; nullopt for others.
std::optional<qnv::VolumeSource> whole_volume(const qnv::Geometry& geometry) {
  const auto* const vectors = geometry.as<qnv::Volume>();
  if (!vectors || !vectors->values || !vectors->values->exact || vectors->values->level != 0) return std::nullopt;
  qnv::VolumeSource volume = vectors->values->source;
  volume.layout.metadata = geometry.description().metadata;
  for (const auto& component : vectors->values->components)
    if (!volume.layout.colors) volume.components.push_back(component->source);
  return volume;
}

/// Opens a file of a server: its volume or vectors, else its world.
std::optional<Opened> open_url_input(const InputOptions& options, const std::string& path, OpenedInput& input) {
  std::optional<Opened> opened = open_world_input(options, path, input.title);
  if (!opened) return std::nullopt;
  auto& surface = *std::get<std::unique_ptr<OpenedSurface>>(*opened);
  input.bytes = surface.world.bytes;
  input.type = surface.world.type;
  input.upright = upright_of(surface.world.up, surface.list.bounds.empty() ? glm::vec3(0) : surface.list.bounds.size());
  const auto geometry = only_geometry(surface);
  if (!geometry) return opened;
  if (const auto* const octree = geometry->as<qnv::OctreeSplats>()) {
    const WorldBudget budget = budget_of(options, LoadLimit(deadline_of(options)));
    qnv::LodLimits limits;
    limits.discs = most_decoded_vectors(*budget);
    octree->stream->set_limits(limits);
    return qnv::Geometry(octree->stream->whole());
  }
  if (auto volume = input.type == "QNV" ? std::nullopt : whole_volume(*geometry)) return std::move(*volume);
  qnv::Geometry kept = *geometry;
  return kept;
}

/// Thrown when a mesh asks for another file: worlds have the rules for references.
struct RefersToFiles {};

// Opens a mesh file without nodes. Returns false if it must be opened as a world.
bool open_mesh_input(const LoadingOptions& options, const ContentType& type, const std::string& path,
                     std::span<const std::byte> bytes, std::optional<Opened>& opened) try {
  if (type.content != ContentClass::mesh || type.has_nodes || bytes.empty()) return false;
  constexpr std::size_t kHead = 8192;
  if (refuse_first_bytes(path, bytes.first(std::min(bytes.size(), kHead)))) return false;
  Diagnostics diagnostics, limits;
  const ReadFile read_file = [](const std::string&) -> BytesResult { throw RefersToFiles(); };
  const WorldBudget budget = budget_of(options, LoadLimit(deadline_of(options)));
  ImportSource source{bytes, path, read_file, budget, diagnostics};
  source.component = options.component;
  source.local = true;
  Asset asset = read_asset(type, source, read_confined);
  auto* const mesh = std::get_if<MeshAsset>(&asset);
  if (mesh && mesh->has_textures()) return false;
  print_diagnostics(diagnostics);
  if (!mesh) return true;
  opened = mesh_surface(std::move(*mesh), path, budget, limits);
  print_diagnostics(limits);
  return true;
} catch (const RefersToFiles&) {
  return false;
} catch (const std::bad_alloc&) {
  print_diagnostics(world_without_memory(path).diagnostics);
  return true;
}

// Opens a mesh that is too large for memory, so that its file is read several times. Returns nullopt for other meshes.
std::optional<MeshStream> large_mesh(const LoadingOptions& options, const ContentType& type,
                                     const std::shared_ptr<const net::MappedFile>& file) {
  if (!type.in_order) return std::nullopt;
  auto mesh = open_mesh_stream(file->bytes(), [file](std::size_t bytes) { file->put_aside(bytes); });
  if (!mesh || mesh->faces <= most_encoded_triangles(options.limits)) return std::nullopt;
  return mesh;
}

/// Maps a local file. Returns null for URLs, and for files that cannot be opened.
std::shared_ptr<const net::MappedFile> mapped_input(const std::string& path) {
  if (is_url_input(path)) return nullptr;
  auto mapped = net::map_file(local_input(path));
  auto* const file = std::get_if<net::MappedFile>(&mapped);
  return file ? std::make_shared<const net::MappedFile>(std::move(*file)) : nullptr;
}

const ContentType& type_of_input(const InputOptions& options, const std::string& path,
                                 std::span<const std::byte> bytes) {
  const ContentType& type = content_type_of(path, first_bytes(bytes));
  if (!type.holds_mesh) return type;
  Diagnostics ignored;  // the reader reports problems
  const WorldBudget budget = budget_of(options, LoadLimit(deadline_of(options)));
  const ReadFile read_file = reader_beside(path, load_options(options).allowed);
  ImportSource source{bytes, path, read_file, budget, ignored};
  source.component = options.component;
  source.local = true;
  return type_of_content(type, source);
}

}  // namespace

const qnv::VolumeSource* values_of(const OpenedInput& input) {
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content)) return volume;
  const auto* geometry = std::get_if<qnv::Geometry>(&input.content);
  const auto* vectors = geometry ? geometry->as<qnv::Volume>() : nullptr;
  return vectors && vectors->values ? &vectors->values->source : nullptr;
}

std::size_t most_encoded_triangles(const Limits& limits) {
  return limits.memory / 32 * kHeldShare / qnv::kDisplacedTriangleBytes;
}

bool is_url_input(const std::string& path) {
  const std::string scheme = net::parse_url(path).scheme;
  std::error_code error;
  return !scheme.empty() && scheme != "file" && !std::filesystem::exists(path, error);
}

std::string local_input(const std::string& path) {
  const net::Url url = net::parse_url(path);
  std::string local = url.scheme == "file" ? net::path_of_url(url) : path;
  std::string file = file_of_folder(local);
  return file.empty() ? local : file;
}

std::optional<OpenedInput> open_input(const InputOptions& options, const std::string& path, MeshForm form) {
  if (is_url_input(path)) {
    OpenedInput input{{}, {}, {}, 0, {}, {}, nullptr};
    auto opened = open_url_input(options, path, input);
    if (!opened) return std::nullopt;
    input.content = std::move(*opened);
    return input;
  }
  std::string local = local_input(path);
  const std::string entry = entry_of_folder(local);
  while (!entry.empty() && local.size() > 1 && local.ends_with('/')) local.pop_back();
  auto mapped = net::map_file(entry.empty() ? local : entry);
  if (const auto* problem = std::get_if<net::FileError>(&mapped)) {
    const auto folder = refusal_of_folder(local);
    (void)fail(folder ? local + ": " + *folder : problem->message);
    return std::nullopt;
  }
  const auto file = std::make_shared<const net::MappedFile>(std::move(std::get<net::MappedFile>(mapped)));
  const auto all = file->bytes();
  const ContentType& type = type_of_input(options, entry.empty() ? local : entry, all);
  std::optional<Opened> opened;
  OpenedInput input{{}, std::string(type.name), zarr_title_of(local), all.size(), {}, {}, nullptr};
  if (input.type == "glTF") input.losses = gltf_losses(all);
  if (auto mesh = large_mesh(options, type, file)) {
    opened = std::move(*mesh);
    input.file = file;
  } else if (is_raw(options) || type.content == ContentClass::volume) {
    opened = open_volume_input(options, local, input);
  } else if (type.is_geometry() && !is_outline_stream(all)) {
    GeometryFile geometry{local, all};
    geometry.origin.read_beside = reader_beside(local, load_options(options).allowed);
    geometry.origin.component = options.component;
    opened = open_geometry_input(options, type, geometry);
  } else if (form == MeshForm::world || !open_mesh_input(options, type, local, all, opened)) {
    opened = open_world_input(options, local, input.title);
  }
  if (!opened) return std::nullopt;
  if (const auto changed = file->changed()) {
    (void)fail(local + ": " + *changed);
    return std::nullopt;
  }
  input.content = std::move(*opened);
  glm::vec3 size(0);
  if (const auto* surface = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content))
    if (const WideBox& bounds = (*surface)->list.bounds; !bounds.empty()) size = bounds.size();
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content))
    for (std::size_t i = 0; i < 3; ++i)
      size += glm::abs(volume->layout.axes[i]) * static_cast<float>(volume->layout.dimensions[i] - 1);
  if (const auto* mesh = std::get_if<MeshSurface>(&input.content); mesh && !mesh->summary.box.empty())
    size = mesh->summary.box.size();
  if (const auto* mesh = std::get_if<MeshStream>(&input.content)) size = mesh->size;
  if (const auto* geometry = std::get_if<qnv::Geometry>(&input.content);
      geometry && !geometry->description().box.empty())
    size = geometry->description().box.size();
  input.upright = upright_of(is_raw(options) ? UpRule::slices : type.up, size);
  return input;
}

std::optional<SplatSurvey> survey_many_splats(const std::string& path, qnv::Ranks& ranks) {
  const auto file = mapped_input(path);
  return survey_splats(
      local_input(path), file ? file->bytes() : std::span<const std::byte>(), qnv::kMostWholeGaussians,
      [file](std::size_t bytes) { file->put_aside(bytes); }, ranks);
}

std::optional<OpenedInput> open_many_splats(const std::string& path, const SplatSurvey* known) {
  const std::string local = local_input(path);
  const auto file = mapped_input(path);
  if (!file) return std::nullopt;
  auto splats = open_splat_file(
      local, file->bytes(), qnv::kMostWholeGaussians, [file](std::size_t bytes) { file->put_aside(bytes); }, known);
  if (!splats) return std::nullopt;
  const ContentType& type = content_type_of(local, first_bytes(file->bytes()));
  OpenedInput input{{}, std::string(type.name), file_name(local), file->bytes().size(), {}, {}, file};
  input.upright = upright_of(type.up, splats->source.base.description.box.size());
  input.content = std::move(*splats);
  return input;
}

std::optional<OpenedInput> open_grid_in_parts(const InputOptions& options, const std::string& path) {
  const auto file = mapped_input(path);
  if (!file) return std::nullopt;
  const std::string local = local_input(path);
  VolumeFile source{
      local, file_name(local), {file, file->bytes()}, reader_beside(local, load_options(options).allowed)};
  source.budget = std::make_shared<Budget>(options.limits);
  source.component = options.component;
  auto grid = open_large_grid(source, source.budget->limit(Resource::nodes));
  if (!grid) return std::nullopt;
  const ContentType& type = content_type_of(local, first_bytes(file->bytes()));
  OpenedInput input{{}, std::string(type.name), file_name(local), file->bytes().size(), {}, {}, file};
  input.bytes += static_cast<std::size_t>(grid->other_bytes);
  input.upright = upright_of(type.up, glm::vec3(0));
  input.content = std::move(*grid);
  return input;
}

std::optional<OpenedInput> open_values_stream(const std::string& path) {
  if (is_url_input(path)) return std::nullopt;
  const std::string local = local_input(path);
  auto opened = net::open_file(local);
  if (std::holds_alternative<net::FileError>(opened)) return std::nullopt;
  const auto file = std::make_shared<const net::RandomAccessFile>(std::move(std::get<net::RandomAccessFile>(opened)));
  std::array<std::byte, 12> first{};
  if (file->read(0, first) != first.size() || qnv::payload_number(first) != static_cast<int>(qnv::Payload::values))
    return std::nullopt;
  qnv::StreamHeader header;
  auto slices = qnv::open_values_slices(
      {file->size(),
       [file](std::uint64_t offset, std::span<std::byte> to) { return file->read(offset, to) == to.size(); }},
      &header);
  auto* const values = std::get_if<std::shared_ptr<const qnv::VolumeValues>>(&slices);
  if (!values) return std::nullopt;
  qnv::Volume volume;
  volume.description = header.description;
  volume.values = std::move(*values);
  OpenedInput input{{}, "QNV", file_name(local), static_cast<std::size_t>(file->size()), {}, {}, nullptr};
  input.content = qnv::Geometry(std::move(volume));
  return input;
}

std::optional<OpenedInput> open_steps(const InputOptions& options, std::span<const std::string> paths) {
  std::optional<OpenedInput> all;
  std::vector<qnv::VolumeSource> steps;
  std::vector<double> times;
  for (const std::string& path : paths) {
    auto input = open_input(options, path);
    if (!input) return std::nullopt;
    auto* const volume = std::get_if<qnv::VolumeSource>(&input->content);
    if (!volume || !volume->steps.empty()) {
      (void)fail(path + ": " + (volume ? "has several steps" : "is no volume") +
                 "; the steps of a time series are files with one volume each");
      return std::nullopt;
    }
    times.push_back(static_cast<double>(steps.size()));
    steps.push_back(std::move(*volume));
    if (!all) {
      all = std::move(input);
    } else {
      all->bytes += input->bytes;
      all->others.insert(all->others.end(), input->others.begin(), input->others.end());
    }
  }
  if (!all) return std::nullopt;
  qnv::VolumeSource source = steps.front();
  source.steps = std::move(steps);
  source.times = std::move(times);
  all->content = std::move(source);
  return all;
}

std::optional<std::string> choose_step(const VoxelComponent& component, OpenedInput& input) {
  auto* const geometry = std::get_if<qnv::Geometry>(&input.content);
  auto* const volume = geometry ? geometry->as<qnv::Volume>() : nullptr;
  if (!component.step || !volume || !volume->values) return std::nullopt;
  const auto values = volume->values;
  if (values->times.empty()) return std::string("--time selects a step of a time series; this is a single volume");
  if (!component.step->time && component.step->number >= values->times.size())
    return "no step " + std::to_string(component.step->number) + "; expected 0 to " +
           std::to_string(values->times.size() - 1);
  const std::uint32_t step = qnv::step_number(*component.step, values->times);
  if (step < values->steps.size()) volume->values = values->steps[step];
  return std::nullopt;
}

std::optional<std::string> choose_component(const VoxelComponent& component, OpenedInput& input) {
  auto* const geometry = std::get_if<qnv::Geometry>(&input.content);
  auto* const volume = geometry ? geometry->as<qnv::Volume>() : nullptr;
  if (!component.chosen || !volume || !volume->values) return std::nullopt;
  if (!volume->values->steps.empty()) {
    // The component of every step.
    auto made = std::make_shared<qnv::VolumeValues>(*volume->values);
    for (auto& step : made->steps) {
      OpenedInput one{{}, {}, {}, 0, {}, {}, nullptr};
      qnv::Volume shown;
      shown.values = step;
      one.content = qnv::Geometry(std::move(shown));
      if (auto problem = choose_component(component, one)) return problem;
      step = std::get<qnv::Geometry>(one.content).as<qnv::Volume>()->values;
    }
    volume->values = std::move(made);
    return std::nullopt;
  }
  const auto all = volume->values->components;
  if (!component.magnitude && component.index >= std::max<std::size_t>(all.size(), 1))
    return "no component " + std::to_string(component.index) + "; expected " +
           (all.empty() ? "0, because each voxel has one number"
                        : "0 to " + std::to_string(all.size() - 1) + ", or magnitude");
  if (all.empty()) return std::nullopt;
  volume->values = component.magnitude ? qnv::magnitude_of(all) : all[component.index];
  return std::nullopt;
}

std::optional<std::string> edit_input(const SplatEdit& edit, OpenedInput& input) {
  if (edit.empty()) return std::nullopt;
  auto* const geometry = std::get_if<qnv::Geometry>(&input.content);
  auto* const splats = geometry ? geometry->as<qnv::Gaussians>() : nullptr;
  const std::string first = options_of(edit).front();
  if (!splats) return first + " edits Gaussian splats; expected a file of splats";
  const SplatsRemoved removed = edit_splats(*splats, edit);
  if (splats->empty()) return first + " leaves no splat of " + std::to_string(removed.before);
  for (std::string& message : messages_of(removed)) input.losses.push_back(std::move(message));
  return std::nullopt;
}

}  // namespace gs::app
