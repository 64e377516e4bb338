#include "app/commands/export.h"

#include "app/base/console.h"
#include "app/commands/common/conversion_report.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/scene_export.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/vectors_of.h"
#include "app/formats/export/export.h"
#include "app/formats/export/outline_text.h"
#include "app/formats/qnv/surface_pictures.h"
#include "net/base/url.h"
#include "net/files/atomic_file.h"
#include "net/files/file.h"
#include "qnv/container/container.h"
#include "qnv/sampling/order/order.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <optional>
#include <span>

namespace gs::app {
namespace {

const ExportFormat* format_of(const ExportCommand& options) {
  const ExportFormat* format = export_format_of(options.files.back());
  return options.vrml97 && format && !format->name.starts_with("vrml97") ? nullptr : format;
}

// Appends the shape and the harmonics of a splat.
void put_gaussian(const qnv::Gaussians& from, std::size_t i, qnv::Gaussians& to) {
  to.degree = from.degree;
  to.antialiased = from.antialiased;
  to.scales.push_back(from.scales[i]);
  to.rotations.push_back(from.rotations[i]);
  to.opacities.push_back(from.opacities[i]);
  to.bases.push_back(from.bases[i]);
  const std::size_t per = qnv::harmonic_count(from.degree);
  for (std::size_t k = 0; k < per; ++k) to.harmonics.push_back(from.harmonics[i * per + k]);
}

// Returns the first `count` vectors in progressive order. For a surface, scales the areas so that their sum stays the
// same.
qnv::Geometry thinned(const qnv::Geometry& source, std::size_t count, const ConversionOptions& options,
                      Progress& progress) {
  const qnv::VectorView all(source);
  const auto* gaussians = source.as<qnv::Gaussians>();
  qnv::OrderOptions order_options;
  order_options.seed = options.seed;
  order_options.kind = all.kind;
  order_options.progress = &progress;
  progress.stage = "thinning";
  std::vector<std::uint32_t> order = qnv::progressive_order(all.positions, all.normals, all.weights, order_options);
  order.resize(std::min(order.size(), count));
  qnv::Geometry geometry;
  if (all.kind == qnv::Kind::volume) geometry = qnv::Volume();
  if (gaussians) geometry = qnv::Gaussians();
  geometry.base() = {all.description, all.color};
  auto* volume = geometry.as<qnv::Volume>();
  qnv::VectorArrays& out = *geometry.arrays();
  for (const std::uint32_t i : order) {
    out.positions.push_back(all.positions[i]);
    out.normals.push_back(all.normals[i]);
    out.weights.push_back(all.weights[i]);
    if (!all.colors.empty()) out.colors.push_back(all.colors[i]);
    if (volume && !all.classes.empty()) volume->classes.push_back(all.classes[i]);
    if (gaussians) put_gaussian(*gaussians, i, *geometry.as<qnv::Gaussians>());
  }
  const double whole = std::accumulate(all.weights.begin(), all.weights.end(), 0.0),
               kept = std::accumulate(out.weights.begin(), out.weights.end(), 0.0);
  if (!volume && kept > 0)
    for (float& weight : out.weights) weight = static_cast<float>(weight * (whole / kept));
  return geometry;
}

// Returns the URL of the file `in`, relative to a world in the file `out`.
std::string url_between(const std::string& out, const std::string& in) {
  std::error_code error;
  const auto folder = std::filesystem::absolute(out, error).parent_path();
  const auto path = std::filesystem::relative(in, folder, error);
  if (error || path.empty()) return {};
  const std::string url = net::url_of_path("/" + path.generic_string()).path;
  return url.substr(std::min<std::size_t>(url.size(), 1));
}

// Writes a stream of outlines as a world that any browser shows.
int export_outlines(vrml::SceneGraph& scene, const std::string& in, const std::string& out, const SceneFormat& format) {
  // Only the browser sets the field `complete`. Worlds must not contain it.
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
    if (const vrml::NodeId id = scene.resolve_as(scene.nodes().id_at(i), vrml::NodeKind::outline_group))
      scene.set<vrml::SFBool>(id, "complete", false);
  std::vector<std::byte> bytes = outline_world(scene, std::filesystem::path(in).stem().string());
  if (format.grammar != vrml::Grammar::vrml97) {
    Exported made = x3d_text(bytes, format.grammar);
    if (const auto* problem = std::get_if<std::string>(&made)) return fail(out + ": " + *problem);
    bytes = std::move(std::get<std::vector<std::byte>>(made));
  }
  if (const auto refusal = refuse_to_replace(out, in, bytes)) return fail(*refusal);
  if (const auto problem = net::write_file_atomically(out, bytes)) return fail_to_write(problem->message);
  print_line("%s: outline groups, %zu bytes", out.c_str(), bytes.size());
  return kDone;
}

// File to write, with its path.
struct WrittenFile {
  std::string path;
  std::span<const std::byte> bytes;
};

// Returns the voxels of a file as they are stored.
std::shared_ptr<qnv::VolumeValues> values_of_file(const qnv::VolumeSource& volume) {
  auto values = std::make_shared<qnv::VolumeValues>();
  values->stored = volume.layout.type;
  values->slope = volume.layout.slope;
  values->intercept = volume.layout.intercept;
  values->missing = volume.layout.missing;
  values->exact = true;
  values->source = volume;
  for (const qnv::VolumeSource& component : volume.components) values->components.push_back(values_of_file(component));
  return values;
}

// Returns the geometry of an input. Formats with triangles get those of the input, without the losses of a stream.
std::variant<qnv::Geometry, qnv::EncodeError> converted(const ExportCommand& options, const ExportFormat& format,
                                                        OpenedInput input, ProgressBar& progress) {
  if (auto* volume = std::get_if<qnv::VolumeSource>(&input.content);
      volume && (format.keeps & kNeedsValues) != 0 && !options.isovalue) {
    auto values = values_of_file(*volume);
    for (const qnv::VolumeSource& step : volume->steps) values->steps.push_back(values_of_file(step));
    values->times = volume->times;
    qnv::Volume made;
    made.values = std::move(values);
    return qnv::Geometry(std::move(made));
  }
  if ((format.keeps & kKeepsTriangles) != 0 && options.vectors == 0)
    if (auto mesh = mesh_of_input(options, input, progress)) return std::move(*mesh);
  return geometry_of_input(options, std::move(input), progress);
}

std::string shortest_text(float value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", static_cast<double>(value));
  return text;
}

// Returns the content of a written file, in the words of users.
std::string contents_of(const ExportFormat& format, const qnv::Geometry& geometry,
                        const std::vector<CompanionFile>& beside) {
  const auto* mesh = (format.keeps & kKeepsTriangles) != 0 ? geometry.as<qnv::IndexedMesh>() : nullptr;
  if ((format.keeps & kNeedsValues) != 0) {
    const auto& values = *geometry.as<qnv::Volume>()->values;
    const auto& [x, y, z] = values.source.layout.dimensions;
    const std::string error = values.exact   ? "exact"
                              : values.error ? "within " + shortest_text(*values.error)
                              : values.wrong ? shortest_text(100 * *values.wrong) + " % of the labels wrong"
                                             : "of a part of the stream";
    const std::size_t numbers = values.components.size();
    const std::string steps = values.steps.empty() ? "" : std::to_string(values.steps.size()) + " steps of ";
    return steps + std::to_string(x) + " x " + std::to_string(y) + " x " + std::to_string(z) + " voxels" +
           (values.source.layout.colors ? " of colours"
            : numbers > 1               ? " of " + std::to_string(numbers) + " numbers"
                                        : "") +
           ", " + error;
  }
  std::string text = mesh && !mesh->triangles.empty() ? counted(mesh->size(), "vertex", "vertices") + ", " +
                                                            counted(mesh->triangles.size() / 3, "triangle", "triangles")
                                                      : counted(geometry.size(), "splat", "splats");
  for (const CompanionFile& file : beside) text += ", " + file.name;
  return text;
}

// Paths of a conversion.
struct ExportPaths {
  const std::string &in, &out;
};

// Writes a file in pieces. Returns the exit status, kDone on success.
int write_in_pieces(const ExportFormat& format, const qnv::Geometry& geometry, const ExportOptions& options,
                    const ExportPaths& paths, ProgressBar& progress, std::uint64_t& bytes) {
  std::optional<net::AtomicFile> file;
  std::optional<int> refused;
  const auto take = [&](std::span<const std::byte> piece) {
    if (progress.cancelled()) return false;
    if (!file && !piece.empty()) {
      if (const auto refusal = refuse_to_replace(paths.out, paths.in, piece)) {
        refused = fail(*refusal);
        return false;
      }
      auto begun = net::AtomicFile::begin(paths.out);
      if (const auto* problem = std::get_if<net::FileError>(&begun)) {
        refused = fail_to_write(problem->message);
        return false;
      }
      file.emplace(std::move(std::get<net::AtomicFile>(begun)));
    }
    bytes += piece.size();
    return piece.empty() || file->write(piece);
  };
  const auto problem = format.write_pieces(geometry, options, take);
  if (refused) return *refused;
  if (progress.cancelled()) return fail("cancelled; " + paths.out + " was not written");
  if (file && file->problem()) return fail_to_write(file->problem()->message);
  if (problem) return fail(paths.out + ": " + *problem);
  if (file)
    if (const auto unfinished = file->commit()) return fail_to_write(unfinished->message);
  return kDone;
}

}  // namespace

std::optional<std::string> check_export(const ExportCommand& options) {
  const std::string& out = options.files.back();
  const ExportFormat* format = format_of(options);
  if (!format && !options.vrml97 && scene_format_of(out)) return std::nullopt;  // .wrz, .x3dz, ...
  if (format && (format->keeps & kNeedsTriangles) != 0 && options.vectors > 0)
    return std::string(format->extension) + " holds triangles only; --vectors excludes it";
  if (format && (format->keeps & kNeedsValues) != 0 && (options.vectors > 0 || options.isovalue))
    return std::string(format->extension) + " holds the values of a volume; --vectors and --isovalue exclude it";
  if (format) return std::nullopt;
  return options.vrml97 ? "expected OUT.wrl with --vrml97, not '" + out + "'"
                        : "unknown extension of '" + out + "'; expected one of: " + export_format_list();
}

int run_export(const ExportCommand& options) {
  const std::string &in = options.files[0], &out = options.files[1];
  const auto start = std::chrono::steady_clock::now();
  std::error_code error;
  if (std::filesystem::equivalent(in, out, error)) return fail(out + " is also the input; not overwritten");
  if (const SceneFormat* const scene = scene_format_of(out);
      scene && !options.vrml97 && options.splats.empty() && exports_scene(options, in))
    return export_scene(options, in, out, *scene);
  ProgressBar progress;
  progress.whole().stage = "reading";
  const ExportFormat* const chosen = format_of(options);
  std::optional<OpenedInput> input;
  if (chosen && (chosen->keeps & kNeedsValues) != 0) input = open_values_stream(in);
  if (!input) input = open_input(options, in);
  if (!input) return kFailed;
  if (const auto problem = choose_step(options.component, *input)) return fail(in + ": " + *problem);
  if (const auto problem = choose_component(options.component, *input)) return fail(in + ": " + *problem);
  if (const auto problem = edit_input(options.splats, *input)) return fail(in + ": " + *problem);
  if (!format_of(options)) return fail(out + ": only scenes and meshes are written compressed; expected .wrl or .x3d");
  const ExportFormat& format = *format_of(options);
  if (auto* world = std::get_if<std::unique_ptr<OpenedSurface>>(&input->content);
      world && input->type == "QNV" && scene_format_of(format.extension))
    return export_outlines(*(*world)->world.scene, in, out, *scene_format_of(format.extension));
  ExportOptions export_options;
  export_options.title = input->title;
  export_options.name = std::filesystem::path(out).stem().string();
  if (input->type == "QNV") export_options.stream_url = is_url_input(in) ? in : url_between(out, in);
  const std::uint64_t in_bytes = input->bytes;
  std::vector<std::string> losses = lost_properties(*input);
  auto made = converted(options, format, std::move(*input), progress);
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  if (const auto* problem = std::get_if<qnv::EncodeError>(&made)) return fail(in + ": " + problem->message);
  auto& geometry = std::get<qnv::Geometry>(made);
  for (const auto& [key, value] : geometry.description().metadata)
    if (key == "title" && !value.empty()) export_options.title = value;
  if (options.vectors > 0 && (format.keeps & kNeedsValues) == 0 && geometry.size() > options.vectors)
    geometry = thinned(geometry, options.vectors, options, progress.whole());
  for (std::string& loss : export_losses(format, geometry)) losses.push_back(std::move(loss));
  if (auto* mesh = geometry.as<qnv::IndexedMesh>(); mesh && mesh->picture && (format.keeps & kKeepsTexture) == 0)
    color_by_picture(*mesh, std::make_shared<Budget>(options.limits));
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  progress.whole().stage = "writing";
  if (format.write_pieces) {
    std::uint64_t out_bytes = 0;
    if (const int status = write_in_pieces(format, geometry, export_options, {in, out}, progress, out_bytes))
      return status;
    progress.hide();
    print_losses(in, losses);
    print_conversion({in, in_bytes, out, out_bytes, contents_of(format, geometry, {})}, start);
    return kDone;
  }
  std::vector<CompanionFile> beside;
  export_options.beside = &beside;
  const Exported exported = format.write(geometry, export_options);
  if (const auto* problem = std::get_if<std::string>(&exported)) return fail(out + ": " + *problem);
  const auto& bytes = std::get<std::vector<std::byte>>(exported);
  std::vector<WrittenFile> written{{out, bytes}};
  for (const CompanionFile& file : beside)
    written.push_back({(std::filesystem::path(out).parent_path() / file.name).string(), file.bytes});
  for (const WrittenFile& file : written)
    if (const auto refusal = refuse_to_replace(file.path, in, file.bytes)) return fail(*refusal);
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  for (const WrittenFile& file : written)
    if (const auto problem = net::write_file_atomically(file.path, file.bytes)) return fail_to_write(problem->message);
  progress.hide();
  print_losses(in, losses);
  print_conversion({in, in_bytes, out, bytes.size(), contents_of(format, geometry, beside)}, start);
  return kDone;
}

}  // namespace gs::app
