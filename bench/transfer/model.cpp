#include "bench/transfer/model.h"

#include "app/encode/outline_model.h"
#include "app/encode/surface_triangles.h"
#include "app/loading/world_loader.h"
#include "bench/shared/mesh_files.h"
#include "net/files/file.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>

namespace gs::bench {
namespace {

namespace fs = std::filesystem;

bool write(const std::string& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(out.flush());
}

std::optional<std::string> read(const std::string& path) {
  const auto file = net::map_file(path);
  const auto* mapped = std::get_if<net::MappedFile>(&file);
  if (!mapped) return std::nullopt;
  return std::string(reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size());
}

}  // namespace

std::uint64_t Model::size(const Format& format) const {
  std::error_code error;
  const auto bytes = fs::file_size(folder() + "/" + std::string(format.file), error);
  return error ? 0 : bytes;
}

// Makes the world to send, and its gzip'd form.
std::optional<std::string> Model::make_world() {
  const std::string path = folder() + "/model.wrl";
  std::string text;
  if (fs::path(options_.file).extension() == ".wrl") {
    auto bytes = read(options_.file);
    if (!bytes) return options_.file + " cannot be read";
    text = std::move(*bytes);
  } else {
    const app::LoadedWorld world = app::load_world(options_.file);
    if (!world.scene) return options_.file + " cannot be opened";
    render::MeshCache cache;
    const render::RenderList list = render::collect(*world.scene, world.images, cache);
    for (const render::DrawItem& item : list.items)
      if (item.mesh) crease_angle_ = std::max(crease_angle_, app::crease_angle_of(*item.mesh));
    text = vrml_text(welded(list), crease_angle_);
  }
  if (!write(path, text) || !write(path + ".gz", gzipped(text))) return path + " cannot be written";
  return std::nullopt;
}

// Loads Draco's output with the shading of the model.
void Model::take_draco(const std::string& base) {
  const app::LoadedWorld world = app::load_world(base + ".out.obj");
  if (!world.scene) return;
  render::MeshCache cache;
  const std::string text = vrml_text(welded(render::collect(*world.scene, world.images, cache)), crease_angle_);
  std::error_code error;
  if (write(base + ".out.wrl", text)) fs::rename(base + ".drc", folder() + "/model.drc", error);
}

std::optional<std::string> Model::make_streams(const render::RenderList& full) {
  const app::SurfaceSummary summary = app::summarize_surface(full);
  triangles_ = summary.triangles;
  // Draco is optional. Without its programs the table has no row for it.
  const std::string base = options_.folder + "/model";
  if (write_obj(welded(full), base + ".obj") && make_draco(base, options_.draco_bits)) take_draco(base);
  constexpr std::size_t kWithoutDraco = 200'000;
  const std::uint64_t draco = size(*format_named("draco"));
  for (const auto payload : {qnv::Payload::packed, qnv::Payload::records}) {
    const bool packed = payload == qnv::Payload::packed;
    qnv::EncodeOptions options;
    options.two_sided = summary.two_sided;
    if (packed)
      options.max_bytes = options_.packed_bytes > 0 ? options_.packed_bytes : draco > 0 ? 2 * draco : kWithoutDraco;
    else
      options.vectors = options_.record_vectors;
    const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) {
      return app::for_each_triangle(full, sink);
    };
    const auto encoded = packed ? qnv::encode_surface(source, options) : qnv::encode_surface_records(source, options);
    if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return problem->message;
    const auto& stream = std::get<qnv::EncodedStream>(encoded);
    (packed ? packed_vectors_ : record_vectors_) = stream.header.vectors;
    const std::string path = folder() + (packed ? "/packed.qnv" : "/records.qnv");
    if (const auto problem = net::write_file_atomically(path, stream.bytes)) return problem->message;
  }
  return std::nullopt;
}

