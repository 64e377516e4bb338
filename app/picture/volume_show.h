#pragma once

#include "app/picture/paint.h"
#include "app/view/derived/volume_scene.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/slice_scene.h"
#include "app/view/values/slices.h"
#include "app/view/values/transfer_editor.h"
#include "app/view/values/volume_display.h"
#include "app/view/values/volume_grid.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Options that determine how a picture shows a volume.
struct VolumeWishes {
  std::string transfer;  // colour map or transfer function file; empty means the volume's own transfer function
  std::vector<SliceWish> slices;
  VolumeSlices slice_look;  // look of the slices; their number and positions are in `slices`
  VolumeDisplay display;
  VoxelComponent component;  // of a volume file
  bool color_bar = false;
  [[nodiscard]] bool any() const { return !transfer.empty() || !slices.empty() || color_bar || display.needs_values(); }
};

/// Message about options that need the values of a volume.
inline constexpr std::string_view kValuesNeeded =
    "the input has no values of voxels; --slice, --isovalue, --projection and --fraction expect a volume, or a stream "
    "of its values";

/// Sets the display of a volume, and the look of its slices. An isosurface hides the vectors, but not projections.
void apply_display(const VolumeWishes& wishes, VolumeDisplay& display, VolumeSlices& slices);

/// Object that applies VolumeWishes to one picture.
class VolumeShow {
 public:
  /// Reads the data that the options need. Returns a message on failure. `path` is the file of the world, from which
  /// slices read voxel values. `key` describes the values that surface colours stand for.
  [[nodiscard]] std::optional<std::string> prepare(const VolumeWishes& wishes, const std::string& path,
                                                   const render::RenderList& list, const std::optional<ColorKey>& key,
                                                   const WorldBudget& budget);
  /// Returns the values that the picture shows besides the vectors, as far as prepare() has found their places.
  [[nodiscard]] render::VolumeReading reading(const VolumeWishes& wishes, const render::RenderList& list) const;
  /// Applies the options to the render list, the splat style and the overlay of `scene`. This object must outlive
  /// `scene`.
  void apply(PictureScene& scene);

 private:
  VolumeWishes wishes_;
  std::optional<ColorBar> surface_bar_;
  Transfer transfer_;  // empty means the volume's own transfer function
  VolumeSlices slices_;
  std::optional<std::string> derive(const qnv::Geometry& geometry, const WorldBudget& budget);

  VolumeDisplay display_;
  std::shared_ptr<const VolumeGrid> grid_;
  VolumeContent content_;
  SliceScene slice_scene_;
  VolumeScene volume_scene_;
};

/// Returns the axis of a volume of one layer of voxels, such as an image; nullopt for other volumes.
[[nodiscard]] std::optional<std::size_t> image_axis(const qnv::Description& volume);
/// Returns true if the local file `path` has the values of a volume, which slices show. Reads the start of the file.
[[nodiscard]] bool has_volume_values(const std::string& path);
/// Shows the only layer of an image as a slice, with colours for nearly all of its values. Replaces `slices`, except
/// its colour map and window.
void show_image(const VolumeGrid& grid, std::size_t axis, VolumeSlices& slices);
/// Returns the transfer function with the name of a colour map, or from a file with the path `name`. Returns a message
/// if `name` is neither.
[[nodiscard]] std::variant<Transfer, std::string> named_transfer(const std::string& name,
                                                                 const qnv::Description& volume);
/// Returns the colour bar of a displayed volume: that of its slices if only slices or a projection are visible, else
/// that of its transfer function.
[[nodiscard]] ColorBar shown_color_bar(const qnv::Description& volume, const Transfer& transfer,
                                       const VolumeSlices& slices, const VolumeDisplay& display);
/// Returns the geometry of the first volume in a list; null if the list has no volume.
[[nodiscard]] std::shared_ptr<const qnv::Geometry> first_volume_geometry(const render::RenderList& list);
/// Returns the description of the first volume in a list; null if the list has no volume.
[[nodiscard]] const qnv::Description* first_volume(const render::RenderList& list);

}  // namespace gs::app
