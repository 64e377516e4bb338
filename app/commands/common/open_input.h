#pragma once

#include "app/commands/common/option_groups.h"
#include "app/encode/grids/large_grid.h"
#include "app/encode/mesh_stream.h"
#include "app/encode/mesh_surface.h"
#include "app/encode/splat_file.h"
#include "app/formats/volume/file_states.h"
#include "app/loading/updates/loaded_world.h"
#include "net/files/file.h"
#include "qnv/sampling/volume/volume.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Surfaces of a world, read and ready for encoding.
struct OpenedSurface {
  LoadedWorld world;
  render::MeshCache meshes;
  render::RenderList list;
};

/// Content of an input of `encode`, `export` and `info`.
using Opened = std::variant<qnv::VolumeSource, qnv::Geometry, std::unique_ptr<OpenedSurface>, MeshSurface, MeshStream,
                            SplatFile, LargeGrid>;

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
  std::shared_ptr<const net::MappedFile> file;  // mapped file, if `content` is read in parts
  std::vector<std::shared_ptr<const FileStates>> others = {};  // states of the other files of volumes
};

/// Returns the maximum number of triangles in memory while a displaced payload is encoded. A larger mesh is simplified
/// to that number.
[[nodiscard]] std::size_t most_encoded_triangles(const Limits& limits);

/// Returns true for the URL of a server (http:, https:, ssh:, ...), which is read as --snapshot reads it.
[[nodiscard]] bool is_url_input(const std::string& path);
/// Returns the path of a local file: of a file: URL, or of the metadata of a container if the path is its folder.
[[nodiscard]] std::string local_input(const std::string& path);

/// Opens a file of any type. If the options give dimensions, the file is a volume without header. Prints errors.
/// Returns nullopt if there is nothing to encode.
[[nodiscard]] std::optional<OpenedInput> open_input(const InputOptions& options, const std::string& path,
                                                    MeshForm form = MeshForm::plain);

/// Surveys a local file with too many splats for one common tree (app/encode/splat_file.h). Returns nullopt for other
/// files, and for those that cannot be opened. Collective.
[[nodiscard]] std::optional<SplatSurvey> survey_many_splats(const std::string& path, qnv::Ranks& ranks);
/// Opens a local file with too many splats for one tree. If `known` is null, surveys it. Returns nullopt for others.
[[nodiscard]] std::optional<OpenedInput> open_many_splats(const std::string& path, const SplatSurvey* known = nullptr);
/// Opens a local file of an unstructured grid that exceeds memory (app/encode/grids/). Returns nullopt for other files.
[[nodiscard]] std::optional<OpenedInput> open_grid_in_parts(const InputOptions& options, const std::string& path);
/// Opens a stream of values for formats that need nothing else. Its slices are decoded when they are read, so that the
/// volume may exceed memory. Returns nullopt for other files, and for streams that cannot be opened in this way.
[[nodiscard]] std::optional<OpenedInput> open_values_stream(const std::string& path);
/// Replaces the values of a time series by those of the step that the user chose, if any. Returns a message if the
/// stream does not have it.
[[nodiscard]] std::optional<std::string> choose_step(const VoxelComponent& component, OpenedInput& input);
/// Opens volumes as the steps of a time series, with the times 0, 1, 2, ... Prints errors.
[[nodiscard]] std::optional<OpenedInput> open_steps(const InputOptions& options, std::span<const std::string> paths);
/// Replaces the values of a stream with several numbers per voxel by the number that the user chose, if any. Returns a
/// message if the stream does not have it.
[[nodiscard]] std::optional<std::string> choose_component(const VoxelComponent& component, OpenedInput& input);

/// Applies the user's edit of Gaussian splats, and adds a loss for each reason why splats were removed. Returns a
/// message if the input has no splats, or if none remains.
[[nodiscard]] std::optional<std::string> edit_input(const SplatEdit& edit, OpenedInput& input);

/// Returns the values of a volume: of its file, or those that its stream holds. Returns null for other inputs.
[[nodiscard]] const qnv::VolumeSource* values_of(const OpenedInput& input);

}  // namespace gs::app
