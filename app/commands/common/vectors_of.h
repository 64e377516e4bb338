#pragma once

#include "app/commands/common/option_groups.h"
#include "app/commands/common/progress_bar.h"
#include "app/encode/mesh_stream.h"
#include "app/encode/mesh_surface.h"
#include "app/encode/outline_model.h"
#include "app/loading/updates/loaded_world.h"
#include "net/files/file.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// Surfaces of a world, ready to be encoded.
struct OpenedSurface {
  LoadedWorld world;
  render::MeshCache meshes;
  render::RenderList list;
};

/// Content of a file for `encode`, `export` and `info`.
using Opened = std::variant<qnv::VolumeSource, qnv::Geometry, std::unique_ptr<OpenedSurface>, MeshSurface, MeshStream>;

/// Form in which a mesh file is opened. A plain one has no nodes and no renderer; a file that refers to others, such as
/// textures, becomes a world all the same.
enum class MeshForm : std::uint8_t { plain, world };

/// Opened file with its content, type and title.
struct OpenedInput {
  Opened content;
  std::string type;   // name of the content type
  std::string title;  // of a world; otherwise the file's name
  std::size_t bytes = 0;
  Upright upright{};                            // from the format, if the file itself gives none
  std::shared_ptr<const net::MappedFile> file;  // source of a MeshStream
};

/// Returns the maximum number of triangles held while a displaced payload is encoded. Larger meshes are simplified to
/// it.
[[nodiscard]] std::size_t most_encoded_triangles(const Limits& limits);

/// Opens a file of any type, or a volume without header if the options give dimensions. Prints errors; returns nullopt
/// if there is nothing to encode.
[[nodiscard]] std::optional<OpenedInput> open_input(const InputOptions& options, const std::string& path,
                                                    MeshForm form = MeshForm::plain);

/// Returns the up axis of the result: that of the options, else that of the file.
[[nodiscard]] Upright wanted_upright(const ConversionOptions& options, const OpenedInput& input);

/// Encodes an input as the options say (qnv::encode).
[[nodiscard]] std::variant<qnv::EncodedStream, qnv::EncodeError> encode_input(const ConversionOptions& options,
                                                                              const OpenedInput& input,
                                                                              ProgressBar& progress);

/// Memory per triangle while outline groups are made.
inline constexpr std::uint64_t kOutlineTriangleBytes = 400;

/// Returns the isosurface of a volume as polygons, or an error.
[[nodiscard]] std::variant<OutlineModel, std::string> isosurface_outlines(const ConversionOptions& options,
                                                                          const qnv::VolumeSource& volume,
                                                                          ProgressBar& progress);

/// Returns the vectors of an input: its own, the gradients of a volume, or those of its encoded surface.
[[nodiscard]] std::variant<qnv::Geometry, qnv::EncodeError> geometry_of_input(const ConversionOptions& options,
                                                                              OpenedInput input, ProgressBar& progress);

}  // namespace gs::app
