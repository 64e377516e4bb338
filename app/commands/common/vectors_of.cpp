#include "app/commands/common/vectors_of.h"

#include "app/base/console.h"
#include "app/commands/common/input_surface.h"
#include "app/commands/common/shared.h"
#include "app/encode/grids/grid_surface.h"
#include "app/encode/surface_triangles.h"
#include "app/encode/textured_surface.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/loading/updates/limit_report.h"
#include "base/text.h"
#include "qnv/codecs/encode.h"
#include "qnv/codecs/gaussians/splat_steps.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/reader/decode_stream.h"
#include "qnv/sampling/volume/component_values.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/isosurface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

namespace gs::app {
namespace {

using Metadata = std::vector<std::pair<std::string, std::string>>;
using qnv::EncodeError;

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
  const auto* stream = std::get_if<MeshStream>(&input.content);
  const std::optional<ColorKey> key = world    ? (*world)->world.color_key
                                      : mesh   ? mesh->color_key
                                      : stream ? stream->color_key
                                               : std::nullopt;
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

// Parts of splats that are encoded at the same time may use 1 / kPartsShare of the memory limit.
constexpr std::size_t kPartsShare = 4;
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

/// Encodes the surface of a grid that exceeds memory.
std::variant<qnv::EncodedStream, EncodeError> encode_grid(const ConversionOptions& options, const OpenedInput& input,
                                                          ProgressBar& progress, const EncodeOutput& output) {
  qnv::EncodeOptions pieces;
  pieces.ranks = output.ranks;
  pieces.spill = output.spill;
  qnv::EncodeRanks shared(pieces);
  auto surface = grid_surface(std::get<LargeGrid>(input.content), shared, options.limits.memory, &progress.whole());
  if (auto* problem = std::get_if<EncodeError>(&surface)) return std::move(*problem);
  if (const std::string& omitted = std::get<MeshStream>(surface).omitted; !omitted.empty() && shared.rank() == 0)
    complain("%s: warning: %s", options.files.front().c_str(), omitted.c_str());
  const OpenedInput made{std::move(std::get<MeshStream>(surface)),
                         input.type,
                         input.title,
                         input.bytes,
                         input.losses,
                         input.upright,
                         input.file};
  EncodeOutput rest = output;
  rest.spill = &shared.store();
  return encode_input(options, made, progress, rest);
}

// Reports whether the stream of a volume stores values instead of gradients.
bool keeps_values(const ConversionOptions& options) {
  const bool selects_gradients = options.vectors > 0 || options.fraction > 0;
  return options.method == EncodeMethod::values || (options.method == EncodeMethod::automatic && !selects_gradients);
}

}  // namespace

Upright wanted_upright(const ConversionOptions& options, const OpenedInput& input) {
  if (options.up && *options.up != UpAxis::automatic) return upright_of(*options.up);
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content))
    if (const auto stated = stated_upright(volume->layout.metadata)) return *stated;
  return input.upright;
}

bool shares_work(const ConversionOptions& options, const OpenedInput& input) {
  if (std::holds_alternative<MeshStream>(input.content) || std::holds_alternative<SplatFile>(input.content) ||
      std::holds_alternative<LargeGrid>(input.content))
    return true;
  const auto* const volume = std::get_if<qnv::VolumeSource>(&input.content);
  return volume && !options.isovalue && options.exact_bits <= 0 && keeps_values(options);
}

std::variant<qnv::EncodedStream, EncodeError> encode_input(const ConversionOptions& options, const OpenedInput& input,
                                                           ProgressBar& progress, const EncodeOutput& output) {
  const std::string& path = options.files.front();
  qnv::EncodeOptions encode_options;
  encode_options.seed = options.seed;
  encode_options.vectors = options.vectors;
  if (options.max_bytes_given) encode_options.max_bytes = options.max_bytes;
  encode_options.parity = options.parity;
  encode_options.threads = output.threads;
  if (options.isovalue && !values_of(input)) return not_a_volume(path);
  if (options.method == EncodeMethod::values && !std::holds_alternative<qnv::VolumeSource>(input.content))
    return EncodeError{"--method values applies to volumes only; leave it out"};
  if (options.most_voxels > 0 && !std::holds_alternative<qnv::VolumeSource>(input.content))
    return EncodeError{"--most-voxels applies to volumes only; leave it out"};
  const auto* const splats = std::get_if<qnv::Geometry>(&input.content);
  const auto* const splat_file = std::get_if<SplatFile>(&input.content);
  if (options.method == EncodeMethod::gaussians && !splat_file && !(splats && splats->as<qnv::Gaussians>()))
    return EncodeError{"--method gaussians applies to Gaussian splats only; leave it out"};
  if (std::holds_alternative<LargeGrid>(input.content)) return encode_grid(options, input, progress, output);
  if (const auto surface = input_surface(input, options.isovalue, progress)) {
    if (options.isovalue && options.fraction > 0)
      return EncodeError{"--fraction counts the voxels of a volume; use --vectors with --isovalue"};
    encode_options.metadata = surface_metadata(options, input);
    if (std::holds_alternative<MeshStream>(input.content)) {
      encode_options.ranks = output.ranks;
      encode_options.spill = output.spill;
    }
    auto encoded = encode(*surface, options, std::move(encode_options), progress);
    if (const auto changed = input.file ? input.file->changed() : std::nullopt) return EncodeError{*changed};
    return encoded;
  }
  if (options.method == EncodeMethod::displaced || options.exact_bits > 0)
    return EncodeError{std::string(options.exact_bits > 0 ? "--keep-mesh" : "--method displaced") +
                       " applies to surfaces of triangles only; leave it out"};
  if (options.method == EncodeMethod::octree && std::holds_alternative<qnv::VolumeSource>(input.content))
    return EncodeError{"--method octree applies to surfaces and points only; leave it out, or use --method records"};
  if (splats || splat_file) {
    encode_options.spill = output.spill;
    encode_options.sink = output.sink;
    encode_options.memory = options.limits.memory / kPartsShare;
  }
  if (splat_file) {
    encode_options.ranks = output.ranks;
    encode_options.metadata = metadata_of(options, input, path, splat_file->source.base.description.metadata);
    const auto steps = splat_steps(options, true);
    if (const auto* problem = std::get_if<EncodeError>(&steps)) return *problem;
    encode_options.splat_steps = std::get<int>(steps);
    auto encoded =
        encode(std::cref(splat_file->source), {requested_payload(options), std::move(encode_options)}, progress);
    if (const auto changed = input.file ? input.file->changed() : std::nullopt) return EncodeError{*changed};
    return encoded;
  }
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
  if (keeps_values(options)) {
    if (volume.layout.type == qnv::VoxelType::f64 && !volume.layout.labels)
      complain("ghostspace: warning: %s: values of float64 are stored as float32", path.c_str());
    const qnv::VolumeSource& first = volume.components.empty() ? volume : volume.components.front();
    encode_options.metadata = metadata_of(options, input, path, first.layout.metadata);
    encode_options.tolerance = options.value_tolerance;
    encode_options.spill = output.spill;
    encode_options.sink = output.sink;
    encode_options.ranks = output.ranks;
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
