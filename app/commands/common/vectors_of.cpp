#include "app/commands/common/vectors_of.h"

#include "app/base/console.h"
#include "app/base/local_file.h"
#include "app/commands/common/input_surface.h"
#include "app/commands/common/shared.h"
#include "app/encode/surface_triangles.h"
#include "app/encode/textured_surface.h"
#include "app/formats/content_types.h"
#include "app/formats/foreign_types.h"
#include "app/formats/gltf/gltf_losses.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/loading/updates/limit_report.h"
#include "app/loading/world_loader.h"
#include "base/text.h"
#include "net/base/url.h"
#include "net/files/file.h"
#include "qnv/codecs/encode.h"
#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/reader/decode_stream.h"
#include "qnv/sampling/volume/component_values.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/isosurface.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;
using Metadata = std::vector<std::pair<std::string, std::string>>;
using qnv::EncodeError;

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

std::optional<Opened> open_volume_input(const InputOptions& options, const std::string& path) {
  auto opened =
      open_volume(path, options.raw, {reader_beside(path, load_options(options).allowed), {}, options.component},
                  budget_of(options, LoadLimit(deadline_of(options))));
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
  Asset asset = read_asset(type, {bytes, path, read_file, budget, diagnostics});
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

// Returns the metadata of a stream to write. `own` is the metadata of the input. Title, source and axes may differ from
// it.
Metadata metadata_of(const ConversionOptions& options, const OpenedInput& input, const std::string& path,
                     const Metadata& own) {
  const bool chosen_up = options.up && *options.up != UpAxis::automatic;
  Metadata all{{"title", input.title}, {"source", file_name(path)}};
  if (input.type == "VRML97" || input.type == "glTF") all.emplace_back("units", "m");  // VRML97 4.4.5; glTF 2.0, 3.4
  for (const auto& pair : own)
    if (pair.first == "title" && !pair.second.empty()) {
      all.front().second = pair.second;
    } else if (pair.first != "source" && !(chosen_up && (pair.first == "up" || pair.first == "front"))) {
      all.push_back(pair);
    }
  Upright upright = chosen_up ? upright_of(*options.up) : input.upright;
  upright.three_quarter = input.upright.three_quarter;
  if (chosen_up || !stated_upright(own))
    for (auto& pair : metadata_of(upright)) all.push_back(std::move(pair));
  // The default axes of VRML97 need no metadata, unless the options choose them instead of other axes.
  if (chosen_up && upright == Upright{} && stated_upright(own)) all.emplace_back("up", name_of(*options.up));
  return all;
}

// Returns the metadata of the surface of an input.
Metadata surface_metadata(const ConversionOptions& options, const OpenedInput& input) {
  const qnv::VolumeSource* const volume = values_of(input);
  Metadata metadata = metadata_of(options, input, options.files.front(), volume ? volume->layout.metadata : Metadata{});
  const auto* world = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content);
  const auto* mesh = std::get_if<MeshSurface>(&input.content);
  const std::optional<ColorKey> key = world ? (*world)->world.color_key : mesh ? mesh->color_key : std::nullopt;
  if (key) metadata.push_back(color_key_metadata(*key));
  if (volume) {
    char value[32];
    std::snprintf(value, sizeof value, "%.9g", options.isovalue.value_or(0));
    metadata.emplace_back("isovalue", value);
  }
  return metadata;
}

EncodeError not_a_volume(const std::string& path) {
  return {path + " has no values of voxels; --isovalue expects a volume, or a stream of its values"};
}

std::size_t part_of(double fraction, std::size_t count) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(fraction * static_cast<double>(count))));
}

// JPEG quality of textures in streams with an exact mesh.
constexpr int kExactTextureQuality = 95;

// Returns the payload that the options name.
std::optional<qnv::Payload> requested_payload(const ConversionOptions& options) {
  if (options.method == EncodeMethod::records) return qnv::Payload::records;
  if (options.method == EncodeMethod::octree) return qnv::Payload::packed;
  if (options.method == EncodeMethod::displaced) return qnv::Payload::displaced;
  if (options.method == EncodeMethod::gaussians) return qnv::Payload::gaussians;
  return std::nullopt;
}

