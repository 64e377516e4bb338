#include "app/commands/common/input_surface.h"

#include "app/encode/mesh_joiner.h"
#include "app/encode/surface_triangles.h"
#include "app/encode/textured_surface.h"
#include "qnv/sampling/volume/isosurface.h"

#include <string_view>
#include <utility>

namespace gs::app {
namespace {

// JPEG quality of a texture image in an exported mesh, if it was painted from several textures.
constexpr int kExportedTextureQuality = 95;

// Returns a surface with this summary; `send(sink, origin)` sends its triangles.
template <class Send>
InputSurface surface_of(const SurfaceSummary& summary, Send send) {
  InputSurface surface;
  surface.origin = qnv::local_origin(summary.box);
  surface.source = [send, origin = surface.origin](const qnv::TriangleSink& sink) { return send(sink, origin); };
  surface.triangles = summary.triangles;
  surface.two_sided = summary.two_sided;
  surface.shine = summary.shine;
  return surface;
}

InputSurface surface_of(const OpenedSurface& opened) {
  const SurfaceSummary summary = summarize_surface(opened.list);
  InputSurface surface =
      surface_of(summary, [&list = opened.list](const qnv::TriangleSink& sink, const glm::dvec3& origin) {
        return for_each_triangle(list, sink, origin);
      });
  if (summary.textured) surface.textured = &opened.list;
  return surface;
}

InputSurface surface_of(const MeshSurface& mesh) {
  return surface_of(mesh.summary, [&mesh](const qnv::TriangleSink& sink, const glm::dvec3& origin) {
    return for_each_triangle(mesh, sink, origin);
  });
}

// Returns the surface of a mesh file. Such a file is usually a scan and may not be closed. So the faces are two-sided,
// as in a world.
InputSurface surface_of(const MeshStream& mesh) {
  InputSurface surface;
  surface.two_sided = true;
  surface.origin = mesh.origin;
  surface.triangles = static_cast<std::size_t>(mesh.faces);
  surface.source = mesh.source;
  return surface;
}

}  // namespace

InputSurface isosurface_of(const qnv::VolumeSource& volume, double isovalue, ProgressBar& progress) {
  InputSurface surface;
  surface.two_sided = true;
  surface.origin = volume.layout.base;
  surface.source = [&volume, isovalue, problem = surface.problem, &progress](const qnv::TriangleSink& sink) {
    qnv::IsosurfaceOptions options;
    options.isovalue = isovalue;
    bool wanted = true;
    const auto error = qnv::isosurface(
        volume, options,
        [&](std::span<const qnv::Triangle> triangles) {
          wanted = sink(triangles);
          return wanted;
        },
        &progress.part());
    if (error) *problem = error->message;
    return wanted && !error;
  };
  return surface;
}

std::optional<InputSurface> input_surface(const OpenedInput& input, std::optional<double> isovalue,
                                          ProgressBar& progress) {
  if (const auto* opened = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content)) return surface_of(**opened);
  if (const auto* mesh = std::get_if<MeshSurface>(&input.content)) return surface_of(*mesh);
  if (const auto* mesh = std::get_if<MeshStream>(&input.content)) return surface_of(*mesh);
  const qnv::VolumeSource* const volume = values_of(input);
  return volume && isovalue ? std::optional(isosurface_of(*volume, *isovalue, progress)) : std::nullopt;
}

qnv::TriangleSource with_progress(const InputSurface& surface, Progress& progress) {
  if (surface.source.runs() != 1) return surface.source;  // encoders report the progress of runs
  return [source = surface.source, total = surface.triangles, &progress](const qnv::TriangleSink& sink) {
    if (total == 0 || progress.stage.load() != std::string_view("reading")) return source(sink);
    progress.done = 0;
    progress.total = total;
    const bool wanted = source([&](std::span<const qnv::Triangle> triangles) {
      progress.done += triangles.size();
      return sink(triangles);
    });
    progress.total = progress.done = 0;  // the length of the next stage is unknown
    return wanted;
  };
}

std::size_t most_joined_triangles(const Limits& limits) { return limits.memory / 2 / MeshJoiner::kTriangleBytes; }

std::variant<qnv::IndexedMesh, qnv::EncodeError> indexed_mesh(const InputSurface& surface, std::size_t most_triangles,
                                                              ProgressBar& progress) {
  MeshJoiner joiner;
  std::optional<qnv::TexturedSurface> textured;
  progress.whole().stage = "reading";
  progress.whole().total = surface.triangles;
  progress.whole().done = 0;
  if (surface.textured) textured = textured_surface(*surface.textured, surface.origin, kExportedTextureQuality);
  bool too_many = false;
  if (textured) {
    for (std::size_t i = 0; i < textured->triangles.size(); ++i)
      joiner.add(textured->triangles[i], textured->coordinates[i]);
  } else {
    (void)surface.source([&](std::span<const qnv::Triangle> triangles) {
      for (const qnv::Triangle& triangle : triangles) joiner.add(triangle);
      progress.whole().done = joiner.triangles();
      too_many = joiner.triangles() > most_triangles;
      return !too_many && !progress.cancelled();
    });
  }
  if (!surface.problem->empty()) return qnv::EncodeError{*surface.problem};
  if (too_many)
    return qnv::EncodeError{"has more than " + std::to_string(most_triangles) +
                            " triangles, which exceed --memory; expected fewer, or a larger --memory"};
  if (joiner.triangles() == 0) return qnv::EncodeError{"has no triangles"};
  qnv::IndexedMesh mesh = joiner.take();
  mesh.description.origin = surface.origin;
  mesh.description.two_sided = surface.two_sided;
  if (textured) {
    auto picture = std::make_shared<qnv::SurfacePicture>();
    picture->bytes = std::move(textured->picture.back().bytes);
    picture->whole = true;
    picture->repeat_s = textured->repeat_s;
    picture->repeat_t = textured->repeat_t;
    mesh.picture = std::move(picture);
  }
  return mesh;
}

}  // namespace gs::app