std::optional<std::string> Model::make_outlines(const render::RenderList& full) {
  const app::OutlineModel model = app::outline_model(full, {});
  qnv::OutlineOptions options;
  options.tolerance = options.outline_tolerance = options_.tolerance * qnv::model_diagonal(model.model);
  const auto grouped = qnv::group_outlines(model.model, options);
  if (const auto* problem = std::get_if<qnv::OutlineError>(&grouped)) return problem->message;
  const auto& groups = std::get<qnv::OutlineGroups>(grouped);
  outline_groups_ = groups.groups.size();
  const auto encoded = qnv::encode_outlines(groups, model.appearances, {});
  if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return problem->message;
  const auto problem =
      net::write_file_atomically(folder() + "/outlines.qnv", std::get<qnv::EncodedStream>(encoded).bytes);
  return problem ? std::optional(problem->message) : std::nullopt;
}

std::variant<std::unique_ptr<Model>, std::string> Model::make(const ModelOptions& options, Studio& studio) {
  std::unique_ptr<Model> model(new Model(options, studio));
  std::error_code error;
  fs::create_directories(model->folder(), error);
  if (auto problem = model->make_world()) return *problem;
  const app::LoadedWorld world = app::load_world(model->folder() + "/model.wrl");
  if (!world.scene) return options.file + " cannot be opened";
  render::MeshCache cache;
  const render::RenderList full = render::collect(*world.scene, world.images, cache);
  if (auto problem = model->make_streams(full)) return *problem;
  if (auto problem = model->make_outlines(full)) return *problem;
  model->bounds_ = full.bounds;
  model->reference_ = studio.pictures(full, full.bounds, std::span(&options.view, 1));
  if (model->reference_.empty()) return options.file + " cannot be drawn";
  return model;
}

Shown Model::compare(const render::RenderList& list) {
  const auto pictures = studio_.pictures(list, bounds_, std::span(&options_.view, 1));
  if (pictures.empty()) return {};
  const auto lit = [](std::uint8_t value) { return value != 0; };
  return {std::any_of(pictures[0].pixels.begin(), pictures[0].pixels.end(), lit), picture_error(pictures, reference_)};
}

std::optional<Shown> Model::show_world(const std::string& path, std::uint64_t bytes) {
  app::LoadOptions options;
  options.max_bytes = bytes;
  options.offline = true;
  const app::LoadedWorld world = app::load_world(path, options);
  if (!world.scene) return std::nullopt;
  render::MeshCache cache;
  return compare(render::collect(*world.scene, world.images, cache));
}

std::optional<Shown> Model::show(const Format& format, std::uint64_t bytes) {
  const std::string path = folder() + "/" + std::string(format.file);
  if (format.prefix == Prefix::world) return show_world(path, bytes);
  if (format.prefix == Prefix::none)
    return bytes < size(format) ? std::nullopt : show_world(options_.folder + "/model.out.wrl", std::uint64_t{1} << 40);
  const auto file = net::map_file(path);
  const auto* mapped = std::get_if<net::MappedFile>(&file);
  if (!mapped) return std::nullopt;
  qnv::StreamDecoder decoder;
  (void)decoder.push(mapped->bytes().first(std::min<std::size_t>(bytes, mapped->bytes().size())));
  return compare(list_of(decoder.geometry()));
}

Thresholds Model::thresholds(const Format& format) {
  constexpr std::uint64_t kStep = 32;
  Thresholds result;
  result.size = size(format);
  const auto end = show(format, result.size);
  if (!end) return result;
  result.end = end->error;
  if (format.prefix == Prefix::none) {
    result.first = result.size;
    if (end->error.ssim >= kUsable) result.usable = result.size;
    return result;
  }
  const auto anything = [&](std::uint64_t bytes) {
    const auto shown = show(format, bytes);
    return shown && shown->anything;
  };
  const auto usable = [&](std::uint64_t bytes) {
    const auto shown = show(format, bytes);
    return shown && shown->error.ssim >= kUsable;
  };
  if (end->anything) result.first = least(1, result.size, kStep, anything);
  if (end->error.ssim >= kUsable) result.usable = least(result.first.value_or(1), result.size, kStep, usable);
  return result;
}

}  // namespace gs::bench