// Returns the steps of Gaussians (qnv::EncodeOptions::splat_steps) for the requested error.
std::variant<int, EncodeError> splat_steps(const ConversionOptions& options, bool gaussians) {
  const qnv::ValueTolerance& tolerance = options.value_tolerance;
  if (!tolerance.error && !tolerance.lossless) return 0;
  if (!gaussians) return EncodeError{"--error and --lossless apply to volumes and Gaussians only; leave them out"};
  if (tolerance.lossless)
    return EncodeError{"--lossless applies to volumes only; splats are rounded; expected --error, as in --error 1%"};
  if (!tolerance.of_range || !(*tolerance.error > 0))
    return EncodeError{"--error of splats is a share of their deviations; expected a percentage above 0, as in 2%"};
  constexpr int kMost = qnv::GaussianCoding::kMostSteps;
  // Rounds to finer steps.
  const double steps = 8 * std::log2(*tolerance.error / qnv::gaussians::splat_errors().place[0]);
  return static_cast<int>(std::floor(std::clamp(steps + 1e-9, double{-kMost}, double{kMost})));
}

std::variant<qnv::EncodedStream, EncodeError> encode(const qnv::EncodeSource& source, qnv::EncodeRequest request,
                                                     ProgressBar& progress) {
  auto encoded = qnv::encode(source, std::move(request), &progress.whole());
  if (auto* problem = std::get_if<EncodeError>(&encoded)) return std::move(*problem);
  return std::move(std::get<qnv::Encoding>(encoded).stream);
}

std::variant<qnv::EncodedStream, EncodeError> encode(const InputSurface& surface, const ConversionOptions& options,
                                                     qnv::EncodeOptions encode_options, ProgressBar& progress) {
  encode_options.two_sided = surface.two_sided;
  if (surface.shine)
    for (auto& pair : qnv::metadata_of(*surface.shine)) encode_options.metadata.push_back(std::move(pair));
  encode_options.origin = surface.origin;
  if (options.fraction > 0 && surface.triangles > 0)
    encode_options.vectors = part_of(options.fraction, surface.triangles);
  encode_options.exact_bits = options.exact_bits;
  encode_options.most_triangles = most_encoded_triangles(options.limits);
  qnv::EncodeRequest request{requested_payload(options), std::move(encode_options)};
  std::optional<qnv::TexturedSurface> textured;
  if (surface.textured && qnv::uses_texture(request, surface.triangles))
    textured = textured_surface(*surface.textured, surface.origin,
                                options.exact_bits > 0 ? kExactTextureQuality : kTextureQuality);
  if (textured) request.options.textured = &*textured;
  const qnv::TriangleSource source = with_progress(surface, progress.whole());
  auto encoded = encode(std::cref(source), std::move(request), progress);
  if (std::holds_alternative<EncodeError>(encoded) && !surface.problem->empty() && !progress.cancelled())
    return EncodeError{*surface.problem};
  return encoded;
}

