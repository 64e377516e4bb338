#pragma once

#include "app/commands/options/options.h"
#include "app/commands/progress_bar.h"
#include "app/encode/mesh_stream.h"
#include "app/encode/outline_model.h"
#include "app/world/opened_world.h"
#include "net/files/file.h"
#include "qnv/encode/encode_surface.h"
#include "qnv/volume/volume.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// A world's surfaces, ready to be encoded.
struct OpenedSurface {
  OpenedWorld world;
  render::MeshCache meshes;
  render::RenderList list;
};

/// What a file is to `encode`, `export` and `info`.
using Opened = std::variant<qnv::VolumeSource, qnv::Cloud, std::unique_ptr<OpenedSurface>, MeshStream>;

/// What is in a file, and what it is called.
struct OpenedInput {
  Opened content;
  std::string type;   // the content type's name
  std::string title;  // of a world, else the file's name
  std::size_t bytes = 0;
  Upright upright{};                            // by its format, where the file itself does not say
  std::shared_ptr<const net::MappedFile> file;  // of which a MeshStream is read
};

/// The most triangles that may be held while they are encoded as displacements: more are thinned to so many.
[[nodiscard]] std::size_t most_encoded_triangles(const vrml::Limits& limits);

/// Opens a file of any type; as headerless volume where the options have dimensions. Prints what is wrong; nothing
/// when there is nothing to work with.
[[nodiscard]] std::optional<OpenedInput> open_input(const Options& options, const std::string& path);

/// How what is made of it stands: as the options say, else as the file does.
[[nodiscard]] Upright wanted_upright(const Options& options, const OpenedInput& input);

/// Encodes an input as the options say; surfaces packed unless `records`.
[[nodiscard]] std::variant<qnv::EncodedStream, qnv::EncodeError> encode_input(const Options& options,
                                                                              const OpenedInput& input,
                                                                              ProgressBar& progress);

/// Memory that a triangle takes while outline groups are made.
inline constexpr std::uint64_t kOutlineTriangleBytes = 400;

/// The isosurface of a volume as polygons; what went wrong.
[[nodiscard]] std::variant<OutlineModel, std::string> isosurface_outlines(const Options& options,
                                                                          const qnv::VolumeSource& volume,
                                                                          ProgressBar& progress);

/// The vectors of an input: those it has, a volume's gradients, or those that its surface is encoded as.
[[nodiscard]] std::variant<qnv::Cloud, qnv::EncodeError> cloud_of_input(const Options& options, OpenedInput input,
                                                                        ProgressBar& progress);

}  // namespace gs::app
