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

/// Surfaces of a world, read and ready for encoding.
struct OpenedSurface {
  LoadedWorld world;
  render::MeshCache meshes;
  render::RenderList list;
};

/// Content of an input of `encode`, `export` and `info`.
using Opened = std::variant<qnv::VolumeSource, qnv::Geometry, std::unique_ptr<OpenedSurface>, MeshSurface, MeshStream>;

/// Form in which a mesh file is opened. A plain one has no nodes and no renderer; a file that refers to others, such as
/// textures, becomes a world all the same.
enum class MeshForm : std::uint8_t { plain, world };

/// Input file after opening: its content, type and title.
struct OpenedInput {
  Opened content;
  std::string type;   // name of the content type of the file
  std::string title;  // title of a world, else the name of the file
  std::size_t bytes = 0;
  std::vector<std::string> losses = {};         // properties of the file that its importer does not keep, as messages
  Upright upright{};                            // orientation that the format implies, if the file defines none
  std::shared_ptr<const net::MappedFile> file;  // mapped file, if `content` is a MeshStream
};

/// Returns the maximum number of triangles in memory while a displaced payload is encoded. A larger mesh is simplified
/// to that number.
[[nodiscard]] std::size_t most_encoded_triangles(const Limits& limits);

/// Opens a file of any type. If the options give dimensions, the file is a volume without header. Prints errors.
/// Returns nullopt if there is nothing to encode.
[[nodiscard]] std::optional<OpenedInput> open_input(const InputOptions& options, const std::string& path,
                                                    MeshForm form = MeshForm::plain);

/// Returns the orientation of the output: that of the options, else that of the input.
[[nodiscard]] Upright wanted_upright(const ConversionOptions& options, const OpenedInput& input);

/// Opens a stream of values for formats that need nothing else. Its slices are decoded when they are read, so that the
/// volume may exceed memory. Returns nullopt for other files, and for streams that cannot be opened in this way.
[[nodiscard]] std::optional<OpenedInput> open_values_stream(const std::string& path);
/// Replaces the values of a stream with several numbers per voxel by the number that the user chose, if any. Returns a
/// message if the stream does not have it.
[[nodiscard]] std::optional<std::string> choose_component(const VoxelComponent& component, OpenedInput& input);

/// Outputs of an encoder that need no memory; see the members of qnv::EncodeOptions.
struct EncodeOutput {
  qnv::SpillStore* spill = nullptr;
  qnv::StreamSink* sink = nullptr;
};

/// Encodes an input (qnv::encode) with the settings of the options. Only volumes use `output`; other streams have their
/// bytes in memory.
[[nodiscard]] std::variant<qnv::EncodedStream, qnv::EncodeError> encode_input(const ConversionOptions& options,
                                                                              const OpenedInput& input,
                                                                              ProgressBar& progress,
                                                                              const EncodeOutput& output = {});

/// Returns the values of a volume: of its file, or those that its stream holds. Returns null for other inputs.
[[nodiscard]] const qnv::VolumeSource* values_of(const OpenedInput& input);

/// Returns the triangles of an input as a mesh, without the losses of a stream. Returns nullopt if it has none.
[[nodiscard]] std::optional<std::variant<qnv::Geometry, qnv::EncodeError>> mesh_of_input(
    const ConversionOptions& options, const OpenedInput& input, ProgressBar& progress);

/// Bytes per triangle while outline groups are made.
inline constexpr std::uint64_t kOutlineTriangleBytes = 400;

/// Returns the isosurface of a volume as polygons, or an error message.
[[nodiscard]] std::variant<OutlineModel, std::string> isosurface_outlines(const ConversionOptions& options,
                                                                          const qnv::VolumeSource& volume,
                                                                          ProgressBar& progress);

/// Returns the vectors of an input. If it has none, takes the gradients of a volume, or encodes the surface.
[[nodiscard]] std::variant<qnv::Geometry, qnv::EncodeError> geometry_of_input(const ConversionOptions& options,
                                                                              OpenedInput input, ProgressBar& progress);

}  // namespace gs::app