std::variant<qnv::Volume, EncodeError> gradients(const qnv::VolumeSource& volume, const ConversionOptions& options,
                                                 ProgressBar& progress) {
  qnv::GradientOptions gradient_options;
  if (options.vectors > 0) {
    gradient_options.fraction = 1;
    gradient_options.vectors = std::min<std::uint64_t>(options.vectors, gradient_options.vectors);
  }
  if (options.fraction > 0) gradient_options.fraction = options.fraction;
  const Budget budget(options.limits);
  const std::uint64_t most = most_gradients(budget);
  const double wanted = gradient_options.fraction * static_cast<double>(qnv::voxel_count(volume.layout));
  if (wanted > static_cast<double>(most) && gradient_options.vectors > most) {
    complain("ghostspace: warning: %.0f gradients are %s; only the %llu longest are used", wanted,
             budget.refusal(Resource::vectors).c_str(), static_cast<unsigned long long>(most));
    gradient_options.vectors = most;
  }
  progress.whole().stage = "gradients";
  auto found = qnv::gradient_vectors(volume, gradient_options, &progress.whole());
  if (const auto* problem = std::get_if<qnv::VolumeError>(&found)) return EncodeError{problem->message};
  return std::move(std::get<qnv::Volume>(found));
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

std::optional<OpenedInput> open_input(const InputOptions& options, const std::string& path, MeshForm form) {
  const net::Url url = net::parse_url(path);
  const std::string local = url.scheme == "file" ? net::path_of_url(url) : path;
  auto mapped = net::map_file(local);
  if (const auto* problem = std::get_if<net::FileError>(&mapped)) {
    const auto folder = refusal_of_folder(local);
    (void)fail(folder ? local + ": " + *folder : problem->message);
    return std::nullopt;
  }
  const auto file = std::make_shared<const net::MappedFile>(std::move(std::get<net::MappedFile>(mapped)));
  const auto all = file->bytes();
  const ContentType& type = content_type_of(local, first_bytes(all));
  std::optional<Opened> opened;
  OpenedInput input{{}, std::string(type.name), file_name(local), all.size(), {}, {}, nullptr};
  if (input.type == "glTF") input.losses = gltf_losses(all);
  if (auto mesh = large_mesh(options, type, file)) {
    opened = std::move(*mesh);
    input.file = file;
  } else if (is_raw(options) || type.content == ContentClass::volume) {
    opened = open_volume_input(options, local);
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
  if (const auto* mesh = std::get_if<MeshSurface>(&input.content); mesh && !mesh->summary.box.empty())
    size = mesh->summary.box.size();
  if (const auto* mesh = std::get_if<MeshStream>(&input.content)) size = mesh->size;
  if (const auto* geometry = std::get_if<qnv::Geometry>(&input.content);
      geometry && !geometry->description().box.empty())
    size = geometry->description().box.size();
  input.upright = upright_of(is_raw(options) ? UpRule::slices : type.up, size);
  return input;
}

std::optional<OpenedInput> open_values_stream(const std::string& path) {
  const net::Url url = net::parse_url(path);
  const std::string local = url.scheme == "file" ? net::path_of_url(url) : path;
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

std::optional<std::string> choose_component(const VoxelComponent& component, OpenedInput& input) {
  auto* const geometry = std::get_if<qnv::Geometry>(&input.content);
  auto* const volume = geometry ? geometry->as<qnv::Volume>() : nullptr;
  if (!component.chosen || !volume || !volume->values) return std::nullopt;
  const auto all = volume->values->components;
  if (!component.magnitude && component.index >= std::max<std::size_t>(all.size(), 1))
    return "no component " + std::to_string(component.index) + "; expected " +
           (all.empty() ? "0, because each voxel has one number"
                        : "0 to " + std::to_string(all.size() - 1) + ", or magnitude");
  if (all.empty()) return std::nullopt;
  volume->values = component.magnitude ? qnv::magnitude_of(all) : all[component.index];
  return std::nullopt;
}

Upright wanted_upright(const ConversionOptions& options, const OpenedInput& input) {
  if (options.up && *options.up != UpAxis::automatic) return upright_of(*options.up);
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content))
    if (const auto stated = stated_upright(volume->layout.metadata)) return *stated;
  return input.upright;
}

std::variant<qnv::EncodedStream, EncodeError> encode_input(const ConversionOptions& options, const OpenedInput& input,
                                                           ProgressBar& progress, const EncodeOutput& output) {
  const std::string& path = options.files.front();
  qnv::EncodeOptions encode_options;
  encode_options.seed = options.seed;
  encode_options.vectors = options.vectors;
  if (options.max_bytes_given) encode_options.max_bytes = options.max_bytes;
  encode_options.parity = options.parity;
  if (options.isovalue && !values_of(input)) return not_a_volume(path);
  if (options.method == EncodeMethod::values && !std::holds_alternative<qnv::VolumeSource>(input.content))
    return EncodeError{"--method values applies to volumes only; leave it out"};
  const auto* const splats = std::get_if<qnv::Geometry>(&input.content);
  if (options.method == EncodeMethod::gaussians && !(splats && splats->as<qnv::Gaussians>()))
    return EncodeError{"--method gaussians applies to Gaussian splats only; leave it out"};
  if (const auto surface = input_surface(input, options.isovalue, progress)) {
    if (options.isovalue && options.fraction > 0)
      return EncodeError{"--fraction counts the voxels of a volume; use --vectors with --isovalue"};
    encode_options.metadata = surface_metadata(options, input);
    auto encoded = encode(*surface, options, std::move(encode_options), progress);
    if (const auto changed = input.file ? input.file->changed() : std::nullopt) return EncodeError{*changed};
    return encoded;
  }
  if (options.method == EncodeMethod::displaced || options.exact_bits > 0)
    return EncodeError{std::string(options.exact_bits > 0 ? "--keep-mesh" : "--method displaced") +
                       " applies to surfaces of triangles only; leave it out"};
  if (options.method == EncodeMethod::octree && std::holds_alternative<qnv::VolumeSource>(input.content))
    return EncodeError{"--method octree applies to surfaces and points only; leave it out, or use --method records"};
  if (const auto* geometry = std::get_if<qnv::Geometry>(&input.content)) {
    encode_options.metadata = metadata_of(options, input, path, geometry->description().metadata);
    const qnv::VectorView vectors(*geometry);
    if (options.fraction > 0) encode_options.vectors = part_of(options.fraction, vectors.size());
    const auto* gaussians = geometry->as<qnv::Gaussians>();
    const auto steps = splat_steps(options, gaussians != nullptr);
    if (const auto* problem = std::get_if<EncodeError>(&steps)) return *problem;
    encode_options.splat_steps = std::get<int>(steps);
    const qnv::EncodeRequest request{requested_payload(options), std::move(encode_options)};
    if (gaussians) return encode(std::cref(*gaussians), request, progress);
    return encode(vectors, request, progress);
  }
  const auto& volume = std::get<qnv::VolumeSource>(input.content);
  const bool selects_gradients = options.vectors > 0 || options.fraction > 0;
  if (options.method == EncodeMethod::values || (options.method == EncodeMethod::automatic && !selects_gradients)) {
    if (volume.layout.type == qnv::VoxelType::f64 && !volume.layout.labels)
      complain("ghostspace: warning: %s: values of float64 are stored as float32", path.c_str());
    const qnv::VolumeSource& first = volume.components.empty() ? volume : volume.components.front();
    encode_options.metadata = metadata_of(options, input, path, first.layout.metadata);
    encode_options.tolerance = options.value_tolerance;
    encode_options.spill = output.spill;
    encode_options.sink = output.sink;
    return encode(std::cref(volume), {qnv::Payload::values, std::move(encode_options)}, progress);
  }
  auto found = gradients(volume, options, progress);
  if (auto* problem = std::get_if<EncodeError>(&found)) return std::move(*problem);
  encode_options.metadata = metadata_of(options, input, path, volume.layout.metadata);
  encode_options.vectors = 0;
  const auto& vectors = std::get<qnv::Volume>(found);
  return encode(qnv::VectorView(vectors), {requested_payload(options), std::move(encode_options)}, progress);
}

std::optional<std::variant<qnv::Geometry, EncodeError>> mesh_of_input(const ConversionOptions& options,
                                                                      const OpenedInput& input, ProgressBar& progress) {
  if (options.isovalue && !values_of(input)) return not_a_volume(options.files.front());
  const auto surface = input_surface(input, options.isovalue, progress);
  if (!surface) return std::nullopt;
  auto mesh = indexed_mesh(*surface, most_joined_triangles(options.limits), progress);
  if (auto* problem = std::get_if<EncodeError>(&mesh)) return std::move(*problem);
  auto& made = std::get<qnv::IndexedMesh>(mesh);
  made.description.metadata = surface_metadata(options, input);
  if (surface->shine)
    for (auto& pair : qnv::metadata_of(*surface->shine)) made.description.metadata.push_back(std::move(pair));
  return qnv::Geometry(std::move(made));
}

std::variant<OutlineModel, std::string> isosurface_outlines(const ConversionOptions& options,
                                                            const qnv::VolumeSource& volume, ProgressBar& progress) {
  const InputSurface surface = isosurface_of(volume, *options.isovalue, progress);
  Budget budget(options.limits);
  const qnv::TriangleSource bounded = [&](const qnv::TriangleSink& sink) {
    return surface.source([&](std::span<const qnv::Triangle> triangles) {
      const std::uint64_t bytes = triangles.size() * kOutlineTriangleBytes;
      if (budget.take(Resource::meshes, bytes)) {
        if (surface.origin == glm::dvec3(0)) return sink(triangles);
        std::vector<qnv::Triangle> moved(triangles.begin(), triangles.end());  // polygons are relative to 0
        for (qnv::Triangle& triangle : moved)
          for (glm::vec3& p : triangle.positions) p = glm::vec3(surface.origin + glm::dvec3(p));
        return sink(moved);
      }
      *surface.problem = "has a surface that needs " + budget.refusal(Resource::meshes);
      return false;
    });
  };
  OutlineModel model = outline_model(bounded, surface.two_sided);
  if (!surface.problem->empty()) return *surface.problem;
  if (model.model.ends.empty()) return "has no surface at this value";
  return model;
}

std::variant<qnv::Geometry, EncodeError> geometry_of_input(const ConversionOptions& options, OpenedInput input,
                                                           ProgressBar& progress) {
  const auto stand = [&](qnv::Description& description) {
    Metadata& metadata = description.metadata;
    if (stated_upright(metadata)) return;
    for (auto& pair : metadata_of(input.upright)) metadata.push_back(std::move(pair));
  };
  if (options.isovalue && !values_of(input)) return not_a_volume(options.files.front());
  if (auto* geometry = std::get_if<qnv::Geometry>(&input.content); geometry && !options.isovalue) {
    stand(geometry->base().description);
    return std::move(*geometry);
  }
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content); volume && !options.isovalue) {
    auto found = gradients(*volume, options, progress);
    if (auto* problem = std::get_if<EncodeError>(&found)) return std::move(*problem);
    auto& vectors = std::get<qnv::Volume>(found);
    stand(vectors.description);
    return std::move(vectors);
  }
  auto encoded = encode_input(options, input, progress);
  if (auto* problem = std::get_if<EncodeError>(&encoded)) return std::move(*problem);
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  auto decoded = qnv::decode_stream(stream.bytes, kAll);
  return std::get<qnv::Geometry>(std::move(decoded.content));
}

}  // namespace gs::app
