#include "app/commands/common/conversion_report.h"

#include "app/base/console.h"
#include "app/encode/surface_losses.h"
#include "app/encode/surface_triangles.h"
#include "app/formats/splats/splats.h"
#include "base/text.h"
#include "qnv/codecs/payloads.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdio>
#include <utility>

namespace gs::app {
namespace {

std::string readable_seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
  return text;
}

}  // namespace

std::string counted(std::uint64_t number, std::string_view one, std::string_view many) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text + " " + std::string(number == 1 ? one : many);
}

std::string StreamContents::text() const {
  return geometry + (texture ? ", texture" : "") + (mesh_at_end ? ", original mesh at the end" : "");
}

StreamContents contents_of(const qnv::EncodedStream& stream, const OpenedInput& input) {
  StreamContents contents;
  const std::string_view payload = qnv::row_of(stream.header).name;
  const auto* volume = std::get_if<qnv::VolumeSource>(&input.content);
  const bool voxels = stream.header.description.spacing > 0 && volume;
  std::string vectors = counted(stream.header.vectors, "splat", "splats");
  if (voxels)
    vectors =
        counted(stream.header.vectors, "of ", "of ") + counted(qnv::voxel_count(volume->layout), "voxel", "voxels");
  if (payload == "values") {
    const std::vector<qnv::ValueError>& errors = stream.header.grid.errors;
    char error[48] = "exact";
    if (!errors.empty() && errors.back().most > 0)
      std::snprintf(error, sizeof error, "within %.4g", static_cast<double>(errors.back().most));
    const bool labels = stream.header.grid.labels;
    const std::size_t steps = stream.header.steps.times.size();
    contents.geometry = (steps > 0 ? counted(steps, "step", "steps") + " of " : std::string()) +
                        (labels                      ? "labels of "
                         : stream.header.grid.colors ? "colours of "
                                                     : "values of ") +
                        counted(qnv::voxel_count(volume->layout), "voxel", "voxels") + ", " + error;
    return contents;
  }
  if (payload == "records")
    contents.geometry = "records of " + vectors;
  else if (payload == "displaced" || payload == "progressive")
    contents.geometry = std::string(payload) + " mesh";
  else if (payload == "gaussians")
    contents.geometry = counted(stream.header.vectors, "Gaussian", "Gaussians");
  else
    contents.geometry = "octree of " + vectors;
  contents.gaussians = payload == "gaussians";
  if (payload == "records" || contents.gaussians || voxels) return contents;
  // The mesh and the texture may be in pieces with parity, so only a decoder finds them.
  qnv::StreamDecoder decoder;
  (void)decoder.push(stream.bytes);
  contents.mesh_at_end = decoder.mesh().bytes > 0;
  contents.texture = decoder.mesh().texture_bytes > 0;
  return contents;
}

std::vector<std::string> lost_properties(const OpenedInput& input) {
  const auto* world = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content);
  std::vector<std::string> losses = input.losses;
  if (!world) return losses;
  for (std::string& loss : surface_losses((*world)->list)) losses.push_back(std::move(loss));
  const LoadedWorld& loaded = (*world)->world;
  if (loaded.scene && !loaded.scene->routes().empty())
    losses.push_back(counted(loaded.scene->routes().size(), "ROUTE", "ROUTEs") +
                     " for animation and interaction left out");
  return losses;
}

std::vector<std::string> lost_in_stream(const OpenedInput& input, const StreamContents& contents) {
  std::vector<std::string> losses;
  const auto* world = std::get_if<std::unique_ptr<OpenedSurface>>(&input.content);
  const auto* mesh = std::get_if<MeshSurface>(&input.content);
  const auto* geometry = std::get_if<qnv::Geometry>(&input.content);
  if (contents.gaussians)
    losses.push_back("positions, shapes, opacities and colours of splats are rounded; info names the errors");
  else if (geometry && geometry->as<qnv::Gaussians>())
    for (const auto& [key, value] : geometry->description().metadata)
      if (key == kSplatsAsDiscs) losses.push_back("splats become " + value);
  if (world) {
    const SurfaceSummary summary = summarize_surface((*world)->list);
    if (summary.textured && !contents.texture)
      losses.emplace_back("textures become colours of vertices, because one image cannot represent them");
    if (!summary.shine) losses.emplace_back("specular colours are left out, because they differ between Shapes");
  }
  if (mesh && !mesh->summary.shine)
    losses.emplace_back("specular colours are left out, because they differ between parts");
  if (mesh && mesh->face_colors) losses.emplace_back("colours of faces blend into each other at their corners");
  return losses;
}

void print_losses(const std::string& in, const std::vector<std::string>& losses) {
  for (const std::string& loss : losses) complain("%s: note: %s", in.c_str(), loss.c_str());
}

void print_conversion(const Conversion& conversion, std::chrono::steady_clock::time_point start) {
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  print_line("%s %s -> %s %s (%s), %s", conversion.in.c_str(), readable_size(conversion.in_bytes).c_str(),
             conversion.out.c_str(), readable_size(conversion.out_bytes).c_str(), conversion.contents.c_str(),
             readable_seconds(took.count()).c_str());
}

}  // namespace gs::app
